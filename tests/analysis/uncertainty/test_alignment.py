"""What a model leaves open is undone before solutions are compared."""

import numpy as np
import pytest
from scipy.spatial import procrustes

from gloss_analysis.uncertainty.alignment import aligned, procrustes_distance


def test_alignment_undoes_what_the_model_leaves_open():
    rng = np.random.default_rng(4)
    points = rng.standard_normal((12, 3)) * [3.0, 2.0, 1.0]
    weights = rng.uniform(0.5, 2, (5, 3))
    transforms = weights[:, :, np.newaxis] * np.eye(3)
    target, own = aligned(points, transforms, points, model="weighted")
    order, sign = [2, 0, 1], np.array([-1.0, 1.0, -1.0])
    moved, turned = aligned(
        7 + points[:, order] * sign * 3, transforms[:, order][:, :, order], target, model="weighted"
    )
    assert moved == pytest.approx(target, abs=1e-12)
    assert turned == pytest.approx(own, abs=1e-12)
    turn, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    for model in ("identity", "generalised"):
        target, own = aligned(points, transforms, points, model=model)
        moved, turned = aligned(points @ turn, turn.T @ transforms @ turn, target, model=model)
        assert moved == pytest.approx(target, abs=1e-9)
        if model == "generalised":
            assert turned == pytest.approx(own, abs=1e-9)


def test_the_procrustes_distance_is_that_of_scipy():
    a, b = np.random.default_rng(5).standard_normal((2, 10, 2))
    assert procrustes_distance(a, b) == pytest.approx(np.sqrt(procrustes(a, b)[2]), abs=1e-12)
    assert procrustes_distance(a, np.zeros((10, 2))) == 1.0
