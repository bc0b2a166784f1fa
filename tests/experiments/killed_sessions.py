"""Runs sessions in processes of their own, kills them from outside at random moments, and lets them go on.

Started by `test_unbreakable` as a program with one thread, so that it may fork: to start a hundred interpreters would
take minutes. It prints how many processes were killed before they were done, what the journals had lost by it, and
which participants there were.
"""

import json
import os
import random
import signal
import sys
import time
from itertools import cycle
from pathlib import Path

from gloss_experiments import read_protocol, run_session
from gloss_experiments.session.journal import journal_path
from gloss_experiments.session.journal_content import read_journal


def main(request):
    """Kill sessions of one participant after the other until there were as many kills as asked for."""
    rng, moments = random.Random(request["seed"]), cycle(request["moments"])
    # Unbroken ones too: they are what the others are compared with. The first one loads whatever is loaded late.
    unbroken_session(request, "01")
    kills, lost, participants = 0, 0, ["01"]
    while kills < request["kills"]:
        finished = False
        while not finished:
            before = n_answered(request, participants[-1])
            moment = next(moments) if kills < request["kills"] else None
            finished, confirmed = one_process(request, participants[-1], rng, moment)
            kills += not finished
            lost += max(0, before + confirmed - n_answered(request, participants[-1]))
        if kills < request["kills"]:
            participants.append(f"{len(participants) + 1:02d}")
            unbroken_session(request, participants[-1])
    print(json.dumps({"kills": kills, "lost": lost, "participants": participants}))


def unbroken_session(request, participant):
    run_session(request["protocol"], stimuli=request["stimuli"], dataset=request["unbroken"], participant=participant)


def n_answered(request, participant):
    task = read_protocol(request["protocol"]).name
    path = journal_path(request["broken"], participant=participant, session="1", task=task)
    return len(read_journal(path).answers) if path.exists() else 0


def one_process(request, participant, rng, moment):
    """Whether the process was done before it was killed, and how many trials it reported until then.

    `moment` says from when on the time to the kill is counted: the "start" of the process, the "first" trial that it
    answered, or the "last" one of the session; None lets it live.
    """
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reader)
        answer_trials(request, participant, writer, pause_s=request["pause_s"] if moment is not None else 0.0)
    os.close(writer)
    reports = b""
    if moment is not None:
        awaited = {"start": b"", "first": b".", "last": b"!"}[moment]
        while awaited not in reports and (more := os.read(reader, 1)):
            reports += more
        time.sleep(rng.uniform(0, request["longest_s"]))
        os.kill(child, signal.SIGKILL)
    while more := os.read(reader, 4096):
        reports += more
    os.close(reader)
    status = os.waitpid(child, 0)[1]
    killed = os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGKILL
    if not killed and os.WEXITSTATUS(status) != 0:
        sys.exit(f"a session of participant {participant} failed")
    return not killed, reports.count(b".")


def answer_trials(request, participant, writer, *, pause_s):
    """Run the session to its end, with a report after each trial; never returns."""

    def report(done, total):
        os.write(writer, b".!" if done == total else b".")
        time.sleep(pause_s)

    code = 1
    try:
        run_session(
            request["protocol"],
            stimuli=request["stimuli"],
            dataset=Path(request["broken"]),
            participant=participant,
            on_trial=report,
        )
        code = 0
    finally:
        os._exit(code)


if __name__ == "__main__":
    main(json.loads(sys.argv[1]))
