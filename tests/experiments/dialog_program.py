"""Run by test_dialog.py on a virtual display: fills in PsychoPy's dialog with real keys, and prints its answers."""

import json
import subprocess
import sys
import threading
import time

from gloss_experiments.window.dialog import ask_details


def xdotool(*words):
    return subprocess.run(["xdotool", *words], capture_output=True, text=True, timeout=20, check=False).stdout.split()


def answer(title, keys):
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline and not (windows := xdotool("search", "--name", title)):
        time.sleep(0.2)
    time.sleep(0.5)
    xdotool("windowfocus", windows[-1])
    for word, key in keys:
        xdotool(word, key)
        time.sleep(0.1)


def asked(title, keys):
    thread = threading.Thread(target=answer, args=(title, keys), daemon=True)
    thread.start()
    details = ask_details({"participant": None, "session": "1", "protocol": None}, title=title)
    thread.join(timeout=20)
    return details


if __name__ == "__main__":
    filled_in = asked("first", [("type", "07"), ("key", "Tab"), ("type", "doi"), ("key", "Return")])
    cancelled = asked("second", [("type", "08"), ("key", "Escape")])
    json.dump([filled_in, cancelled], sys.stdout)
