"""A table's gaps, and the rows that it comes from."""

import numpy as np
import pytest

from glossspace.errors import GlossError
from glossspace.reflectance import Tabulated, grid_from_rows
from tests.glossspace.reflectance.tables import AXIS, HALF_TURN, table_of, trilinear


def with_gaps(function, places, **options):
    values = function(*np.meshgrid(AXIS, AXIS, HALF_TURN, indexing="ij"))
    for place in places:
        values[place] = np.nan
    return Tabulated(AXIS, AXIS, HALF_TURN, values, **options)


def test_gaps_are_refused_with_their_number_and_place():
    with pytest.raises(GlossError, match="has 2 gaps .*incidence 10°, exitance 15°, azimuth 0°.*nearest or along-exit"):
        with_gaps(trilinear, [(2, 3, 0), (4, 5, 12)])


@pytest.mark.parametrize("gaps", ["along-exitant", "reciprocal"])
def test_gaps_of_a_linear_reciprocal_table_are_filled_exactly(gaps):
    filled = with_gaps(trilinear, [(2, 3, 0), (4, 5, 7)], gaps=gaps)
    np.testing.assert_allclose(filled.values, table_of(trilinear).values, rtol=1e-12)


def test_the_reciprocal_fill_of_a_whole_turn_looks_to_the_other_side():
    whole = np.linspace(0, 360, 25)
    full = table_of(lambda i, o, p: 1 + (o - i) / 180 * np.sin(np.radians(p)), phi=whole)
    values = full.values.copy()
    values[2, 9, 5] = np.nan
    filled = Tabulated(AXIS, AXIS, whole, values, gaps="reciprocal")
    np.testing.assert_allclose(filled.values, full.values, rtol=1e-12)


def test_the_nearest_fill_takes_a_neighbour():
    filled = with_gaps(trilinear, [(2, 3, 5)], gaps="nearest")
    whole = table_of(trilinear)
    around = [whole.values[2 + a, 3 + b, 5 + c] for a, b, c in [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0),
                                                               (0, 0, 1), (0, 0, -1)]]  # fmt: skip
    assert filled.values[2, 3, 5] in around
    known = np.ones(whole.values.shape, bool)
    known[2, 3, [5, 19]] = False  # azimuth 285° mirrors 75°
    np.testing.assert_array_equal(filled.values[known], whole.values[known])


def test_the_nearest_fill_looks_in_each_wavelength_for_itself():
    values = np.repeat(table_of(trilinear).values[:, :, : HALF_TURN.size, None], 2, axis=3) * [1.0, 2.0]
    values[2, 3, 5, 0] = values[6, 7, 8, 1] = np.nan
    filled = Tabulated(AXIS, AXIS, HALF_TURN, values, gaps="nearest").values
    # A neighbour is 5° in one polar angle or 15° in azimuth away, so it differs by a hundredth at most.
    assert filled[2, 3, 5, 0] == pytest.approx(trilinear(10.0, 15.0, 75.0), abs=0.01)
    assert filled[6, 7, 8, 1] == pytest.approx(2 * trilinear(30.0, 35.0, 120.0), abs=0.02)


def test_what_a_fill_cannot_reach_is_refused():
    with pytest.raises(GlossError, match="has 2 gaps .*that the fill 'reciprocal' leaves.*nearest or along-exitant"):
        with_gaps(trilinear, [(2, 3, 0), (3, 2, 0)], gaps="reciprocal")
    with pytest.raises(GlossError, match="that the fill 'along-exitant' leaves"):
        with_gaps(trilinear, [(2, slice(None), 0)], gaps="along-exitant")
    with pytest.raises(GlossError, match="that the fill 'nearest' leaves"):
        with_gaps(trilinear, [(slice(None),) * 3], gaps="nearest")


def test_rows_in_any_order_make_the_table():
    grid = np.stack([a.ravel() for a in np.meshgrid([0, 45, 90], [0, 30, 90], [0, 90, 180], indexing="ij")])
    order = np.random.default_rng(1).permutation(grid.shape[1])
    values = trilinear(*grid)
    table = Tabulated(*grid_from_rows(*grid[:, order], values[order]))
    np.testing.assert_array_equal(table.values[:, :, :3].ravel(), values)
    missing = grid_from_rows(*grid[:, order[1:]], values[order[1:]])
    with pytest.raises(GlossError, match="has 1 gap "):
        Tabulated(*missing)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        (([0, 0], [0, 0], [0, 0], [1, 2]), "The directions 0°, 0°, 0° .*stand in more than one row. Average them"),
        (([0, 45, 45], [0, 30, 30], [0] * 3, [1, 2, 3]), "The directions 45°, 30°, 0° "),
        (([0, 0], [0], [0, 0], [1, 2]), "equally many angles and values"),
        (([0, np.nan], [0, 1], [0, 0], [1, 2]), "not a finite number"),
    ],
)
def test_impossible_rows_are_refused(rows, message):
    with pytest.raises(GlossError, match=message):
        grid_from_rows(*rows)
