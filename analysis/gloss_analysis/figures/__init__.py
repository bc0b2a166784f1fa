"""The figures of the gloss paper, drawn from a run; each function returns a matplotlib figure and touches no file."""

from gloss_analysis.figures.examples import draw_city_map, draw_colour_circle, draw_participant_weights
from gloss_analysis.figures.gloss import draw_composite, draw_envelope, draw_gloss_space, draw_ratings
from gloss_analysis.figures.scaling import (
    draw_axis_ratios,
    draw_configuration,
    draw_identity_configuration,
    draw_rotation_cost,
    draw_stress_curve,
)

__all__ = [
    "draw_axis_ratios",
    "draw_city_map",
    "draw_colour_circle",
    "draw_composite",
    "draw_configuration",
    "draw_envelope",
    "draw_gloss_space",
    "draw_identity_configuration",
    "draw_participant_weights",
    "draw_ratings",
    "draw_rotation_cost",
    "draw_stress_curve",
]
