"""A hand on the real X pointer and keyboard, beside a person's session in the same process."""

import subprocess
import threading
import time

from framebuffer_watch import Watch

from gloss_experiments import run_session
from gloss_experiments.session.state import Phase
from gloss_experiments.window.pointer import slider_x


class Hand:
    """A hand on the real X pointer and keyboard."""

    def __init__(self, watch):
        self.watch = watch

    @staticmethod
    def xdotool(*words):
        subprocess.run(["xdotool", *map(str, words)], check=True, timeout=20)
        time.sleep(0.1)  # the hand rests: the window polls the pointer once a frame

    def key(self, *names):
        for name in names:
            self.xdotool("key", name)

    def to(self, place):
        self.xdotool("mousemove", round(640 + place[0]), round(512 - place[1]))

    def click(self, place):
        self.to(place)
        self.xdotool("mousedown", 1)
        self.xdotool("mouseup", 1)

    def drag(self, start, end):
        self.to(start)
        self.xdotool("mousedown", 1)
        self.to(((start[0] + end[0]) / 2, (start[1] + end[1]) / 2))
        self.to(end)
        self.xdotool("mouseup", 1)

    def on_slider(self, rating):
        layout = self.watch.screen.layout
        return slider_x(rating, layout), layout.slider[1]

    def until_shown(self):
        """Wait until the present trial stands on the screen: what is done in the blank before it counts for nothing."""
        self.watch.wait_for(lambda state: self.watch.screen._shown is state.trial)
        time.sleep(0.1)

    def begin(self):
        self.watch.wait_for(lambda state: state.phase is Phase.READY)
        self.watch.wait_for(lambda state: state.phase is Phase.RATING, lambda: self.key("space"))
        self.until_shown()


def with_a_hand(stimuli, folder, protocol, acts, *, participant):
    """A person's session in which `acts(watch, hand)` runs beside the window; Escape and Stop end it."""
    watch, failures, seen = Watch(stimuli), [], {}

    def run():
        hand = Hand(watch)
        try:
            seen.update(acts(watch, hand) or {})
        except Exception as error:
            failures.append(repr(error))
        hand.key("Escape", "Left", "Return")

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    result = run_session(protocol, stimuli=stimuli, dataset=folder, participant=participant, mode="screen")
    thread.join(timeout=20)
    return {
        "failures": failures,
        "answered": result.n_answered,
        "finished": result.data_path is not None,
        "simulated": result.simulated,
        "journal": str(result.journal_path),
        **watch.document(),
        **seen,
    }
