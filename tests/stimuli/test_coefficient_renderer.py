"""How the coefficient path tracer multiplies its randomisations: with a tracer whose every number is known.

The tracer itself is tested in `test_tracer`, its cache in `test_passes`, its pictures in `test_render`.
"""

import dataclasses
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from gloss_stimuli import coefficient_renderer, passes
from gloss_stimuli.coefficient_renderer import RANDOMISATIONS, CoefficientRenderer
from gloss_stimuli.render import tone_curve
from gloss_stimuli.renderer import Rendering
from gloss_stimuli.scene import Film, Scene, read_scene
from gloss_stimuli.target import ErrorTarget, find_target
from gloss_stimuli.tracer import diffuse_exponents, specular_exponents
from glossspace.stimulus_set import Stimulus

WIDTH, HEIGHT = 24, 16
PIXELS = WIDTH * HEIGHT
GRAY, MATTE = Stimulus.of(0.193, 0.066, 0.07), Stimulus.of(0.5, 0.0, 0.3)
SHINY = Stimulus.of(0.03, 0.9, 0.1)


def truth(alpha: float | None) -> NDArray[np.float64]:
    """Coefficients of a room that does not exist: any numbers of the right size, other ones for each α."""
    rng = np.random.default_rng(0 if alpha is None else round(1e6 * alpha))
    exponents = diffuse_exponents() if alpha is None else specular_exponents()
    return np.array([20 * 0.1 ** (i + j) * rng.uniform(1, 2, PIXELS) for i, j in exponents])


class Tracer:
    """Stands for `trace_pass`: the truth with independent normal errors, of this size in the lowest order."""

    def __init__(self) -> None:
        self.sigmas: dict[float | None, float] = {None: 0.2, 0.07: 1.0, 0.1: 1.0}
        self.calls: list[float | None] = []

    def __call__(
        self, scene: Scene, pixels: NDArray[np.uint32], *, samples: int, seed: int, alpha: float | None = None
    ) -> NDArray[np.float32]:
        self.calls.append(alpha)
        estimates = truth(alpha)[:, pixels]
        estimates[0] += self.sigmas[alpha] * np.random.default_rng([seed, *pixels]).normal(size=len(pixels))
        return estimates.astype(np.float32)


@pytest.fixture
def tracer(monkeypatch: pytest.MonkeyPatch) -> Tracer:
    tracer = Tracer()
    monkeypatch.setattr(passes, "trace_pass", tracer)
    monkeypatch.setattr(passes, "use_llvm", lambda: None)
    return tracer


def renderer(cache: Path, scene: Scene | None = None, *, film: tuple[int, int] = (WIDTH, HEIGHT), **changes):
    scene = (scene or read_scene()).with_film(Film(width=film[0], height=film[1]))
    settings = {"target": find_target("draft"), "tone": tone_curve(scene), "display": scene.display.model(), "seed": 1}
    return CoefficientRenderer(scene=scene, cache=cache, **{**settings, **changes})


def render(one: CoefficientRenderer, stimuli: Sequence[Stimulus]) -> list[Rendering]:
    """All renderings; what is announced as steps must be done as steps."""
    done, expected = 0, one.steps(stimuli)

    def step(*, more: int = 0) -> None:
        nonlocal done, expected
        done, expected = done + 1, expected + more
        assert done <= expected

    renderings = list(one.render(stimuli, step=step))
    assert done == expected
    return renderings


def polynomial(stimulus: Stimulus) -> NDArray[np.float64]:
    parts = [(diffuse_exponents(), truth(None))]
    if stimulus.rho_s > 0:
        parts.append((specular_exponents(), truth(stimulus.alpha)))
    terms = [
        stimulus.rho_d**i * stimulus.rho_s**j * row
        for exponents, rows in parts
        for (i, j), row in zip(exponents, rows, strict=True)
    ]
    return np.sum(terms, axis=0).reshape(HEIGHT, WIDTH)


def test_an_image_is_the_polynomial_of_both_passes(tracer: Tracer, tmp_path: Path) -> None:
    tracer.sigmas = dict.fromkeys(tracer.sigmas, 0.0)
    renderings = render(renderer(tmp_path), [SHINY, GRAY, MATTE])
    assert [r.stimulus for r in renderings] == [MATTE, GRAY, SHINY]  # by α; the matte one has none
    for rendering in renderings:
        np.testing.assert_allclose(rendering.luminance, polynomial(rendering.stimulus), rtol=1e-6)  # float32
        white = truth(None).sum(axis=0).reshape(HEIGHT, WIDTH)
        np.testing.assert_allclose(rendering.white_luminance, white, rtol=1e-6)
        assert rendering.details == {"randomisations": RANDOMISATIONS[0]}


def test_the_error_estimate_is_the_error(tracer: Tracer, tmp_path: Path) -> None:
    """Both passes are noisy, and their variances add: the errors that were made are those that were stated."""
    loose = ErrorTarget(max_code_error=100, fraction=0.5)
    one = renderer(tmp_path, target=loose)
    for rendering in render(one, [MATTE, SHINY]):
        codes = [
            one.display.exact_codes(one.display.white_cd_m2 * one.tone(luminance))
            for luminance in (rendering.luminance, polynomial(rendering.stimulus))
        ]
        errors = np.abs(codes[0] - codes[1])
        for limit in (0.1, 0.2, 0.5, 1.0):
            # .1: three standard errors of a share of 384 pixels.
            assert np.mean(errors < limit) == pytest.approx(rendering.error.within(limit), abs=0.1)


def test_what_is_not_good_enough_gets_more_randomisations(tracer: Tracer, tmp_path: Path) -> None:
    # The walls are noiseless. A code value is about .5 cd/m² here; .9 of a scatter of 4 over √8 and √32 is 1.3 and .64,
    # so that one code value on half of the pixels (.67 sigma) takes the second attempt.
    tracer.sigmas = {None: 0.0, 0.07: 0.0, 0.1: 4.0}
    target = ErrorTarget(max_code_error=1.0, fraction=0.5)
    renderings = render(renderer(tmp_path, target=target), [SHINY, GRAY, MATTE])
    assert [(r.stimulus, r.details["randomisations"]) for r in renderings] == [(MATTE, 8), (GRAY, 8), (SHINY, 32)]
    assert all(target.is_reached(r.error) for r in renderings)
    # The roughness that is finished is not traced again: pixels on and off the sphere for it, all for the diffuse pass.
    assert [tracer.calls.count(alpha) for alpha in (None, 0.07, 0.1)] == [8 + 32, 2 * 8, 2 * (8 + 32)]


def test_at_the_last_attempt_it_gives_what_it_has_and_does_not_claim_more(
    tracer: Tracer, tmp_path: Path, monkeypatch
) -> None:
    monkeypatch.setattr(coefficient_renderer, "RANDOMISATIONS", (2, 4, 6))
    target = ErrorTarget(max_code_error=1e-4, fraction=0.999)
    renderings = render(renderer(tmp_path, target=target), [GRAY, SHINY])
    assert [r.details for r in renderings] == [{"randomisations": 6}] * 2
    assert not any(target.is_reached(r.error) for r in renderings)


def test_finished_passes_are_not_traced_again(tracer: Tracer, tmp_path: Path) -> None:
    first = render(renderer(tmp_path), [GRAY])
    tracer.calls.clear()
    again = render(renderer(tmp_path), [GRAY])
    assert again[0].luminance.tobytes() == first[0].luminance.tobytes()
    render(renderer(tmp_path), [Stimulus.of(0.4, 0.1, 0.07), MATTE])
    assert tracer.calls == []


def test_other_seeds_are_other_errors(tracer: Tracer, tmp_path: Path) -> None:
    one, other = (render(renderer(tmp_path, seed=seed), [MATTE])[0] for seed in (1, 2))
    assert (one.luminance != other.luminance).all()


def test_the_key_changes_with_everything_that_changes_pixels(tmp_path: Path, scene_with) -> None:
    base = renderer(tmp_path)
    changed = [
        renderer(tmp_path, seed=2),
        renderer(tmp_path, film=(HEIGHT, WIDTH)),
        renderer(tmp_path, scene_with(light={"luminance_cd_m2": 900.0})),
        renderer(tmp_path, scene_with(sphere={"lobe": "duer2006"})),
        # The target decides how many randomisations there are, and so does what turns luminance into code values.
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
    base = renderer(tmp_path)
    assert renderer(tmp_path / "elsewhere").key(GRAY) == base.key(GRAY)
    assert renderer(tmp_path, scene_with(viewing={"distance_cm": 60.0})).key(GRAY) == base.key(GRAY)
    assert base.key(dataclasses.replace(GRAY, name="other")) == base.key(GRAY)
    # Without a specular term nobody sees its form or how rough it would be.
    assert base.key(MATTE) == base.key(Stimulus.of(0.5, 0.0, 0.01))
    assert renderer(tmp_path, scene_with(sphere={"lobe": "duer2006"})).key(MATTE) == base.key(MATTE)


def test_the_manifest_says_how_it_was_made(tmp_path: Path) -> None:
    described = renderer(tmp_path, seed=7).describe()
    assert set(described.pop("software")) == {"mitsuba", "drjit", "numpy"}
    assert described == {"seed": 7, "samples_a_randomisation": {"diffuse": 256, "sphere": 64, "wall": 16}}
