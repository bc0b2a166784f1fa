"""The experimenter's summary of a session: whether the observer understood the task and kept at it."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from statistics import StatisticsError, correlation, fmean, median

from gloss_experiments.session.state import Answer

__all__ = ["FAST_S", "SessionSummary", "summarise", "summary_lines"]

# Nobody looks at two images, judges them and moves a slider in less.
FAST_S = 0.5
# A correlation of fewer pairs of answers says nothing.
_FEWEST_RETESTS = 5


@dataclass(frozen=True)
class SessionSummary:
    """What a session's answers say of the observer. None stands for what cannot be known.

    Attributes
    ----------
    n_judged, n_practice, n_catch
        Answers of each role, those that timed out included.
    median_time_s
        Median response time of the judged trials; None for simulated observers.
    share_fast
        Share of the judged trials that took less than `FAST_S`.
    identical_mean, different_mean
        Mean rating of identical pairs, which should be near 0, and of the others; judged trials of pairs.
    retest_r, n_retests
        Pearson correlation of the answers to what was judged more than once, each showing with the one before, catch
        trials included; of ranks it is Spearman's. And of how many pairs of answers. Identical pairs are left out.
    catch_difference
        Mean absolute difference between a repeated catch trial and the answer before, in slider units.
    catch_identical_mean
        Mean rating of catch trials that were identical pairs.
    n_timed_out
        Judged trials whose time limit passed.
    n_without_response
        Of those, the ones in which the slider never moved.
    n_distinct
        How many different ratings were given; None in a ranking.
    """

    n_judged: int
    n_practice: int
    n_catch: int
    median_time_s: float | None
    share_fast: float | None
    identical_mean: float | None
    different_mean: float | None
    retest_r: float | None
    n_retests: int
    catch_difference: float | None
    catch_identical_mean: float | None
    n_timed_out: int
    n_without_response: int
    n_distinct: int | None


def summarise(answers: Sequence[Answer]) -> SessionSummary:
    """Summarise the answers of a session, in the order in which they were given.

    Examples
    --------
    >>> from gloss_experiments.design import Trial
    >>> pairs = [("a", "b"), ("a", "a"), ("b", "a")]
    >>> answers = [Answer(Trial(i, 1, 1, pair), 10 * i, 2.0 * i) for i, pair in enumerate(pairs, start=1)]
    >>> summary = summarise(answers)
    >>> summary.median_time_s, summary.identical_mean, summary.n_retests
    (4.0, 20.0, 1)
    """
    judged = [answer for answer in answers if answer.trial.role == "judged"]
    catch = [answer for answer in answers if answer.trial.role == "catch"]
    shown = [answer for answer in answers if answer.trial.role != "practice"]
    times = [answer.response_time_s for answer in judged if answer.response_time_s is not None]
    rated = [answer for answer in judged if answer.rating is not None]
    identical = [answer.rating for answer in rated if _is_identical(answer)]
    different = [answer.rating for answer in rated if len(answer.trial.stimuli) == 2 and not _is_identical(answer)]
    retests = list(_retests(shown))
    timed_out = [answer for answer in judged if answer.timed_out]
    return SessionSummary(
        n_judged=len(judged),
        n_practice=sum(answer.trial.role == "practice" for answer in answers),
        n_catch=len(catch),
        median_time_s=median(times) if times else None,
        share_fast=sum(time < FAST_S for time in times) / len(times) if times else None,
        identical_mean=_mean(identical),
        different_mean=_mean(different),
        retest_r=_correlation([(before, after) for before, after, _ in retests]),
        n_retests=len(retests),
        catch_difference=_mean([abs(after - before) for before, after, role in retests if role == "catch"]),
        catch_identical_mean=_mean([answer.rating for answer in catch if _is_identical(answer)]),
        n_timed_out=len(timed_out),
        n_without_response=sum(answer.trace is not None and answer.trace.n_changes == 0 for answer in timed_out),
        n_distinct=len({answer.rating for answer in rated}) if rated else None,
    )


def _is_identical(answer: Answer) -> bool:
    return len(answer.trial.stimuli) == 2 and len(set(answer.trial.stimuli)) == 1


def _retests(answers: Iterable[Answer]) -> Iterator[tuple[float, float, str]]:
    """Answers to the same thing at one showing and the next, and the role of the later trial."""
    last: dict[tuple[str, ...], float] = {}
    for answer in answers:
        values: dict[tuple[str, ...], float] = {}
        if answer.order is not None:
            values = {(item,): rank for rank, item in enumerate(answer.order, start=1)}
        elif answer.rating is not None and not _is_identical(answer):
            values = {tuple(sorted(answer.trial.stimuli)): answer.rating}
        for shown, value in values.items():
            if shown in last:
                yield last[shown], value, answer.trial.role
            last[shown] = value


def _mean(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return fmean(known) if known else None


def _correlation(pairs: Sequence[tuple[float, float]]) -> float | None:
    if len(pairs) < _FEWEST_RETESTS:
        return None
    try:
        return correlation([before for before, _ in pairs], [after for _, after in pairs])
    except StatisticsError:  # an observer who always answers the same
        return None


def summary_lines(summary: SessionSummary) -> list[str]:
    """The summary in words, one fact a line; what cannot be known is left out."""
    counts = [(summary.n_practice, "practice"), (summary.n_catch, "catch")]
    beside = ", ".join(f"{n} {role}" for n, role in counts if n)
    lines = [f"Judged trials: {summary.n_judged}" + (f" (and {beside})" if beside else "")]
    if summary.median_time_s is not None and summary.share_fast is not None:
        lines.append(
            f"Time per trial: median {summary.median_time_s:.1f} s; under {FAST_S:g} s in {summary.share_fast:.0%}"
        )
    if summary.identical_mean is not None:
        others = "" if summary.different_mean is None else f"; of different pairs {summary.different_mean:.1f}"
        lines.append(f"Mean rating of identical pairs: {summary.identical_mean:.1f}{others}")
    if summary.n_retests:
        r = "–" if summary.retest_r is None else f"{summary.retest_r:.2f}"
        lines.append(f"Test–retest of {summary.n_retests} answers: r = {r}")
    if summary.catch_difference is not None:
        lines.append(f"Catch trials: repeated ones differ by {summary.catch_difference:.1f} on average")
    if summary.catch_identical_mean is not None:
        lines.append(f"Catch trials: mean rating of identical pairs {summary.catch_identical_mean:.1f}")
    if summary.n_timed_out:
        lines.append(f"Time limit passed in {summary.n_timed_out}, in {summary.n_without_response} without a response")
    if summary.n_distinct == 1 and summary.n_judged > 1:
        lines.append("All ratings are the same: was the slider used?")
    return lines
