"""The double integral over two apertures, against closed forms, sampling and itself at a tighter tolerance."""

import numpy as np
import pytest

from glossspace import GlossError
from glossspace.instruments.apertures import Aperture
from glossspace.instruments.quadrature import QuadratureWarning, mean_over_apertures, mean_projection
from glossspace.instruments.standards import glossmeter_geometry
from glossspace.reflectance import CookTorrance, Ggx, Lambert, Phong, Sum, Tabulated, Ward, direction
from glossspace.reflectance.model import ReflectanceModel

POINT = {"source": Aperture(50, 180), "detector": Aperture(50)}


def sampled_mean(model: ReflectanceModel, source: Aperture, detector: Aperture, *, n=400_000, seed=1):
    """Monte Carlo by the model's own sampling: mean of f cosθi cosθr over both apertures, and its standard error."""
    rng = np.random.default_rng(seed)
    x, y = (rng.uniform(*extent, n) for extent in (source.x_range, source.y_range))
    incident, density = source.directions(x, y)
    drawn = model.sample(incident, rng.random((n, 2)))
    x, y = detector.mirror_points(drawn.exitant * np.array([-1.0, -1.0, 1.0]))  # mirrored twice: where they hit
    inside = (x >= detector.x_range[0]) & (x <= detector.x_range[1])
    inside &= (y >= detector.y_range[0]) & (y <= detector.y_range[1]) & (drawn.exitant[:, 2] > 0)
    area = np.ptp(source.x_range) * np.ptp(source.y_range)
    share = np.where(inside, drawn.weight, 0) * incident[:, 2] * density * area
    scale = source.solid_angle * detector.solid_angle
    return share.mean() / scale, share.std() / np.sqrt(n) / scale


@pytest.mark.parametrize("angle", [20, 60, 85])
@pytest.mark.parametrize(
    "model",
    [
        Ward(0.5, 0.11), Ward(0.5, 0.01), Ward(0.5, 0.3, alpha_y=0.05), Ward(0.5, 0.2, normalisation="duer2006"),
        CookTorrance(1.0, 0.1, 1.5, form="beckmann"), CookTorrance(5.3, 0.84, 0.65, 2.81), Ggx(0.05, n=1.5),
        Phong(0.3, 200.0), Ward(0.1, 0.05) + Lambert(0.3), Ward(0.5, 0.001), Ggx(0.01), Ggx(0.001, n=1.5),
        CookTorrance(1.0, 0.001, 1.5, form="beckmann"), Phong(1.0, 1e6), Ward(1.0, 0.1, alpha_y=0.002),
    ],
    ids=repr,
)  # fmt: skip
def test_against_sampling(model, angle):
    geometry = glossmeter_geometry(angle)
    mean, error = sampled_mean(model, geometry.source, geometry.detector)
    # 45 comparisons: 4.5 standard errors are passed by chance once in 3,000 runs of them all
    assert mean_over_apertures(model, geometry.source, geometry.detector).value == pytest.approx(mean, abs=4.5 * error)


@pytest.mark.parametrize(
    ("source", "detector"),
    [
        (Aperture(80, 180, 1, 3), Aperture(85, 0, 20, 10)),  # cut by the horizon
        (Aperture(90, 180, 10, 10), Aperture(80, 0, 10, 10)),  # half of the source below it
        (Aperture(30, 180, 3, 3), Aperture(45, 20, 3, 3)),  # beside the mirror direction and out of plane
        (Aperture(30, 180, 20, 20), Aperture(30, 0, 1, 1)),  # the source is the larger one
        (Aperture(0, 0, 5, 5), Aperture(0, 0, 5, 5)),  # along the normal, as if the source were no obstacle
    ],
)
@pytest.mark.parametrize("model", [Ward(0.5, 0.15), CookTorrance(1.0, 0.2, 1.5, form="beckmann")], ids=["ward", "ct"])
def test_other_places_against_sampling(model, source, detector):
    mean, error = sampled_mean(model, source, detector, n=1_000_000)
    found = mean_over_apertures(model, source, detector)
    assert found.value == pytest.approx(mean, abs=4.5 * error)
    # V-grooves' attenuation has a kink near the horizon, which Gauss–Legendre rules meet slowly; the error says so.
    # 3e-4 of 100 gloss units is .03, less than the tenth that a glossmeter shows.
    kinked = isinstance(model, CookTorrance) and source.theta_deg >= 80
    assert found.relative_error < (3e-4 if kinked else 1e-6)


@pytest.mark.parametrize(
    ("alphas", "source", "detector"),
    [
        ((0.1, 0.002), Aperture(60, 45, 0.75, 2.5), Aperture(60, 225, 4.4, 11.7)),
        ((0.002, 0.1), Aperture(85, 20, 0.75, 2.5), Aperture(85, 200, 4, 6)),
        ((0.02, 0.4), Aperture(30, 160, 5, 5), Aperture(30, -5, 6, 6)),  # out of plane
        ((0.02, 0.4), Aperture(30, 160, 5, 5), Aperture(30, -10, 4, 4)),  # the detector is the smaller one
        ((0.3, 0.02), Aperture(45, 300, 2, 2), Aperture(45, 120, 2, 2)),
    ],
)
def test_brushed_samples_that_are_turned_obliquely_against_sampling(alphas, source, detector):
    model = Ward(1.0, alphas[0], alpha_y=alphas[1])
    mean, error = sampled_mean(model, source, detector, n=1_000_000)
    found = mean_over_apertures(model, source, detector)
    assert found.value == pytest.approx(mean, abs=4.5 * error)
    assert found.relative_error < 1e-5  # what some million nodes reach of a ridge


def test_a_brushed_sample_may_turn_with_both_apertures():
    # turned by a quarter together, a sample with its roughnesses exchanged reads the same
    pairs = [(Aperture(40, phi, 1, 2), Aperture(42, phi + 185, 2, 3)) for phi in (25, 115)]
    lobes = Ward(0.5, [0.2, 0.1], alpha_y=[0.03, 0.1]), Ward(0.5, [0.03, 0.1], alpha_y=[0.2, 0.1])
    first, second = (mean_over_apertures(lobe, *pair).value for lobe, pair in zip(lobes, pairs, strict=True))
    np.testing.assert_allclose(first, second, rtol=2e-6)  # each within a millionth
    isotropic = mean_over_apertures(Ward(0.5, 0.1), Aperture(40, 180, 1, 2), Aperture(42, 5, 2, 3)).value
    assert first[1] == pytest.approx(float(isotropic), rel=2e-6)


def test_lines_across_a_ridge_give_the_mean_along_them():
    model, source, detector = Ward(1.0, 0.3, alpha_y=0.02), Aperture(40, 30, 1, 0), Aperture(40, 210, 0, 1)
    x, y = (np.linspace(-1, 1, 401)[:, None] * np.tan(np.radians(0.5)) for _ in range(2))
    i, weight_i = source.directions(x, np.zeros_like(x))
    r, weight_r = detector.directions(np.zeros_like(y.T), y.T)
    values = model.evaluate(i, r) * i[..., 2] * r[..., 2] * weight_i * weight_r
    wanted = np.trapezoid(np.trapezoid(values)) / np.trapezoid(weight_i[:, 0]) / np.trapezoid(weight_r[0])
    # trapezoids of 1/400 of lines as wide as a third of the lobe
    assert mean_over_apertures(model, source, detector).value == pytest.approx(wanted, rel=1e-5)


@pytest.mark.parametrize("angle", [20, 60, 85])
@pytest.mark.parametrize("width", [0.001, 0.002, 0.02, 0.11, 0.5])
@pytest.mark.parametrize(
    "make",
    [
        lambda width: Ward(1.0, width),
        lambda width: CookTorrance(1.0, width, 1.41),
        lambda width: CookTorrance(1.0, width, 0.65, 2.81, form="beckmann"),
        Ggx,
    ],
    ids=["ward", "paper", "beckmann", "ggx"],
)
def test_a_millionth_is_reached_and_the_stated_error_holds(make, width, angle):
    geometry = glossmeter_geometry(angle)
    usual = mean_over_apertures(make(width), geometry.source, geometry.detector)
    tight = mean_over_apertures(make(width), geometry.source, geometry.detector, relative_tolerance=1e-9)
    true_error = abs(usual.value / tight.value - 1)
    assert usual.relative_error <= 1e-6
    assert true_error <= max(usual.relative_error, 1e-12)  # rounding of sums over thousands of nodes


@pytest.mark.parametrize("angle", [20, 60, 85])
@pytest.mark.parametrize("alpha", [1e-3, 1e-4])
def test_long_tails_go_on_to_the_edge_of_the_detector(alpha, angle):
    """A narrow GGX lobe from a point loses what its tail sends beyond the detector: nearly a closed form.

    On the detector's plane a half vector's slopes are x/2 in the plane of incidence and y/(2 cosθ) across it. The share
    of GGX's facets that are steeper than s is α²/(α² + s²), so the light lost is its mean over directions, with s the
    slope at which each direction leaves the detector.
    """
    theta, detector = np.radians(angle), glossmeter_geometry(angle).detector
    (_, a), (_, b) = detector.x_range, detector.y_range
    phi = (np.arange(20_000) + 0.5) * 2 * np.pi / 20_000
    edge = 1 / np.maximum(np.abs(np.cos(phi)) / (a / 2), np.abs(np.sin(phi)) / (b / 2 / np.cos(theta)))
    lost = np.mean(alpha**2 / (alpha**2 + edge**2))
    found = mean_over_apertures(Ggx(alpha), Aperture(angle, 180), detector).value
    # The mean of f cosθi cosθr over the detector is its flux, cosθi (1 - lost), over its solid angle. At the detector's
    # edge at 85 degrees half vectors' slopes are up to .3, whose square is what the projection above leaves out.
    assert 1 - found * detector.solid_angle / np.cos(theta) == pytest.approx(lost, rel=0.05)


def test_who_gives_up_far_off_says_so(monkeypatch):
    monkeypatch.setattr("glossspace.instruments.quadrature._MOST_NODES", 0)
    geometry = glossmeter_geometry(60)
    with pytest.warns(QuadratureWarning, match="to ±") as caught:
        found = mean_over_apertures(Ward(1.0, 0.0001, 0.1), geometry.source, geometry.detector)
    assert caught[0].message.relative_error == found.relative_error > 1e-3


def test_a_tail_that_no_instrument_sees_is_no_reason_to_warn():
    # The suite turns a warning into an error.
    found = mean_over_apertures(Ward(0.1, 0.002, 0.4), Aperture(60, 180, 20, 20), Aperture(75, 0, 3, 3))
    assert found.value < 1e-100
    assert found.relative_error > 1e-3


def test_lambert_is_the_product_of_projections():
    source, detector = Aperture(60, 180, 20, 30), Aperture(85, 0, 20, 40)
    wanted = mean_projection(source) * mean_projection(detector) * 0.7 / np.pi
    assert mean_over_apertures(Lambert(0.7), source, detector).value == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize("model", [Ward(0.5, 0.001), CookTorrance(2.0, 0.1, 1.5), Ggx(0.1)], ids=repr)
@pytest.mark.parametrize(("theta_i", "theta_r"), [(50, 50), (30, 31), (89.9, 89.9)])
def test_points_give_the_model_itself(model, theta_i, theta_r):
    i, r = direction(theta_i, 180.0), direction(theta_r)
    wanted = model.evaluate(i, r) * i[2] * r[2]
    found = mean_over_apertures(model, Aperture(theta_i, 180), Aperture(theta_r)).value
    # cosines at 89.9 degrees have 1e-13 of rounding, and α = .001 multiplies a slope's by a million
    assert found == pytest.approx(wanted, rel=1e-6)


def test_small_apertures_tend_to_their_limit():
    # The second moment of a square of side w moves the mean by O(w²).
    model = Ward(0.5, 0.1)
    limit = mean_over_apertures(model, Aperture(40, 180), Aperture(45)).value
    errors = [
        mean_over_apertures(model, Aperture(40, 180, w, w), Aperture(45, 0, w, w), relative_tolerance=1e-10).value
        / limit - 1
        for w in (0.4, 0.2, 0.1)
    ]  # fmt: skip
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.01)  # the next order is (w/α)² ≈ 1e-3
    assert errors[1] / errors[2] == pytest.approx(4, rel=0.01)
    line = mean_over_apertures(model, Aperture(40, 180, 0.1, 0), Aperture(45, 0, 0, 0.1)).value
    assert line == pytest.approx(float(limit), rel=1e-3)


def test_sums_and_swapped_roles():
    source, detector = Aperture(60, 180, 0.75, 2.5), Aperture(60, 0, 4.4, 11.7)
    terms = (Ward(0.1, 0.02), CookTorrance(0.5, 0.3, 1.5, form="beckmann"), Lambert(0.2))
    parts = sum(mean_over_apertures(term, source, detector).value for term in terms)
    whole = mean_over_apertures(Sum(terms), source, detector)
    assert whole.value == pytest.approx(parts, rel=1e-6)
    # All these are reciprocal: source and detector may change places.
    assert mean_over_apertures(Sum(terms), detector, source).value == pytest.approx(whole.value, rel=1e-6)


def test_many_paints_at_once_are_those_one_by_one():
    rng = np.random.default_rng(0)
    alpha, rho_s, rho_d = rng.uniform(0.01, 0.5, 60), rng.uniform(0, 0.5, 60), rng.uniform(0, 0.5, 60)
    geometry = glossmeter_geometry(60)
    pair = geometry.source, geometry.detector
    many = mean_over_apertures(Ward(rho_s, alpha) + Lambert(rho_d), *pair)
    ones = [
        mean_over_apertures(Ward(s, a) + Lambert(d), *pair).value for s, a, d in zip(rho_s, alpha, rho_d, strict=True)
    ]
    np.testing.assert_allclose(many.value, ones, rtol=2e-6)  # each within a millionth of the truth
    assert many.relative_error <= 1e-6
    # a term without channels counts for each of them
    shared = mean_over_apertures(Ward(rho_s, alpha) + Lambert(0.3), *pair).value
    single = mean_over_apertures(Ward(rho_s[7], alpha[7]) + Lambert(0.3), *pair).value
    assert shared[7] == pytest.approx(float(single), rel=2e-6)


def test_nothing_reflects_nothing():
    found = mean_over_apertures(Ward(0.0, 0.1) + Lambert(0.0), **POINT)
    assert found.value == 0
    assert found.relative_error == 0
    assert mean_over_apertures(CookTorrance(1.0, 0.1, 1.0), **POINT).value == 0  # n = 1: no interface


def test_an_index_far_below_k_is_a_mirror():
    nearly_one = CookTorrance(1.0, 0.1, 1.0, 1e6, form="beckmann").evaluate(direction(50, 180.0), direction(50))
    found = mean_over_apertures(CookTorrance(1.0, 0.1, 1.0, 1e6, form="beckmann"), **POINT).value
    assert found == pytest.approx(nearly_one * np.cos(np.radians(50)) ** 2, rel=1e-12)


@pytest.mark.parametrize("tolerance", [0, float("nan"), 1])
def test_impossible_tolerances(tolerance):
    with pytest.raises(GlossError, match="Invalid relative_tolerance"):
        mean_over_apertures(Lambert(0.5), **POINT, relative_tolerance=tolerance)


class Striped(ReflectanceModel):
    """A model of a user's own, whose channels nobody but itself can part. A reading asks for its values alone."""

    channels = 2

    def evaluate(self, incident, exitant):
        return np.stack([Ward(0.5, 0.1).evaluate(incident, exitant), Lambert(0.5).evaluate(incident, exitant)], axis=-1)

    def draw(self, incident, u):
        raise NotImplementedError

    def pdf(self, incident, exitant):
        raise NotImplementedError

    def albedo(self, theta_deg, *, phi_deg=0.0):
        raise NotImplementedError


def test_channels_of_models_that_cannot_be_parted():
    geometry = glossmeter_geometry(60)
    pair = geometry.source, geometry.detector
    found = mean_over_apertures(Striped(), *pair).value
    alone = [mean_over_apertures(model, *pair).value for model in (Ward(0.5, 0.1), Lambert(0.5))]
    np.testing.assert_allclose(found, alone, rtol=2e-6)


def test_tables_with_wavelengths():
    axis, nm = np.array([0.0, 30.0, 60.0, 90.0]), [400.0, 500.0, 600.0, 700.0]
    rho = np.array([0.1, 0.2, 0.3, 0.4])
    table = Tabulated(axis, axis, [0.0, 180.0], np.full((4, 4, 2, 4), 1 / np.pi) * rho, wavelengths_nm=nm)
    source, detector = Aperture(45, 180, 4, 4), Aperture(40, 0, 4, 4)
    wanted = mean_over_apertures(Lambert(rho), source, detector).value
    np.testing.assert_allclose(mean_over_apertures(table, source, detector).value, wanted, rtol=1e-9)


def test_a_table_that_ends_before_the_aperture_is_refused_there():
    axis = [0.0, 30.0, 60.0]
    table = Tabulated(axis, axis, [0.0, 180.0], np.full((3, 3, 2), 0.1))
    with pytest.raises(GlossError, match="60"):
        mean_over_apertures(table, Aperture(45, 180, 4, 4), Aperture(60, 0, 4, 4))
