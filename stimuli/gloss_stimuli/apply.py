"""A gloss space applied (section 5 of the gloss paper): ring and matched spheres as stimulus sets with figures."""

import json
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from gloss_stimuli.applied_figures import draw_isogloss_ring, draw_matched_spheres, save_figure
from gloss_stimuli.applied_set import AppliedSet
from gloss_stimuli.isogloss_ring import PAPER_RADII, PAPER_REFERENCE, RING, isogloss_ring
from gloss_stimuli.matched_spheres import MATCHED, PAPER_RHO_DS, PAPER_WHITE, matched_spheres
from gloss_stimuli.render import render_set
from gloss_stimuli.sets import StimulusList
from glossspace.console import note
from glossspace.errors import GlossError
from glossspace.files import read_json, read_toml, write_text
from glossspace.metric import PAPER_SPACE, GlossSpace, Paint
from glossspace.stimulus_set import StimulusSet

__all__ = ["TABLE", "render_isogloss_ring", "render_matched_spheres"]

TABLE = "stimuli.csv"
"""The file of a set that holds where its stimuli lie in the space."""

LIST = "stimuli.toml"

# What tells a table and a list that were made here from those of somebody else.
_TABLE_COLUMNS = ("stimulus", "rho_d", "rho_s", "alpha", "c", "d", "distance")
_NAMES = (RING, MATCHED)


def render_isogloss_ring(
    out: str | Path,
    *,
    space: GlossSpace = PAPER_SPACE,
    reference: Paint = PAPER_REFERENCE,
    radii: Sequence[float] = PAPER_RADII,
    n: int = 8,
    **rendering: Any,
) -> StimulusSet:
    """Render `isogloss_ring` and draw it: figure 11 of the gloss paper.

    Parameters
    ----------
    out : path
        The folder to fill: a stimulus set, with `stimuli.csv` (where its paints lie in the space), `stimuli.toml` (the
        same paints as a list for `gloss render`), and the figure as `ring.png`, `.svg` and `.pdf`. Called again,
        only what changed is rendered, and pictures of paints that are no longer in the set are removed. A `stimuli.csv`
        or `stimuli.toml` of somebody else is not replaced.
    space, reference, radii, n
        See `gloss_stimuli.isogloss_ring.isogloss_ring`.
    rendering
        Options of `gloss_stimuli.render_set`, such as `size`, `quality`, `seed`, `scene`, `cache`.

    Returns
    -------
    StimulusSet

    Raises
    ------
    GlossError
        A parameter is impossible, or see `render_set`.
    """
    applied = isogloss_ring(space, reference=reference, radii=radii, n=n)
    rendered = _render(applied, Path(out), rendering)
    save_figure(draw_isogloss_ring(applied, rendered), Path(out) / RING)
    return rendered


def render_matched_spheres(
    out: str | Path,
    *,
    space: GlossSpace = PAPER_SPACE,
    reference: Paint = PAPER_WHITE,
    rho_ds: Sequence[float] = PAPER_RHO_DS,
    **rendering: Any,
) -> StimulusSet:
    """Render `matched_spheres` and draw them: figure 12 of the gloss paper.

    Parameters
    ----------
    out : path
        As for `render_isogloss_ring`, with the figure as `matched.png`, `.svg` and `.pdf`.
    space, reference, rho_ds
        See `gloss_stimuli.matched_spheres.matched_spheres`.
    rendering
        Options of `gloss_stimuli.render_set`.

    Returns
    -------
    StimulusSet

    Raises
    ------
    GlossError
        A parameter is impossible, or see `render_set`.
    """
    applied = matched_spheres(space, reference=reference, rho_ds=rho_ds)
    rendered = _render(applied, Path(out), rendering)
    save_figure(draw_matched_spheres(applied, rendered), Path(out) / MATCHED)
    return rendered


def _render(applied: AppliedSet, out: Path, rendering: dict[str, Any]) -> StimulusSet:
    _check_replaceable(out)
    for remark in applied.remarks:
        note(remark)
    # The set renderer reads lists from files; that of a mistaken call must not claim the folder.
    with tempfile.TemporaryDirectory() as folder:
        wanted = Path(folder) / LIST
        wanted.write_text(_as_toml(applied.stimuli), encoding="utf-8")
        rendered = render_set(wanted, out, **rendering)
    _remove_former(out, kept={stimulus.name for stimulus in rendered.stimuli})
    write_text(out / LIST, _as_toml(applied.stimuli))
    write_text(out / TABLE, applied.table.to_csv(index=False, lineterminator="\n"))
    return rendered


def _check_replaceable(out: Path) -> None:
    """Refuse a folder with a table or list of the same name that was not made here: it may be somebody's data."""
    for name, is_ours in ((TABLE, _is_our_table), (LIST, _is_our_list)):
        if (out / name).exists() and not is_ours(out / name):
            raise GlossError(
                f"'{out / name}' is there, was not made by this command, and would be replaced. Choose another folder "
                "for --out."
            )


def _is_our_table(path: Path) -> bool:
    try:
        return set(_TABLE_COLUMNS) <= set(pd.read_csv(path, nrows=0).columns)
    except (OSError, ValueError):
        return False


def _is_our_list(path: Path) -> bool:
    try:
        return read_toml(path, what="stimulus list").get("name") in _NAMES
    except GlossError:
        return False


def _as_toml(wanted: StimulusList) -> str:
    # TOML has no escape for a character such as a bell in the name of somebody's space.
    title = "".join(character if character.isprintable() else " " for character in wanted.title)
    head = (
        f'format = "glossspace/stimulus-list"\nversion = 1\nname = "{wanted.name}"\n'
        f"title = {json.dumps(title, ensure_ascii=False)}\n"
    )
    rows = (
        f"\n[[stimulus]]\nrho_d = {stimulus.rho_d!r}\nrho_s = {stimulus.rho_s!r}\nalpha = {stimulus.alpha!r}\n"
        for stimulus in wanted.stimuli
    )
    return head + "".join(rows)


def _remove_former(out: Path, *, kept: set[str]) -> None:
    """Remove the pictures of paints that an older table of this folder names, and the set no longer holds."""
    try:
        former = set(pd.read_csv(out / TABLE, usecols=["stimulus"], dtype=str)["stimulus"].dropna())
    except (OSError, ValueError):
        return  # nothing was here, or a table that is not ours
    for record in (out / "finished").glob("*.json"):
        if record.stem in former - kept:
            try:
                entry = read_json(record, what="record of a finished stimulus")["entry"]
                files = [out / entry[kind] for kind in entry["sha256"]]
            except (GlossError, KeyError, TypeError):
                continue  # damaged: nothing is known of its files
            for file in (*files, record):
                file.unlink(missing_ok=True)
