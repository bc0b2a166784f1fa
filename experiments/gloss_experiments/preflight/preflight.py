"""The check of the screen before a session: one table of what was found against what must be, and a refusal.

What is found out from a window stands in `gloss_experiments.preflight.screen_facts`, how each thing is judged in
`gloss_experiments.preflight.preflight_rows`.
"""

from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from gloss_experiments.calibration.record import StoredCalibration, read_calibration
from gloss_experiments.preflight.preflight_rows import Row, judge_rows
from gloss_experiments.preflight.screen_facts import ScreenFacts, screen_facts
from gloss_experiments.protocol import Protocol
from glossspace.errors import GlossError
from glossspace.stimulus_set import StimulusSet

__all__ = ["Preflight", "Row", "check_screen", "judge_screen"]


@dataclass(frozen=True, kw_only=True)
class Preflight:
    """All that was checked of a screen before a session.

    Attributes
    ----------
    rows : tuple of Row
    override : str or None
        Why the session is to run all the same.
    calibration : dict or None
        Which calibration was checked: screen, file, SHA-256, day, photometer, residuals of its verification.
    """

    rows: tuple[Row, ...]
    override: str | None = None
    calibration: dict[str, Any] | None = None

    @property
    def problems(self) -> tuple[Row, ...]:
        """What refuses the session."""
        return tuple(row for row in self.rows if row.verdict == "refused")

    @property
    def warnings(self) -> tuple[Row, ...]:
        """What could not be checked."""
        return tuple(row for row in self.rows if row.verdict == "warning")

    def table(self) -> str:
        """The rows as aligned text."""
        marks = {"ok": "ok", "warning": "not checked", "refused": "REFUSED"}
        cells = [
            ("check", "found", "expected", ""),
            *((r.name, r.found, r.expected, marks[r.verdict]) for r in self.rows),
        ]
        widths = [max(len(row[column]) for row in cells) for column in range(4)]
        lines = [
            "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in cells
        ]
        if self.override is not None:
            lines.append(f"Overridden: {self.override}")
        return "\n".join(lines)

    def require(self) -> None:
        """Let a session begin only where nothing refuses it, or somebody has said why it may all the same.

        Raises
        ------
        GlossError
            A row refuses, and there is no override.
        """
        if self.problems and self.override is None:
            said = "; ".join(f"{row.name}: {row.found}, but expected {row.expected}" for row in self.problems)
            raise GlossError(
                f"The screen is not as it must be ({said}). Put it right, or say why the session shall run all "
                'the same: --override "REASON", which the journal keeps.'
            )

    def to_dict(self) -> dict[str, Any]:
        """As the journal keeps it."""
        return {
            "rows": [asdict(row) for row in self.rows],
            "refused": [row.name for row in self.problems],
            "override": self.override,
            "calibration": self.calibration,
        }


def check_screen(
    window: Any,
    protocol: Protocol,
    stimulus_set: StimulusSet,
    *,
    refresh_s: float | None,
    calibration: str | Path | StoredCalibration | None = None,
    override: str | None = None,
    now: datetime | None = None,
) -> Preflight:
    """Check the screen of an open PsychoPy window before a session.

    The gamma table of the video card is read as it is found; nothing is changed.

    Parameters
    ----------
    window
        The session's PsychoPy window, before its first trial.
    protocol, stimulus_set
        Of the session.
    refresh_s : float or None
        Refresh period of the display in seconds, as `window.refresh_period_s` measures it.
    calibration : path or StoredCalibration, optional
        Of this screen, as `gloss calibrate` writes it.
    override : str, optional
        Why the session is to run although a row refuses it.
    now : datetime, optional
        By default the clock's.

    Returns
    -------
    Preflight
        Call its `require` to refuse.

    Raises
    ------
    GlossError
        The calibration cannot be read, or the reason of the override is blank.
    """
    if override is not None and not override.strip():
        raise GlossError("--override needs the reason why the session shall run all the same; the journal keeps it.")
    if calibration is not None and not isinstance(calibration, StoredCalibration):
        calibration = read_calibration(calibration)
    facts = screen_facts(window, refresh_s=refresh_s)
    judged = judge_screen(facts, protocol, stimulus_set, calibration=calibration, now=now or datetime.now(UTC))
    return replace(judged, override=None if override is None else override.strip())


def judge_screen(
    facts: ScreenFacts,
    protocol: Protocol,
    stimulus_set: StimulusSet,
    *,
    calibration: StoredCalibration | None,
    now: datetime,
) -> Preflight:
    """Judge what was found out about a screen; see `check_screen`."""
    rows = judge_rows(facts, protocol, stimulus_set, calibration=calibration, now=now)
    known = None
    if calibration is not None:
        known = {
            "screen": calibration.screen.name,
            "file": str(calibration.path),
            "sha256": calibration.sha256,
            "measured_at": calibration.measured_at.isoformat(timespec="seconds"),
            "photometer": calibration.photometer,
            "simulated": calibration.simulated,
            "n_verified": calibration.n_verified,
            "rms_delta_l": calibration.rms_delta_l,
            "largest_delta_l": calibration.largest_delta_l,
        }
    return Preflight(rows=rows, calibration=known)
