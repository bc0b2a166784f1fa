"""Weighted non-metric multidimensional scaling: three-way, with any level of measurement, ties, gaps and weights."""

from gloss_analysis.mds.disparities import LEVELS, TIES, Level, Ties
from gloss_analysis.mds.restriction import FREE, Restriction, external_variables, fixed_stimuli
from gloss_analysis.mds.search import scale
from gloss_analysis.mds.solution import MODELS, MdsSolution, Model, load_solution

__all__ = [
    "FREE", "LEVELS", "MODELS", "TIES", "Level", "MdsSolution", "Model", "Restriction", "Ties", "external_variables",
    "fixed_stimuli", "load_solution", "scale",
]  # fmt: skip
