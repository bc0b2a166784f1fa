"""The plugin in perceptual terms: Ward's by another name in XML and Python, refusing what no paint is."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gloss_stimuli.gloss_ward_bsdf import appearance_to_paint, gloss_ward_class, register_plugins
from gloss_stimuli.mitsuba_scene import luminance_film
from gloss_stimuli.ward_lobe import FORMS
from glossspace.errors import GlossError
from glossspace.metric import AxisFunction, GlossSpace, from_physical

C_RATINGS, D_RATINGS = AxisFunction(380.0, 4.0, 0.94, 24), AxisFunction(410.0, -330.0, 0.96, 11)
FITTED = GlossSpace(name="ours", axis_functions={"c": C_RATINGS, "d": D_RATINGS})


@pytest.fixture(scope="module", autouse=True)
def plugins(llvm: None) -> None:
    register_plugins()


def equations_6_to_8(lightness: float, c: float, d: float) -> dict[str, float]:
    """The gloss paper as printed, for L* above 8, where CIELAB's inverse is a cube."""
    rho_d = ((lightness + 16) / 116) ** 3
    return {"rho_d": rho_d, "rho_s": (c + (rho_d / 2) ** (1 / 3)) ** 3 - rho_d / 2, "alpha": 1 - d}


def responses(bsdf) -> list[np.ndarray]:
    """Value, density, and samples of a BSDF at many directions, seen from above and from below."""
    import drjit as dr
    import mitsuba as mi

    count = 2048
    numbers = np.random.default_rng(2).random((7, count))
    si = dr.zeros(mi.SurfaceInteraction3f, count)
    si.wi = mi.warp.square_to_uniform_sphere(mi.Point2f(numbers[:2]))
    mirrored = mi.Vector3f(-si.wi.x, -si.wi.y, si.wi.z)
    wo = dr.normalize(mirrored + 0.2 * mi.warp.square_to_uniform_sphere(mi.Point2f(numbers[2:4])))
    sampled, weight = bsdf.sample(mi.BSDFContext(), si, mi.Float(numbers[4]), mi.Point2f(numbers[5:7]))
    value, pdf = bsdf.eval_pdf(mi.BSDFContext(), si, wo)
    results = [np.array(x) for x in (value, pdf, weight, sampled.wo, sampled.pdf)]
    assert results[0].any()
    assert results[2].any()
    return results


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(("lightness", "c", "d"), [(20.0, 0.3, 0.96), (51.0, 0.087, 0.93), (90.0, 0.02, 0.7)])
def test_it_is_ward_with_the_parameters_of_equations_6_to_8(form: str, lightness: float, c: float, d: float) -> None:
    import mitsuba as mi

    gloss_ward = mi.load_dict({"type": "gloss_ward", "lightness": lightness, "c": c, "d": d, "form": form})
    ward = mi.load_dict({"type": "ward", **equations_6_to_8(lightness, c, d), "form": form})
    for ours, reference in zip(responses(gloss_ward), responses(ward), strict=True):
        # 1e-5: the parameters may differ in their last float32 digit, which a narrow lobe magnifies.
        np.testing.assert_allclose(ours, reference, rtol=1e-5, atol=1e-6)


def test_the_default_is_the_gray_paint_of_the_paper() -> None:
    import mitsuba as mi

    # Fig. 11: c = .087, d = .93 is the gray stimulus with ρs .066 and α .07, whose ρd .193 has L* = 51.04.
    parameters = mi.traverse(mi.load_dict({"type": "gloss_ward"}))
    for name, value in {"rho_d": 0.193, "rho_s": 0.066, "alpha": 0.07}.items():
        assert parameters[name][0] == pytest.approx(value, rel=2e-3)  # the default is rounded to two digits


def test_xml_and_dictionary_are_the_same() -> None:
    import mitsuba as mi

    xml = """<bsdf version="3.0.0" type="gloss_ward"><float name="lightness" value="30"/><float name="c" value="0.2"/>
        <float name="d" value="0.9"/><string name="form" value="duer2006"/></bsdf>"""
    described = {"type": "gloss_ward", "lightness": 30, "c": 0.2, "d": 0.9, "form": "duer2006"}
    for left, right in zip(responses(mi.load_string(xml)), responses(mi.load_dict(described)), strict=True):
        np.testing.assert_array_equal(left, right)
    assert str(mi.load_string(xml)).startswith("GlossWard[rho_d=")


@given(rho_d=st.floats(0.001, 0.9), rho_s=st.floats(1e-3, 0.1), alpha=st.floats(0.001, 0.3))
def test_a_paint_comes_back_from_its_appearance(rho_d: float, rho_s: float, alpha: float) -> None:
    lightness, c, d = (float(value) for value in from_physical(rho_d, rho_s, alpha))
    # 1e-9: c near zero on a white paint, and d near one, keep a few digits less than double precision.
    assert appearance_to_paint(lightness, c, d) == pytest.approx((rho_d, rho_s, alpha), rel=1e-9)


@given(c=st.floats(0.01, 0.3), d=st.floats(0.7, 0.999))
def test_with_a_space_c_and_d_are_its_observers_ratings(c: float, d: float) -> None:
    rated = {"c": 4.0 + 380.0 * c, "d": -330.0 + 410.0 * d}
    # 1e-9: subtracting the intercepts loses some three digits.
    assert appearance_to_paint(40.0, **rated, space=FITTED) == pytest.approx(appearance_to_paint(40.0, c, d), rel=1e-9)


def test_a_scene_names_the_file_of_a_space(tmp_path: Path) -> None:
    import mitsuba as mi

    FITTED.save(tmp_path / "gloss-space.json")
    rated = {"c": 4.0 + 380.0 * 0.25, "d": -330.0 + 410.0 * 0.92}
    with_space = mi.load_dict(
        {"type": "gloss_ward", "lightness": 30.0, **rated, "space": f"{tmp_path}/gloss-space.json"}
    )
    without = mi.load_dict({"type": "gloss_ward", "lightness": 30.0, "c": 0.25, "d": 0.92})
    for ours, reference in zip(responses(with_space), responses(without), strict=True):
        np.testing.assert_allclose(ours, reference, rtol=1e-5, atol=1e-6)  # the last float32 digit of a parameter
    # Beside the scene's file, like its meshes.
    (tmp_path / "paint.xml").write_text(
        '<bsdf version="3.0.0" type="gloss_ward"><float name="c" value="99"/><float name="d" value="47.2"/>'
        '<string name="space" value="gloss-space.json"/></bsdf>'
    )
    assert mi.traverse(mi.load_file(str(tmp_path / "paint.xml")))["alpha"][0] == pytest.approx(0.08, rel=1e-6)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"lightness": 101.0}, "lightness = 101.*0 to 100"),
        ({"c": -0.01}, "c = -0.01"),
        ({"c": 0.9}, "Contrast gloss c = 0.9 is out of reach for rho_d = .*Choose a darker paint"),
        ({"d": 1.0}, "d = 1.*alpha = 1 - d must be positive"),
        ({"d": 0.99999}, "single precision resolves no narrower lobe"),
        ({"d": -0.5}, "alpha must lie between .* but is 1.5"),
        ({"c": math.nan}, "c of a painted surface must be one finite number, but is nan"),
        ({"form": "phong"}, "Unknown form 'phong'"),
        ({"space": "no-such-space.json", "c": 20.0, "d": 50.0}, "No gloss space at 'no-such-space.json'"),
    ],
)
def test_an_appearance_that_no_paint_has_is_refused(parameters: dict, message: str) -> None:
    import mitsuba as mi

    properties = mi.Properties("gloss_ward")
    for name, value in parameters.items():
        properties[name] = value
    with pytest.raises(GlossError, match=message):
        gloss_ward_class()(properties)


def test_physical_parameters_are_refused() -> None:
    import mitsuba as mi

    with pytest.raises(RuntimeError, match="rho_d"):
        mi.load_dict({"type": "gloss_ward", "rho_d": 0.1})


@pytest.mark.parametrize(
    ("space", "ratings", "message"),
    [
        (GlossSpace(), (20.0, 50.0), "has no axis function of c.*Refit it with magnitude estimates"),
        (GlossSpace(axis_functions={"c": C_RATINGS}), (20.0, 50.0), "has no axis function of d"),
        (
            GlossSpace(axis_functions={"c": AxisFunction(0.0, 7.0, 0.0, 24), "d": D_RATINGS}),
            (20.0, 50.0),
            "axis function of c .* is flat .*rating 7",
        ),
        (FITTED, (0.0, 50.0), "ratings c = 0 and d = 50 stand for c = -0.0105.* in the gloss space 'ours': "),
        (FITTED, (20.0, 80.0), "stand for .*d = 1.*alpha = 1 - d must be positive"),
    ],
)
def test_ratings_that_a_space_cannot_invert_are_refused(space: GlossSpace, ratings: tuple, message: str) -> None:
    with pytest.raises(GlossError, match=message):
        appearance_to_paint(50.0, *ratings, space=space)


def test_with_a_space_no_rating_has_a_default(tmp_path: Path) -> None:
    import mitsuba as mi

    FITTED.save(tmp_path / "gloss-space.json")
    with pytest.raises(RuntimeError, match="needs both c and d"):
        mi.load_dict({"type": "gloss_ward", "c": 20.0, "space": str(tmp_path / "gloss-space.json")})


def test_it_renders_in_a_scene_beside_ward() -> None:
    import mitsuba as mi

    scene = mi.load_dict({
        "type": "scene",
        "integrator": {"type": "path"},
        "sky": {"type": "constant", "radiance": 10.0},
        "sensor": {
            "type": "orthographic",
            "to_world": mi.ScalarTransform4f().look_at(origin=[0, 0, 5], target=[0, 0, 0], up=[0, 1, 0]),
            "film": luminance_film(4, 2),
        },
        "left": {
            "type": "rectangle",
            "to_world": mi.ScalarTransform4f().translate([-1, 0, 0]),
            "paint": {"type": "ward", **equations_6_to_8(51.0, 0.087, 0.93)},
        },
        "right": {
            "type": "rectangle",
            "to_world": mi.ScalarTransform4f().translate([1, 0, 0]),
            "paint": {"type": "gloss_ward", "lightness": 51.0, "c": 0.087, "d": 0.93},
        },
    })  # fmt: skip
    image = np.array(mi.render(scene, spp=4096, seed=1))[..., 0]
    assert image[:, :2].mean() == pytest.approx(image[:, 2:].mean(), rel=0.01)  # some five standard errors
    assert image.mean() == pytest.approx(
        10 * (0.193 + 0.9856 * 0.066), rel=0.01
    )  # albedo of eq. 2 at 0°, by quadrature
