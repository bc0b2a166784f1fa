"""Run by test_screen.py in a process of its own, on a virtual display: PsychoPy keeps a window system of its own.

``window_program.py scripted SET DATASET`` and ``window_program.py pointer SET DATASET`` print one JSON document.
"""

import json
import subprocess
import sys
import threading
import time

import numpy as np
from PIL import Image

from gloss_experiments import read_protocol, run_session
from gloss_experiments.pointer import slider_x
from gloss_experiments.screen import Screen
from gloss_experiments.session import Phase
from glossspace.stimulus_set import read_stimulus_set


def region(frame, place, size):
    """The part of a frame that is `size` (width, height) about `place` (x, y from the centre, y upwards)."""
    height, width = frame.shape[:2]
    left, top = width // 2 + place[0] - size[0] // 2, height // 2 - place[1] - size[1] // 2
    return frame[top : top + size[1], left : left + size[0]]


class Watch:
    """Looks at each state that the screen shows, and at what the framebuffer then holds."""

    def __init__(self, stimuli):
        self.stimuli = read_stimulus_set(stimuli)
        self.frames_checked = self.differing_pixels = self.lit_around_images = 0
        self.brightest_before_response, self.dimmest_marker = 0, 255
        self.screen, self.state = None, None
        original = Screen.next_event

        def next_event(screen, state):
            self.screen, self.state = screen, state
            event = original(screen, state)
            if state.phase is Phase.RATING and event is not None:
                self.look(screen, state)
            return event

        Screen.next_event = next_event

    def look(self, screen, state):
        screen.draw(state)
        frame = screen.framebuffer()
        screen._window.clearBuffer()
        for name, place in zip(state.trial.stimuli, screen.layout.images, strict=True):
            image = np.asarray(Image.open(self.stimuli.image_path(name)).convert("RGB"))
            shown = region(frame, place, (image.shape[1], image.shape[0]))
            self.differing_pixels += int((shown != image).any(axis=2).sum())
            with_border = region(frame, place, (image.shape[1] + 8, image.shape[0] + 8)).copy()
            with_border[4:-4, 4:-4] = 0
            self.lit_around_images += int(with_border.any(axis=2).sum())
        if state.rating is not None:
            marker = region(frame, (round(slider_x(state.rating, screen.layout)), screen.layout.slider[1]), (4, 4))
            self.dimmest_marker = min(self.dimmest_marker, int(marker.max()))
        elif screen._slider.markerPos is None:
            line = region(frame, screen.layout.slider, (screen.layout.slider_size[0] + 40, 40))
            self.brightest_before_response = max(self.brightest_before_response, int(line.max()))
        self.frames_checked += 1

    def wait_for(self, condition, act, *, timeout_s=30):
        """Do `act`, again every second, until `condition` of the state is true."""
        deadline = time.monotonic() + timeout_s
        while time.monotonic() < deadline:
            act()
            again = time.monotonic() + 1
            while time.monotonic() < again:
                if self.state is not None and condition(self.state):
                    return
                time.sleep(0.01)
        raise TimeoutError(f"the screen stayed at {self.state}")


def scripted(stimuli, dataset):
    watch = Watch(stimuli)
    begin = time.monotonic()
    first = []
    result = run_session(
        "pairwise",
        stimuli=stimuli,
        dataset=dataset,
        participant="01",
        mode="simulate",
        on_trial=lambda done, total: first.append(time.monotonic() - begin),
    )
    return {
        "trials": result.n_answered,
        "frames_checked": watch.frames_checked,
        "differing_pixels": watch.differing_pixels,
        "lit_around_images": watch.lit_around_images,
        "brightest_before_response": watch.brightest_before_response,
        "dimmest_marker": watch.dimmest_marker,
        "window_size": [int(value) for value in watch.screen._window.size],
        "seconds_to_first_answer": first[0],
    }


def xdotool(*words):
    subprocess.run(["xdotool", *map(str, words)], check=True, timeout=20)


def pointer(stimuli, dataset):
    watch = Watch(stimuli)
    failures = []

    def hand():
        try:
            watch.wait_for(lambda state: state.phase is Phase.READY, lambda: None)
            watch.wait_for(lambda state: state.phase is Phase.RATING, lambda: xdotool("key", "space"))
            layout = watch.screen.layout

            def at(place):
                return round(640 + place[0]), round(512 - place[1])

            def click(place):
                xdotool("mousemove", *at(place))
                time.sleep(0.1)  # the hand rests: the window polls the pointer once a frame
                xdotool("mousedown", 1)
                time.sleep(0.1)
                xdotool("mouseup", 1)
                time.sleep(0.1)

            def on_slider(rating):
                return slider_x(rating, layout), layout.slider[1]

            # The space bar before a response means nothing; then a click on the slider, and the space bar confirms.
            xdotool("key", "space")
            watch.wait_for(lambda state: state.rating == 30, lambda: click(on_slider(30)))
            watch.wait_for(lambda state: state.n_answered == 1, lambda: xdotool("key", "space"))
            # Second trial: changed once, then confirmed with the button.
            watch.wait_for(lambda state: state.rating == 10, lambda: click(on_slider(10)))
            watch.wait_for(lambda state: state.rating == 75, lambda: click(on_slider(75)))
            watch.wait_for(lambda state: state.n_answered == 2, lambda: click(layout.button))
            # Third trial: rated but not confirmed, then Escape.
            watch.wait_for(lambda state: state.rating == 50, lambda: click(on_slider(50)))
        except Exception as error:
            failures.append(repr(error))
        xdotool("key", "Escape")

    thread = threading.Thread(target=hand, daemon=True)
    thread.start()
    result = run_session(read_protocol("pairwise"), stimuli=stimuli, dataset=dataset, participant="02", mode="screen")
    thread.join(timeout=20)
    return {
        "failures": failures,
        "answered": result.n_answered,
        "data": result.data_path,
        "simulated": result.simulated,
        "journal": str(result.journal_path),
        "differing_pixels": watch.differing_pixels,
        "frames_checked": watch.frames_checked,
    }


if __name__ == "__main__":
    program = {"scripted": scripted, "pointer": pointer}[sys.argv[1]]
    print(json.dumps(program(*sys.argv[2:4])))
