"""The models of `glossspace.reflectance` against the renderer: its Ward plugin, and Mitsuba's own lobes as a peer."""

import numpy as np
import pytest

from gloss_stimuli.exact.lobe import lobe_value
from gloss_stimuli.ward_lobe import FORMS, NORMALISATION
from glossspace.reflectance import Ggx, Lambert, Ward, direction, fresnel_reflectance
from glossspace.reflectance.cook_torrance import CookTorrance

pytestmark = pytest.mark.usefixtures("llvm")


def float32_pairs(width: float, count: int = 2000) -> tuple[np.ndarray, np.ndarray]:
    """Directions whose half vectors lie within a lobe, as Mitsuba holds them."""
    generator = np.random.default_rng(5)
    i = direction(generator.uniform(0, 80, count), generator.uniform(0, 360, count))
    h = direction(np.degrees(np.arctan(width * generator.uniform(0, 2.5, count))), generator.uniform(0, 360, count))
    o = 2 * np.sum(i * h, axis=-1, keepdims=True) * h - i
    i, o = (array[o[:, 2] > 0.05].astype(np.float32).astype(float) for array in (i, o))
    return i, o


def mitsuba_value_and_pdf(plugin: dict, i: np.ndarray, o: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    import drjit as dr
    import mitsuba as mi

    bsdf = mi.load_dict(plugin)
    si = dr.zeros(mi.SurfaceInteraction3f, len(i))
    si.wi = mi.Vector3f(i.T)
    value, pdf = bsdf.eval_pdf(mi.BSDFContext(), si, mi.Vector3f(o.T))
    return np.array(value[0], dtype=float), np.array(pdf, dtype=float)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("alpha", [0.001, 0.04, 0.19, 0.5])
def test_ward_is_the_plugins(form: str, alpha: float) -> None:
    i, o = float32_pairs(alpha)
    paint = {"rho_d": 0.193, "rho_s": 0.066, "alpha": alpha}
    value, pdf = mitsuba_value_and_pdf({"type": "ward", "form": form, **paint}, i, o)
    diffuse, lobe = Lambert(0.193), Ward(0.066, alpha, normalisation=NORMALISATION[form])
    # 3e-5: an exponent of up to 6.3 of a few float32 operations, each wrong by 6e-8, and α rounded to float32 (twice).
    np.testing.assert_allclose(value, (diffuse + lobe).evaluate(i, o) * o[:, 2], rtol=3e-5)
    share = 0.066 / (0.066 + 0.193)
    np.testing.assert_allclose(pdf, share * lobe.pdf(i, o) + (1 - share) * diffuse.pdf(i, o), rtol=3e-5)


@pytest.mark.parametrize("form", FORMS)
def test_ward_is_the_exact_renderers(form: str) -> None:
    i, o = float32_pairs(0.07, 200)
    lobe = Ward(1.0, 0.07, normalisation=NORMALISATION[form])
    compiled = np.array([lobe_value(FORMS.index(form), 0.07, *a, *b) for a, b in zip(i, o, strict=True)])
    # Directions rounded to float32 are not of unit length to 6e-8, which both read from other components.
    np.testing.assert_allclose(compiled[:, 0], lobe.evaluate(i, o) * o[:, 2], rtol=1e-6)
    np.testing.assert_allclose(compiled[:, 1], lobe.pdf(i, o), rtol=1e-6)


@pytest.mark.parametrize(("n", "k"), [(1.5, 0.0), (0.26, 2.9), (2.8, 3.2)])
def test_ggx_is_mitsubas_rough_conductor(n: float, k: float) -> None:
    i, o = float32_pairs(0.2)
    plugin = {"type": "roughconductor", "distribution": "ggx", "alpha": 0.2, "material": "none"}
    value, pdf = mitsuba_value_and_pdf({**plugin, "specular_reflectance": 1.0}, i, o)
    mirror = Ggx(0.2)
    # 2e-4: float32, and a distribution that Mitsuba computes from the normalised half vector.
    np.testing.assert_allclose(value, mirror.evaluate(i, o) * o[:, 2], rtol=2e-4)
    np.testing.assert_allclose(pdf, mirror.pdf(i, o), rtol=2e-4)
    plugin = {"type": "roughconductor", "distribution": "ggx", "alpha": 0.2, "eta": n, "k": k}
    value, _ = mitsuba_value_and_pdf(plugin, i, o)
    np.testing.assert_allclose(value, Ggx(0.2, n=n, k=k).evaluate(i, o) * o[:, 2], rtol=2e-4)


def test_beckmanns_facets_are_mitsubas() -> None:
    import mitsuba as mi

    i, o = float32_pairs(0.3)
    half = (i + o) / np.linalg.norm(i + o, axis=-1, keepdims=True)
    distribution = mi.MicrofacetDistribution(mi.MicrofacetType.Beckmann, 0.3, False)
    facets = np.array(distribution.eval(mi.Vector3f(half.T)), dtype=float)
    cosine = np.sum(half * i, axis=-1)
    grooves = np.minimum(1, 2 * half[:, 2] * np.minimum(i[:, 2], o[:, 2]) / cosine)
    ours = CookTorrance(1.0, 0.3, 0.0, 1.0, "beckmann").evaluate(i, o)  # a lossless conductor: F = 1
    np.testing.assert_allclose(ours * 4 * i[:, 2] * o[:, 2] / grooves, facets, rtol=2e-4)  # float32, as above


@pytest.mark.parametrize(("n", "k"), [(1.5, 0.0), (0.26, 2.9), (0.05, 40.0)])
def test_fresnel_is_mitsubas(n: float, k: float) -> None:
    import mitsuba as mi

    cosine = np.linspace(0.01, 1, 200)
    theirs = np.array(mi.fresnel_conductor(mi.Float(cosine), mi.Complex2f(n, k)), dtype=float)
    np.testing.assert_allclose(fresnel_reflectance(cosine, n, k), theirs, atol=2e-5)  # float32, cancelling for large k
