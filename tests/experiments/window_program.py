"""Run by test_screen.py in a process of its own, on a virtual display: PsychoPy keeps a window system of its own.

``window_program.py WHAT SET FOLDER`` prints one JSON document.
"""

import json
import sys
import time
from dataclasses import replace

import numpy as np
from framebuffer_watch import Watch, region
from PIL import Image
from real_hand import with_a_hand
from window_texts import ARABIC, HEBREW

from gloss_experiments import read_protocol, run_session
from gloss_experiments.design import Trial
from gloss_experiments.session.state import Phase, start_session
from gloss_experiments.window.message_screen import MessageScreen
from gloss_experiments.window.screen import open_screen
from glossspace.errors import GlossError
from glossspace.stimulus_set import read_stimulus_set


def protocol_with(source, *, design=None, texts=None, display=None):
    """A shipped protocol with other values."""
    protocol = read_protocol(source)
    parts = {"design": design, "texts": texts, "display": display}
    document = protocol.model_dump()
    for name, values in parts.items():
        document[name] |= values or {}
    return type(protocol).model_validate(document)


def scripted(stimuli, folder):
    """A whole session of each kind, every judgement with the scripted mouse; what it shows is read back."""
    documents = {}
    # The framebuffer is read at every so many events.
    for protocol, every in ((read_protocol("pairwise"), 9), (read_protocol("doi"), 3), (read_protocol("ranking"), 1)):
        watch = Watch(stimuli, every=every)
        result = run_session(protocol, stimuli=stimuli, dataset=folder, participant="01", mode="simulate")
        frames = watch.screen.frame_report().to_dict()
        documents[protocol.kind] = {"trials": result.n_answered, "frames": frames, **watch.document()}
    return documents


def pointer(stimuli, folder):
    """Real pointer and keys in a pairwise session."""

    def acts(watch, hand):
        wait = watch.wait_for
        hand.begin()
        # The space bar before a response means nothing; then a click on the slider, and the space bar confirms.
        hand.key("space")
        wait(lambda state: state.rating == 30, lambda: hand.click(hand.on_slider(30)))
        wait(lambda state: state.n_answered == 1, lambda: hand.key("space"))
        # Second trial: dragged, then confirmed with the button.
        wait(lambda state: state.rating == 75, lambda: hand.drag(hand.on_slider(10), hand.on_slider(75)))
        wait(lambda state: state.n_answered == 2, lambda: hand.click(watch.screen.layout.button))
        hand.until_shown()
        # Third trial, with keys alone: no arrow moves a marker that is not there; 4 and 2 are typed, then moved by 1
        # and back by 10.
        hand.key("Right")
        unmoved = watch.state.rating
        hand.key("4", "2")
        wait(lambda state: state.rating == 42)
        hand.key("Right")
        wait(lambda state: state.rating == 43)
        hand.key("shift+Left")
        wait(lambda state: state.rating == 33)
        # Escape asks; the space bar is no answer; Escape again goes on where it was.
        hand.key("Escape", "space", "Escape")
        after_escape = [watch.state.n_answered, watch.state.rating, watch.screen._trial_screen.slider.markerPos]
        # So does the button of that name, a click on which presses nothing in the trial.
        hand.key("Escape")
        hand.click((114, -60))
        hand.key("Right")
        wait(lambda state: state.rating == 34)
        hand.key("space")
        wait(lambda state: state.n_answered == 3)
        # Fourth trial: the button has been down since before it began, outside the bar, and moves onto the bar.
        wait(lambda state: state.rating == 5, lambda: hand.click(hand.on_slider(5)))
        hand.to((0, 450))
        hand.xdotool("mousedown", 1)
        hand.key("space")
        wait(lambda state: state.n_answered == 4)
        hand.until_shown()
        hand.to(hand.on_slider(60))
        held = watch.state.rating
        hand.xdotool("mouseup", 1)
        # Fifth trial: rated, not confirmed; then the session is stopped.
        wait(lambda state: state.rating == 50, lambda: hand.click(hand.on_slider(50)))
        return {"unmoved": unmoved, "after_escape": after_escape, "held": held}

    return with_a_hand(
        stimuli, folder, protocol_with("pairwise", design={"practice": 0, "preview": False}), acts, participant="02"
    )


def ranking(stimuli, folder):
    """Real pointer and keys in a ranking of five items."""
    names = [stimulus.name for stimulus in read_stimulus_set(stimuli).stimuli]
    design = {"reference": names[0], "stimuli": names[1:6], "repeats": 2, "preview": False, "practice": 0}

    def acts(watch, hand):
        hand.begin()
        layout, board = watch.screen.layout, watch.screen._trial_screen
        items = watch.state.trial.items

        def until(condition, act):
            watch.wait_for(lambda _: condition(), act)

        # Two are dragged: the second before the first. A drop beside everything changes nothing.
        until(lambda: board.board.placed == (items[3],), lambda: hand.drag(layout.waiting[3], layout.ranks[0]))
        until(lambda: board.board.placed == (items[1], items[3]), lambda: hand.drag(layout.waiting[1], layout.ranks[0]))
        hand.drag(layout.waiting[0], (-600, 480))
        dropped_beside = list(board.board.placed)
        # One is taken back, and the space bar confirms nothing.
        until(lambda: board.board.placed == (items[1],), lambda: hand.drag(layout.ranks[1], layout.waiting[3]))
        hand.key("space")
        unconfirmed = watch.state.n_answered
        # The rest with keys: Return places the marked one and marks the next; Shift moves it.
        hand.to((0, 450))
        until(lambda: board._marked == items[0], lambda: hand.key("Right"))
        hand.key("Return", "Return", "Return", "Return")
        until(lambda: board.board.complete, lambda: None)
        by_keys = list(board.board.placed)
        hand.key("shift+Left")
        until(lambda: watch.state.order is not None and watch.state.order != tuple(by_keys), lambda: None)
        moved = list(watch.state.order)
        marked = board._marked
        hand.key("Escape", "Escape")
        after_escape = list(board.board.placed)
        watch.wait_for(lambda state: state.n_answered == 1, lambda: hand.click(layout.button))
        return {
            "items": list(items),
            "dropped_beside": dropped_beside,
            "unconfirmed": unconfirmed,
            "by_keys": by_keys,
            "marked": marked,
            "moved": moved,
            "after_escape": after_escape,
        }

    protocol = protocol_with("ranking", design=design)
    return with_a_hand(stimuli, folder, protocol, acts, participant="03")


def limits(stimuli, folder):
    """A time limit, a break with a shortest rest, the window's close button, the thanks and the summary."""
    names = [stimulus.name for stimulus in read_stimulus_set(stimuli).stimuli]
    design = {"stimuli": names[:2], "include_identical": True, "break_every": 2, "break_min_s": 2.0}
    design |= {"time_limit_s": 3.0, "practice": 0, "preview": False}

    pages = []
    original = MessageScreen.summary_page

    def summary_page(screen, lines):
        pages.append(list(lines))
        return original(screen, lines)

    MessageScreen.summary_page = summary_page

    def acts(watch, hand):
        hand.begin()
        stage = watch.screen._stage
        began = time.monotonic()
        # First trial: nothing is done, and the message waits for the space bar.
        time.sleep(3.5)
        waiting = watch.state.n_answered
        watch.wait_for(lambda state: state.n_answered == 1, lambda: hand.key("space"))
        timed_out_after_s = time.monotonic() - began
        hand.until_shown()
        # Second trial: asked whether to stop, for longer than the limit; the trial's clock stands still.
        hand.key("7")
        watch.wait_for(lambda state: state.rating == 7)
        stage.window.winHandle.dispatch_event("on_close")
        time.sleep(3.5)
        hand.key("Return")
        hand.key("space")
        watch.wait_for(lambda state: state.n_answered == 2)
        # The break: the space bar does nothing before its two seconds are over.
        watch.wait_for(lambda state: state.phase is Phase.PAUSE)
        rest_began = time.monotonic()
        watch.wait_for(lambda state: state.phase is Phase.RATING, lambda: hand.key("space"))
        rested_s = time.monotonic() - rest_began
        hand.until_shown()
        hand.key("9", "space")
        # Thanks; the key S shows the summary, and the next key ends the session.
        watch.wait_for(lambda _: pages, lambda: hand.key("s"))
        return {"waiting": waiting, "timed_out_after_s": timed_out_after_s, "rested_s": rested_s, "pages": pages}

    return with_a_hand(stimuli, folder, protocol_with("pairwise", design=design), acts, participant="04")


def overview(stimuli, folder):
    """The preview, at native size where all fit and smaller where not.

    A calibration with a gamma lies where PsychoPy looks for it, under the name of the session's monitor.
    """
    from psychopy import monitors

    saved = monitors.Monitor("glossspace", gamma=2.2, distance=57)
    saved.setGammaGrid(np.array([[0, 100, 2.2]] * 4))
    saved.saveMon()
    stimulus_set = read_stimulus_set(stimuli)
    images = {stimulus.name: stimulus_set.image_path(stimulus.name) for stimulus in stimulus_set.stimuli}
    found = {"saved_gamma": float(monitors.Monitor("glossspace").getGamma()[0])}
    for window_size in ((1280, 1024), (740, 440)):
        # At native size all fit beside each other into the large window, and not into the small one.
        protocol = protocol_with(
            "doi",
            design={"preview": True},
            display={"fullscreen": False, "window_size_px": window_size},
            texts={"size_px": 12},
        )
        with open_screen(protocol, images) as screen:
            state = replace(start_session(_trials_of(images), preview=True), phase=Phase.PREVIEW)
            screen.draw(state)
            frame = screen.framebuffer()
            screen._stage.window.clearBuffer()
            preview = screen._preview
            differing = 0
            for name, place in zip(images, preview.places, strict=False):
                with Image.open(images[name]) as image:
                    expected = np.asarray(image.resize(preview.grid.picture_size, Image.Resampling.BOX).convert("RGB"))
                shown = region(frame, place, preview.grid.picture_size)
                differing += int((shown != expected).any(axis=2).sum())
            found[f"{window_size[0]}"] = {
                "picture_size": list(preview.grid.picture_size),
                "differing_pixels": differing,
                "size_note": preview._size_note.text,
                "gamma": screen._stage.window.gamma,
                "native_gamma": bool(screen._stage.window.useNativeGamma),
            }
    return found


def overflow(stimuli, folder):
    """What is said where a text does not fit into the window."""
    stimulus_set = read_stimulus_set(stimuli)
    images = {stimulus.name: stimulus_set.image_path(stimulus.name) for stimulus in stimulus_set.stimuli}
    found = {}
    for key, text in (("instructions", "a line\n" * 60), ("question", "wide " * 400), ("finished", "a line\n" * 35)):
        protocol = protocol_with("doi", texts={key: text}, display={"fullscreen": False})
        try:
            with open_screen(protocol, images):
                found[key] = None
        except GlossError as error:
            found[key] = str(error)
    return found


def scripts(stimuli, folder):
    """What a Hebrew and an Arabic text look like."""
    stimulus_set = read_stimulus_set(stimuli)
    images = {stimulus.name: stimulus_set.image_path(stimulus.name) for stimulus in stimulus_set.stimuli}
    found = {}
    for language, words in (("he", HEBREW), ("ar", ARABIC)):
        texts = {"instructions": " ".join(words * 10), "progress": "{done} / {total}", "font": "DejaVu Sans"}
        protocol = protocol_with("doi", texts=texts, display={"fullscreen": False})
        with open_screen(protocol, images) as screen:
            message = MessageScreen(screen._stage)
            message.draw(start_session(_trials_of(images)))
            Image.fromarray(screen._stage.framebuffer()).save(f"{folder}/{language}.png")
            found[language] = {
                "lines": message._message.text.split("\n"),
                "size": list(message._message.boundingBox),
            }
    return found


def fonts(stimuli, folder):
    """What is said of fonts that are not here, or lack signs."""
    stimulus_set = read_stimulus_set(stimuli)
    images = {stimulus.name: stimulus_set.image_path(stimulus.name) for stimulus in stimulus_set.stimuli}
    found = {}
    for name, texts in {
        "shipped": {},
        "generic": {"font": "serif"},
        "japanese": {"question": "光沢 100", "font": "DejaVu Sans"},
        "label": {"finished": "光沢光沢", "font": "DejaVu Sans"},
        "many": {"question": "".join(map(chr, range(0x4E00, 0x4E20)))},
        "elsewhere": {"font": "No Such Font"},
        "nameless": {"font": ""},
        "lao": {"question": "ເບິ່ງ", "font": "DejaVu Sans"},
        "pointed": {"question": "שָׁלוֹם", "font": "DejaVu Sans"},
        "decomposed": {"question": "Glanz fu\u0308r", "font": "DejaVu Sans"},
    }.items():
        try:
            with open_screen(protocol_with("doi", texts=texts, display={"fullscreen": False}), images):
                found[name] = None
        except GlossError as error:
            found[name] = str(error)
    return found


def _trials_of(images):
    return tuple(Trial(i, 1, 1, (name,)) for i, name in enumerate(images, start=1))


PROGRAMS = {
    "scripted": scripted,
    "pointer": pointer,
    "ranking": ranking,
    "limits": limits,
    "overview": overview,
    "overflow": overflow,
    "scripts": scripts,
    "fonts": fonts,
}

if __name__ == "__main__":
    print(json.dumps(PROGRAMS[sys.argv[1]](*sys.argv[2:4])))
