"""A scaling solution with what a careful analyst needs to judge it; kept as JSON."""

from dataclasses import asdict, dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np
import pandas as pd

from gloss_analysis.mds.disparities import Level, Ties
from glossspace.errors import GlossError
from glossspace.files import read_json, write_json

__all__ = ["MODELS", "MdsSolution", "Model", "load_solution"]

Model: TypeAlias = Literal["identity", "weighted", "generalised"]
MODELS: tuple[Model, ...] = ("identity", "weighted", "generalised")

_FORMAT, _VERSION = "glossspace mds solution", 1


@dataclass(frozen=True)
class MdsSolution:
    """A configuration with what a careful analyst needs to judge it.

    Attributes
    ----------
    stimuli, participants : tuple of str
    n_dims : int
    model, level, ties : str
    conditional, restricted : bool
        What was assumed; see `scale`.
    coordinates : ndarray, shape (n, n_dims)
        The group space: centred, dimensions in the order of their variance, total mean square 1.
    dimension_weights : ndarray, shape (m, n_dims)
        How much each participant stretches each dimension, >= 0; ones in the identity model. Each participant's own
        space has total mean square 1, and the root mean square over participants is 1 in every dimension, so that the
        group space is the space of the average participant.
    transforms : ndarray, shape (m, n_dims, n_dims)
        Matrices C_k: participant k sees coordinates @ C_k. Diagonal with the dimension weights, or in the generalised
        model symmetric, where the dimension weights are the lengths of its rows.
    stress1 : float
        Root of the mean over participants of Stress-1 squared, each at its own scale.
    source_stress1 : ndarray, shape (m,)
        Kruskal's Stress-1 of each participant.
    distances, disparities, dissimilarities : ndarray, shape (m, n (n - 1) / 2)
        In each participant's own space; what they should have been; what was judged, NaN where nothing was.
    pair_weights : ndarray, shape (m, n (n - 1) / 2)
    source_shares : ndarray, shape (m,)
        Part of each participant in the mean.
    starts, best_hits : int
        How many starts were made, and how many of those that were polished ended at the best stress.
    start_stress1 : ndarray
        Stress of every polished start, best first.
    search : str
        How the minimum was looked for, in words: for one dimension, whether every order of the stimuli was tried.
    converged : bool
        Whether the best run ended by itself rather than at its step limit.
    warnings : tuple of str
        What speaks against reading the solution at face value.
    """

    stimuli: tuple[str, ...]
    participants: tuple[str, ...]
    n_dims: int
    model: Model
    level: Level
    ties: Ties
    conditional: bool
    restricted: bool
    coordinates: np.ndarray
    dimension_weights: np.ndarray
    transforms: np.ndarray
    stress1: float
    source_stress1: np.ndarray
    distances: np.ndarray
    disparities: np.ndarray
    dissimilarities: np.ndarray
    pair_weights: np.ndarray
    source_shares: np.ndarray
    starts: int
    best_hits: int
    start_stress1: np.ndarray
    search: str
    converged: bool
    warnings: tuple[str, ...]

    @property
    def normalized_raw_stress(self) -> float:
        """Stress-1 squared: PROXSCAL's normalised raw stress, with each participant at the best scale."""
        return self.stress1**2

    @property
    def dispersion_accounted_for(self) -> float:
        """DAF, 1 less the normalised raw stress."""
        return 1 - self.normalized_raw_stress

    @property
    def tucker_phi(self) -> float:
        """Tucker's coefficient of congruence of distances and disparities, the root of DAF."""
        return float(np.sqrt(max(self.dispersion_accounted_for, 0.0)))

    @cached_property
    def proxscal_normalized_raw_stress(self) -> float:
        """PROXSCAL's normalised raw stress: disparities of norm sqrt(sum of weights), one common scale of distances.

        sum_k |d^_k - t d_k|^2 / sum_k |d^_k|^2 at the best t. In the weighted and the generalised model a participant's
        scale is part of the weights and each has its own t; where all judged equally many pairs it then equals
        `normalized_raw_stress`.
        """
        if not self.conditional:
            return self.normalized_raw_stress
        mass = self.source_shares * np.sum(self._judged_weights, axis=1)
        if self.model != "identity":
            return float(mass @ self.source_stress1**2 / mass.sum())
        length = np.sqrt(np.sum(self._judged_weights * self.distances**2, axis=1))
        cosine = np.sqrt(np.maximum(1 - self.source_stress1**2, 0.0))
        common = np.sqrt(self.source_shares * mass) @ (cosine * length)
        return float(1 - common**2 / ((self.source_shares @ length**2) * mass.sum()))

    @cached_property
    def _judged_weights(self) -> np.ndarray:
        return np.where(np.isnan(self.dissimilarities), 0.0, self.pair_weights)

    @cached_property
    def source_stress2(self) -> np.ndarray:
        """Kruskal's Stress-2 of each participant, shape (m,): residuals against the spread of the distances.

        NaN where a participant judged nothing or the distances do not differ.
        """
        weights = self._judged_weights
        total = weights.sum(axis=1, keepdims=True)
        mean = np.divide(
            np.sum(weights * self.distances, axis=1, keepdims=True), total, out=np.zeros_like(total), where=total > 0
        )
        spread = np.sum(weights * (self.distances - mean) ** 2, axis=1)
        residual = np.sum(self._weighted_squares, axis=1)
        floor = 1e-24 * np.sum(weights * self.distances**2, axis=1)
        return np.sqrt(np.divide(residual, spread, out=np.full(len(spread), np.nan), where=spread > floor))

    @property
    def stress2(self) -> float:
        """Root of the mean of Stress-2 squared over the participants for whom it is defined; NaN if for none.

        Where all share one transformation, that of all judgements together.
        """
        if not self.conditional:
            weights = self.source_shares[:, np.newaxis] * self._judged_weights
            mean = np.sum(weights * self.distances) / np.sum(weights)
            spread = np.sum(weights * (self.distances - mean) ** 2)
            residual = self.source_shares @ np.sum(self._weighted_squares, axis=1)
            return float(np.sqrt(residual / spread)) if spread > 0 else np.nan
        counted = (self.source_shares > 0) & ~np.isnan(self.source_stress2)
        shares = self.source_shares[counted]
        return float(np.sqrt(shares @ self.source_stress2[counted] ** 2 / shares.sum())) if counted.any() else np.nan

    @cached_property
    def _weighted_squares(self) -> np.ndarray:
        residual = np.where(np.isnan(self.dissimilarities), 0.0, self.distances - self.disparities)
        return self.pair_weights * residual**2

    @cached_property
    def _parts(self) -> np.ndarray:
        """Part of every judgement in the squared stress, shape (m, n (n - 1) / 2): they add up to 1, or to 0."""
        total = np.sum(self._judged_weights * self.distances**2, axis=1)
        if not self.conditional:
            total = np.full(len(total), self.source_shares @ total)
        scale = np.divide(self.source_shares, total, out=np.zeros_like(total), where=total > 0)
        parts = scale[:, np.newaxis] * self._weighted_squares
        whole = parts.sum()
        return np.asarray(parts / whole if whole > 0 else parts)

    @property
    def stress_per_pair(self) -> np.ndarray:
        """Part of each pair in the squared stress, shape (n (n - 1) / 2,): they add up to 1, or to 0 without stress."""
        return np.asarray(self._parts.sum(axis=0))

    @property
    def stress_per_point(self) -> np.ndarray:
        """Part of each stimulus in the squared stress, shape (n,): half of that of each of its pairs."""
        first, second = np.triu_indices(len(self.stimuli), 1)
        n = len(self.stimuli)
        parts = self.stress_per_pair
        return (np.bincount(first, parts, n) + np.bincount(second, parts, n)) / 2

    @property
    def stress_per_source(self) -> np.ndarray:
        """Part of each participant in the squared stress, shape (m,)."""
        return np.asarray(self._parts.sum(axis=1))

    @property
    def start_spread(self) -> float:
        """Highest less lowest stress of the polished starts: how rough the landscape is."""
        return float(np.ptp(self.start_stress1))

    def shepard_table(self) -> pd.DataFrame:
        """Every judgement with its distance and disparity: what a Shepard diagram shows.

        Returns
        -------
        DataFrame
            Columns `participant_id`, `stimulus_a`, `stimulus_b`, `dissimilarity`, `distance`, `disparity`.
        """
        source, pair = np.nonzero(~np.isnan(self.disparities))
        first, second = np.triu_indices(len(self.stimuli), 1)
        names = np.array(self.stimuli, dtype=object)
        return pd.DataFrame(
            {
                "participant_id": np.array(self.participants, dtype=object)[source],
                "stimulus_a": names[first[pair]],
                "stimulus_b": names[second[pair]],
                "dissimilarity": self.dissimilarities[source, pair],
                "distance": self.distances[source, pair],
                "disparity": self.disparities[source, pair],
            }
        )

    def save(self, path: str | Path) -> None:
        """Write the solution as versioned JSON, whole or not at all; `load_solution` reads it."""
        content = {key: _plain(value) for key, value in asdict(self).items()}
        write_json(Path(path), {"format": _FORMAT, "version": _VERSION, **content})


def load_solution(path: str | Path) -> MdsSolution:
    """Read a solution that `MdsSolution.save` wrote.

    Raises
    ------
    GlossError
        No such file, not one of a solution, or one of a later version.
    """
    content = read_json(Path(path), what="scaling solution")
    if content.get("format") != _FORMAT:
        raise GlossError(f"'{path}' holds no scaling solution. Give a file that `gloss mds --out` wrote.")
    if content.get("version") != _VERSION:
        raise GlossError(f"'{path}' has version {content.get('version')!r}; this program reads {_VERSION}. Update it.")
    values: dict[str, Any] = {}
    for field in fields(MdsSolution):
        if field.name not in content:
            raise GlossError(f"'{path}' lacks {field.name!r}. Scale the data again.")
        value = content[field.name]
        if field.type is np.ndarray:
            try:
                values[field.name] = np.array(value, dtype=float)
            except (TypeError, ValueError):
                raise GlossError(f"'{path}': {field.name!r} is no table of numbers. Scale the data again.") from None
        else:
            values[field.name] = tuple(value) if isinstance(value, list) else value
    return MdsSolution(**values)


def _plain(value: Any) -> Any:
    # JSON has no NaN: a pair that was not judged is null, which reads as NaN again.
    if not isinstance(value, np.ndarray):
        return value
    numbers = value.astype(object)
    numbers[np.isnan(value)] = None
    return numbers.tolist()
