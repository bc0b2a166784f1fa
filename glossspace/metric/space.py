"""A gloss space: axis functions, weights, and the distance they define (eq. 5 of the gloss paper)."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from glossspace.errors import GlossError
from glossspace.files import read_json, write_json
from glossspace.metric.axes import Appearance, Paint, diffuse_reflectance, lightness
from glossspace.metric.forms import PAPER_CONTRAST, PAPER_DISTINCTNESS, ContrastForm, DistinctnessForm
from glossspace.metric.validity import FloatArray, as_float_arrays, require

__all__ = ["PAPER_SPACE", "AxisFunction", "GlossSpace"]

_FORMAT = "glossspace/gloss-space"
_VERSION = 2


@dataclass(frozen=True)
class AxisFunction:
    """How observers' ratings of single images rose along one axis: rating = intercept + slope * coordinate.

    Attributes
    ----------
    slope, intercept, r_squared : float
        The least-squares line through the mean ratings and its squared correlation.
    n_stimuli : int
        How many stimuli the line was fitted to.
    slope_ci95, intercept_ci95 : tuple of float, optional
        95 % intervals over participants; None where there were too few.
    """

    slope: float
    intercept: float
    r_squared: float
    n_stimuli: int
    slope_ci95: tuple[float, float] | None = None
    intercept_ci95: tuple[float, float] | None = None


@dataclass(frozen=True)
class GlossSpace:
    """A perceptually uniform gloss space: D = sqrt((weight_c dc)^2 + (weight_d dd)^2).

    The default is the gloss paper's. A space fitted on new data is saved and loaded as versioned JSON.

    Attributes
    ----------
    weight_c, weight_d : float
        Weights of contrast gloss and distinctness of image, > 0. Only their ratio is meaningful for uniformity;
        by convention weight_c is 1.
    name : str
        Whose space this is.
    weight_d_ci95 : tuple of float, optional
        95 % confidence interval of weight_d / weight_c.
    axis_functions : mapping of str to AxisFunction
        Per axis, the regression of magnitude estimates on it, where it was made.
    stimulus_range : mapping of str to (low, high)
        The parameters that the judged stimuli spanned.
    provenance : mapping
        Where the space came from: data, observers (simulated or human), software, seed.
    contrast_form, distinctness_form : ContrastForm, DistinctnessForm
        How c and d depend on a paint; the gloss paper's by default. The unit of c and of d, and so what a weight means,
        goes with the form.

    Examples
    --------
    >>> round(float(GlossSpace().distance(Paint(0.193, 0.066, 0.07), Paint(0.193, 0.066, 0.04))), 4)
    0.0534
    """

    weight_c: float = 1.0
    weight_d: float = 1.78
    name: str = "Pellacini, Ferwerda and Greenberg (2000)"
    weight_d_ci95: tuple[float, float] | None = None
    axis_functions: Mapping[str, AxisFunction] = field(default_factory=dict)
    stimulus_range: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    provenance: Mapping[str, Any] = field(default_factory=dict)
    contrast_form: ContrastForm = PAPER_CONTRAST
    distinctness_form: DistinctnessForm = PAPER_DISTINCTNESS

    @property
    def has_paper_forms(self) -> bool:
        """Whether c and d are those of eqs 3 and 4."""
        return self.contrast_form == PAPER_CONTRAST and self.distinctness_form == PAPER_DISTINCTNESS

    def __post_init__(self) -> None:
        for name, weight in (("weight_c", self.weight_c), ("weight_d", self.weight_d)):
            if not _is_finite_number(weight) or weight <= 0:
                raise GlossError(f"Invalid {name} = {weight!r} of a gloss space. Allowed: a finite number > 0.")
        ci95 = self.weight_d_ci95
        if ci95 is not None and not (len(ci95) == 2 and all(map(_is_finite_number, ci95)) and ci95[0] <= ci95[1]):
            raise GlossError(
                f"Invalid weight_d_ci95 = {ci95!r} of a gloss space. Allowed: (low, high), finite, or None if unknown."
            )

    def coordinates(self, paint: Paint) -> tuple[FloatArray, FloatArray]:
        """Coordinates (c, d) of a paint, unweighted, broadcast to one shape.

        Raises
        ------
        GlossError
            A parameter of the paint is impossible.
        """
        rho_d, rho_s, alpha = as_float_arrays(**paint._asdict())
        c, d = np.broadcast_arrays(self.contrast_form.value(rho_d, rho_s), self.distinctness_form.value(alpha))
        return c.copy()[()], d.copy()[()]

    def appearance(self, paint: Paint) -> Appearance:
        """Appearance (L*, c, d) of a paint; in the gloss paper's space that of `from_physical`.

        Raises
        ------
        GlossError
            A parameter of the paint is impossible.
        """
        c, d = self.coordinates(paint)
        rho_d = np.broadcast_to(paint.rho_d, np.shape(c))
        return Appearance(lightness(rho_d), c, d)

    def paint(self, lightness: ArrayLike, c: ArrayLike, d: ArrayLike) -> Paint:
        """Paint of an appearance (L* 0-100, c, d), which broadcast: the inverse of `appearance`.

        Raises
        ------
        GlossError
            No paint looks like this; the message names the parameter and its value.

        Examples
        --------
        >>> round(float(GlossSpace().paint(51.036, 0.08702, 0.93).rho_s), 3)
        0.066
        """
        lightness, c, d = as_float_arrays(lightness=lightness, c=c, d=d)
        rho_d = diffuse_reflectance(lightness)
        rho_s, alpha = self.contrast_form.specular_reflectance(rho_d, c), self.distinctness_form.roughness_alpha(d)
        return Paint(*(value.copy()[()] for value in np.broadcast_arrays(rho_d, rho_s, alpha)))

    def distance(self, paint_a: Paint, paint_b: Paint) -> FloatArray:
        """Gloss distance between paints (eq. 5); their lightness enters through c alone.

        Parameters
        ----------
        paint_a, paint_b : Paint
            (rho_d, rho_s, alpha), scalars or arrays that broadcast.

        Returns
        -------
        ndarray or float
            D >= 0. NaN in gives NaN out.

        Raises
        ------
        GlossError
            A parameter is impossible.
        """
        c_a, d_a = self.coordinates(paint_a)
        c_b, d_b = self.coordinates(paint_b)
        return self.distance_between(c_a, d_a, c_b, d_b)

    def distance_between(self, c_a: ArrayLike, d_a: ArrayLike, c_b: ArrayLike, d_b: ArrayLike) -> FloatArray:
        """Gloss distance between points (c_a, d_a) and (c_b, d_b) of the space (eq. 5), which broadcast.

        Raises
        ------
        GlossError
            A coordinate is not a finite number (or NaN), or the shapes do not broadcast. Points where no paint is are
            allowed.
        """
        points = as_float_arrays(c_a=c_a, d_a=d_a, c_b=c_b, d_b=d_b)
        for name, values in zip(("c_a", "d_a", "c_b", "d_b"), points, strict=True):
            require(np.isfinite(values), values, name=name, allowed="finite")
        from_c, from_d, to_c, to_d = points
        with np.errstate(over="ignore"):  # what no float holds is infinitely far
            return np.hypot(self.weight_c * (from_c - to_c), self.weight_d * (from_d - to_d))[()]

    def save(self, path: str | Path) -> None:
        """Write the space as versioned JSON, whole or not at all."""
        axes = {}
        for axis, form, weight, ci95 in (
            ("c", self.contrast_form, self.weight_c, None),
            ("d", self.distinctness_form, self.weight_d, self.weight_d_ci95),
        ):
            function = self.axis_functions.get(axis)
            axes[axis] = {
                "form": form.text,
                "parameters": asdict(form),
                "weight": weight,
                "weight_ci95": None if ci95 is None else list(ci95),
                "ratings": None if function is None else asdict(function),
            }
        write_json(
            path,
            {
                "format": _FORMAT,
                "version": _VERSION,
                "name": self.name,
                "axes": axes,
                "stimulus_range": {key: list(value) for key, value in self.stimulus_range.items()},
                "provenance": dict(self.provenance),
            },
        )

    @classmethod
    def load(cls, path: str | Path) -> "GlossSpace":
        """Read a space that `save` wrote.

        Raises
        ------
        GlossError
            The file is missing, is not a gloss space, is of a newer version, or holds impossible numbers.
        """
        document = read_json(path, what="gloss space")
        if document.get("format") != _FORMAT:
            raise GlossError(
                f"'{path}' is not a gloss space: its format is {document.get('format')!r}, not '{_FORMAT}'."
            )
        if document.get("version") not in (1, _VERSION):
            raise GlossError(
                f"'{path}' is a gloss space of version {document.get('version')!r}; this program reads versions 1 and "
                f"{_VERSION}. Update glossspace, or refit the space."
            )
        try:
            return cls._from_document(document)
        except KeyError as error:
            reason = f"{error} is missing"
        except (TypeError, IndexError, AttributeError, ValueError) as error:
            reason = str(error).rstrip(".")
        raise GlossError(f"The gloss space '{path}' cannot be used: {reason}. Restore the file or refit the space.")

    @classmethod
    def _from_document(cls, document: dict[str, Any]) -> "GlossSpace":
        axes = document["axes"]
        forms: dict[str, Any] = {"c": PAPER_CONTRAST, "d": PAPER_DISTINCTNESS}
        if document["version"] != 1:  # which knew no other forms
            forms = {axis: type(form)(**axes[axis]["parameters"]) for axis, form in forms.items()}
        for axis, form in forms.items():
            if axes[axis]["form"] != form.text:
                raise GlossError(f"axis {axis} has the unknown form {axes[axis]['form']!r}, not {form.text!r}")
        ci95 = axes["d"]["weight_ci95"]
        ranges = document.get("stimulus_range", {})
        ratings = {axis: axes[axis].get("ratings") for axis in forms}
        return cls(
            weight_c=axes["c"]["weight"],
            weight_d=axes["d"]["weight"],
            name=str(document["name"]),
            weight_d_ci95=None if ci95 is None else tuple(ci95),
            axis_functions={axis: _axis_function(axis, line) for axis, line in ratings.items() if line is not None},
            stimulus_range={key: _interval(value, f"stimulus_range of {key}") for key, value in ranges.items()},
            provenance=dict(document.get("provenance", {})),
            contrast_form=forms["c"],
            distinctness_form=forms["d"],
        )


def _axis_function(axis: str, line: Mapping[str, Any]) -> AxisFunction:
    numbers = {name: line[name] for name in ("slope", "intercept", "r_squared", "n_stimuli")}
    for name, value in numbers.items():
        if not _is_finite_number(value):
            raise GlossError(f"{name} = {value!r} of the ratings along {axis} is no finite number")
    intervals = {
        name: None if line.get(name) is None else _interval(line[name], f"{name} of the ratings along {axis}")
        for name in ("slope_ci95", "intercept_ci95")
    }
    return AxisFunction(
        slope=float(numbers["slope"]),
        intercept=float(numbers["intercept"]),
        r_squared=float(numbers["r_squared"]),
        n_stimuli=int(numbers["n_stimuli"]),
        **intervals,
    )


def _interval(value: Any, what: str) -> tuple[float, float]:
    if not isinstance(value, list) or len(value) != 2 or not all(map(_is_finite_number, value)) or value[0] > value[1]:
        raise GlossError(f"the {what} must be two finite numbers, the lower one first, not {value!r}")
    return float(value[0]), float(value[1])


def _is_finite_number(value: object) -> bool:
    if isinstance(value, bool) or not isinstance(value, Real):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # an integer that no float holds
        return False


PAPER_SPACE = GlossSpace()
"""The gloss paper's space: D = sqrt(dc^2 + (1.78 dd)^2)."""
