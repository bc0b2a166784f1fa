"""Sums of reflectance models, such as a diffuse base under a specular lobe."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property, reduce

import numpy as np
from numpy.typing import ArrayLike

from glossspace.errors import GlossError
from glossspace.metric.validity import FloatArray
from glossspace.reflectance.model import ReflectanceModel, as_directions, as_uniforms

__all__ = ["Sum"]


@dataclass(frozen=True, eq=False)
class Sum(ReflectanceModel):
    """The sum of models: values and albedos add, directions are drawn from one of them.

    Models without channels count for each channel of the others. A sum of sums is flat.

    Attributes
    ----------
    models : tuple of ReflectanceModel
        The terms, at least one; all with channels have equally many.

    Raises
    ------
    GlossError
        There is no term, one is no model, or the numbers of channels differ.

    Examples
    --------
    >>> from glossspace.reflectance.lambert import Lambert
    >>> from glossspace.reflectance.ward import Ward
    >>> (Lambert(0.193) + Ward(0.066, 0.07)).albedo([0.0, 60.0]).round(4).tolist()
    [0.258, 0.2256]
    """

    models: tuple[ReflectanceModel, ...]

    def __post_init__(self) -> None:
        given = tuple(self.models) if isinstance(self.models, Iterable) else (self.models,)
        if not given or not all(isinstance(model, ReflectanceModel) for model in given):
            raise GlossError(f"A sum needs at least one reflectance model and nothing else, but got {self.models!r}.")
        flat = tuple(term for model in given for term in (model.models if isinstance(model, Sum) else (model,)))
        object.__setattr__(self, "models", flat)
        counts = {model.channels for model in flat if model.channels is not None}
        if len(counts) > 1:
            raise GlossError(f"The terms of a sum need equally many channels, but have {sorted(counts)}.")

    @property
    def channels(self) -> int | None:
        """Number of wavelengths or paints, None if no term has any."""
        return next((model.channels for model in self.models if model.channels is not None), None)

    @cached_property
    def shares(self) -> FloatArray:
        """Share of draws that each term gets: its albedo at 45°, averaged over channels. Equal if all are black."""
        albedos = np.array([np.mean(model.albedo(45.0)) for model in self.models])
        total = albedos.sum()
        return albedos / total if total > 0 else np.full(len(albedos), 1 / len(albedos))

    def evaluate(self, incident: ArrayLike, exitant: ArrayLike) -> FloatArray:
        """BRDF (1/sr); see `ReflectanceModel.evaluate`."""
        return _total([self._aligned(model, model.evaluate(incident, exitant)) for model in self.models])

    def draw(self, incident: ArrayLike, u: ArrayLike) -> FloatArray:
        """Exitant directions, each from one of the terms, which u's first number chooses and which then reuses it."""
        first, second = as_uniforms(u)
        i = as_directions(incident, name="incident")
        ends = np.cumsum(self.shares)
        ends[-1] = 1.0  # whatever rounding made of it
        chosen = np.searchsorted(ends, first, side="right")
        exitant = np.empty(np.broadcast_shapes(i.shape, (*first.shape, 3)))
        for index, (model, start, share) in enumerate(zip(self.models, ends - self.shares, self.shares, strict=True)):
            picked = np.broadcast_to(chosen == index, exitant.shape[:-1])
            if np.any(picked):
                # Rounding may leave the interval by its last digit.
                again = np.clip((first - start) / share, 0, np.nextafter(1, 0))
                pair = np.broadcast_to(np.stack([again, second], axis=-1), (*exitant.shape[:-1], 2))
                exitant[picked] = model.draw(np.broadcast_to(i, exitant.shape)[picked], pair[picked])
        return exitant

    def pdf(self, incident: ArrayLike, exitant: ArrayLike) -> FloatArray:
        """Density (1/sr) of `draw`: the terms' densities, each times its share."""
        pairs = zip(self.shares, self.models, strict=True)
        return _total([share * model.pdf(incident, exitant) for share, model in pairs if share > 0])

    def albedo(self, theta_deg: ArrayLike, *, phi_deg: ArrayLike = 0.0) -> FloatArray:
        """Directional-hemispherical reflectance: the sum of the terms'."""
        return _total([self._aligned(model, model.albedo(theta_deg, phi_deg=phi_deg)) for model in self.models])

    def _aligned(self, model: ReflectanceModel, value: FloatArray) -> FloatArray:
        """A term's values with the axis of channels that the sum has."""
        return value[..., None] if self.channels is not None and model.channels is None else value


def _total(arrays: list[FloatArray]) -> FloatArray:
    return reduce(np.add, arrays)
