"""The rows of a session's data file, made from its answers."""

from collections.abc import Sequence

from gloss_experiments.session.state import Answer
from glossspace.dataset.schema import TaskKind
from glossspace.dataset.write import Row

__all__ = ["trial_rows"]


def trial_rows(answers: Sequence[Answer], *, kind: TaskKind, simulated: bool) -> list[Row]:
    """Rows of the judged trials, as `glossspace.dataset.write_session_data` takes them.

    Practice and catch trials give none. A trial that timed out has a row without an answer. Nobody's hand moved the
    slider of a simulated observer, so its rows say nothing of how an answer came about.

    Returns
    -------
    list of dict
        One a judged trial; one a stimulus in a ranking, in the order in which they lay at the start.

    Examples
    --------
    >>> from gloss_experiments.design import Trial
    >>> rows = trial_rows([Answer(Trial(1, 1, 1, ("a", "b")), rating=40)], kind="pairwise", simulated=True)
    >>> [rows[0][name] for name in ("stimulus_left", "stimulus_right", "dissimilarity", "timed_out")]
    ['a', 'b', 40, 'no']
    """
    return [
        row
        for answer in answers
        if answer.trial.role == "judged"
        for row in _rows(answer, kind, _process(answer, simulated=simulated))
    ]


def _rows(answer: Answer, kind: TaskKind, process: Row) -> list[Row]:
    trial = answer.trial
    common: Row = {"block": trial.block, "trial": trial.number, "repeat": trial.repeat}
    if kind == "pairwise":
        left, right = trial.stimuli
        judged: list[Row] = [{"stimulus_left": left, "stimulus_right": right, "dissimilarity": answer.rating}]
    elif kind == "magnitude":
        judged = [{"stimulus": trial.stimuli[0], "rating": answer.rating}]
    else:
        reference, *items = trial.stimuli
        ranks = {item: rank for rank, item in enumerate(answer.order or (), start=1)}
        judged = [
            {"reference": reference, "stimulus": item, "start_place": place, "rank": ranks.get(item)}
            for place, item in enumerate(items, start=1)
        ]
    return [common | row | process for row in judged]


def _process(answer: Answer, *, simulated: bool) -> Row:
    trace = None if simulated else answer.trace
    return {
        "response_time_s": _milliseconds(None if simulated else answer.response_time_s),
        "timed_out": "yes" if answer.timed_out else "no",
        "first_response_s": _milliseconds(None if trace is None else trace.first_response_s),
        "n_changes": None if trace is None else trace.n_changes,
        "n_reversals": None if trace is None else trace.n_reversals,
        "dropped_frames": None if trace is None else trace.n_dropped,
    }


def _milliseconds(time_s: float | None) -> float | None:
    return None if time_s is None else round(time_s, 3)
