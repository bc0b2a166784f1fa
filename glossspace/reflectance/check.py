"""The check that every reflectance model should pass: reciprocity, energy, sampling, finiteness at grazing."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from glossspace.errors import GlossError
from glossspace.metric.validity import FloatArray
from glossspace.reflectance.model import ReflectanceModel, direction, over_channels
from glossspace.reflectance.sampling_check import sampling_p_value

__all__ = ["ModelCheck", "check_model"]

ANGLES_DEG = (0.0, 20.0, 45.0, 60.0, 75.0, 85.0, 89.0)
_GRAZING_DEG = (89.9, 89.99, 89.9999)
_RECIPROCITY_TOLERANCE = 1e-6  # what rounding does to a narrow lobe's exponent, and more than any formula should
_ENERGY_TOLERANCE = 1e-6
_WEIGHT_TOLERANCE = 1e-6
_SIGNIFICANCE = 1e-3
_STANDARD_ERRORS = 5.0


@dataclass(frozen=True)
class ModelCheck:
    """What `check_model` found.

    Attributes
    ----------
    reciprocity_error : float
        Largest difference between both ways of the light, relative to the larger value.
    theta_deg : ndarray of float64, shape (A,)
        Angles of incidence that were checked.
    albedo : ndarray of float64, shape (A,) or (A, K)
        Directional-hemispherical reflectance at each.
    p_values : ndarray of float64, shape (A,)
        Of chi² tests of the draws against the density.
    weight_error : float
        Largest difference of a sampled weight from f cosθ / pdf, relative to the larger.
    albedo_deviation : float
        Largest difference between mean weight and albedo, in standard errors of the mean.
    finite : bool
        Whether values, densities, weights and albedos are finite and not negative, up to 89.9999°.
    problems : tuple of str
        What is wrong, one sentence each; empty for a model that passes.
    """

    reciprocity_error: float
    theta_deg: FloatArray
    albedo: FloatArray
    p_values: FloatArray
    weight_error: float
    albedo_deviation: float
    finite: bool
    problems: tuple[str, ...]

    @property
    def passes(self) -> bool:
        """Whether there is no problem."""
        return not self.problems


def check_model(
    model: ReflectanceModel, *, theta_deg: Sequence[float] = ANGLES_DEG, samples: int = 20_000, seed: int = 0
) -> ModelCheck:
    """Check that a model is reciprocal, conserves energy, draws what it says, and stays finite.

    Parameters
    ----------
    model : ReflectanceModel
        One of this package or one's own; its lobe must have one roughness, as sampling needs.
    theta_deg : sequence of float
        Angles of incidence, 0 to below 90 degrees.
    samples : int
        Draws at each angle, at least 1000.
    seed : int
        Of the draws: the same seed gives the same result.

    Returns
    -------
    ModelCheck
        The measures, and a sentence for each problem.

    Raises
    ------
    GlossError
        An angle or the number of samples is out of its range, or the model cannot be sampled.

    Examples
    --------
    >>> from glossspace.reflectance import CookTorrance, Ward
    >>> check_model(Ward(1.0, 0.07), theta_deg=[20.0, 60.0]).problems
    ()
    >>> check_model(CookTorrance(scale=21.5, slope=0.6, n=1.32), theta_deg=[20.0, 85.0]).problems
    ('It reflects more than it receives: the albedo at 85° is 4.571.',)
    """
    if not isinstance(model, ReflectanceModel):
        raise GlossError(f"check_model needs a ReflectanceModel, but got {model!r}. Derive yours from it.")
    if samples < 1000:
        raise GlossError(f"Invalid samples = {samples}. Allowed: 1000 and more, for a chi² test.")
    angles = np.asarray(theta_deg, dtype=float)
    if angles.ndim != 1 or angles.size == 0:
        raise GlossError(f"theta_deg must be a list of at least one angle, but is {theta_deg!r}.")
    albedo = np.asarray(model.albedo(angles))
    generator = np.random.default_rng(seed)
    p_values, deviations, weight_errors, reciprocities, finite = [], [], [], [], True
    for row, angle in enumerate(angles):
        incident = direction(angle)
        drawn = model.sample(incident, generator.random((samples, 2)))
        p_values.append(sampling_p_value(model, float(angle), drawn.exitant))
        value = model.evaluate(incident, drawn.exitant)
        expected = value * over_channels(drawn.exitant[:, 2], model.channels)
        weight_errors.append(_relative(drawn.weight * over_channels(drawn.pdf, model.channels), expected))
        deviations.append(_deviation(drawn.weight, albedo[row]))
        reciprocities.append(_reciprocity(model, incident, drawn.exitant, generator))
        finite &= all(_finite(array) for array in (value, drawn.pdf, drawn.weight))
    finite &= _finite(albedo) and _finite_at_grazing(model, generator)
    found = {
        "reciprocity_error": max(reciprocities),
        "weight_error": max(weight_errors),
        "albedo_deviation": max(deviations),
    }
    return ModelCheck(
        theta_deg=angles,
        albedo=albedo,
        p_values=np.array(p_values),
        finite=bool(finite),
        problems=_problems(angles, albedo, np.array(p_values), finite, **found),
        **found,
    )


def _problems(
    angles: FloatArray,
    albedo: FloatArray,
    p_values: FloatArray,
    finite: bool,
    reciprocity_error: float,
    weight_error: float,
    albedo_deviation: float,
) -> tuple[str, ...]:
    problems = []
    if not reciprocity_error <= _RECIPROCITY_TOLERANCE:
        problems.append(
            f"It is not reciprocal: both ways of the light differ by up to {reciprocity_error:.2g} of the value."
        )
    largest = albedo.reshape(len(angles), -1).max(axis=1)
    if np.any(largest > 1 + _ENERGY_TOLERANCE):
        worst = int(np.argmax(largest))
        problems.append(f"It reflects more than it receives: the albedo at {angles[worst]:g}° is {largest[worst]:.4g}.")
    # Šidák: one false alarm in a thousand for all angles together.
    if np.any(p_values < 1 - (1 - _SIGNIFICANCE) ** (1 / len(angles))):
        worst = int(np.argmin(p_values))
        problems.append(
            f"Its draws do not follow its density: chi² at {angles[worst]:g}° has p = {p_values[worst]:.2g}."
        )
    if not weight_error <= _WEIGHT_TOLERANCE:
        problems.append(f"A sample's weight is not f cosθ / pdf: they differ by up to {weight_error:.2g} of it.")
    if not albedo_deviation <= _STANDARD_ERRORS:
        problems.append(f"The mean weight of samples is {albedo_deviation:.3g} standard errors from the albedo.")
    if not finite:
        problems.append("A value, density, weight or albedo is negative or not finite.")
    return tuple(problems)


def _relative(left: FloatArray, right: FloatArray) -> float:
    """Largest difference relative to the larger of each pair, leaving out what is nothing beside the largest."""
    size = np.maximum(np.abs(left), np.abs(right))
    counted = size > 1e-9 * np.max(size, initial=0.0)
    return float(np.max(np.abs(left - right)[counted] / size[counted], initial=0.0))


def _reciprocity(
    model: ReflectanceModel, incident: FloatArray, drawn: FloatArray, generator: np.random.Generator
) -> float:
    """Over directions that the model draws and others."""
    cosine, phi = generator.uniform(0, 1, 1000), generator.uniform(0, 2 * np.pi, 1000)
    sine = np.sqrt(1 - cosine**2)
    anywhere = np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine], axis=-1)
    above = drawn[drawn[:, 2] > 0]
    # Each kind for itself: outside a lobe all is nothing beside its peak.
    return max(_relative(model.evaluate(incident, some), model.evaluate(some, incident)) for some in (above, anywhere))


def _deviation(weight: FloatArray, albedo: FloatArray) -> float:
    mean, error = weight.mean(axis=0), weight.std(axis=0) / np.sqrt(len(weight))
    # What rare draws reflect, or fail to, may never have been drawn: no error is less than that of one draw.
    largest = weight.max(axis=0)
    one_draw = np.where(largest > 0, largest, 1.0) / len(weight)
    return float(np.max(np.abs(mean - albedo) / np.maximum(error, one_draw)))


def _finite(array: FloatArray) -> bool:
    return bool(np.all(np.isfinite(array) & (array >= 0)))


def _finite_at_grazing(model: ReflectanceModel, generator: np.random.Generator) -> bool:
    incident = direction(_GRAZING_DEG)[:, None]
    drawn = model.sample(incident, generator.random((1000, 2)))
    mirrored = incident * [-1, -1, 1]
    back = np.broadcast_to(incident, mirrored.shape)
    arrays = [drawn.exitant**2, drawn.pdf, drawn.weight]
    for exitant in (mirrored, back, direction([0.0, 45.0, 90.0])):
        arrays += [model.evaluate(incident, exitant), model.pdf(incident, exitant), model.evaluate(exitant, incident)]
    return all(_finite(array) for array in arrays)
