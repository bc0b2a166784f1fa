"""Figures of any scaling solution, and those of the gloss paper, drawn from a run.

Each function returns a matplotlib figure and touches no file, but for `save_mds_figures`.
"""

from gloss_analysis.figures.configuration import draw_configuration_of, draw_subject_weights
from gloss_analysis.figures.diagnostics import draw_shepard, draw_stress_curve, draw_stress_per_point
from gloss_analysis.figures.examples import draw_city_map, draw_colour_circle, draw_participant_weights
from gloss_analysis.figures.files import save_mds_figures
from gloss_analysis.figures.gloss import draw_composite, draw_envelope, draw_gloss_space, draw_ratings
from gloss_analysis.figures.hypotheses import draw_hypotheses
from gloss_analysis.figures.orthogonality import draw_orthogonality
from gloss_analysis.figures.scaling import (
    draw_axis_ratios,
    draw_configuration,
    draw_identity_configuration,
    draw_rotation_cost,
)
from gloss_analysis.figures.validation import draw_metric_stress, draw_predicted_against_judged

__all__ = [
    "draw_axis_ratios",
    "draw_city_map",
    "draw_colour_circle",
    "draw_composite",
    "draw_configuration",
    "draw_configuration_of",
    "draw_envelope",
    "draw_gloss_space",
    "draw_hypotheses",
    "draw_identity_configuration",
    "draw_metric_stress",
    "draw_orthogonality",
    "draw_participant_weights",
    "draw_predicted_against_judged",
    "draw_ratings",
    "draw_rotation_cost",
    "draw_shepard",
    "draw_stress_curve",
    "draw_stress_per_point",
    "draw_subject_weights",
    "save_mds_figures",
]
