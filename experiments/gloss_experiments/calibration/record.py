"""A calibration: all that the readings of a screen tell, kept in one dated file."""

from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from gloss_experiments.calibration.checks import (
    Additivity,
    StrayLight,
    Uniformity,
    WarmUp,
    check_additivity,
    check_stray_light,
    check_uniformity,
    check_warm_up,
)
from gloss_experiments.calibration.readings import Readings
from gloss_experiments.calibration.screen_identity import ScreenIdentity
from gloss_experiments.calibration.screen_model import ScreenModel, Verification, fit_screen
from glossspace.display import DisplayModel
from glossspace.errors import GlossError
from glossspace.files import read_json, sha256_of, write_json

__all__ = ["FORMAT", "Calibration", "StoredCalibration", "calibrate", "read_calibration", "save_calibration"]

FORMAT = "glossspace/screen-calibration"
VERSION = 1

# Where a remark is due. An L* of 1 is about what an eye tells apart side by side; a photometer errs by 2 %.
_NOTABLE_DELTA_L = 1.0
_NOTABLE_PERCENT = 2.0


@dataclass(frozen=True, kw_only=True)
class Calibration:
    """A screen as its readings tell it; make one with `calibrate`.

    Attributes
    ----------
    measured_at : datetime
        When the readings were made, in UTC.
    screen : ScreenIdentity
    readings : Readings
    bits : int
    models : tuple of (ScreenModel, Verification)
        Every model, the best first.
    additivity, uniformity, stray_light, warm_up
        See `gloss_experiments.calibration.checks`.
    """

    measured_at: datetime
    screen: ScreenIdentity
    readings: Readings
    bits: int
    models: tuple[tuple[ScreenModel, Verification], ...]
    additivity: tuple[Additivity, ...]
    uniformity: tuple[Uniformity, ...]
    stray_light: StrayLight
    warm_up: WarmUp | None

    @property
    def model(self) -> ScreenModel:
        """The model with the smallest residual on the verification patches."""
        return self.models[0][0]

    @property
    def verification(self) -> Verification:
        """Its residuals there."""
        return self.models[0][1]

    @property
    def display(self) -> DisplayModel:
        """The screen as stimuli are encoded for it."""
        return self.model.display

    @property
    def simulated(self) -> bool:
        """Whether the readings are made up."""
        return self.readings.simulated

    def reason(self) -> str:
        """Why this model was chosen, in a sentence."""
        best = f"{self.verification.rms_delta_l:.2g}"
        others = ", ".join(f"{one.rms_delta_l:.2g} ({one.model})" for _, one in self.models[1:])
        n = len(self.verification.codes)
        against = f", against {others}" if others else ""
        return (
            f"Chosen: {self.model.name}, with the smallest residual on {n} verification patches that no fit has seen: "
            f"rms ΔL* {best}{against}."
        )

    def remarks(self) -> tuple[str, ...]:
        """What somebody should look at before trusting the calibration."""
        found = []
        if self.simulated:
            found.append("These readings are simulated: no screen was measured.")
        if any(one.luminance_cd_m2 == 0 for one in self.readings.of("fit")):
            found.append("The photometer reads 0 at black. A scene needs the black: use a more sensitive instrument.")
        if self.verification.largest_delta_l > _NOTABLE_DELTA_L:
            found.append(
                f"A verification patch is off by ΔL* {self.verification.largest_delta_l:.2g}. Look at the figure."
            )
        if any(abs(one.error_percent) > _NOTABLE_PERCENT for one in self.additivity):
            worst = max(self.additivity, key=lambda one: abs(one.error_percent))
            found.append(f"The channels add up to {worst.error_percent:+.1f} % of gray at code {worst.code}.")
        if any(abs(one.delta_l) > _NOTABLE_DELTA_L for one in self.uniformity):
            uneven = max(self.uniformity, key=lambda one: abs(one.delta_l))
            found.append(
                f"The image positions differ by ΔL* {uneven.delta_l:+.2g} at code {uneven.code} (right less left)."
            )
        if self.warm_up is not None and self.warm_up.stable_after_min is None:
            found.append(
                f"The screen was not warm after {self.warm_up.minutes[-1]:g} minutes. Wait longer, measure again."
            )
        return tuple(found)

    def to_dict(self) -> dict[str, Any]:
        """All of it, as JSON takes it."""
        gog = {
            model.name: asdict(model.gain_offset_gamma)
            for model, _ in self.models
            if model.gain_offset_gamma is not None
        }
        return {
            "format": FORMAT,
            "version": VERSION,
            "measured_at": self.measured_at.isoformat(timespec="seconds"),
            "simulated": self.simulated,
            "photometer": self.readings.photometer,
            "screen": self.screen.to_dict(),
            "bits": self.bits,
            "model": self.model.name,
            "reason": self.reason(),
            "remarks": list(self.remarks()),
            "display": self.display.to_dict(),
            "gain_offset_gamma": _finite(gog),
            "verification": [asdict(one) for _, one in self.models],
            "additivity": [asdict(one) for one in self.additivity],
            "uniformity": [asdict(one) for one in self.uniformity],
            "stray_light": asdict(self.stray_light),
            "warm_up": None if self.warm_up is None else asdict(self.warm_up),
            "readings": [reading.to_dict() for reading in self.readings.items],
        }


@dataclass(frozen=True, kw_only=True)
class StoredCalibration:
    """What a session needs of a calibration on the disk; make one with `read_calibration`.

    `rms_delta_l` and `largest_delta_l` are residuals on `n_verified` patches that the fit has not seen.
    """

    path: Path
    sha256: str
    measured_at: datetime
    screen: ScreenIdentity
    photometer: str
    simulated: bool
    display: DisplayModel
    n_verified: int
    rms_delta_l: float
    largest_delta_l: float


def calibrate(
    readings: Readings, *, screen: ScreenIdentity, bits: int = 8, measured_at: datetime | None = None
) -> Calibration:
    """Fit the models of a screen to its readings, choose one, and check the screen.

    Parameters
    ----------
    readings : Readings
    screen : ScreenIdentity
    bits : {8, 16}
        Of the code values.
    measured_at : datetime, optional
        When the readings were made; now by default.

    Raises
    ------
    GlossError
        See `fit_screen`.

    Examples
    --------
    >>> from gloss_experiments.calibration import SimulatedScreen, simulated_readings
    >>> found = calibrate(simulated_readings(SimulatedScreen()), screen=ScreenIdentity(name="simulated"))
    >>> found.model.name, found.display.codes(10.0).tolist(), found.simulated
    ('gain-offset-gamma of gray', 90, True)
    """
    models = fit_screen(readings, bits=bits)
    display = models[0][0].display
    white = display.white_cd_m2
    return Calibration(
        measured_at=measured_at or datetime.now(UTC),
        screen=screen,
        readings=readings,
        bits=bits,
        models=models,
        additivity=check_additivity(readings, white_cd_m2=white),
        uniformity=check_uniformity(readings, white_cd_m2=white),
        stray_light=check_stray_light(readings, black_cd_m2=display.black_cd_m2, white_cd_m2=white),
        warm_up=check_warm_up(readings),
    )


def save_calibration(calibration: Calibration, path: str | Path) -> None:
    """Write a calibration as JSON, whole or not at all."""
    write_json(path, calibration.to_dict())


def read_calibration(path: str | Path) -> StoredCalibration:
    """Read what a session needs of a calibration.

    Raises
    ------
    GlossError
        There is none, it is damaged, or of a newer version.
    """
    path = Path(path)
    document = read_json(path, what="screen calibration")
    if document.get("format") != FORMAT:
        raise GlossError(
            f"'{path}' is no screen calibration: its format is {document.get('format')!r}, not '{FORMAT}'. "
            "Make one with `gloss calibrate`."
        )
    if document.get("version") != VERSION:
        raise GlossError(
            f"The screen calibration '{path}' is of version {document.get('version')!r}, but this program reads "
            f"{VERSION}. Install the glossspace that wrote it, or fit its readings again."
        )
    try:
        measured_at = datetime.fromisoformat(document["measured_at"])
        verified = document["verification"][0]
        return StoredCalibration(
            path=path,
            sha256=sha256_of(path),
            measured_at=measured_at if measured_at.tzinfo else measured_at.replace(tzinfo=UTC),
            screen=ScreenIdentity.from_dict(document["screen"]),
            photometer=str(document["photometer"]),
            simulated=document["simulated"] is not False,
            display=DisplayModel.from_dict(document["display"]),
            n_verified=len(verified["codes"]),
            rms_delta_l=float(verified["rms_delta_l"]),
            largest_delta_l=float(verified["largest_delta_l"]),
        )
    except (KeyError, IndexError, TypeError, ValueError, AttributeError) as error:
        what = f"'{error.args[0]}' is missing" if isinstance(error, KeyError) else str(error)
        raise GlossError(
            f"The screen calibration '{path}' is damaged: {what}. Restore it, or fit its readings again."
        ) from None


def _finite(value: Any) -> Any:
    """Without infinities, which JSON lacks: an interval that the readings do not determine is null."""
    if isinstance(value, dict):
        return {key: _finite(one) for key, one in value.items()}
    return None if isinstance(value, float) and abs(value) == float("inf") else value
