"""``dataset_description.json``: kept equal to the data files it describes, whatever a lab adds to it by hand."""

from pathlib import Path
from typing import Any

from glossspace.dataset.lock import locked
from glossspace.dataset.schema import DESCRIPTION_FILE, property_value
from glossspace.dataset.table import data_files, read_data_file
from glossspace.files import read_json, write_json

__all__ = ["update_description"]

_OUR_DESCRIPTION = "Judgements of apparent surface gloss on a slider from 0 to 100."


def update_description(folder: str | Path) -> Path:
    """Write ``dataset_description.json`` anew from the data files; what a lab has added to it stays.

    ``variableMeasured`` becomes exactly the union of the columns; ``measurementTechnique`` and the description say
    which participants are simulated. A description written by hand is kept. Several processes may call it at once.

    Raises
    ------
    GlossError
        A data file or the existing description cannot be read.
    """
    folder = Path(folder)
    path = folder / DESCRIPTION_FILE
    with locked(folder / ".dataset.lock"):
        known = read_json(path, what="dataset description") if path.exists() else {}
        described = _description(folder, known)
        if described != known:
            write_json(path, described)
    return path


def _description(folder: Path, known: dict[str, Any]) -> dict[str, Any]:
    columns: dict[str, None] = {}
    observers: dict[str, set[str]] = {}
    for data_file in data_files(folder):
        table = read_data_file(data_file)
        columns |= dict.fromkeys(table.header)
        for _, row in table.rows:
            observers.setdefault(row.get("observer", "unknown"), set()).add(row.get("participant_id", "?"))
    who = _observers_in_words(observers)
    document: dict[str, Any] = {
        "@context": "https://schema.org/",
        "@type": "Dataset",
        "name": f"Apparent gloss: {folder.resolve().name}",
        "description": "",
        "schemaVersion": "Psych-DS 1.5.0",
        **known,
        "measurementTechnique": who,
        "variableMeasured": _variables(list(columns), known.get("variableMeasured")),
    }
    if not document["description"] or str(document["description"]).startswith(_OUR_DESCRIPTION):
        document["description"] = f"{_OUR_DESCRIPTION} {who}"
    return document


def _observers_in_words(observers: dict[str, set[str]]) -> str:
    words = {
        "simulated": "Simulated observers (answers computed by a program, no person took part)",
        "human": "Human observers",
    }
    parts = [
        f"{words.get(kind, f'Observers of kind {kind}')}: participants {', '.join(sorted(who))}."
        for kind, who in sorted(observers.items())
    ]
    return " ".join(parts) or "No session is finished yet."


def _variables(columns: list[str], known: Any) -> list[Any]:
    listed = known if isinstance(known, list) else []
    by_hand = {item["name"]: item for item in listed if isinstance(item, dict) and "name" in item}
    return [by_hand.get(name, property_value(name)) for name in columns]
