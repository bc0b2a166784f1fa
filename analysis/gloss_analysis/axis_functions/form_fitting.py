"""One form of an axis function, fitted to mean ratings by least squares."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from scipy.optimize import minimize
from scipy.stats import t as student_t

from gloss_analysis.ratings.polynomials import aicc
from glossspace.metric import ContrastForm, DistinctnessForm
from glossspace.metric.forms import FORM_LIMITS

__all__ = ["AxisForm", "FormFit", "fit_form"]

AxisForm: TypeAlias = ContrastForm | DistinctnessForm
"""A form of c or of d."""

_PAPER: Mapping[str, AxisForm] = {"c": ContrastForm(), "d": DistinctnessForm()}
# Where searches begin, per parameter, beside the paper's form. An offset is searched on a logarithm too.
_STARTS: Mapping[str, tuple[float, ...]] = {
    "exponent": (0.2, 0.5, 1.0),
    "diffuse_share": (0.2, 0.5, 1.5),
    "offset": (1e-3, 1e-2),
}
_LEAST_OFFSET = 1e-6
# Size of the simplex that a search begins with, on logarithms.
_STEP = 0.1
# A parameter so near its limit, relatively, has been stopped by it.
_AT_LIMIT = 1e-6


@dataclass(frozen=True)
class FormFit:
    """One form of an axis, fitted to mean ratings: rating = intercept + slope * form.

    Attributes
    ----------
    form : ContrastForm or DistinctnessForm
    free : tuple of str
        Its parameters that were fitted; the others are the gloss paper's.
    slope, intercept, r_squared : float
    leave_one_out_error : float
        Root mean square error, in units of rating, of predicting each stimulus from a fit to all others.
    aicc : float
        Akaike's information criterion for small samples, up to a constant.
    ci95 : mapping of str to (low, high)
        95 % intervals over participants, of the free parameters, `slope` and `intercept`; empty with fewer than three
        participants, and without what `at_limit` names.
    at_limit : tuple of str
        Free parameters that the search drove to the end of their range, or an offset that it drove to 0: the ratings
        do not tell them.
    """

    form: AxisForm
    free: tuple[str, ...]
    slope: float
    intercept: float
    r_squared: float
    leave_one_out_error: float
    aicc: float
    ci95: Mapping[str, tuple[float, float]]
    at_limit: tuple[str, ...] = ()


def fit_form(
    axis: str, free: tuple[str, ...], paints: np.ndarray, rating: np.ndarray, jackknifed: list[np.ndarray]
) -> tuple[FormFit, np.ndarray]:
    """Fit one form of an axis to mean ratings.

    Parameters
    ----------
    axis : {"c", "d"}
    free : tuple of str
        Parameters of the form to fit.
    paints : ndarray, shape (n, 3)
        rho_d, rho_s, alpha.
    rating : ndarray, shape (n,)
    jackknifed : list of ndarray, shape (n,)
        Mean ratings without each participant in turn.

    Returns
    -------
    FormFit
    ndarray, shape (n,)
        Error of predicting each stimulus from the others.
    """
    form = _best(axis, free, paints, rating)
    left_out = _left_out_errors(axis, form, free, paints, rating)
    slope, intercept, rest = _line(_coordinate(form, paints), rating)
    parts = []
    for means in jackknifed:
        own = _best(axis, free, paints, means, near=form)
        parts.append([*(getattr(own, name) for name in free), *_line(_coordinate(own, paints), means)[:2]])
    names = (*free, "slope", "intercept")
    values = [*(getattr(form, name) for name in free), slope, intercept]
    at_limit = tuple(name for name in free if _is_at_limit(name, getattr(form, name)))
    ci95 = {}
    for name, value, without in zip(names, values, np.transpose(parts), strict=True) if parts else ():
        if name in at_limit:
            continue
        positive = name in ("exponent", "diffuse_share")
        ci95[name] = _jackknife_interval(value, without, positive=positive)
    fit = FormFit(
        form=form,
        free=free,
        slope=slope,
        intercept=intercept,
        r_squared=1 - rest / float(np.sum((rating - rating.mean()) ** 2)),
        leave_one_out_error=float(np.sqrt(np.mean(left_out**2))),
        aicc=aicc(rest, len(rating), 3 + len(free)),
        ci95=ci95,
        at_limit=at_limit,
    )
    return fit, left_out


def _coordinate(form: AxisForm, paints: np.ndarray) -> np.ndarray:
    if isinstance(form, ContrastForm):
        return np.asarray(form.value(paints[:, 0], paints[:, 1]))
    return np.asarray(form.value(paints[:, 2]))


def _line(x: np.ndarray, y: np.ndarray) -> tuple[float, float, float]:
    """Slope, intercept and sum of squared residuals; slope 0 where x does not vary."""
    dx, dy = x - x.mean(), y - y.mean()
    varies = float(dx @ dx)
    slope = float(dx @ dy) / varies if varies > 0 else 0.0
    rest = dy - slope * dx
    return slope, float(y.mean() - slope * x.mean()), float(rest @ rest)


def _form(axis: str, free: Sequence[str], logs: np.ndarray) -> AxisForm:
    values = {name: float(np.clip(np.exp(value), *FORM_LIMITS[name])) for name, value in zip(free, logs, strict=True)}
    if values.get("offset", 1.0) <= _LEAST_OFFSET * (1 + _AT_LIMIT):
        values["offset"] = 0.0
    return type(_PAPER[axis])(**values)


def _best(
    axis: str, free: Sequence[str], paints: np.ndarray, rating: np.ndarray, near: AxisForm | None = None
) -> AxisForm:
    """The form of least squares; searched from `near` where it is given."""
    if not free:
        return _PAPER[axis]

    def rest(logs: np.ndarray) -> float:
        return _line(_coordinate(_form(axis, free, logs), paints), rating)[2] / scale

    scale = float(np.sum((rating - rating.mean()) ** 2)) or 1.0
    limits = [tuple(np.log(np.maximum(FORM_LIMITS[name], _LEAST_OFFSET))) for name in free]
    if near is not None:
        here = {name: max(getattr(near, name), _LEAST_OFFSET) for name in free}
        starts = [list(here.values())]
        if here.get("offset") == _LEAST_OFFSET:  # there the objective is flat, and a search would stay
            starts += [list({**here, "offset": offset}.values()) for offset in _STARTS["offset"]]
    else:
        grid = np.meshgrid(*(_STARTS[name] for name in free))
        starts = np.column_stack([one.ravel() for one in grid]).tolist()
        starts.append([max(getattr(_PAPER[axis], name), _LEAST_OFFSET) for name in free])
    options: dict[str, Any] = {"xatol": 1e-9, "fatol": 1e-15, "maxiter": 400 * len(free)}
    found = []
    for start in np.log(starts):
        # By default steps are parts of the logarithm: none for an exponent of 1, out of bounds for the least offset.
        inward = np.where(start + _STEP > [high for _, high in limits], -_STEP, _STEP)
        options["initial_simplex"] = np.vstack([start, start + np.diag(inward)])
        found.append(minimize(rest, start, method="Nelder-Mead", bounds=limits, options=options))
    return _form(axis, free, min(found, key=lambda one: one.fun).x)


def _left_out_errors(
    axis: str, form: AxisForm, free: Sequence[str], paints: np.ndarray, rating: np.ndarray
) -> np.ndarray:
    """Error of predicting each stimulus from the others, shape (n,)."""
    errors = np.empty(len(rating))
    for k in range(len(rating)):
        others = np.arange(len(rating)) != k
        own = _best(axis, free, paints[others], rating[others], near=form)
        slope, intercept, _ = _line(_coordinate(own, paints[others]), rating[others])
        errors[k] = rating[k] - intercept - slope * _coordinate(own, paints[[k]])[0]
    return errors


def _is_at_limit(name: str, value: float) -> bool:
    low, high = FORM_LIMITS[name]
    return value <= low * (1 + _AT_LIMIT) or value >= high * (1 - _AT_LIMIT)


def _jackknife_interval(value: float, without: np.ndarray, *, positive: bool) -> tuple[float, float]:
    m = len(without)
    if positive:
        value, without = np.log(value), np.log(without)
    error = np.sqrt((m - 1) / m * np.sum((without - without.mean()) ** 2))
    half = student_t.ppf(0.975, m - 1) * error
    low, high = value - half, value + half
    return (float(np.exp(low)), float(np.exp(high))) if positive else (float(low), float(high))
