"""The room as cells: against functions of a point that know nothing of cells."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gloss_stimuli.exact.room import Room, build_room, cell_at, coordinate, frame, leave_box
from tests.stimuli.exact.rooms import CEILING, Enclosure, inward, rectangle, scene_of

SCENES = {
    "shipped": scene_of(),
    "cut checks": scene_of(box={"check_size": 0.35}),
    "small light inside a check": scene_of(light={"center_xz": [0.05, 0.8], "size_xz": [0.2, 0.1]}),
    "light along checks": scene_of(light={"center_xz": [0.0, 0.75], "size_xz": [1.5, 1.5]}),
    "sphere aside, odd sizes": scene_of(
        box={"minimum": [-2.0, -1.0, -1.1], "maximum": [1.3, 1.7, 3.05], "check_size": 0.61},
        sphere={"center": [0.5, -0.3, 0.4], "radius": 0.45},
        light={"center_xz": [-0.3, 1.1], "size_xz": [1.9, 0.7]},
    ),
}
ROOMS = {name: build_room(scene, width_over_gap=1.1) for name, scene in SCENES.items()}

each_room = pytest.mark.parametrize("name", SCENES)
unit = st.floats(0, 1)


def planes(enclosure: Enclosure) -> list[float]:
    return [(enclosure.low, enclosure.high)[wall % 2][wall // 2] for wall in range(6)]


def point_on(enclosure: Enclosure, wall: int, a: float, b: float) -> np.ndarray:
    """Point of a wall, at fractions of its extent along the next axis and the one after it."""
    point, axis = np.array(enclosure.low), wall // 2
    extent = enclosure.high - enclosure.low
    point[axis] = planes(enclosure)[wall]
    point[(axis + 1) % 3] += a * extent[(axis + 1) % 3]
    point[(axis + 2) % 3] += b * extent[(axis + 2) % 3]
    return point


def inner_points(room: Room, cell: int, wall: int, plane: float, count: int) -> np.ndarray:
    """Random points of a cell, its corners (a millionth inside) among them."""
    u = np.random.default_rng(cell).random((count, 2))
    u[:4] = [[1e-6, 1e-6], [1e-6, 1 - 1e-6], [1 - 1e-6, 1e-6], [1 - 1e-6, 1 - 1e-6]]
    along = room.cell_low[cell] + u * (room.cell_high[cell] - room.cell_low[cell])
    points = np.full((count, 3), plane)
    points[:, (wall // 2 + 1) % 3], points[:, (wall // 2 + 2) % 3] = along.T
    return points


@each_room
def test_cells_tile_every_wall(name: str) -> None:
    room, enclosure = ROOMS[name], Enclosure(SCENES[name])
    for wall in range(6):
        axis = wall // 2
        cells = np.arange(room.wall_start[wall], room.wall_start[wall + 1])
        assert (room.cell_wall[cells] == wall).all()
        count_a, count_b = room.cells_along[wall]
        assert len(cells) == count_a * count_b
        # Cell number = first + b × (cells along a) + a, and each begins where the one before it ends, to the bit.
        for side in (0, 1):
            along = (axis + 1 + side) % 3
            low = room.cell_low[cells, side].reshape(count_b, count_a)
            high = room.cell_high[cells, side].reshape(count_b, count_a)
            low, high = (low[0], high[0]) if side == 0 else (low[:, 0], high[:, 0])
            assert low[0] == enclosure.low[along]
            assert high[-1] == enclosure.high[along]
            assert (low[1:] == high[:-1]).all()
            assert (low < high).all()
        grid = room.cell_low[cells].reshape(count_b, count_a, 2)
        assert (grid[..., 0] == grid[:1, :, 0]).all()
        assert (grid[..., 1] == grid[:, :1, 1]).all()
    assert room.wall_start[0] == 0
    assert room.wall_start[6] == len(room.cell_wall) == len(room.reflectance) == len(room.is_light)


@each_room
def test_paint_is_one_in_a_cell_and_that_of_its_points(name: str) -> None:
    # Corners a millionth of a cell inside: so no edge of a check or of the light runs through a cell.
    room, enclosure = ROOMS[name], Enclosure(SCENES[name])
    for cell, wall in enumerate(room.cell_wall):
        points = inner_points(room, cell, wall, planes(enclosure)[wall], 12)
        walls = np.full(len(points), wall)
        assert (enclosure.reflectance(walls, points) == room.reflectance[cell]).all(), (cell, wall)
        assert (enclosure.in_light(walls, points) == room.is_light[cell]).all(), (cell, wall)


@each_room
def test_light_cells_make_up_the_light(name: str) -> None:
    room = ROOMS[name]
    areas = (room.cell_high - room.cell_low).prod(1)
    assert (room.cell_wall[room.is_light] == CEILING).all()
    # double rounding of a sum of at most 40 areas
    assert areas[room.is_light].sum() == pytest.approx(np.prod(SCENES[name].light.size_xz), rel=1e-13)
    assert (room.reflectance[room.is_light] == 0).all()


def test_corner_check_is_dark_and_its_neighbour_light() -> None:
    room, scene = ROOMS["shipped"], SCENES["shipped"]
    for wall in range(6):
        start = room.wall_start[wall]
        assert room.reflectance[start] == scene.box.dark_reflectance
    # The side wall x = low is far from the sphere: its cells are the checks, 5 along y and 9 along z.
    side = room.reflectance[: room.wall_start[1]].reshape(9, 5)
    assert (side[::2, ::2] == 0.03).all()
    assert (side[1::2, 1::2] == 0.03).all()
    assert (side[::2, 1::2] == 0.767).all()
    assert (side[1::2, ::2] == 0.767).all()


def test_checks_under_the_sphere_are_split_as_worked_out_by_hand() -> None:
    # The floor is .75 below the center of a sphere of radius .5. Rows of checks of .5 along x, and their distance:
    # [-.25, .25] → .25, so 2 parts; [.25, .75] → hypot(.75, .25) - .5 = .29, 2 parts; [.75, 1.25] → .56, 1 part.
    room = build_room(SCENES["shipped"], width_over_gap=1.0)
    floor = slice(room.wall_start[2], room.wall_start[3])
    along_x = np.unique(room.cell_low[floor, 1])
    assert along_x == pytest.approx([-1.25, -0.75, -0.5, -0.25, 0, 0.25, 0.5, 0.75], abs=1e-15)
    # Along z: [-1, -.5] and [.5, 1] → hypot(.75, .5) - .5 = .40, 2 parts; the two above the center 2 each.
    along_z = np.unique(room.cell_low[floor, 0])
    assert along_z == pytest.approx(
        [-1.5, -1, -0.75, -0.5, -0.25, 0, 0.25, 0.5, 0.75, 1, 1.5, 2, 2.5], abs=1e-15
    )  # fmt: skip


@each_room
@pytest.mark.parametrize("width_over_gap", [0.5, 1.4, 1.9])
def test_no_cell_is_wider_than_its_distance_from_the_sphere_allows(name: str, width_over_gap: float) -> None:
    scene = SCENES[name]
    room, enclosure = build_room(scene, width_over_gap=width_over_gap), Enclosure(scene)
    for cell, wall in enumerate(room.cell_wall):
        corners = rectangle(wall, planes(enclosure)[wall], room.cell_low[cell], room.cell_high[cell])
        nearest = np.clip(enclosure.center, corners.min(0), corners.max(0))
        gap = np.linalg.norm(nearest - enclosure.center) - scene.sphere.radius
        # 1e-9: a width that equals the limit to within the rounding of its own edges is left whole
        assert (room.cell_high[cell] - room.cell_low[cell] <= width_over_gap * gap * (1 + 1e-9) + 1e-9).all()


def test_no_check_is_split_for_nothing() -> None:
    # With any width allowed the cells are the checks, 5 × 9 × 4 + 5 × 5 × 2 of them, and the light cuts the ceiling:
    # its edges ±.6 in x and .15, 1.35 in z lie inside checks, so 5 + 2 by 9 + 2.
    room = build_room(SCENES["shipped"], width_over_gap=np.inf)
    assert np.diff(room.wall_start).tolist() == [45, 45, 45, 77, 25, 25]


@each_room
def test_edge_cells_are_those_that_begin_within_half_a_check_of_the_plane(name: str) -> None:
    room, enclosure = ROOMS[name], Enclosure(SCENES[name])
    at = planes(enclosure)
    corners = np.array(
        [rectangle(w, at[w], room.cell_low[c], room.cell_high[c]) for c, w in enumerate(room.cell_wall)]
    )  # fmt: skip
    for wall in range(6):
        distance = np.abs(corners[..., wall // 2] - at[wall]).min(1)
        beside = room.cell_wall // 2 != wall // 2
        wanted = np.flatnonzero(beside & (distance < 0.5 * SCENES[name].box.check_size))
        listed = room.edge_cells[wall]
        assert listed[: len(wanted)].tolist() == wanted.tolist()
        assert (listed[len(wanted) :] == -1).all()
        assert listed[-1] == -1  # kernels stop there


@given(name=st.sampled_from(sorted(SCENES)), wall=st.integers(0, 5), a=unit, b=unit)
@settings(max_examples=150, deadline=None)  # the first example compiles
def test_cell_at_finds_the_cell_whose_ends_enclose_the_point(name: str, wall: int, a: float, b: float) -> None:
    room, enclosure = ROOMS[name], Enclosure(SCENES[name])
    point = point_on(enclosure, wall, a, b)
    cell, u, v = cell_at(room.box, room.grid, wall, *point)
    assert room.cell_wall[cell] == wall
    assert 0 <= u <= 1
    assert 0 <= v <= 1
    side = room.cell_high[cell] - room.cell_low[cell]
    back = room.cell_low[cell] + np.array([u, v]) * side
    along = point[[(wall // 2 + 1) % 3, (wall // 2 + 2) % 3]]
    # Coordinates give the point back to the rounding of numbers below 4.
    assert back == pytest.approx(along, abs=1e-14)


@each_room
def test_cell_at_knows_every_cell_by_its_middle(name: str) -> None:
    room, enclosure = ROOMS[name], Enclosure(SCENES[name])
    for cell, wall in enumerate(room.cell_wall):
        middle = rectangle(wall, planes(enclosure)[wall], room.cell_low[cell], room.cell_high[cell]).mean(0)
        found, u, v = cell_at(room.box, room.grid, int(wall), *middle)
        assert found == cell
        assert (u, v) == pytest.approx((0.5, 0.5), abs=1e-12)  # rounding of 4 over the narrowest cell, .03


@st.composite
def rays(draw: st.DrawFn) -> tuple[str, np.ndarray, np.ndarray]:
    """A room, a point in it or on a wall, and a direction, along an axis or in a plane of two now and then."""
    name = draw(st.sampled_from(sorted(SCENES)))
    enclosure = Enclosure(SCENES[name])
    point = enclosure.low + np.array([draw(unit) for _ in range(3)]) * (enclosure.high - enclosure.low)
    point = np.minimum(point, enclosure.high)
    wall = draw(st.none() | st.integers(0, 5))
    if wall is not None:
        point[wall // 2] = planes(enclosure)[wall]
    component = st.sampled_from([0.0, -0.0, 1.0, -1.0]) | st.floats(-1, 1)
    direction = np.array([draw(component) for _ in range(3)])
    length = np.linalg.norm(direction)
    if length < 1e-3:
        direction, length = np.array([0.0, -1.0, 0.0]), 1.0
    return name, point, direction / length


@given(rays())
@settings(max_examples=400, deadline=None)  # the first example compiles
def test_leave_box_ends_on_the_first_wall_ahead(ray: tuple[str, np.ndarray, np.ndarray]) -> None:
    name, point, direction = ray
    enclosure = Enclosure(SCENES[name])
    wall, *end = leave_box(ROOMS[name].box, *point, *direction)
    end = np.array(end)
    # These four make the wall and the point the only ones, up to rays through an edge of the box. 1e-12: the rounding
    # of numbers below 4 times a way of at most a few thousand steps' worth of a component of the direction.
    assert direction @ inward(wall) < 0
    assert end[wall // 2] == pytest.approx(planes(enclosure)[wall], abs=1e-12)
    assert (end >= enclosure.low - 1e-12).all()
    assert (end <= enclosure.high + 1e-12).all()
    way = (end - point) @ direction
    assert way >= -1e-12
    assert end == pytest.approx(point + way * direction, abs=1e-12)


@pytest.mark.parametrize("wall", range(6))
def test_rays_from_a_wall_leave_by_that_wall_only_when_they_point_out(wall: int) -> None:
    room, enclosure = ROOMS["shipped"], Enclosure(SCENES["shipped"])
    point = point_on(enclosure, wall, 0.3, 0.6)
    assert leave_box(room.box, *point, *-inward(wall))[0] == wall
    assert leave_box(room.box, *point, *-inward(wall))[1:] == pytest.approx(point, abs=0)
    assert leave_box(room.box, *point, *inward(wall))[0] == (wall ^ 1)
    for axis in {0, 1, 2} - {wall // 2}:
        for sign in (1.0, -1.0):
            along = np.zeros(3)
            along[axis] = sign
            grazed, *end = leave_box(room.box, *point, *along)
            assert grazed == 2 * axis + (sign > 0)
            assert end[wall // 2] == point[wall // 2]


@given(st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(-1, 1)))
@settings(max_examples=200, deadline=None)  # the first example compiles
def test_frame_is_right_handed_and_orthonormal(vector: tuple[float, float, float]) -> None:
    axis = np.array(vector)
    length = np.linalg.norm(axis)
    axis = axis / length if length > 1e-3 else np.array([0.0, 0.0, -1.0])
    first, second = np.array(frame(*axis)).reshape(2, 3)
    # Duff et al. 2017 report errors of a few ulp for their branch on the sign of z.
    assert np.array([first, second, axis]) @ np.array([first, second, axis]).T == pytest.approx(np.eye(3), abs=1e-14)
    assert np.cross(first, second) == pytest.approx(axis, abs=1e-14)


def test_coordinate_picks_the_axis() -> None:
    assert [coordinate(1.0, 2.0, 3.0, axis) for axis in range(3)] == [1.0, 2.0, 3.0]
