"""What a session left on the disk, read back; and protocols with another design."""

import csv
import json

from gloss_experiments import read_protocol

__all__ = ["data_of", "lines_of", "rows_of", "with_design"]


def with_design(name, **design):
    """A shipped protocol with some keys of its design changed."""
    protocol = read_protocol(name)
    return protocol.model_copy(update={"design": protocol.design.model_copy(update=design)})


def data_of(dataset):
    """Content of the data files of a dataset, by name."""
    return {path.name: path.read_bytes() for path in sorted((dataset / "data").rglob("*.csv"))}


def rows_of(path):
    """Rows of a data file."""
    with path.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def lines_of(path):
    """Lines of a journal."""
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
