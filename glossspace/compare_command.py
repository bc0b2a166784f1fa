"""Sub-command `gloss compare`."""

from dataclasses import asdict
from typing import Any

import pandas as pd

from glossspace.console import JsonFlag, note, print_json, print_table
from glossspace.metric.comparison import SpaceComparison, compare_spaces
from glossspace.named_space import named_space, note_simulated_space

__all__ = ["compare"]


def compare(a: str, b: str, /, *, json: JsonFlag = False) -> None:
    """Where two gloss spaces differ by more than their uncertainty.

    Compares the weight of d, the axis functions, the ranges of paints that were
    judged, and distances over a grid of the paints that both cover.

    Examples:

        gloss compare glossy.json matte.json

        gloss compare gloss-space.json paper --json

    Parameters
    ----------
    a
        A gloss-space.json, or the word paper for the gloss paper's space.
    b
        The other one.
    """
    spaces = {"a": named_space(a), "b": named_space(b)}
    found = compare_spaces(spaces["a"], spaces["b"])
    for space in spaces.values():
        note_simulated_space(space)
    if json:
        names = {key: {"file": file, "name": spaces[key].name} for key, file in (("a", a), ("b", b))}
        print_json(names | _document(found))
        return
    _print(found, spaces["a"].name, spaces["b"].name)


def _document(found: SpaceComparison) -> dict[str, Any]:
    document = asdict(found)
    if found.distances is not None:
        for key in ("paint_1", "paint_2"):
            document["distances"][key] = getattr(found.distances, key)._asdict()
    return document


def _print(found: SpaceComparison, a: str, b: str) -> None:
    print(f"a: {a}\nb: {b}")
    rows: list[tuple[Any, ...]] = []
    estimates = {"weight of d over that of c": found.weight} | {
        f"relative slope of ratings along {axis}": one for axis, one in found.slopes.items()
    }
    for name, one in estimates.items():
        low, high = one.ratio_ci95 or (float("nan"), float("nan"))
        differs = {True: "yes", False: "no", None: "not known"}[one.differs]
        rows.append((name, one.a, one.b, one.ratio, low, high, differs))
    print_table(pd.DataFrame(rows, columns=["quantity", "a", "b", "b / a", "95 % from", "95 % to", "they differ"]))
    fits = [(f"r² of ratings along {axis}", *pair) for axis, pair in found.r_squared.items()]
    if fits:
        print_table(pd.DataFrame(fits, columns=["quantity", "a", "b"]))
    ranges = [
        (one.parameter, _span(one.a), _span(one.b), _span(one.common), float("nan") if one.share is None else one.share)
        for one in found.ranges
    ]
    print_table(pd.DataFrame(ranges, columns=["judged paints", "a", "b", "common", "common part"]))
    if found.distances is not None:
        worst = found.distances
        paints = ["{:.4g}, {:.4g}, {:.4g}".format(*paint) for paint in (worst.paint_1, worst.paint_2)]
        print(
            f"Distances of {worst.n_paints} paints, each space at a scale of its own: b / a is furthest from 1 with "
            f"{worst.ratio:.4g}, between the paints ({paints[0]}) and ({paints[1]}); the typical pair (median) differs "
            f"by a factor of {worst.median_factor:.4g}."
        )
    for remark in found.remarks:
        note(remark)


def _span(span: tuple[float, float] | None) -> str:
    return "–" if span is None else f"{span[0]:g} to {span[1]:g}"
