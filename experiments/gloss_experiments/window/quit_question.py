"""Escape asks before it ends a session: one question, two answers, with keys and mouse."""

from gloss_experiments.window.button import Button
from gloss_experiments.window.layout import button_size_px
from gloss_experiments.window.stage import Stage

__all__ = ["wants_to_stop"]


def wants_to_stop(stage: Stage) -> bool:
    """Ask whether to stop here, until it is answered; the trial's clock stands still meanwhile.

    "Go on" is marked at first. The arrow keys mark the other button and Return presses the marked one; Escape goes on.
    The space bar, which confirms trials, does nothing here, so that a hand in its rhythm ends no session.
    """
    with stage.clock.paused():
        answer = _answer(stage)
    stage.begin_anew()
    stage.frames.interrupt()
    return answer


def _answer(stage: Stage) -> bool:
    texts, line = stage.protocol.texts, stage.line_px
    width, height = button_size_px(texts.size_px)
    y = -line - height // 2
    question = stage.text(texts.quit_question, (0, line), vertical="bottom")
    stop = Button(stage, texts.quit_yes, (-(width + line) // 2, y))
    go_on = Button(stage, texts.quit_no, ((width + line) // 2, y))
    stop_marked = False
    stage.begin_anew()
    while True:
        stage.left_button.look()
        question.draw()
        stop.draw(marked=stop_marked)
        go_on.draw(marked=not stop_marked)
        stage.flip()
        for key in stage.pressed_keys():
            if key == "escape":
                return False
            if key == "return":
                return stop_marked
            stop_marked = {"left": True, "right": False, "tab": not stop_marked}.get(key, stop_marked)
        if stop.clicked():
            return True
        if go_on.clicked():
            return False
