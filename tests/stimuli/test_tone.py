import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gloss_stimuli.tone import ToneCurve, solve_tone_curve
from glossspace.errors import GlossError


@st.composite
def curves(draw: st.DrawFn) -> tuple[ToneCurve, dict[str, float]]:
    """Curves for any sensible scene and display."""
    adapting = draw(st.floats(0.1, 1000))
    wanted = {
        "adapting": adapting,
        "minimum": adapting * draw(st.one_of(st.just(0.0), st.floats(1e-4, 1e-2))),
        "maximum": adapting * draw(st.floats(5, 1000)),
        "slope": draw(st.floats(0.8, 1.5)),
        "contrast": draw(st.floats(30, 140)),
    }
    return solve_tone_curve(**wanted), wanted


@given(curves())
def test_slope_contrast_and_white_are_what_was_asked_for(made) -> None:
    curve, wanted = made
    low, high = curve([wanted["minimum"], wanted["maximum"]])
    # 1e-12: the root is found to 1e-15 in ln k, and g and D follow from it in a few operations.
    assert high == pytest.approx(1.0, rel=1e-12)
    assert high / low == pytest.approx(wanted["contrast"], rel=1e-12)
    assert curve.log_log_slope(wanted["adapting"]) == pytest.approx(wanted["slope"], rel=1e-12)


@given(curves())
def test_the_curve_is_monotone_and_finite(made) -> None:
    curve, wanted = made
    luminance = np.linspace(wanted["minimum"], wanted["maximum"], 2001)
    displayed = curve(luminance)
    assert np.isfinite(displayed).all()
    assert (np.diff(displayed) > 0).all()


@given(curves(), st.floats(0, 1))
def test_inverse_undoes_the_curve(made, share: float) -> None:
    curve, wanted = made
    luminance = wanted["minimum"] + share * (wanted["maximum"] - wanted["minimum"])
    displayed = float(curve(luminance))
    # Displayed luminance comes back to 1e-12 of the white everywhere.
    assert float(curve(curve.inverse(displayed))) == pytest.approx(displayed, rel=1e-12, abs=1e-12)
    # Scene luminance does where the curve rises; near black a rounding of s is 1/slope larger in luminance.
    slope = float(curve.log_log_slope(luminance))
    if slope > 0.05:
        assert float(curve.inverse(displayed)) == pytest.approx(luminance, rel=1e-12 / slope)


@given(curves(), st.floats(0.01, 0.99))
def test_log_log_slope_is_the_derivative(made, share: float) -> None:
    curve, wanted = made
    luminance = share * wanted["maximum"]
    step = 1e-5
    numerical = np.log(curve(luminance * np.exp(step)) / curve(luminance * np.exp(-step))) / (2 * step)
    # Central difference: truncation of order step², and cancellation of 1e-16 / step.
    assert curve.log_log_slope(luminance) == pytest.approx(float(numerical), abs=1e-8)


@given(curves(), st.floats(0.01, 5))
def test_the_curve_is_symmetric_about_the_adapting_luminance(made, log_ratio: float) -> None:
    # s(x) s(1/x) = (D/k)², since (y + 1/k)(1/y + 1/k) is (y + k)(1/y + k) over k².
    curve, wanted = made
    above, below = curve(wanted["adapting"] * np.exp([log_ratio, -log_ratio]))
    # A dozen roundings; the power amplifies that of x by its exponent, at most some 5.
    assert above * below == pytest.approx((curve.gain / curve.knee) ** 2, rel=1e-13)
    assert curve(wanted["adapting"]) == pytest.approx(curve.gain / curve.knee, rel=1e-14)


@given(curves(), st.floats(-5, 5))
def test_it_is_nowhere_steeper_than_at_the_adapting_luminance(made, log_ratio: float) -> None:
    curve, wanted = made
    slope = curve.log_log_slope(wanted["adapting"] * np.exp(log_ratio))
    assert 0 < slope <= wanted["slope"] * (1 + 1e-12)  # the slope asked for is met to 1e-12


@given(curves(), st.lists(st.floats(0, 1), min_size=1, max_size=20))
def test_displayed_luminances_come_back_to_1e_12(made, shares: list[float]) -> None:
    curve, _ = made
    darkest = curve.gain / curve.knee**2
    displayed = darkest + np.array(shares) * (1 - darkest)
    # The bound; the equation is solved for y in four operations, and x^g undone.
    assert curve(curve.inverse(displayed)) == pytest.approx(displayed, rel=1e-12)


def test_a_luminance_that_nothing_is_displayed_at_has_no_inverse() -> None:
    curve = solve_tone_curve(adapting=10.0, minimum=0.0, maximum=250.0, slope=1.0, contrast=154.0)
    with pytest.raises(GlossError, match="No scene luminance is displayed at 0.001 of white.*from 0.00649"):
        curve.inverse([0.5, 0.001])
    with pytest.raises(GlossError, match="displayed at 1.5 of white"):
        curve.inverse(1.5)
    assert np.isnan(curve.inverse(np.nan))


def test_shapes_are_kept_and_inputs_left_alone() -> None:
    curve = solve_tone_curve(adapting=10.0, minimum=0.0, maximum=250.0, slope=1.0, contrast=154.0)
    luminance = np.array([[1.0, 20.0, 250.0]])
    displayed = curve(luminance)
    assert displayed.shape == (1, 3)
    assert luminance.tolist() == [[1.0, 20.0, 250.0]]
    assert float(curve(20)) == displayed[0, 1]
    # Darkness is the least there is: a luminance that noise made negative is displayed as zero.
    assert float(curve(-1.0)) == float(curve(0.0))


def test_parameters_solve_the_equations_in_high_precision() -> None:
    curve = solve_tone_curve(adapting=10.0, minimum=0.0, maximum=250.0, slope=1.0, contrast=108 / 0.7)
    with mpmath.workdps(40):
        high, contrast = mpmath.mpf(25), mpmath.mpf(108) / mpmath.mpf("0.7")

        def excess(k):
            g = (k + 1) / (k - 1)
            return (high**g + 1 / k) / (high**g + k) * k**2 - contrast

        knee = mpmath.findroot(excess, 20)
    assert curve.knee == pytest.approx(float(knee), rel=1e-13)  # a few units of rounding
    assert curve.exponent == pytest.approx(float((knee + 1) / (knee - 1)), rel=1e-13)


def test_asymptotic_contrast_is_the_square_of_the_knee() -> None:
    curve = solve_tone_curve(adapting=10.0, minimum=0.0, maximum=250.0, slope=1.0, contrast=154.0)
    assert float(curve(1e200) / curve(0.0)) == pytest.approx(curve.knee**2, rel=1e-12)


def test_values_outside_the_range_are_counted() -> None:
    curve = solve_tone_curve(adapting=10.0, minimum=0.1, maximum=250.0, slope=1.0, contrast=100.0)
    assert curve.clipped([0.05, 0.1, 5.0, 250.0, 251.0]) == 2


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"minimum": 20.0}, "0 <= minimum < adapting < maximum"),
        ({"slope": 0.0}, "slope above 0"),
        ({"contrast": 1.0}, "contrast above 1"),
        ({"maximum": float("inf")}, "maximum"),
        ({"minimum": 5.0, "maximum": 20.0, "slope": 0.5, "contrast": 1000.0}, "it reaches 2 at most.*Raise"),
    ],
)
def test_impossible_curves_are_refused(change: dict[str, float], message: str) -> None:
    wanted = {"adapting": 10.0, "minimum": 0.0, "maximum": 250.0, "slope": 1.0, "contrast": 154.0}
    with pytest.raises(GlossError, match=message):
        solve_tone_curve(**{**wanted, **change})
