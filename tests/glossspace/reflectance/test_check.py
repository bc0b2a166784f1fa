"""The check finds what is wrong with a model, and nothing in a good one."""

import re
from dataclasses import replace

import numpy as np
import pytest

from glossspace.errors import GlossError
from glossspace.reflectance import Lambert, Phong, Ward, check_model, direction
from glossspace.reflectance.sampling_check import sampling_p_value

ANGLES = [0.0, 30.0, 60.0, 85.0]


class _OneWay(Ward):
    """Loses reciprocity by a factor of the exitant cosine alone."""

    def evaluate(self, incident, exitant):
        return super().evaluate(incident, exitant) * np.sqrt(np.maximum(np.asarray(exitant)[..., 2], 0))


class _OneWayWing(Ward):
    """Is not reciprocal where it never draws: beside the lobe, whose values dwarf the wing's."""

    def evaluate(self, incident, exitant):
        return super().evaluate(incident, exitant) + 1e-7 * np.maximum(np.asarray(exitant)[..., 2], 0)


class _ABitOneWay(Lambert):
    def evaluate(self, incident, exitant):
        return super().evaluate(incident, exitant) * (1 + 1e-5 * np.asarray(exitant)[..., 2])


class _ABitHeavy(Lambert):
    def sample(self, incident, u):
        sample = super().sample(incident, u)
        return replace(sample, weight=sample.weight * (1 + 1e-5))


class _Negative(Lambert):
    """Below zero on one side, but not on average."""

    def evaluate(self, incident, exitant):
        return super().evaluate(incident, exitant) + np.where(np.asarray(exitant)[..., 0] > 0, -0.2, 0.2)


class _WrongWidth(Ward):
    """Draws a lobe a tenth wider than its density says."""

    def draw(self, incident, u):
        return Ward(self.rho_s, self.alpha * 1.1).draw(incident, u)


class _WrongWeight(Ward):
    def sample(self, incident, u):
        sample = super().sample(incident, u)
        return replace(sample, weight=sample.weight * 1.01)


class _WrongAlbedo(Ward):
    def albedo(self, theta_deg, *, phi_deg=0.0):
        return super().albedo(theta_deg, phi_deg=phi_deg) * 1.005


class _RarelyBlack(Lambert):
    """As if black in a millionth of its directions, which no draw happens to meet."""

    def albedo(self, theta_deg, *, phi_deg=0.0):
        return super().albedo(theta_deg, phi_deg=phi_deg) * (1 - 1e-6)


class _GrazingInfinity(Lambert):
    def evaluate(self, incident, exitant):
        value = super().evaluate(incident, exitant)
        return np.where(np.asarray(incident)[..., 2] < 0.002, np.inf, value)


class _TooDense(Lambert):
    """A density that integrates to 1.05, with weights to match."""

    def pdf(self, incident, exitant):
        return super().pdf(incident, exitant) * 1.05


@pytest.mark.parametrize(
    ("model", "message"),
    [
        (_OneWay(1.0, 0.1), "not reciprocal"),
        (_OneWay(1.0, 1e-5), "not reciprocal"),
        (_OneWayWing(1.0, 0.001), "not reciprocal"),
        (_ABitOneWay(0.5), "not reciprocal: both ways of the light differ by up to 1e-05 of the value"),
        (_ABitHeavy(0.5), "weight is not f cosθ / pdf: they differ by up to 1e-05 of it"),
        (_Negative(0.5), "negative or not finite"),
        (_WrongWidth(1.0, 0.1), "draws do not follow its density: chi² at"),
        (_WrongWidth(1.0, 0.001), "draws do not follow its density: chi² at"),
        (_WrongWeight(1.0, 0.1), "weight is not f cosθ / pdf: they differ by up to 0.0099 of it"),
        (_WrongAlbedo(1.0, 0.1), "standard errors from the albedo"),
        (_GrazingInfinity(0.5), "negative or not finite"),
        (_TooDense(0.5), "draws do not follow its density.*p = 0"),
        (Ward(1.0, 0.1, normalisation="duer2006"), "more than it receives: the albedo at 89° is"),
        (Lambert(0.7) + Lambert(0.7), "more than it receives: the albedo at 0° is 1.4"),
    ],
)
def test_it_finds_what_is_wrong(model, message):
    check = check_model(model)
    assert not check.passes
    assert any(re.search(message, problem) for problem in check.problems), check


def test_what_rare_draws_would_show_is_no_deviation():
    assert check_model(_RarelyBlack(0.5)).problems == ()  # though the weights of all others have no spread at all


@pytest.mark.parametrize("alpha", [0.001, 0.02, 0.5])
def test_p_values_of_true_draws_are_uniform(alpha):
    """Over 60 seeds: the mean of uniform numbers is .5 ± 1/sqrt(12 · 60), here to four standard errors."""
    model = Lambert(0.3) + Ward(0.3, alpha)
    values = []
    for seed in range(60):
        exitant = model.draw(direction(50.0), np.random.default_rng(seed).random((5000, 2)))
        values.append(sampling_p_value(model, 50.0, exitant))
    assert np.mean(values) == pytest.approx(0.5, abs=4 / np.sqrt(12 * 60))


def test_same_seed_same_result():
    first, again = (check_model(Phong(0.5, 20), theta_deg=ANGLES, seed=3) for _ in range(2))
    np.testing.assert_array_equal(first.p_values, again.p_values)
    assert first.albedo_deviation == again.albedo_deviation
    assert first.albedo.shape == (4,)
    assert check_model(Lambert([0.1, 0.2, 0.3]), theta_deg=ANGLES).albedo.shape == (4, 3)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: check_model("ward"), "check_model needs a ReflectanceModel, but got 'ward'"),
        (lambda: check_model(Lambert(0.1), samples=10), "Invalid samples = 10. Allowed: 1000 and more"),
        (lambda: check_model(Lambert(0.1), theta_deg=[]), "at least one angle"),
        (lambda: check_model(Lambert(0.1), theta_deg=[90.0]), "Invalid theta_deg = 90.0"),
        (lambda: check_model(Ward(0.1, [0.1, 0.2])), "alpha has 2 channels"),
    ],
)
def test_bad_calls_are_refused(call, message):
    with pytest.raises(GlossError, match=message):
        call()
