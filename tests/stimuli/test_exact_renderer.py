"""How the exact renderer climbs its ladder, and what it keeps: with a solver whose every number is known.

The solver itself is tested in `tests/stimuli/exact`, its pictures in `test_render`.
"""

import dataclasses
import os
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter
from threadpoolctl import threadpool_info, threadpool_limits

from gloss_stimuli import exact_renderer
from gloss_stimuli.exact import DIFFUSE_EXPONENTS, LEVELS, SPECULAR_EXPONENTS, Level
from gloss_stimuli.exact_renderer import ExactRenderer
from gloss_stimuli.render import tone_curve
from gloss_stimuli.renderer import Rendering
from gloss_stimuli.scene import Film, Scene, read_scene
from gloss_stimuli.target import ErrorTarget, find_target
from glossspace.stimulus_set import Stimulus

WIDTH, HEIGHT = 6, 4
PIXELS = WIDTH * HEIGHT
GRAY = Stimulus.of(0.193, 0.066, 0.07)
WHITE, BLACK, MATTE = Stimulus.of(0.767, 0.033, 0.07), Stimulus.of(0.03, 0.099, 0.1), Stimulus.of(0.5, 0.0, 0.3)

Array = NDArray[np.float64]


def truth(alpha: float | None, pixels: int = PIXELS) -> Array:
    """Coefficients of a room that does not exist: any numbers of the right size, other ones for each α."""
    rng = np.random.default_rng(0 if alpha is None else round(1e6 * alpha))
    terms = len(DIFFUSE_EXPONENTS) if alpha is None else len(SPECULAR_EXPONENTS)
    falling = 40.0 * 0.1 ** np.arange(terms)[:, None] if alpha is None else 40.0
    return falling * rng.uniform(0.5, 1, (terms, pixels))


class Solver:
    """Stands for `solve`: the truth plus an error that is the same for all pixels and known for each level.

    Attributes
    ----------
    errors : list of float
        Of each level, in cd/m²: by so much the constant term is off.
    of_alpha : dict
        So many times that error is the first specular term of an α off.
    calls, seeds : list
        Level and roughnesses of each call, and its seed.
    stop_before : float or None
        The roughness at which somebody presses Ctrl-C.
    """

    def __init__(self) -> None:
        self.errors = [0.4, -0.2, 0.04, -0.02, 0.0]
        self.of_alpha: dict[float, float] = {}
        self.calls: list[tuple[int, list[float]]] = []
        self.seeds: list[tuple[int, ...]] = []
        self.stop_before: float | None = None

    def __call__(
        self, scene: Scene, level: Level, seed: Sequence[int], alphas: Sequence[float]
    ) -> Iterator[tuple[float | None, NDArray[np.float32]]]:
        number = LEVELS.index(level)
        self.calls.append((number, list(alphas)))
        self.seeds.append(tuple(seed))
        assert all(pool["num_threads"] == 1 for pool in threadpool_info())  # so that no library's own threads round
        for alpha in [None, *alphas]:
            if alpha is not None and alpha == self.stop_before:
                raise KeyboardInterrupt
            coefficients = truth(alpha, scene.film.width * scene.film.height)
            coefficients[0] += self.errors[number] * (1.0 if alpha is None else self.of_alpha.get(alpha, 0.0))
            yield alpha, coefficients.astype(np.float32)


@pytest.fixture
def solver(monkeypatch: pytest.MonkeyPatch) -> Solver:
    solver = Solver()
    monkeypatch.setattr(exact_renderer, "solve", solver)
    return solver


def renderer(cache: Path, scene: Scene | None = None, *, film: tuple[int, int] = (WIDTH, HEIGHT), **changes):
    scene = (scene or read_scene()).with_film(Film(width=film[0], height=film[1]))
    settings = {"target": find_target("draft"), "tone": tone_curve(scene), "display": scene.display.model(), "seed": 1}
    return ExactRenderer(scene=scene, cache=cache, **{**settings, **changes})


def render(one: ExactRenderer, stimuli: Sequence[Stimulus]) -> list[Rendering]:
    """All renderings; what is announced as steps must be done as steps."""
    done, expected = 0, one.steps(stimuli)

    def step(*, more: int = 0) -> None:
        nonlocal done, expected
        done, expected = done + 1, expected + more
        assert done <= expected

    renderings = list(one.render(stimuli, step=step))
    assert done == expected
    return renderings


def polynomial(stimulus: Stimulus, diffuse: Array, specular: Array | None) -> Array:
    """Luminance, term by term: what the docstring of `gloss_stimuli.exact.solution` says."""
    total = np.zeros(PIXELS)
    for (i, j), row in zip(DIFFUSE_EXPONENTS, diffuse, strict=True):
        total += stimulus.rho_d**i * stimulus.rho_s**j * row
    if specular is not None:
        for (i, j), row in zip(SPECULAR_EXPONENTS, specular, strict=True):
            total += stimulus.rho_d**i * stimulus.rho_s**j * row
    return total.reshape(HEIGHT, WIDTH)


def test_an_image_is_the_polynomial_of_two_levels_mean(solver: Solver, tmp_path: Path) -> None:
    solver.of_alpha = {0.07: 2.0, 0.1: 1.0}
    renderings = render(renderer(tmp_path), [GRAY, WHITE, BLACK, MATTE])
    assert [r.stimulus for r in renderings] == [MATTE, GRAY, WHITE, BLACK]  # by α; the matte one has none
    for rendering in renderings:
        stimulus = rendering.stimulus
        # The levels are off by .4 and -.2, so their mean is by .1.
        expected = polynomial(stimulus, truth(None), truth(stimulus.alpha) if stimulus.rho_s else None) + 0.1
        expected += 0.1 * solver.of_alpha.get(stimulus.alpha, 0) * stimulus.rho_s
        np.testing.assert_allclose(rendering.luminance, expected, rtol=1e-6)  # float32, a dozen sums of it
        assert rendering.details == {"levels": [0, 1]}


def test_an_image_does_not_depend_on_the_threads_of_a_linear_algebra_library(solver: Solver, tmp_path: Path) -> None:
    # A size at which OpenBLAS, given several threads, rounds a product of matrices in another way.
    film, bits = (500, 334), set()
    for threads in (1, 2, 3):
        with threadpool_limits(threads):
            one = renderer(tmp_path, film=film, target=ErrorTarget(max_code_error=100, fraction=0.5))
            (rendering,) = render(one, [GRAY])
            bits.add((rendering.luminance.tobytes(), rendering.white_luminance.tobytes()))
    assert len(bits) == 1


def test_white_luminance_is_that_of_a_perfect_diffuser(solver: Solver, tmp_path: Path) -> None:
    for rendering in render(renderer(tmp_path), [GRAY, MATTE]):
        expected = truth(None).sum(axis=0).reshape(HEIGHT, WIDTH) + 0.1  # every monomial is 1, and the mean error .1
        np.testing.assert_allclose(rendering.white_luminance, expected, rtol=1e-6)


def test_the_error_is_half_the_difference_of_the_two_levels(solver: Solver, tmp_path: Path) -> None:
    one = renderer(tmp_path)
    (rendering,) = render(one, [MATTE])

    def codes(luminance: Array) -> Array:
        return one.display.exact_codes(one.display.white_cd_m2 * one.tone(luminance))

    # Half of .4 - -.2 is .3 cd/m² in every pixel. What it is in codes is shared among neighbours, as a mean of squares.
    sigmas = (codes(rendering.luminance + 0.3) - codes(rendering.luminance - 0.3)) / 2
    mean_squares = uniform_filter(sigmas**2, 3, mode="nearest")
    np.testing.assert_allclose(rendering.error.sigmas, np.sort(np.sqrt(mean_squares), axis=None), rtol=1e-5)  # float32


@pytest.mark.parametrize(("max_code_error", "first"), [(2.0, 0), (1.0, 0), (0.99, 1), (0.5, 1)])
def test_a_loose_target_starts_lower(solver: Solver, tmp_path: Path, max_code_error: float, first: int) -> None:
    solver.errors = [0.0] * 5
    target = ErrorTarget(max_code_error=max_code_error, fraction=0.999)
    (rendering,) = render(renderer(tmp_path, target=target), [GRAY])
    assert rendering.details == {"levels": [first, first + 1]}
    assert solver.calls == [(first, [0.07]), (first + 1, [0.07])]
    # A level draws other numbers than its neighbour.
    assert solver.seeds == [(1, first), (1, first + 1)]


def test_what_is_not_good_enough_goes_on_and_takes_along_only_what_it_needs(solver: Solver, tmp_path: Path) -> None:
    # A code value is about .5 cd/m² in these pictures. The walls are good enough from the start; times rho_s, the lobe
    # of .1 is off by .099 · 3000 · (.01, -.01, .01, 0, 0) cd/m², which takes it to the pair of levels without error.
    solver.errors = [0.01, -0.01, 0.01, 0.0, 0.0]
    solver.of_alpha = {0.07: 30.0, 0.1: 3000.0}
    target = ErrorTarget(max_code_error=1.0, fraction=0.999)
    renderings = render(renderer(tmp_path, target=target), [BLACK, GRAY, MATTE])
    assert [(r.stimulus, r.details["levels"]) for r in renderings] == [
        (MATTE, [0, 1]), (GRAY, [0, 1]), (BLACK, [3, 4])
    ]  # fmt: skip
    assert solver.calls == [(0, [0.07, 0.1]), (1, [0.07, 0.1]), (2, [0.1]), (3, [0.1]), (4, [0.1])]
    assert all(target.is_reached(r.error) for r in renderings)


def test_at_the_last_level_it_gives_what_it_has_and_does_not_claim_more(solver: Solver, tmp_path: Path) -> None:
    solver.errors = [1.0, -1.0, 1.0, -1.0, 1.0]
    target = ErrorTarget(max_code_error=1e-4, fraction=0.999)
    renderings = render(renderer(tmp_path, target=target), [GRAY, BLACK])
    last = len(LEVELS) - 1
    assert [r.details["levels"] for r in renderings] == [[last - 1, last]] * 2
    assert not any(target.is_reached(r.error) for r in renderings)
    assert [number for number, _ in solver.calls] == list(range(1, len(LEVELS)))  # each once


def test_a_set_of_matte_paints_solves_no_lobe(solver: Solver, tmp_path: Path) -> None:
    render(renderer(tmp_path), [MATTE])
    assert solver.calls == [(0, []), (1, [])]


def test_what_is_in_the_cache_is_not_solved_again(solver: Solver, tmp_path: Path) -> None:
    first = render(renderer(tmp_path), [GRAY, BLACK])
    assert len(list(tmp_path.iterdir())) == 2 * 3
    solver.calls.clear()
    again = render(renderer(tmp_path), [GRAY, BLACK])
    assert solver.calls == []
    assert [r.luminance.tobytes() for r in again] == [r.luminance.tobytes() for r in first]
    # Other paints of these roughnesses and another target need nothing new either, a new roughness needs itself.
    render(renderer(tmp_path, target=find_target("draft", fraction=0.9)), [WHITE, MATTE])
    assert solver.calls == []
    render(renderer(tmp_path), [GRAY, Stimulus.of(0.2, 0.1, 0.04)])
    assert solver.calls == [(0, [0.04]), (1, [0.04])]


def test_coefficients_that_are_used_again_are_young_again(solver: Solver, tmp_path: Path) -> None:
    render(renderer(tmp_path), [GRAY, BLACK])
    for path in tmp_path.iterdir():
        os.utime(path, (1, 1))
    render(renderer(tmp_path), [GRAY])
    # So the cache, which drops the oldest, drops the roughness that nobody has asked for since.
    one = renderer(tmp_path)
    old = {path for path in tmp_path.iterdir() if path.stat().st_mtime == 1}
    assert old == {one._path(level, BLACK.alpha) for level in (0, 1)}


@pytest.mark.parametrize("damage", ["cut", "empty", "other", "gone"])
def test_a_damaged_file_is_made_again(solver: Solver, tmp_path: Path, damage: str) -> None:
    one = renderer(tmp_path)
    first = render(one, [GRAY])
    solver.calls.clear()
    path = one._path(1, 0.07)
    if damage == "cut":
        path.write_bytes(path.read_bytes()[:-100])
    elif damage == "empty":
        path.write_bytes(b"")
    elif damage == "other":  # of a film with other pixels
        np.savez(path, coefficients=np.zeros((6, 3), dtype=np.float32))
    else:
        path.unlink()
    again = render(one, [GRAY])
    assert solver.calls == [(1, [0.07])]
    assert again[0].luminance.tobytes() == first[0].luminance.tobytes()


def test_interrupted_it_keeps_what_was_finished(solver: Solver, tmp_path: Path) -> None:
    solver.stop_before = 0.1
    with pytest.raises(KeyboardInterrupt):
        render(renderer(tmp_path), [GRAY, BLACK])
    assert len(list(tmp_path.iterdir())) == 2  # the diffuse part and α = .07 of the first level, and no fragment
    solver.stop_before = None
    solver.calls.clear()
    render(renderer(tmp_path), [GRAY, BLACK])
    assert solver.calls == [(0, [0.1]), (1, [0.07, 0.1])]


def test_coefficients_that_another_rendering_drops_are_solved_again(solver: Solver, tmp_path: Path) -> None:
    rendered = renderer(tmp_path).render([GRAY, BLACK], step=lambda **_: None)
    next(rendered)
    calls = len(solver.calls)
    for path in tmp_path.iterdir():
        path.unlink()
    assert next(rendered).stimulus in (GRAY, BLACK)
    assert len(solver.calls) > calls


def test_the_key_changes_with_everything_that_changes_pixels(tmp_path: Path, scene_with) -> None:
    base = renderer(tmp_path)
    changed = [
        renderer(tmp_path, seed=2),
        renderer(tmp_path, film=(HEIGHT, WIDTH)),
        renderer(tmp_path, scene_with(light={"luminance_cd_m2": 900.0})),
        renderer(tmp_path, scene_with(sphere={"lobe": "duer2006"})),
        # The target decides which level serves, and so does what turns luminance into code values.
        renderer(tmp_path, target=find_target("exact")),
        renderer(tmp_path, scene_with(tone={"slope": 0.9})),
        renderer(tmp_path, scene_with(display={"gamma": 2.2})),
    ]
    keys = {one.key(GRAY) for one in [base, *changed]}
    keys |= {
        base.key(Stimulus.of(*paint)) for paint in ((0.2, 0.066, 0.07), (0.193, 0.067, 0.07), (0.193, 0.066, 0.08))
    }
    assert len(keys) == len(changed) + 4


def test_the_key_ignores_what_does_not_change_pixels(tmp_path: Path, scene_with) -> None:
    key = renderer(tmp_path).key(GRAY)
    assert renderer(tmp_path / "elsewhere").key(GRAY) == key
    assert renderer(tmp_path, scene_with(viewing={"distance_cm": 60.0})).key(GRAY) == key
    assert renderer(tmp_path, read_scene().model_copy(update={"name": "other"})).key(GRAY) == key
    assert renderer(tmp_path).key(dataclasses.replace(GRAY, name="other")) == key
    # Without a specular term nobody sees how rough it would be.
    assert renderer(tmp_path).key(MATTE) == renderer(tmp_path).key(Stimulus.of(0.5, 0.0, 0.01))


def test_the_tone_curve_is_in_no_coefficients(solver: Solver, tmp_path: Path, scene_with) -> None:
    render(renderer(tmp_path), [GRAY])
    solver.calls.clear()
    for scene in (
        scene_with(tone={"slope": 0.9}), scene_with(display={"gamma": 2.2}), scene_with(viewing={"distance_cm": 60.0})
    ):  # fmt: skip
        render(renderer(tmp_path, scene), [GRAY])
    assert solver.calls == []


def test_the_manifest_says_what_made_it(tmp_path: Path) -> None:
    described = renderer(tmp_path, seed=7).describe()
    assert set(described.pop("software")) == {"numba", "llvmlite", "numpy", "scipy"}
    assert described == {"seed": 7}
