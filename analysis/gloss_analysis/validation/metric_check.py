"""A fitted gloss space held against the judgements it came from, the gloss paper's space, and one without a weight."""

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from scipy.stats import t as student_t

from gloss_analysis.confirmatory.scaling import ConfirmatoryFit
from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.validation.metric_validation import MetricComparison, MetricValidation, compare_metrics
from gloss_analysis.validation.stress_index import stress_index
from glossspace.metric import PAPER_SPACE, GlossSpace, Paint

__all__ = ["MetricCheck", "check_metric", "mean_interval", "predicted_differences"]


@dataclass(frozen=True)
class MetricCheck:
    """How well three spaces predict judged differences: STRESS of García et al. (2007), in per cent.

    Attributes
    ----------
    against_paper, against_unweighted : MetricComparison
        The fitted space (first) against the gloss paper's, and against one in which d weighs as much as c (second).
    left_out_stress : ndarray, shape (m,)
        STRESS of each participant by the fitted space with the weight that all others have: what a new observer would
        have. NaN for a participant without others.
    """

    against_paper: MetricComparison
    against_unweighted: MetricComparison
    left_out_stress: np.ndarray

    @property
    def fitted(self) -> MetricValidation:
        """The fitted space, on the judgements that its weight was fitted to."""
        return self.against_paper.first

    @property
    def gain(self) -> np.ndarray:
        """By how much less than by the unweighted space each left-out participant is missed, shape (m,)."""
        return self.against_unweighted.second.stress - self.left_out_stress

    def table(self) -> pd.DataFrame:
        """One row a participant: STRESS in per cent by each space, and against the mean of the other participants."""
        return pd.DataFrame(
            {
                "participant_id": self.fitted.participants,
                "stress_fitted": self.fitted.stress,
                "stress_left_out": self.left_out_stress,
                "stress_paper": self.against_paper.second.stress,
                "stress_unweighted": self.against_unweighted.second.stress,
                "stress_other_observers": self.fitted.inter_observer,
            }
        )


def check_metric(
    stimuli: pd.DataFrame, pairs: Dissimilarities, space: GlossSpace, confirmatory: ConfirmatoryFit
) -> MetricCheck:
    """Hold a fitted space against the judged differences, beside two others.

    Parameters
    ----------
    stimuli : DataFrame
        Columns `stimulus`, `rho_d`, `rho_s`, `alpha`.
    pairs : Dissimilarities
    space : GlossSpace
        Fitted to these pairs.
    confirmatory : ConfirmatoryFit
        The fit that its weight comes from.

    Returns
    -------
    MetricCheck

    Raises
    ------
    GlossError
        See `gloss_analysis.validation.metric_validation.compare_metrics`.

    Examples
    --------
    >>> check = check_metric(paints, judged, fit.space, fit.confirmatory)  # doctest: +SKIP
    >>> check.against_unweighted.better  # doctest: +SKIP
    'first'
    """
    fitted = predicted_differences(stimuli, pairs, space)
    unweighted = replace(space, weight_d=space.weight_c, weight_d_ci95=None)
    names = list(pairs.participants)
    left_out = np.full(len(names), np.nan)
    logs = np.log([one.ratio for one in confirmatory.individual])
    comparison = compare_metrics(pairs, fitted, predicted_differences(stimuli, pairs, PAPER_SPACE))
    for k, name in enumerate(confirmatory.participants):
        row = names.index(name)
        others = np.delete(logs, k)
        if len(others) and np.isfinite(comparison.first.stress[row]):
            own = replace(space, weight_d=float(space.weight_c * np.exp(others.mean())), weight_d_ci95=None)
            judged = np.where(pairs.judged[row], pairs.values[row], np.nan)
            left_out[row] = stress_index(predicted_differences(stimuli, pairs, own), judged)
    return MetricCheck(
        against_paper=comparison,
        against_unweighted=compare_metrics(pairs, fitted, predicted_differences(stimuli, pairs, unweighted)),
        left_out_stress=left_out,
    )


def predicted_differences(stimuli: pd.DataFrame, pairs: Dissimilarities, space: GlossSpace) -> np.ndarray:
    """Distances of a space between all pairs of stimuli, shape (n (n - 1) / 2,), in the order of `pairs`."""
    known = stimuli.drop_duplicates("stimulus").set_index("stimulus").loc[list(pairs.stimuli)]
    first, second = pairs.pairs
    a, b = (Paint(*(known[key].to_numpy()[end] for key in Paint._fields)) for end in (first, second))
    return np.asarray(space.distance(a, b))


def mean_interval(values: np.ndarray) -> tuple[float, float] | None:
    """Student's 95 % interval of a mean; NaN is left out. None with fewer than two values.

    Examples
    --------
    >>> low, high = mean_interval(np.array([1.0, 2.0, 3.0]))  # 2 -+ 4.303 / sqrt(3)
    >>> round(low, 3), round(high, 3)
    (-0.484, 4.484)
    """
    known = values[np.isfinite(values)]
    if len(known) < 2:
        return None
    half = student_t.ppf(0.975, len(known) - 1) * known.std(ddof=1) / np.sqrt(len(known))
    return float(known.mean() - half), float(known.mean() + half)
