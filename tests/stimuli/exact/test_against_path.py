"""The exact renderer against stock path tracing: Mitsuba's means in `tests/reference/path_blocks.json`.

Where a block of 32 × 32 pixels differs, in standard errors of both, is known for 64 blocks of six stimuli, and for the
means over walls and sphere. A short run of Mitsuba itself keeps the stored numbers honest.
"""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from gloss_stimuli.exact import DIFFUSE_EXPONENTS, LEVELS, SPECULAR_EXPONENTS, solution, solve
from gloss_stimuli.scene import Film, read_scene
from tests.reference.path_blocks import BLOCKS, SAMPLES_A_PASS, SIZE, regions, statistics

REFERENCE = Path(__file__).parents[2] / "reference" / "path_blocks.json"
LARGEST_BIAS = 3e-4
COUNT = BLOCKS * BLOCKS


@pytest.fixture(scope="module")
def reference() -> dict:
    return json.loads(REFERENCE.read_text())


def stored(stimulus: dict) -> tuple[np.ndarray, np.ndarray]:
    """Means and their standard errors: blocks row by row, walls, sphere."""
    return tuple(
        np.array([*stimulus[f"blocks{kind}"], stimulus[f"walls{kind}"], stimulus[f"sphere{kind}"]])
        for kind in ("", "_standard_error")
    )


@pytest.fixture(scope="module")
def exact(reference: dict) -> np.ndarray:
    """The same means of the two levels that the default target starts with, shape (2, stimuli, 66)."""
    scene = read_scene().with_film(Film(width=SIZE, height=SIZE))
    alphas = sorted({stimulus["alpha"] for stimulus in reference["stimuli"]})
    walls, sphere = regions(SIZE)
    means = np.empty((2, len(reference["stimuli"]), COUNT + 2))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(solution, "SMALLEST_FILM", SIZE)  # blocks average many pixels; finer ones only take time
        for number in (1, 2):
            parts = dict(solve(scene, LEVELS[number], (1, number), alphas))
            for k, stimulus in enumerate(reference["stimuli"]):
                rho_d, rho_s = stimulus["rho_d"], stimulus["rho_s"]
                image = np.zeros(SIZE * SIZE)
                for powers, alpha in ((DIFFUSE_EXPONENTS, None), (SPECULAR_EXPONENTS, stimulus["alpha"])):
                    image += np.array([rho_d**i * rho_s**j for i, j in powers]) @ parts[alpha].astype(float)
                means[number - 1, k] = statistics(image.reshape(SIZE, SIZE), walls, sphere)
    return means


def own_error(exact: np.ndarray) -> np.ndarray:
    """Relative error of the mean of two levels, half their difference, shape (66,).

    It is mostly that of the walls' irradiance, which all stimuli share: so their rms says it best.
    """
    return np.sqrt(np.mean(((exact[0] - exact[1]) / (exact[0] + exact[1])) ** 2, axis=0))


def test_the_reference_is_of_the_shipped_scene(reference: dict) -> None:
    scene = read_scene().with_film(Film(width=SIZE, height=SIZE))
    assert reference["scene"] == json.loads(json.dumps(scene.geometry())), (
        "The scene has changed: make path_blocks.json anew (see path_blocks.py)."
    )
    assert len(reference["stimuli"]) >= 6
    for stimulus in reference["stimuli"]:
        mean, error = stored(stimulus)
        assert np.isfinite(mean).all()
        assert (error > 0).all()
        assert np.median(error / mean) < 5e-4  # good enough to see what the standard code error does not


def test_blocks_agree_within_their_standard_errors(reference: dict, exact: np.ndarray) -> None:
    mean, own = exact.mean(axis=0), own_error(exact)
    scores = []
    for k, stimulus in enumerate(reference["stimuli"]):
        expected, error = stored(stimulus)
        scores.append(((mean[k] - expected) / np.hypot(error, own * mean[k]))[:COUNT])
    scores = np.array(scores)
    # All blocks of all stimuli together raise a false alarm once in a hundred times (Bonferroni).
    largest = stats.norm.isf(0.01 / 2 / scores.size)
    worst = np.unravel_index(np.abs(scores).argmax(), scores.shape)
    assert np.abs(scores[worst]) < largest, (worst[0], divmod(int(worst[1]), BLOCKS))  # stimulus, block
    # The errors are true: the rms is one. Stimuli share the walls' irradiance, so there are some 100 blocks of one kind
    # rather than 384, and it is known to 7 %.
    assert 0.7 < np.sqrt(np.mean(scores**2)) < 1.25
    assert abs(scores.mean()) < 0.25  # four standard errors of a mean of 300


@pytest.mark.parametrize(("region", "index"), [("walls", COUNT), ("sphere", COUNT + 1)])
def test_mean_bias_is_below_three_hundredths_of_a_percent(
    reference: dict, exact: np.ndarray, region: str, index: int
) -> None:
    """The bound is at least two standard errors of what is compared, and for most stimuli three to five."""
    mean, own = exact.mean(axis=0)[:, index], own_error(exact)[index]
    for k, stimulus in enumerate(reference["stimuli"]):
        expected, error = (values[index] for values in stored(stimulus))
        combined = float(np.hypot(error / expected, own))
        assert combined < LARGEST_BIAS / 2, region
        assert abs(mean[k] / expected - 1) < LARGEST_BIAS, (region, stimulus)


@pytest.mark.usefixtures("llvm")
def test_stored_numbers_are_still_those_of_mitsuba(reference: dict) -> None:
    """A few passes of today's Mitsuba and plugin: within the scatter that the reference states for them."""
    import mitsuba as mi

    from gloss_stimuli.gloss_ward_bsdf import register_plugins
    from gloss_stimuli.mitsuba_scene import load_scene
    from gloss_stimuli.path_renderer import INTEGRATOR
    from glossspace.stimulus_set import Stimulus

    register_plugins()
    stimulus = reference["stimuli"][3]
    paint = Stimulus.of(stimulus["rho_d"], stimulus["rho_s"], stimulus["alpha"])
    loaded = load_scene(read_scene().with_film(Film(width=SIZE, height=SIZE)), paint)
    integrator = mi.load_dict(INTEGRATOR)
    walls, sphere = regions(SIZE)
    passes = 4
    live = np.mean(
        [
            statistics(
                np.array(mi.render(loaded, integrator=integrator, spp=SAMPLES_A_PASS, seed=10**6 + k))
                .reshape(SIZE, SIZE)
                .astype(float),
                walls,
                sphere,
            )
            for k in range(passes)
        ],
        axis=0,
    )
    expected, error = stored(stimulus)
    ratio = stimulus["samples_per_pixel"] / SAMPLES_A_PASS / passes
    scores = (live - expected) / (error * np.sqrt(1 + ratio))
    assert np.abs(scores).max() < stats.norm.isf(0.001 / 2 / len(scores))
    # Variance of 66 scores: 1 ± .17; both the live scatter and the stored errors would show here.
    assert 0.5 < np.mean(scores**2) < 1.6
