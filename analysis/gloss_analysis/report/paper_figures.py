"""Every figure of the gloss paper, and where its counterpart is in the report, or why there is none."""

from collections.abc import Mapping
from dataclasses import dataclass

from gloss_analysis.report.pictures import Picture

__all__ = ["PaperFigure", "paper_figures"]


@dataclass(frozen=True)
class PaperFigure:
    """One figure of the paper.

    Attributes
    ----------
    number : int
    shows : str
        What it shows in the paper.
    key : str or None
        The picture of this report that is its counterpart; None where there is none.
    here : str
        What the counterpart is, or why there is none.
    """

    number: int
    shows: str
    key: str | None
    here: str


_COUNTERPARTS = (
    (2, "US map from distances", "map", "scaled anew, with the table's columns put straight"),
    (3, "Stress of the map", "map_stress", "from this engine"),
    (4, "Stimuli of Experiment 1", "composite", "rendered anew"),
    (5, "Stress of Experiment 1", "stress", "from this run's judgements, beside random ones"),
    (6, "Two-dimensional solution", "plane", "from this run's judgements, with 95 % regions"),
    (7, "Ratings against d", "doi", "from this run's ratings, with intervals"),
    (8, "Ratings against c", "contrast", "from this run's ratings, with intervals"),
    (9, "The gloss space", "space", "with the weight of this run and its interval"),
    (10, "Envelope of gloss space", "envelope", "from eq. 4: no judgements"),
    (11, "Isogloss contours", "ring", "rendered from the fitted space"),
    (12, "Matched spheres", "matched", "rendered from the fitted space"),
)
_WITHOUT = (
    (1, "Coffee mugs of different gloss", "a scene of its own, without data; the stimuli here are spheres"),
    (13, "Prototype of a gloss picker", "an interactive tool, not a result"),
    (14, "Two mugs matched in gloss", "a scene of its own, made in another program, without data"),
)


def paper_figures(pictures: Mapping[str, Picture]) -> list[PaperFigure]:
    """Say for each of the paper's fourteen figures where it is here.

    Parameters
    ----------
    pictures : mapping of str to Picture
        Those of the report.

    Returns
    -------
    list of PaperFigure
        In the order of the paper.
    """
    rows = [PaperFigure(number, shows, None, f"None: {why}.") for number, shows, why in _WITHOUT]
    for number, shows, key, here in _COUNTERPARTS:
        if key in pictures:
            rows.append(PaperFigure(number, shows, key, f"{here[0].upper()}{here[1:]}."))
        else:
            rows.append(PaperFigure(number, shows, None, "None: not rendered in this study."))
    return sorted(rows, key=lambda row: row.number)
