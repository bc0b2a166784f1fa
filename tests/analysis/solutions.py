"""Scaling solutions put together by hand, so that what reads a solution is tested without a search for one."""

import numpy as np

from gloss_analysis.mds import MdsSolution
from gloss_analysis.mds.objective import source_distances

__all__ = ["solution_of"]


def solution_of(
    coordinates: np.ndarray,
    transforms: np.ndarray | None = None,
    *,
    model: str = "weighted",
    stimuli: tuple[str, ...] | None = None,
    participants: tuple[str, ...] | None = None,
    noise: float = 0.0,
    conditional: bool = True,
) -> MdsSolution:
    """Make the solution of judgements that are the squares of the distances; `noise` parts disparities from them."""
    coordinates = np.asarray(coordinates, dtype=float)
    n, p = coordinates.shape
    transforms = np.eye(p)[np.newaxis] if transforms is None else np.asarray(transforms, dtype=float)
    if transforms.ndim == 2:
        transforms = transforms[:, :, np.newaxis] * np.eye(p)
    m = len(transforms)
    distances = source_distances(coordinates, transforms)
    disparities = distances * (1 + noise * np.random.default_rng(0).standard_normal(distances.shape))
    stress = np.sqrt(np.sum((distances - disparities) ** 2, axis=1) / np.sum(distances**2, axis=1))
    return MdsSolution(
        stimuli=stimuli or tuple(f"s{i}" for i in range(n)),
        participants=participants or tuple(f"p{k}" for k in range(m)),
        n_dims=p,
        model=model,
        level="ordinal",
        ties="primary",
        conditional=conditional,
        restricted=False,
        coordinates=coordinates,
        dimension_weights=np.linalg.norm(transforms, axis=2),
        transforms=transforms,
        stress1=float(np.sqrt(np.mean(stress**2))),
        source_stress1=stress,
        distances=distances,
        disparities=disparities,
        dissimilarities=distances**2,
        pair_weights=np.ones(distances.shape),
        source_shares=np.full(m, 1 / m),
        starts=1,
        best_hits=1,
        start_stress1=np.zeros(1),
        search="made by hand",
        converged=True,
        warnings=(),
    )
