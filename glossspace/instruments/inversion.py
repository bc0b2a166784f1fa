"""The glossmeter backwards: parameters of a lobe from one, two or three readings, and all that read alike."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.optimize import brentq, minimize_scalar

from glossspace.errors import GlossError
from glossspace.instruments.glossmeter import gloss_units
from glossspace.instruments.lobe_families import (
    Family,
    Material,
    diffuse_units,
    lobe_family,
    require_readings,
    unit_readings,
)
from glossspace.metric.validity import FloatArray

__all__ = ["Inversion", "LobeFit", "alike_parameters", "invert_gloss"]

_EXACT_GU = 1e-4
# Share of a step of the table that tells on which side of it the error falls.
_INWARDS = 1e-2


@dataclass(frozen=True)
class LobeFit:
    """One set of parameters and what it reads.

    Attributes
    ----------
    amplitude, roughness : float
        The lobe's parameters.
    readings : mapping of int to float
        Gloss units at the angles that were given.
    worst_error_gu : float
        Largest distance from a given reading.
    albedo60 : float
        Directional-hemispherical reflectance at 60°, diffuse part included; above one, no such sample can be.
    """

    amplitude: float
    roughness: float
    readings: Mapping[int, float]
    worst_error_gu: float
    albedo60: float


@dataclass(frozen=True)
class Inversion:
    """Lobes that read as was measured.

    Attributes
    ----------
    family : str
        Family of the lobe.
    fits : tuple of LobeFit
        The best one first. Further ones read equally well, such as a narrow and a wide lobe.
    exact : bool
        Whether the best one meets every reading.
    ceilings : mapping of int to float
        Highest reading at each angle that the family reaches with the given amplitude, or with the largest one.
    """

    family: str
    fits: tuple[LobeFit, ...]
    exact: bool
    ceilings: Mapping[int, float]


def invert_gloss(
    readings: Mapping[int, float],
    *,
    family: str = "ward",
    amplitude: float | None = None,
    roughness: float | None = None,
    material: Material | None = None,
) -> Inversion:
    """Parameters of a lobe from gloss readings, by least squares in gloss units where there are more than unknowns.

    Parameters
    ----------
    readings : mapping of int to float
        Gloss units by angle: one to three of 20, 60, 85.
    family : str
        ``ward``, ``beckmann`` or ``cook-torrance``.
    amplitude, roughness : float, optional
        What is known of the lobe. One reading alone needs one of them.
    material : Material, optional
        Diffuse reflectance and index of refraction; black and 1.5 by default.

    Returns
    -------
    Inversion
        The lobes found, and whether they meet the readings.

    Raises
    ------
    GlossError
        There are more unknowns than readings, both are given, a value is impossible, or one reading is out of reach:
        then the message states the highest or lowest reading that the family gives.

    Examples
    --------
    >>> found = invert_gloss({60: 10.0}, amplitude=0.05)
    >>> round(found.fits[0].roughness, 4)
    0.0511
    """
    kind, material = lobe_family(family), material or Material()
    measured, angles = require_readings(readings)
    low, high = _amplitude_bounds(kind, material, amplitude)
    if amplitude is not None and roughness is not None:
        raise GlossError("Amplitude and roughness are both given: nothing is left to find. Leave one out.")
    if len(measured) == 1 and amplitude is None and roughness is None:
        raise GlossError(
            f"One reading does not tell two unknowns. Give {kind.amplitude} or {kind.roughness}, or a second reading; "
            "`alike_parameters` gives all pairs that read so."
        )
    if roughness is not None and not kind.roughness_range[0] <= roughness <= kind.roughness_range[1]:
        raise GlossError(
            f"Invalid {kind.roughness} = {roughness!r}. Allowed: {kind.roughness_range[0]:g} to "
            f"{kind.roughness_range[1]:g}."
        )
    base = np.array([float(diffuse_units(material.rho_d, angle)) for angle in angles])
    grid, table = _table(kind, material, angles)
    ceilings = {angle: float(base[k] + high * table[k].max()) for k, angle in enumerate(angles)}
    if len(measured) == 1:
        _require_reach(kind, measured[0], angles[0], base[0], (low, high), table[0], roughness, grid)
    target = measured - base
    if roughness is not None:
        candidates = [float(roughness)]
    elif len(measured) == 1:
        candidates = _crossings(kind, material, angles[0], float(amplitude or 0), float(target[0]), grid, table[0])
    else:
        candidates = _minima(kind, material, angles, (low, high), target, grid, table)
    fits = [_fit(kind, material, angles, (low, high), target, base, at) for at in candidates]
    fits.sort(key=lambda one: one.worst_error_gu)
    alike = tuple(one for one in fits if one.worst_error_gu <= fits[0].worst_error_gu + _EXACT_GU)
    return Inversion(kind.name, alike, alike[0].worst_error_gu <= 100 * _EXACT_GU, ceilings)


def alike_parameters(
    readings: Mapping[int, float],
    *,
    family: str = "ward",
    tolerance_gu: float = 0.5,
    material: Material | None = None,
) -> pd.DataFrame:
    """All lobes that read as was measured, within a tolerance at every angle: what the readings leave open.

    Parameters
    ----------
    readings, family, material
        As in `invert_gloss`.
    tolerance_gu : float
        Half width of what counts as alike, > 0; glossmeters repeat to about half a unit.

    Returns
    -------
    DataFrame
        A row for each roughness of the table that has such lobes, named as in the family (``alpha`` and ``rho_s_low``,
        ``rho_s_high`` for Ward): the range of amplitudes. Empty where no lobe reads so.

    Raises
    ------
    GlossError
        A reading or the tolerance is impossible.

    Examples
    --------
    >>> one = alike_parameters({60: 10.0})
    >>> three = alike_parameters({20: 1.0, 60: 10.0, 85: 0.5})
    >>> len(one) > len(three)
    True
    """
    kind, material = lobe_family(family), material or Material()
    measured, angles = require_readings(readings)
    if not (np.isfinite(tolerance_gu) and tolerance_gu > 0):
        raise GlossError(f"Invalid tolerance_gu = {tolerance_gu!r}. Allowed: a finite number of gloss units above 0.")
    low, high = _amplitude_bounds(kind, material, None)
    base = np.array([float(diffuse_units(material.rho_d, angle)) for angle in angles])
    grid, table = _table(kind, material, angles)
    least = np.maximum(low, ((measured - base - tolerance_gu)[:, None] / table).max(axis=0))
    most = np.minimum(high, ((measured - base + tolerance_gu)[:, None] / table).min(axis=0))
    rows = pd.DataFrame({kind.roughness: grid, f"{kind.amplitude}_low": least, f"{kind.amplitude}_high": most})
    return rows[least <= most].reset_index(drop=True)


def _amplitude_bounds(kind: Family, material: Material, amplitude: float | None) -> tuple[float, float]:
    if not (np.isfinite(material.rho_d) and 0 <= material.rho_d <= 1):
        raise GlossError(f"Invalid rho_d = {material.rho_d!r}. Allowed: 0 to 1.")
    most = kind.most(material)
    if most <= 0:
        raise GlossError(f"rho_d = {material.rho_d:g} leaves no {kind.amplitude} for a lobe. Lower rho_d.")
    if amplitude is None:
        return 0.0, most
    if not (np.isfinite(amplitude) and 0 < amplitude <= most + 1e-12):
        raise GlossError(f"Invalid {kind.amplitude} = {amplitude!r}. Allowed: above 0 to {most:g}.")
    return float(amplitude), float(amplitude)


def _table(kind: Family, material: Material, angles: tuple[int, ...]) -> tuple[FloatArray, FloatArray]:
    tables = [unit_readings(kind.name, angle, material.n, material.k) for angle in angles]
    if not any(np.any(table[1] > 0) for table in tables):
        raise GlossError(f"n = {material.n:g} and k = {material.k:g} reflect nothing. Choose another n or k.")
    return tables[0][0], np.maximum(np.stack([table[1] for table in tables]), 1e-300)


def _require_reach(
    kind: Family, reading: float, angle: int, base: float, bounds: tuple[float, float], table: FloatArray,
    roughness: float | None, grid: FloatArray,
) -> None:  # fmt: skip
    """Refuse one reading that no lobe of the family gives."""
    within = table if roughness is None else np.array([np.interp(np.log(roughness), np.log(grid), table)])
    ceiling, floor = base + bounds[1] * within.max(), base + bounds[0] * within.min()
    given = f"{kind.amplitude} {'=' if bounds[0] == bounds[1] else '<='} {bounds[1]:g}"
    if reading > ceiling * (1 + 1e-4):
        raise GlossError(
            f"{reading:g} gloss units at {angle} degrees are out of reach of the family {kind.name} with {given}: its "
            f"ceiling is {ceiling:.3g}. Raise {kind.amplitude}, lower {kind.roughness}, or choose another family."
        )
    if reading < floor * (1 - 1e-4):
        raise GlossError(
            f"{reading:g} gloss units at {angle} degrees are out of reach of the family {kind.name} with {given}: "
            f"it reads {floor:.3g} or more, of which {base:.3g} are the diffuse part. Lower {kind.amplitude} or rho_d."
        )


def _units(kind: Family, material: Material, angle: int, roughness: float) -> float:
    return float(gloss_units(kind.lobe(1.0, roughness, material), angle))


def _crossings(
    kind: Family, material: Material, angle: int, amplitude: float, target: float, grid: FloatArray, table: FloatArray
) -> list[float]:
    """Roughnesses at which a lobe of the given amplitude reads `target`: every crossing of the table, made exact."""

    def excess(log_roughness: float) -> float:
        return amplitude * _units(kind, material, angle, float(np.exp(log_roughness))) - target

    logs, coarse = np.log(grid), amplitude * table - target
    found = [
        float(np.exp(brentq(excess, logs[k], logs[k + 1], xtol=1e-12)))
        for k in np.flatnonzero(np.signbit(coarse[1:]) != np.signbit(coarse[:-1]))
        if excess(logs[k]) * excess(logs[k + 1]) <= 0
    ]
    # At the very ceiling or floor, the table's accuracy decides nothing: the nearest lobe is the answer.
    return found or [float(grid[np.argmin(np.abs(coarse))])]


def _best_amplitude(units: FloatArray, target: FloatArray, bounds: tuple[float, float]) -> FloatArray:
    """Least-squares amplitude for unit readings (angles, ...) within bounds."""
    norm = np.sum(units**2, axis=0)
    free = np.tensordot(target, units, axes=1) / np.where(norm > 0, norm, 1.0)
    return np.clip(free, *bounds)


def _minima(
    kind: Family, material: Material, angles: tuple[int, ...], bounds: tuple[float, float], target: FloatArray,
    grid: FloatArray, table: FloatArray,
) -> list[float]:  # fmt: skip
    """Roughnesses of the local minima of the squared error, each made exact."""

    def squared_error(log_roughness: float) -> float:
        units = np.array([_units(kind, material, angle, float(np.exp(log_roughness))) for angle in angles])
        return float(np.sum((_best_amplitude(units, target, bounds) * units - target) ** 2))

    amplitudes = _best_amplitude(table, target, bounds)
    if not np.any(amplitudes > 0):  # every roughness is then as good as any other
        raise GlossError(
            "The readings are no higher than those of the diffuse part alone: there is no lobe whose "
            f"{kind.roughness} could be found. Lower rho_d, or give {kind.amplitude}."
        )
    errors = np.sum((amplitudes * table - target[:, None]) ** 2, axis=0)
    padded = np.concatenate([[np.inf], errors, [np.inf]])
    lowest = np.flatnonzero((errors <= padded[:-2]) & (errors <= padded[2:]))
    best = errors[lowest].min()
    logs = np.log(grid)
    found = []
    for k in lowest[errors[lowest] <= 4 * best + 1.0]:
        around = logs[max(k - 1, 0)], logs[min(k + 1, len(grid) - 1)]
        if k in (0, len(grid) - 1):
            # The error rises from the end of the range inwards: no search, whose steps towards an end are many.
            inwards = logs[k] + _INWARDS * (np.mean(around) - logs[k])
            if squared_error(logs[k]) <= squared_error(inwards):
                found.append(float(grid[k]))
                continue
        done = minimize_scalar(squared_error, bounds=around, method="bounded", options={"xatol": 1e-9})
        found.append(float(np.exp(done.x)))
    return found


def _fit(
    kind: Family, material: Material, angles: tuple[int, ...], bounds: tuple[float, float], target: FloatArray,
    base: FloatArray, roughness: float,
) -> LobeFit:  # fmt: skip
    units = np.array([_units(kind, material, angle, roughness) for angle in angles])
    amplitude = float(_best_amplitude(units, target, bounds))
    read = base + amplitude * units
    albedo = material.rho_d + float(kind.lobe(amplitude, roughness, material).albedo(60.0))
    worst = float(np.max(np.abs(read - base - target)))
    return LobeFit(amplitude, roughness, dict(zip(angles, read.tolist(), strict=True)), worst, albedo)
