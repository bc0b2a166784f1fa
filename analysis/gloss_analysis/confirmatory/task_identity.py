"""Is a scale the same in two tasks? Ratings of single images against the scale that judged pairs make.

The gloss paper (3.3.4) takes its scaling functions for task independent: what fits the magnitude estimates is tested on
the pairs. Here the two are compared directly, on the stimuli of both tasks: mean ratings against the coordinates of the
free MDS solution, and ratings in place of the given axis in confirmatory MDS.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from gloss_analysis.axes.orientation import matched_dimensions
from gloss_analysis.confirmatory.scaling import confirm_axes
from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds import scale
from gloss_analysis.mds.disparities import Level, Ties
from gloss_analysis.ratings.magnitude import Equalisation, mean_ratings
from gloss_analysis.ratings.polynomials import AxisRegression, polynomial_sentence, regress_ratings
from glossspace.errors import GlossError

__all__ = ["TaskIdentity", "among", "compare_tasks"]

# A line and a curve need five stimuli to be compared by the corrected criterion; two points are any line.
_FEWEST_FOR_A_LINE, _FEWEST_FOR_A_CURVE = 3, 5
_STARTS = 100


@dataclass(frozen=True)
class TaskIdentity:
    """One axis in two tasks, on the stimuli that were both rated and judged in pairs.

    Attributes
    ----------
    axis : str
    stimuli : tuple of str, length n
        In both tasks.
    rating : ndarray, shape (n,)
        Mean ratings, participants' scales equalised.
    scale_value : ndarray, shape (n,)
        Coordinate on the dimension of the MDS solution of all judged stimuli that stands for this axis, rising with it.
    n_rated : int
        Stimuli that were rated at all.
    regression : AxisRegression or None
        Of the ratings on the scale values; None with fewer than three different ones, or ratings all the same.
    stress1_given, stress1_scaled, stress1_rated : float
        Stress-1 of the judged pairs of these stimuli, weights shared, with the given coordinate, the scale value, or
        the mean rating on this axis; the other axes, where these stimuli differ on them, as given. NaN where it
        cannot be fitted. The scale values were made from these judgements among others: theirs is no rival.
    """

    axis: str
    stimuli: tuple[str, ...]
    rating: np.ndarray
    scale_value: np.ndarray
    n_rated: int
    regression: AxisRegression | None
    stress1_given: float
    stress1_scaled: float
    stress1_rated: float

    @property
    def sentences(self) -> tuple[str, ...]:
        """The result in words."""
        n = len(self.stimuli)
        here = f"Axis {self.axis}: {n} of {self.n_rated} rated stimuli were judged in pairs too"
        if n < _FEWEST_FOR_A_LINE:
            return (f"{here}, too few to compare the tasks. Rate {_FEWEST_FOR_A_CURVE} or more of the judged ones.",)
        if self.regression is None:
            return (f"{here}, but their ratings or their scale values do not differ enough for a line.",)
        fit = self.regression
        found = [f"{here}. Ratings over MDS scale values: r² = {fit.r_squared:.3f}."]
        if fit.slope < 0:
            found.append(f"Ratings fall where the MDS scale of {self.axis} rises. Was one of the scales reversed?")
        if n < _FEWEST_FOR_A_CURVE:
            found.append(
                f"Whether the relation is a line or a curve cannot be told from {n} stimuli. Rate "
                f"{_FEWEST_FOR_A_CURVE} or more of the judged ones."
            )
            return tuple(found)
        found.append(polynomial_sentence([one for one in fit.polynomials if one.order < 3]))
        if not np.isnan(self.stress1_rated):
            found.append(
                f"Stress-1 of their pairs: {self.stress1_rated:.4f} with the ratings as {self.axis}, "
                f"{self.stress1_given:.4f} with the given {self.axis}, {self.stress1_scaled:.4f} with the MDS scale."
            )
        return tuple(found)


def compare_tasks(
    data: Dissimilarities,
    coordinates: np.ndarray,
    ratings: Mapping[str, pd.DataFrame],
    *,
    axes: tuple[str, ...],
    level: Level = "ordinal",
    ties: Ties = "primary",
    equalise: Equalisation = "linear",
    n_starts: int = _STARTS,
    seed: int = 1,
    n_jobs: int = 1,
) -> tuple[TaskIdentity, ...]:
    """Compare the scale of each rated axis with that of the judged pairs.

    Parameters
    ----------
    data : Dissimilarities
        n stimuli.
    coordinates : ndarray, shape (n, p)
        Position of each stimulus along each given axis.
    ratings : mapping of str to DataFrame
        For some of the axes, `participant_id`, `stimulus`, `rating` of a study that varied this axis.
    axes : tuple of str, length p
    level, ties
        See `gloss_analysis.mds.scale`.
    equalise
        See `mean_ratings`.
    n_starts, seed, n_jobs
        Of the scaling that makes the scale values.

    Returns
    -------
    tuple of TaskIdentity
        In the order of `ratings`.

    Raises
    ------
    GlossError
        Ratings along an axis that is not among `axes`, or what `confirm_axes`, `scale` or `mean_ratings` refuses.

    Notes
    -----
    The scale values are coordinates of the group space of a weighted solution in p dimensions, free of the given
    coordinates except that these tell which dimension is which. With one axis the stimuli lie on a line.

    Examples
    --------
    >>> place = np.array([0.0, 1.0, 2.5, 4.5, 7.0, 8.0])
    >>> first, second = np.triu_indices(6, 1)
    >>> data = Dissimilarities(tuple("abcdef"), ("1",), np.abs(place[first] - place[second])[np.newaxis])
    >>> rated = pd.DataFrame({"participant_id": "1", "stimulus": list("abcdef"), "rating": 10 + 5 * place})
    >>> found = compare_tasks(data, place[:, np.newaxis], {"c": rated}, axes=("c",), level="ratio")[0]
    >>> round(found.regression.r_squared, 6), bool(found.stress1_rated < 1e-6)
    (1.0, True)
    """
    unknown = [axis for axis in ratings if axis not in axes]
    if unknown:
        raise GlossError(f"Ratings along {unknown[0]!r}, which is no axis here. Allowed: {', '.join(axes)}.")
    confirm_axes(data, coordinates, axes=axes, level=level, ties=ties)  # refuses bad input
    solution = scale(data, n_dims=len(axes), level=level, ties=ties, n_starts=n_starts, seed=seed, n_jobs=n_jobs)
    order, sign = matched_dimensions(solution.coordinates, coordinates)
    scaled = solution.coordinates[:, order] * sign
    found = []
    for axis, table in ratings.items():
        try:
            found.append(
                _compared(data, coordinates, scaled, mean_ratings(table, equalise=equalise), axes, axis, level, ties)
            )
        except GlossError as error:
            raise GlossError(f"Ratings along {axis}: {error}") from None
    return tuple(found)


def among(data: Dissimilarities, stimuli: tuple[str, ...]) -> Dissimilarities:
    """Judgements of the pairs of some of the stimuli alone, in the given order."""
    place = [data.stimuli.index(name) for name in stimuli]
    n = len(data.stimuli)
    number = np.zeros((n, n), dtype=int)
    first, second = data.pairs
    number[first, second] = number[second, first] = np.arange(len(first))
    one, other = np.triu_indices(len(stimuli), 1)
    pairs = number[np.asarray(place)[one], np.asarray(place)[other]]
    return Dissimilarities(
        stimuli,
        data.participants,
        data.values[:, pairs],
        None if data.pair_weights is None else data.pair_weights[:, pairs],
        data.source_weights,
    )


def _compared(
    data: Dissimilarities,
    coordinates: np.ndarray,
    scaled: np.ndarray,
    means: pd.DataFrame,
    axes: tuple[str, ...],
    axis: str,
    level: Level,
    ties: Ties,
) -> TaskIdentity:
    rated = dict(zip(means["stimulus"], means["rating"], strict=True))
    stimuli = tuple(name for name in data.stimuli if name in rated)
    rows = [data.stimuli.index(name) for name in stimuli]
    column = axes.index(axis)
    rating = np.array([rated[name] for name in stimuli], dtype=float)
    value = scaled[rows, column]
    regression = None
    if len(np.unique(value)) >= _FEWEST_FOR_A_LINE and np.ptp(rating) > 0:
        regression = regress_ratings(value, rating)
    stress = {}
    for what, own in (("given", coordinates[rows, column]), ("scaled", value), ("rated", rating)):
        stress[what] = np.nan
        if len(stimuli) >= _FEWEST_FOR_A_LINE:
            placed = coordinates[rows].copy()
            placed[:, column] = own
            differing = [k for k in range(len(axes)) if k == column or np.ptp(placed[:, k]) > 0]
            stress[what] = _stress(among(data, stimuli), placed[:, differing], level, ties)
    return TaskIdentity(
        axis=axis,
        stimuli=stimuli,
        rating=rating,
        scale_value=value,
        n_rated=len(means),
        regression=regression,
        stress1_given=stress["given"],
        stress1_scaled=stress["scaled"],
        stress1_rated=stress["rated"],
    )


def _stress(data: Dissimilarities, coordinates: np.ndarray, level: Level, ties: Ties) -> float:
    names = tuple(str(k) for k in range(coordinates.shape[1]))
    try:
        return confirm_axes(data, coordinates, axes=names, level=level, ties=ties).shared.stress1
    except GlossError:
        return np.nan  # these pairs alone, or these coordinates, allow no fit
