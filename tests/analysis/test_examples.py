"""Real data with a known answer: US cities, Helm's colour chips, Ekman's colours."""

from pathlib import Path

import numpy as np
import pytest

from gloss_analysis.mds import scale
from gloss_analysis.study.examples import city_map, colour_circle
from tests.analysis.studies import named

REFERENCE = Path(__file__).parents[1] / "reference"


def test_the_us_map_comes_back_from_its_distances():
    cities = city_map()
    place = cities.positions_miles.set_index("city")
    # Seattle is north-west, Miami south-east; San Francisco and New York are 2571 airline miles apart (Table 1).
    assert place.loc["Seattle", "east"] < place.loc["Denver", "east"] < place.loc["New York", "east"]
    assert place.loc["Miami", "north"] < place.loc["Atlanta", "north"] < place.loc["Seattle", "north"]
    across = np.hypot(*(place.loc["San Francisco"] - place.loc["New York"]))
    assert across == pytest.approx(2571, abs=cities.largest_error_miles)
    # The plane is a good map of a curved country: the paper calls the error of Table 1 negligible.
    assert cities.largest_error_miles < 10
    assert cities.curve[0].stress1 > 50 * cities.curve[1].stress1


def test_helms_colours_lie_on_a_circle_and_deficient_observers_weigh_red_green_less():
    # Helm (1959); Borg and Groenen (2005), section 21.1: chips in hue order round a circle, and lower weights of the
    # red-green dimension for the four red-green deficient participants than for any with normal vision.
    circle = colour_circle()
    assert circle.in_hue_order
    assert circle.radius_variation < 0.15
    normal = circle.relative_weight[list(circle.normal)]
    deficient = circle.relative_weight[list(circle.deficient)]
    assert deficient.max() < normal.min()
    assert np.all(circle.solution.source_stress1 < 0.2)


def test_ekmans_colours_lie_on_a_horseshoe_in_the_order_of_their_wavelengths():
    # Ekman (1954), 14 spectral colours from 434 to 674 nm; Shepard (1962) found the hue circle in them.
    values = np.loadtxt(REFERENCE / "ekman.csv", delimiter=",", ndmin=2)
    solution = scale(named(values, 14), n_dims=2, model="identity")
    angle = np.unwrap(np.arctan2(solution.coordinates[:, 1], solution.coordinates[:, 0]))
    steps = np.diff(angle)
    assert np.all(steps > 0) or np.all(steps < 0)
    assert abs(steps.sum()) < 2 * np.pi  # a gap stays open between violet and red
