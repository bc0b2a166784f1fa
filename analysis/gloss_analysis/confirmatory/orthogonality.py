"""Are two axes independent? Whether judgements ask for axes that are turned, or correlated, beyond what noise does.

The gloss paper's distance, sqrt(dc^2 + (w dd)^2), says that the two axes add up like the sides of a right angle. Three
models of the same coordinates are compared, each with its own scale and transformation for every participant:

1. independent: the axes, weighted by each participant;
2. rotated: the axes turned by one angle for all, then weighted by each participant;
3. correlated: for each participant any symmetric 2 x 2 metric, that is, a correlation of the axes besides the weight.

Models 2 and 3 contain model 1 and always fit better; `check_orthogonality` asks whether by more than where model 1 is
true.
"""

from dataclasses import dataclass, replace

import numpy as np

from gloss_analysis.confirmatory.axis_models import fit_axis_models
from gloss_analysis.confirmatory.residual_permutation import permuted_residuals
from gloss_analysis.confirmatory.scaling import confirm_axes
from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds.disparities import Level, Ties
from gloss_analysis.mds.objective import source_distances
from gloss_analysis.replicates import OnStep, in_parallel, no_step
from glossspace.errors import GlossError

__all__ = ["Orthogonality", "check_orthogonality"]

_ALPHA = 0.05
# Drops that rounding cannot tell apart.
_ROUNDING = 1e-12


@dataclass(frozen=True)
class Orthogonality:
    """How much better turned or correlated axes fit than independent ones, and how often chance does as much.

    Attributes
    ----------
    axes : tuple of str, length 2
    participants : tuple of str, length m
        Those whose weights could be fitted.
    stress1, stress1_rotated, stress1_correlated : float
        Root mean square over participants of Stress-1 of the three models.
    angle : float
        Degrees by which model 2 turns the axes, anticlockwise from the first to the second, in units of their standard
        deviations over the stimuli; from -45 to 45.
    correlations : ndarray, shape (m,)
        Of the axes in each participant's metric under model 3, -1 to 1: the cosine of the angle between them, negative
        where equal signs of the two differences make a pair more alike. Free of units.
    drop_rotated, drop_correlated : float
        Part of the mean square stress of model 1 that model 2 or 3 takes away, 0 to 1.
    null_rotated, null_correlated : ndarray, shape (n_permutations,)
        The same of each permutation.
    p_rotated, p_correlated : float
        (b + 1) / (n_permutations + 1), b being the number of permutations that drop as much.
    """

    axes: tuple[str, str]
    participants: tuple[str, ...]
    stress1: float
    stress1_rotated: float
    stress1_correlated: float
    angle: float
    correlations: np.ndarray
    drop_rotated: float
    drop_correlated: float
    null_rotated: np.ndarray
    null_correlated: np.ndarray
    p_rotated: float
    p_correlated: float

    @property
    def sentences(self) -> tuple[str, ...]:
        """The result in words."""
        first, second = self.axes
        found = [
            f"Independent axes {first} and {second}: Stress-1 {self.stress1:.4f}. Turned by {self.angle:.1f} degrees "
            f"for all: {self.stress1_rotated:.4f}. Correlated, for each participant alone: "
            f"{self.stress1_correlated:.4f}, correlation {self.correlations.mean():.2f} on average.",
        ]
        n = len(self.null_rotated)
        for what, drop, null, p in (
            ("A common rotation takes", self.drop_rotated, self.null_rotated, self.p_rotated),
            ("Correlations take", self.drop_correlated, self.null_correlated, self.p_correlated),
        ):
            verdict = (
                "more than noise does: the axes are not independent"
                if p <= _ALPHA
                else "no more than noise may: nothing here speaks against independent axes"
            )
            found.append(
                f"{what} away {100 * drop:.1f} % of the mean square stress, "
                f"{100 * np.median(null):.1f} % in the median of {n} permutations (p = {p:.3g}), {verdict}."
            )
        if 1 / (n + 1) > _ALPHA:
            found.append(f"With {n} permutations p cannot be below {_ALPHA:g}. Take 199 or more.")
        return tuple(found)


def check_orthogonality(
    data: Dissimilarities,
    coordinates: np.ndarray,
    *,
    axes: tuple[str, ...],
    level: Level = "ordinal",
    ties: Ties = "primary",
    n_permutations: int = 199,
    seed: int = 1,
    n_jobs: int = 1,
    on_step: OnStep = no_step,
) -> Orthogonality:
    """Test whether two given axes are independent in the judged dissimilarities.

    Parameters
    ----------
    data : Dissimilarities
        n stimuli.
    coordinates : ndarray, shape (n, 2)
    axes : tuple of str, length 2
    level, ties
        See `gloss_analysis.mds.scale`.
    n_permutations : int
        1 or more; p is no finer than 1 / (n_permutations + 1).
    seed : int
        Of the permutations; the result does not depend on `n_jobs`.
    n_jobs : int
        Threads (joblib), -1 for one a core.
    on_step : callable
        Called with the number of permutations done and of all.

    Returns
    -------
    Orthogonality

    Raises
    ------
    GlossError
        Not two axes, no permutations, or what `gloss_analysis.confirmatory.scaling.confirm_axes` refuses.

    Notes
    -----
    **What is permuted.** The judgements of a participant are regressed monotonely on the distances that model 1
    predicts for him: a response curve of his own, such as a slider compresses; pairs at one distance share a point of
    it. What is left are residuals, enlarged by sqrt(q / (q - f)) for q pairs, f being the steps of that curve and the
    one weight, since a fit takes up part of the noise. They are permuted among pairs of neighbouring predicted
    distance, 20 at a time, because the spread of the noise may change along the curve; then added to the curve. The
    participant's own answers, ties and all, are dealt out in the order of these sums, so that steps and limits of his
    slider are kept. All three models are fitted anew.

    **Why.** If model 1 is true, residuals of pairs at the same distance are exchangeable: nothing but the distance
    tells pairs apart. Permutation leaves the curve, weights and noise as they are, and breaks only what a turned or
    correlated metric would leave behind: residuals that go with the product of the two differences. As the curve is
    estimated, the test is approximate. What is compared is the part of stress that goes away, for it does not change
    where the noise of a permutation is a little smaller or larger.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> place = rng.uniform(size=(12, 2))
    >>> first, second = np.triu_indices(12, 1)
    >>> judged = np.hypot(*(place[first] - place[second]).T) + 0.1 * rng.standard_normal(66)
    >>> data = Dissimilarities(tuple("abcdefghijkl"), ("1",), np.maximum(judged, 0)[np.newaxis])
    >>> found = check_orthogonality(data, place, axes=("c", "d"), n_permutations=19)
    >>> found.stress1_correlated <= found.stress1
    True
    """
    if len(axes) != 2:
        raise GlossError(f"Independence is asked of two axes, not {len(axes)}: {', '.join(axes)}.")
    if n_permutations < 1:
        raise GlossError(f"Invalid number of permutations = {n_permutations}. Allowed: 1 or more.")
    # Refuses bad input, and tells whose weights can be fitted.
    confirmed = confirm_axes(data, coordinates, axes=axes, level=level, ties=ties)
    chosen = replace(data, trials=None).of(confirmed.participants)
    # By halves, so that coordinates at both ends of the floating-point range do not overflow.
    half = np.asarray(coordinates, dtype=float) / 2
    scaled = (half - half.min(axis=0)) / np.ptp(half, axis=0)
    position = (scaled - scaled.mean(axis=0)) / scaled.std(axis=0)

    found = fit_axis_models(chosen, position, level=level, ties=ties)
    drawn = permuted_residuals(chosen, source_distances(position, found.weights))

    def one(child: np.random.SeedSequence) -> tuple[float, float]:
        permuted = fit_axis_models(drawn(np.random.default_rng(child)), position, level=level, ties=ties)
        return permuted.drop(permuted.rotated), permuted.drop(permuted.correlated)

    children = np.random.SeedSequence(seed).spawn(n_permutations)
    null = np.array(list(in_parallel(one, children, n_jobs, on_step)))
    drops = np.array([found.drop(found.rotated), found.drop(found.correlated)])
    p = (np.count_nonzero(null >= drops - _ROUNDING, axis=0) + 1) / (n_permutations + 1)
    return Orthogonality(
        axes=(axes[0], axes[1]),
        participants=confirmed.participants,
        stress1=float(np.sqrt(found.independent)),
        stress1_rotated=float(np.sqrt(found.rotated)),
        stress1_correlated=float(np.sqrt(found.correlated)),
        angle=found.angle,
        correlations=found.correlations,
        drop_rotated=float(drops[0]),
        drop_correlated=float(drops[1]),
        null_rotated=null[:, 0],
        null_correlated=null[:, 1],
        p_rotated=float(p[0]),
        p_correlated=float(p[1]),
    )
