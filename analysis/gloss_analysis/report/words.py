"""What the data support, in words: the sentences with which sections of the report begin, computed from the numbers."""

import numpy as np

from gloss_analysis.hypotheses.candidates import Axis
from gloss_analysis.ratings.polynomials import AxisRegression, PolynomialFit
from gloss_analysis.report.numbers import counted, fixed, interval, joined, p_value
from gloss_analysis.study.analysis import StudyAnalysis
from gloss_analysis.validation.metric_check import mean_interval
from gloss_analysis.validation.metric_validation import MetricComparison
from glossspace.metric import PAPER_SPACE

__all__ = [
    "axes_words",
    "dimensions_words",
    "hypotheses_words",
    "independence_words",
    "metric_words",
    "observers_words",
    "own_weights_words",
    "ratings_words",
    "tasks_words",
    "weight_words",
]

# The gloss paper's limit (3.3.4) for calling a relation linear.
_LINEAR_GAIN = 0.01
_ALPHA = 0.05
# Stress-1 that two minimisations cannot be told apart by.
_SAME_STRESS = 1e-4


def observers_words(analysis: StudyAnalysis) -> str:
    """Who judged: people, programs, or both."""
    programs = [name for name in analysis.study.participants if name in analysis.study.simulated_participants]
    people = [name for name in analysis.study.participants if name not in programs]
    parts = []
    if people:
        parts.append(f"{counted(len(people), 'person', 'people')} ({', '.join(people)})")
    if programs:
        parts.append(f"{counted(len(programs), 'simulated observer')} ({', '.join(programs)}; programs, not people)")
    return f"{_capital(joined(parts))} took part."


def dimensions_words(analysis: StudyAnalysis) -> str:
    """How many dimensions the judgements support."""
    study = analysis.dimensionality
    advice, stress = study.recommendation, dict(zip(study.dims, study.stress1, strict=True))
    if advice.n_dims is None:
        return "No number of dimensions is supported: the judgements cannot be told from permuted ones."
    n = advice.n_dims
    values = [
        f"{fixed(stress[dims], 3)} in {counted(dims, 'dimension')}" for dims in (n - 1, n, n + 1) if dims in stress
    ]
    supported = f"{_capital(counted(n, 'dimension'))} {'is' if n == 1 else 'are'} supported"
    agreement = "every criterion agrees" if advice.agreed else "the criteria do not all agree"
    column = study.dims.index(n)
    random = fixed(float(np.nanmedian(study.random[:, column])), 3)
    return (
        f"{supported}, and {agreement}: Stress-1 is {joined(values)}; random judgements would have {random} in "
        f"{counted(n, 'dimension')}."
    )


def axes_words(analysis: StudyAnalysis) -> str:
    """Whether the dimensions of the weighted solution are c and d."""
    if np.count_nonzero(analysis.plane.source_shares) < 2:
        return "A solution of one participant may be turned at will: where its dimensions lie says nothing of axes."
    reading = analysis.axes
    parts = [
        f"{axis} lies {fixed(float(reading.vectors[axis].angle_deg[dimension]), 1)}° from dimension {dimension + 1} "
        f"(r² {fixed(reading.vectors[axis].r_squared, 3)})"
        for axis, dimension in zip(("c", "d"), reading.order, strict=True)
    ]
    best = float(reading.rotation_deg[int(np.argmin(reading.rotation_stress1))])
    gained = analysis.plane.stress1 - float(reading.rotation_stress1.min())
    turned = (
        "no rotation of the axes in steps of 5° fits the judgements better"
        if best == 0 or gained < _SAME_STRESS
        else f"axes turned by {fixed(best, 0)}° fit the judgements better"
    )
    return f"In the weighted solution {joined(parts)}; {turned}."


def independence_words(analysis: StudyAnalysis) -> str:
    """Whether c and d are independent axes."""
    found = analysis.orthogonality
    tests = (
        f"a common rotation takes away {fixed(100 * found.drop_rotated, 1)} % of the mean square stress "
        f"(p {p_value(found.p_rotated)}), correlations {fixed(100 * found.drop_correlated, 1)} % "
        f"(p {p_value(found.p_correlated)}; {len(found.null_rotated)} permutations)"
    )
    if min(found.p_rotated, found.p_correlated) > _ALPHA:
        return f"Nothing in the judgements speaks against independent axes: {tests}."
    return f"The judgements speak against independent axes: {tests}."


def own_weights_words(analysis: StudyAnalysis) -> str:
    """Whether participants weigh the axes differently; empty for a single one."""
    found = analysis.indscal
    if found.p_value is None:
        return ""
    taken = (
        f"own weights take away {fixed(100 * found.share_taken, 1)} % of the mean square stress of shared ones, "
        f"{fixed(100 * float(np.median(found.null)), 1)} % in the median of {len(found.null)} permutations "
        f"(p {p_value(found.p_value)})"
    )
    differ = found.p_value <= _ALPHA
    verdict = (
        "Participants weigh the axes differently" if differ else "Nothing says that participants differ in weights"
    )
    said = f"{verdict}: {taken}."
    if differ and found.angles is not None:
        near = joined(
            [f"{fixed(float(angle), 0)}° from {axis}" for axis, angle in zip(found.axes, found.angles, strict=True)]
        )
        said += f" The axes that their differences ask for lie {near}."
    return said


def tasks_words(analysis: StudyAnalysis) -> str:
    """Whether ratings and judged pairs have one scale."""
    return " ".join(sentence for task in analysis.tasks for sentence in task.sentences)


def ratings_words(analysis: StudyAnalysis, axis: str) -> str:
    """Whether ratings are linear along an axis."""
    line, known = analysis.fit.regressions[axis], analysis.r_squared_intervals[axis]
    sure = f" (95 % interval over participants {interval(known, 3)})" if known is not None else ""
    fit = f"r² = {fixed(line.r_squared, 3)}{sure}"
    if line.slope_ci95[0] <= 0 <= line.slope_ci95[1]:
        return f"Ratings are not seen to change along {axis}: {fit}, and the slope may be 0."
    way = "rise" if line.slope > 0 else "fall"
    if not line.polynomial_r_squared:
        return f"Ratings {way} along {axis}: {fit}; there are too few positions for a curve."
    gain = max(0.0, *(value - line.r_squared for value in line.polynomial_r_squared))
    gained = f"polynomials up to order {1 + len(line.polynomial_r_squared)} gain {fixed(gain, 3)} in r²"
    straight, curve = line.polynomials[0], _best_predicting(line)
    better = (
        f"order {curve.order} predicts left-out stimuli better (error {fixed(curve.leave_one_out_error, 2)} rating "
        f"units, the line {fixed(straight.leave_one_out_error, 2)})"
    )
    if gain >= _LINEAR_GAIN:
        return f"Ratings {way} along {axis}, but not linearly: {fit}, and {gained}, where the gloss paper allows .01."
    if curve.order == 1:
        return f"Ratings {way} linearly along {axis}: {fit}, and {gained}."
    return (
        f"Ratings {way} along {axis}, linearly by the gloss paper's criterion: {fit}, and {gained}, less than its .01. "
        f"Yet {better}."
    )


def _best_predicting(line: AxisRegression) -> PolynomialFit:
    """The order that predicts left-out stimuli best; the line where that is not known."""
    straight, *curves = line.polynomials
    known = [fit for fit in curves if fit.leave_one_out_error < straight.leave_one_out_error]
    return min(known, key=lambda fit: fit.leave_one_out_error, default=straight)


def hypotheses_words(analysis: StudyAnalysis, axis: Axis) -> str:
    """Which form of an axis ratings and pairs ask for; empty where too few could be tested."""
    if axis not in analysis.hypotheses:
        return ""
    test = analysis.hypotheses[axis]
    compared = test.compared.sort_values("r_squared", ascending=False)
    confirmed = test.confirmed.sort_values("stress1")
    ratings = joined([f"{row.hypothesis} {fixed(row.r_squared, 3)}" for row in compared.itertuples()])
    pairs = joined([f"{row.hypothesis} {fixed(row.stress1, 3)}" for row in confirmed.itertuples()])
    first, second = compared["hypothesis"].iloc[0], confirmed["hypothesis"].iloc[0]
    words = f"{counted(len(compared), 'form')} of {axis}"
    evidence = f"(r² with the ratings: {ratings}; Stress-1 on the judged pairs: {pairs})"
    if first == second:
        said = f"Of {words}, “{first}” fits both the ratings and the judged pairs best {evidence}."
    else:
        said = f"Of {words}, “{first}” fits the ratings best, but “{second}” the judged pairs {evidence}."
    fallen = compared.loc[compared["slope"] < 0, "hypothesis"].tolist()
    return said + (f" Ratings fall with {joined(fallen)}." if fallen else "")


def weight_words(analysis: StudyAnalysis) -> str:
    """How much d weighs, and whether that is what the gloss paper found."""
    fit = analysis.fit.confirmatory
    ratio, ends, paper = fit.population_ratio, fit.population_ci95, PAPER_SPACE.weight_d
    said = f"A step along d counts {fixed(ratio, 2)} times as much as one along c"
    if ends is None:
        return f"{said}, for {counted(len(fit.participants), 'participant')}: too few for an interval."
    within = "contains" if ends[0] <= paper <= ends[1] else "excludes"
    ratios = [one.ratio for one in fit.individual]
    said += f" (95 % interval {interval(ends, 2)}, which {within} the gloss paper's {paper:g})."
    said += f" Participants differ: {interval((min(ratios), max(ratios)), 2)}."
    truth = analysis.study.true_ratios
    if all(name in truth for name in fit.participants):
        mean = float(np.exp(np.mean([np.log(truth[name]) for name in fit.participants])))
        inside = "inside" if ends[0] <= mean <= ends[1] else "outside"
        said += f" The simulated observers' true geometric mean is {fixed(mean, 2)}, {inside} the interval."
    return said


def metric_words(analysis: StudyAnalysis) -> str:
    """How well the fitted space predicts judged differences, and whether better than others."""
    check = analysis.metric
    new = check.left_out_stress
    if np.isfinite(new).any():
        said = f"Fitted to the others, the space misses a participant by a STRESS of {_mean_words(new)}"
    else:
        said = (
            f"The space misses the judgements that it was fitted to by a STRESS of {_mean_words(check.fitted.stress)}"
        )
    if check.fitted.ceiling is not None:
        said += f"; participants miss the mean of the others by {fixed(check.fitted.ceiling, 1)} %"
    said += "."
    gain = mean_interval(check.gain)
    if gain is not None:
        mean = fixed(float(np.nanmean(check.gain)), 1)
        verb = "is needed" if gain[0] > 0 else "is not seen to help" if gain[1] >= 0 else "does harm"
        said += f" The weight of d {verb}: without it a left-out participant is missed by {mean} points more "
        said += f"(95 % interval {interval(gain, 1)})."
    against = (
        f"{_against(check.against_unweighted, 'an unweighted space')}, {_against(check.against_paper, 'the paper’s')}"
    )
    return f"{said} By the F test on the mean judgement the fitted space is {against}."


def _against(comparison: MetricComparison, what: str) -> str:
    verdict = {"first": "better than", "second": "worse than", None: "not to be told from"}[comparison.better]
    return f"{verdict} {what} (F = {fixed(comparison.f_ratio, 2)}, p {p_value(comparison.p_value)})"


def _mean_words(values: np.ndarray) -> str:
    ends = mean_interval(values)
    return f"{fixed(float(np.nanmean(values)), 1)} %" + (
        "" if ends is None else f" (95 % interval {interval(ends, 1)})"
    )


def _capital(words: str) -> str:
    return words[:1].upper() + words[1:]
