"""Looks at what a session's window shows, from within its process: the framebuffer is read back."""

import sys
import threading
import time

import numpy as np
from PIL import Image

from gloss_experiments.session.state import Phase
from gloss_experiments.window.pointer import slider_x
from gloss_experiments.window.screen import Screen
from glossspace.stimulus_set import read_stimulus_set


def region(frame, place, size):
    """The part of a frame that is `size` (width, height) about `place` (x, y from the centre, y upwards)."""
    height, width = frame.shape[:2]
    left, top = width // 2 + place[0] - size[0] // 2, height // 2 - place[1] - size[1] // 2
    return frame[top : top + size[1], left : left + size[0]]


class Watch:
    """Looks at each state that the screen shows, and at what the framebuffer then holds."""

    def __init__(self, stimuli, *, every=1):
        self.images = {
            stimulus.name: np.asarray(Image.open(read_stimulus_set(stimuli).image_path(stimulus.name)).convert("RGB"))
            for stimulus in read_stimulus_set(stimuli).stimuli
        }
        self.frames_checked = self.differing_pixels = self.lit_around_images = self.n_events = 0
        self.brightest_before_response, self.dimmest_marker = 0, 255
        self.phases = []
        self.opened_in_trials = []
        self.in_trial = False
        sys.addaudithook(self.note_opened)
        self.screen, self.state = None, None
        original, original_begin = Screen.next_event, Screen._begin

        def begin(screen, trial):
            original_begin(screen, trial)
            if self.n_events % every == 0:
                self.in_trial = False
                self.look(screen, self.state)
                self.in_trial = True

        def next_event(screen, state):
            if not self.phases or self.phases[-1] != state.phase.value:
                self.phases.append(state.phase.value)
            self.screen, self.state = screen, state
            self.in_trial = state.phase is Phase.RATING
            event = original(screen, state)
            self.in_trial = False
            if state.phase is Phase.RATING and event is not None:
                self.n_events += 1
                if self.n_events % every == 0:
                    self.look(screen, state)
            return event

        Screen.next_event, Screen._begin = next_event, begin

    def note_opened(self, event, details):
        if event == "open" and self.in_trial and threading.current_thread() is threading.main_thread():
            self.opened_in_trials.append(str(details[0]))

    def look(self, screen, state):
        screen.draw(state)
        frame = screen.framebuffer()
        screen._stage.window.clearBuffer()
        for name, place in self.shown(screen, state):
            image = self.images[name]
            self.differing_pixels += int((region(frame, place, image.shape[1::-1]) != image).any(axis=2).sum())
            with_border = region(frame, place, (image.shape[1] + 8, image.shape[0] + 8)).copy()
            with_border[4:-4, 4:-4] = 0
            self.lit_around_images += int(with_border.any(axis=2).sum())
        if not state.trial.items:
            self.look_at_the_slider(screen, state, frame)
        self.frames_checked += 1

    @staticmethod
    def shown(screen, state):
        if state.trial.items:
            ranking = screen._trial_screen
            return [(state.trial.stimuli[0], screen.layout.reference), (ranking._marked, screen.layout.candidate)]
        return zip(state.trial.stimuli, screen.layout.images, strict=True)

    def look_at_the_slider(self, screen, state, frame):
        if state.rating is not None and screen._trial_screen.slider.markerPos == state.rating:
            marker = region(frame, (round(slider_x(state.rating, screen.layout)), screen.layout.slider[1]), (4, 4))
            self.dimmest_marker = min(self.dimmest_marker, int(marker.max()))
        elif state.rating is None and screen._trial_screen.slider.markerPos is None:
            line = region(frame, screen.layout.slider, (screen.layout.slider_size[0] + 40, 40))
            self.brightest_before_response = max(self.brightest_before_response, int(line.max()))

    def document(self):
        return {
            "frames_checked": self.frames_checked,
            "differing_pixels": self.differing_pixels,
            "lit_around_images": self.lit_around_images,
            "brightest_before_response": self.brightest_before_response,
            "dimmest_marker": self.dimmest_marker,
            "phases": self.phases,
            "opened_in_trials": self.opened_in_trials,
            "window_size": list(self.screen._stage.size),
        }

    def wait_for(self, condition, act=lambda: None, *, timeout_s=30):
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
