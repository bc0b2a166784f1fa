"""``simulated_observers.json``: the true parameters of simulated participants, to compare recovered ones with."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from glossspace.dataset.lock import locked
from glossspace.errors import GlossError
from glossspace.files import read_json, write_json

__all__ = ["SIMULATED_OBSERVERS_FILE", "read_simulated_observers", "record_simulated_observer"]

SIMULATED_OBSERVERS_FILE = "simulated_observers.json"
_FORMAT = "gloss-simulated-observers"
_COLUMNS = ("weight_c", "weight_d", "ratio", "exponent", "noise_sd")
# Every observer has these; one that looks at images has no weights of c and d, and one with a failing has more.
_PARAMETERS = ("exponent", "noise_sd")


def record_simulated_observer(folder: str | Path, participant: str, parameters: Mapping[str, Any]) -> None:
    """Note that `participant` is simulated, with the parameters that its answers embody.

    Raises
    ------
    GlossError
        The participant is noted already with other parameters.
    """
    path = Path(folder) / SIMULATED_OBSERVERS_FILE
    with locked(Path(folder) / ".dataset.lock"):
        observers = _observers(path)
        known = observers.get(participant)
        if known is not None and known != dict(parameters):
            raise GlossError(
                f"Participant '{participant}' of '{folder}' is already simulated with other parameters "
                f"({', '.join(f'{name} {_short(value)}' for name, value in known.items())}). Use another participant."
            )
        if known is None:
            observers[participant] = dict(parameters)
            document = {
                "format": _FORMAT,
                "version": 1,
                "note": "These participants are simulated: a program computed their answers from these parameters.",
                "observers": dict(sorted(observers.items())),
            }
            write_json(path, document)


def read_simulated_observers(folder: str | Path) -> pd.DataFrame | None:
    """The true parameters of the simulated participants of a dataset, or None where none is noted.

    Returns
    -------
    DataFrame or None
        One row a participant: ``participant_id`` (str), ``weight_c``, ``weight_d``, ``ratio`` (weight_d / weight_c),
        ``exponent`` (of the compressive response), ``noise_sd`` (slider units). The first three are NaN for an observer
        that looked at the images: what it saw is not made of c and d. What else is noted, such as ``lapse_rate``, has
        a column of its own, empty where an observer lacks it.

    Raises
    ------
    GlossError
        The file is there but cannot be read.

    Examples
    --------
    >>> read_simulated_observers("study")["ratio"].median()  # doctest: +SKIP
    1.78
    """
    path = Path(folder) / SIMULATED_OBSERVERS_FILE
    if not path.exists():
        return None
    observers = _observers(path)
    nothing = dict.fromkeys(_COLUMNS, float("nan"))
    return pd.DataFrame([{"participant_id": name, **nothing, **parameters} for name, parameters in observers.items()])


def _observers(path: Path) -> dict[str, dict[str, Any]]:
    if not path.exists():
        return {}
    document = read_json(path, what="list of simulated observers")
    if document.get("format") != _FORMAT or document.get("version") != 1:
        raise GlossError(
            f"'{path}' has format '{document.get('format')}', version {document.get('version')}; "
            f"this version reads '{_FORMAT}', version 1. Install the glossspace that wrote it."
        )
    observers: dict[str, dict[str, Any]] = document.get("observers", {})
    if not isinstance(observers, dict) or not all(_is_observer(parameters) for parameters in observers.values()):
        raise GlossError(
            f"'{path}' is damaged: each of its observers must have the numbers {', '.join(_PARAMETERS)}. Restore it."
        )
    return observers


def _is_observer(parameters: Any) -> bool:
    return (
        isinstance(parameters, dict)
        and all(_is_number(parameters.get(name)) for name in _PARAMETERS)
        and all(_is_number(parameters[name]) for name in _COLUMNS if name in parameters)
    )


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _short(value: Any) -> str:
    return f"{value:.4g}" if _is_number(value) else str(value)
