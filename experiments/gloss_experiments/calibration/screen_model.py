"""Models of a screen, and the choice between them by patches that no fit has seen."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gloss_experiments.calibration.fit_table import CHANNELS, CurveName, FitTable, fit_table
from gloss_experiments.calibration.gain_offset_gamma import GainOffsetGamma, fit_gain_offset_gamma
from gloss_experiments.calibration.lightness import lightness_of_luminance
from gloss_experiments.calibration.patches import largest_code
from gloss_experiments.calibration.readings import Reading, Readings
from glossspace.display import DisplayModel
from glossspace.errors import GlossError
from glossspace.luminance_table import LuminanceTable

__all__ = ["ScreenModel", "Verification", "fit_screen", "verify"]

# Fewer would choose a model by chance.
_FEWEST_VERIFIED = 3
# A table of every code value of 8 bits; of 16 bits every 257th is as smooth.
_TABLE_ROWS = 256


@dataclass(frozen=True, kw_only=True)
class ScreenModel:
    """A model of what a screen shows.

    Attributes
    ----------
    name : str
        Such as ``"gain-offset-gamma of gray"``.
    table : LuminanceTable
        Its luminances, as a scene's ``[display.measured]`` takes them.
    gain_offset_gamma : GainOffsetGamma or None
        Its parameters; None for an interpolation.
    added_cd_m2 : dict
        What each curve adds to black, as a function of code values.
    """

    name: str
    bits: int
    table: LuminanceTable
    gain_offset_gamma: GainOffsetGamma | None
    added_cd_m2: dict[CurveName, Callable[[NDArray[np.float64]], NDArray[np.float64]]]
    black_cd_m2: float

    @property
    def display(self) -> DisplayModel:
        """The screen as stimuli are encoded for it."""
        return DisplayModel.from_table(self.table, bits=self.bits)

    def predict(self, codes: NDArray[np.int64]) -> NDArray[np.float64]:
        """Luminance of patches; NaN for a patch in colour where gray alone was measured.

        Parameters
        ----------
        codes : ndarray, shape (n, 3)
            Code values of red, green and blue.
        """
        codes = np.atleast_2d(codes)
        if "gray" in self.added_cd_m2:
            gray = self.black_cd_m2 + self.added_cd_m2["gray"](codes[:, 0].astype(float))
            return np.where((codes == codes[:, :1]).all(axis=1), gray, np.nan)
        added = [self.added_cd_m2[name](codes[:, i].astype(float)) for i, name in enumerate(CHANNELS)]
        return np.asarray(self.black_cd_m2 + np.sum(added, axis=0), dtype=float)


@dataclass(frozen=True, kw_only=True)
class Verification:
    """How well a model predicts patches that were not used in its fit.

    Attributes
    ----------
    model : str
    codes : tuple
        Code values of each patch that the model predicts.
    measured_cd_m2, predicted_cd_m2 : tuple of float
    error_cd_m2, error_percent, delta_l : tuple of float
        Measured less predicted: in cd/m², in percent of the prediction, and as lightness L* of the measured white.
    rms_delta_l : float
        Over the gray patches: what the models are compared by.
    """

    model: str
    codes: tuple[tuple[int, int, int], ...]
    measured_cd_m2: tuple[float, ...]
    predicted_cd_m2: tuple[float, ...]
    error_cd_m2: tuple[float, ...]
    error_percent: tuple[float, ...]
    delta_l: tuple[float, ...]
    rms_delta_l: float
    largest_delta_l: float
    rms_percent: float


def verify(model: ScreenModel, readings: Sequence[Reading], *, white_cd_m2: float) -> Verification:
    """Compare the predictions of a model with readings that it has not seen.

    Raises
    ------
    GlossError
        There are fewer than three gray patches.
    """
    codes = np.array([reading.patch.codes for reading in readings]).reshape(-1, 3)
    measured = np.array([reading.luminance_cd_m2 for reading in readings])
    predicted = model.predict(codes) if readings else np.array([])
    told = np.isfinite(predicted)
    codes, measured, predicted = codes[told], measured[told], predicted[told]
    gray = (codes == codes[:, :1]).all(axis=1)
    if gray.sum() < _FEWEST_VERIFIED:
        raise GlossError(
            f"There are {gray.sum()} gray readings of the purpose 'verify', but {_FEWEST_VERIFIED} are needed: a curve "
            "is judged by patches that it was not fitted to. Measure some between those of the fit."
        )
    delta_l = np.subtract(*(lightness_of_luminance(one, white_cd_m2=white_cd_m2) for one in (measured, predicted)))
    percent = 100 * (measured - predicted) / np.maximum(predicted, np.finfo(float).tiny)
    return Verification(
        model=model.name,
        codes=tuple((int(red), int(green), int(blue)) for red, green, blue in codes),
        measured_cd_m2=tuple(measured.tolist()),
        predicted_cd_m2=tuple(predicted.tolist()),
        error_cd_m2=tuple((measured - predicted).tolist()),
        error_percent=tuple(percent.tolist()),
        delta_l=tuple(delta_l.tolist()),
        rms_delta_l=_rms(delta_l[gray]),
        largest_delta_l=float(np.abs(delta_l[gray]).max()),
        rms_percent=_rms(percent[gray]),
    )


def fit_screen(readings: Readings, *, bits: int = 8) -> tuple[tuple[ScreenModel, Verification], ...]:
    """Fit every model that the readings allow; the one with the smallest residual on the verification comes first.

    Gain-offset-gamma and a monotone interpolation, each of gray and, where they were measured, of the three channels.
    An interpolation is left out where noise makes the readings fall.

    Returns
    -------
    tuple of (ScreenModel, Verification)
        By the root mean square of ΔL* over the gray verification patches, the best first.

    Raises
    ------
    GlossError
        See `fit_table` and `verify`; or a verification patch is one of the fit.
    """
    top = largest_code(bits)
    fitted, held_out = readings.of("fit"), readings.of("verify")
    table = fit_table(fitted, top=top)
    seen = {reading.patch.codes for reading in fitted}
    for reading in held_out:
        if reading.patch.codes in seen:
            raise GlossError(
                f"The verification patch {reading.patch.codes} is one of the fit too, so it would judge the curve by "
                "what made it. Measure another code value."
            )
        if reading.patch.position != table.position:
            raise GlossError(
                f"The verification patch {reading.patch.codes} stood at '{reading.patch.position}', but the fit at "
                f"'{table.position}'. Measure it there."
            )
    models = []
    for names in (("gray",), CHANNELS):
        if all(name in table.curves for name in names):
            models += [_gain_offset_gamma(table, names, bits), *_interpolation(table, names, bits)]
    white = max(float(curve.luminance_cd_m2.max()) for curve in table.curves.values())
    if "gray" not in table.curves:
        white = float(models[0].predict(np.array([[top] * 3]))[0])
    judged = [(model, verify(model, held_out, white_cd_m2=white)) for model in models]
    # Rounded, so that of two models without error the simpler one stays first.
    return tuple(sorted(judged, key=lambda pair: round(pair[1].rms_delta_l, 9)))


def _gain_offset_gamma(table: FitTable, names: tuple[CurveName, ...], bits: int) -> ScreenModel:
    top = largest_code(bits)
    fitted = fit_gain_offset_gamma(table, names, top=top)
    codes = np.linspace(0, top, _TABLE_ROWS).round().astype(int)
    gray = fitted.gray_cd_m2(codes)
    # A negative offset cuts the darkest codes off: a table must rise, so of equal luminances the first one stays.
    rises = np.concatenate([[True], np.diff(np.maximum.accumulate(gray)) > 0])
    return ScreenModel(
        name=f"gain-offset-gamma of {_what(names)}",
        bits=bits,
        table=LuminanceTable(codes=tuple(codes[rises].tolist()), gray_cd_m2=tuple(gray[rises].tolist())),
        gain_offset_gamma=fitted,
        added_cd_m2={name: _bound(fitted, name) for name in names},
        black_cd_m2=fitted.black_cd_m2,
    )


def _bound(fitted: GainOffsetGamma, name: CurveName) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    return lambda codes: fitted.added_cd_m2(name, codes)


def _interpolation(table: FitTable, names: tuple[CurveName, ...], bits: int) -> list[ScreenModel]:
    from scipy.interpolate import PchipInterpolator

    if any(name in table.dips for name in names):
        return []
    black = float(table.black_cd_m2.mean())
    levels = {name: table.curves[name].levels() for name in names}
    shared = np.unique(np.concatenate([codes for codes, _ in levels.values()]))
    curves = {
        name: PchipInterpolator([0, *codes], [0, *(luminance - black)]) for name, (codes, luminance) in levels.items()
    }
    # The rows of the table are the code values that any channel was measured at.
    columns = {f"{name}_cd_m2": (black, *(black + curves[name](shared)).tolist()) for name in names}
    luminance_table = LuminanceTable(codes=(0, *shared.tolist()), **columns)
    return [
        ScreenModel(
            name=f"interpolation of {_what(names)}",
            bits=bits,
            table=luminance_table,
            gain_offset_gamma=None,
            added_cd_m2=dict(curves),
            black_cd_m2=black,
        )
    ]


def _what(names: tuple[CurveName, ...]) -> str:
    return "gray" if names == ("gray",) else "the channels"


def _rms(values: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
