"""The table "paper / this run / why they differ"."""

from dataclasses import dataclass

import numpy as np

from gloss_analysis.study.analysis import StudyAnalysis
from gloss_analysis.study.examples import CityMap
from glossspace.metric import contrast_gloss, max_contrast_gloss

__all__ = ["Comparison", "compare_with_paper"]


@dataclass(frozen=True)
class Comparison:
    """One row: a quantity, what the gloss paper prints, what this run gives, and why they differ or agree.

    `judged` says whether the run's value comes from the participants' judgements.
    """

    quantity: str
    paper: str
    run: str
    why: str
    judged: bool = False


def compare_with_paper(analysis: StudyAnalysis, cities: CityMap) -> list[Comparison]:
    """Set the paper's numbers beside this run's, with the reason for each difference."""
    truth = analysis.study.true_ratios
    embodied = (
        "The simulated observers embody the paper's metric: recovering it tests the software, not the paper."
        if analysis.study.embodied
        else f"Other observers ({analysis.study.observers}), other images."
    )
    fit = analysis.fit.confirmatory
    ratio = f"{fit.population_ratio:.2f}"
    if fit.population_ci95 is not None:
        ratio += f" (95 % interval {fit.population_ci95[0]:.2f} to {fit.population_ci95[1]:.2f})"
    true = [truth[name] for name in fit.participants if name in truth]
    if true:
        ratio += f"; true geometric mean of the simulated observers {np.exp(np.mean(np.log(true))):.2f}"
    stress = ", ".join(f"{solution.stress1:.3f}" for solution in analysis.dimensionality.curve)
    return [
        Comparison(
            "Stress, 1 to 5 dimensions",
            "a steep fall from 1 to 2, a slow one after (fig. 5, no numbers)",
            stress,
            f"Kruskal's Stress-1, ordinal, ties primary, each participant at a scale of its own. {embodied}",
            judged=True,
        ),
        Comparison("Weight of d in eq. 5", "1.78", ratio, embodied, judged=True),
        Comparison(
            "r² of ratings on d (fig. 7)",
            ".96; polynomials gain less than .01",
            _r_squared(analysis, "d"),
            embodied + (" Their noise and compression were chosen, not measured." if analysis.study.embodied else ""),
            judged=True,
        ),
        Comparison(
            "r² of ratings on c (fig. 8)",
            ".94",
            _r_squared(analysis, "c"),
            embodied + " Which 24 of the 30 possible stimuli the paper used is not known.",
            judged=True,
        ),
        Comparison(
            "Axes of the two-dimensional solution (fig. 6)",
            "read along the diagonals of the picture",
            _angles(analysis),
            "A weighted solution fixes its axes up to order and sign; the paper's picture seems to be turned. "
            + embodied,
            judged=True,
        ),
        Comparison(
            "c of the gray paint ρs .066 (fig. 11)",
            ".087",
            f"{float(contrast_gloss(0.193, 0.066)):.5f}",
            "Eq. 4; equal after rounding.",
        ),
        Comparison(
            "c of the white paint ρs .099 (fig. 12)",
            ".057",
            f"{float(contrast_gloss(0.767, 0.099)):.4f}",
            "Eq. 4; the paper cut the last digit off instead of rounding.",
        ),
        Comparison(
            "Δd that equals Δc = .04 (fig. 11)", ".22", f"{0.04 / 1.78:.4f}", "A misprint: 0.04/1.78 is 0.0225."
        ),
        Comparison(
            "Ends of the envelope (fig. 10)",
            "c = 1 at L = 0, c = 0 at L = 100",
            f"{float(max_contrast_gloss(0.0)):g} and {float(max_contrast_gloss(100.0)):.1g}",
            "ρd + ρs ≤ 1 in eq. 4.",
        ),
        Comparison(
            "Stress of ten US cities in the plane (fig. 3)",
            "about 0",
            f"{cities.curve[1].stress1:.4f}; largest error of a distance {cities.largest_error_miles:.0f} miles",
            "Ratio level. The Earth is round. New York to Seattle is 2408 miles here; the paper prints 2406.",
        ),
    ]


def _angles(analysis: StudyAnalysis) -> str:
    reading = analysis.axes
    parts = [
        f"{axis} lies {reading.vectors[axis].angle_deg[dimension]:.1f}° from dimension {dimension + 1}"
        for axis, dimension in zip(("c", "d"), reading.order, strict=True)
    ]
    return ", ".join(parts)


def _r_squared(analysis: StudyAnalysis, axis: str) -> str:
    line, ends = analysis.fit.regressions[axis], analysis.r_squared_intervals[axis]
    gain = max((value - line.r_squared for value in line.polynomial_r_squared), default=0.0)
    sure = "" if ends is None else f" (95 % interval over participants {ends[0]:.3f} to {ends[1]:.3f})"
    return f"{line.r_squared:.3f}{sure}; polynomials up to order 3 gain {gain:.4f}"
