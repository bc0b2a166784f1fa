"""The companion paper on the virtual glossmeter: its table 2 and figure 6 again, and the lobes that it reads."""

from functools import cache

import pandas as pd

from gloss_analysis.report.pictures import Picture, drawn
from glossspace.instruments.figures import figure6, lobe_surface, polar_lobes
from glossspace.instruments.table2 import table2_cells, table2_rmse
from glossspace.reflectance import CookTorrance, Ward

__all__ = ["glossmeter_pictures", "glossmeter_rows", "glossmeter_tables", "glossmeter_words"]

# Rouge Tiziano, as table 2 has it for both models.
_WARD, _COOK_TORRANCE = Ward(1.0, 0.332), CookTorrance(scale=21.5, slope=0.6, n=1.32)


def glossmeter_pictures() -> dict[str, Picture]:
    """Figure 6, and lobes as polar plots and as a surface. No observer took part."""
    return {
        "copper": drawn(
            "glossmeter-fig6-copper",
            figure6(),
            "Spectrum of copper under D65, and its index of refraction",
            "Figure 6 of the glossmeter paper: unpolished copper at 60° under D65, by Cook and Torrance with two "
            "measured tables of n and k.",
        ),
        "lobes": drawn(
            "glossmeter-lobes",
            polar_lobes({"Ward, α = .332": _WARD, "Cook–Torrance, m = .6": _COOK_TORRANCE}),
            "Polar plots of two reflectance lobes at two angles of incidence",
            "KKX Rouge Tiziano as table 2 has it: BRDF times cosine in the plane of incidence, each over its maximum.",
        ),
        "lobe_surface": drawn(
            "glossmeter-lobe-surface",
            lobe_surface(_WARD),
            "Surface whose distance from the centre is the reflected light in each direction",
            "The same Ward lobe in space, light from 45°.",
        ),
    }


def glossmeter_tables() -> dict[str, pd.DataFrame]:
    """Table 2, cell by cell, and its RMSE columns."""
    cells = _cells()
    return {"glossmeter-table2": cells, "glossmeter-table2-rmse": table2_rmse(cells)}


@cache
def _cells() -> pd.DataFrame:
    """They are the same in every report."""
    return table2_cells()


def glossmeter_rows(tables: dict[str, pd.DataFrame]) -> list[dict[str, object]]:
    """Rows of table 2 as the page shows them: one a sample and model, with its three cells and its RMSE."""
    rmse = tables["glossmeter-table2-rmse"].set_index(["sample", "model"])
    rows = []
    for (sample, model), cells in tables["glossmeter-table2"].groupby(["sample", "model"], sort=False):
        notes = dict.fromkeys(note for note in cells["note"] if note)
        rows.append(
            {
                "sample": sample,
                "model": model,
                "cells": cells.to_dict("records"),
                "rmse": rmse.loc[(sample, model)].to_dict(),
                "albedo": float(cells["albedo"].max()),
                "note": "; ".join(notes),
            }
        )
    return rows


def glossmeter_words(tables: dict[str, pd.DataFrame]) -> str:
    """What table 2 says of itself, in a sentence made from its numbers."""
    cells, rmse = tables["glossmeter-table2"], tables["glossmeter-table2-rmse"]
    parts = []
    for model, own in cells.groupby("model", sort=False):
        parts.append(f"{int(own['reproduced'].sum())} of {len(own)} cells of the {model} rows")
    gaining = cells.loc[cells["albedo"] > 1, "sample"].nunique()
    off = float((rmse["printed"] - rmse["from_printed_cells"]).abs().max())
    return (
        f"In the paper's own reading {' and '.join(parts)} come back within the rounding of what is printed. Its RMSE "
        f"columns follow from its printed cells to {off:.3f}. Samples with a row that reflects more than it receives: "
        f"{gaining}."
    )
