"""Where things stand on the screen: whole pixels, nothing overlaps, and what does not fit is refused."""

from itertools import combinations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gloss_experiments import read_protocol
from gloss_experiments.window.grid import largest_grid
from gloss_experiments.window.layout import arrange, visual_angle_deg
from gloss_experiments.window.pointer import ScriptedPointer, drag_steps, rating_steps, slider_x
from gloss_experiments.window.ranking_layout import arrange_ranking
from glossspace.errors import GlossError

PAIRWISE, DOI, RANKING = (read_protocol(name) for name in ("pairwise", "doi", "ranking"))
SXGA = (1280, 1024)


def test_the_visual_angle_of_the_paper():
    """3.2 degrees at 60 inches are 8.514 cm: 2 · 152.4 cm · tan 1.6 degrees."""
    assert visual_angle_deg(8514, pixel_pitch_mm=0.01, distance_cm=152.4) == pytest.approx(3.2, abs=1e-4)


@pytest.mark.parametrize("protocol", [PAIRWISE, DOI], ids=["pairwise", "magnitude"])
@pytest.mark.parametrize("size", [64, 256, 512])
def test_a_rating_is_in_whole_pixels_and_nothing_overlaps(protocol, size):
    layout = arrange(protocol, image_size_px=(size, size), window_size_px=SXGA)
    assert len(layout.images) == (2 if protocol.kind == "pairwise" else 1)
    assert sum(x for x, _ in layout.images) == 0, "symmetric about the centre"
    bottom_of_images = layout.images[0][1] - size // 2
    assert layout.question[1] > layout.images[0][1] + size // 2
    assert bottom_of_images > layout.slider[1] > layout.readout[1] > layout.button[1]
    assert layout.button[1] - layout.button_size[1] // 2 >= -512
    if protocol.kind == "pairwise":
        gap = layout.images[1][0] - layout.images[0][0] - size
        assert gap == pytest.approx(size * 0.8 / 3.2, abs=1)


@pytest.mark.parametrize(
    ("size", "window", "message"),
    [
        ((255, 256), SXGA, "The images are 255 x 256 pixels; both must be even"),
        ((640, 640), SXGA, "The trial needs 1440 x .* pixels, but the window has 1280 x 1024"),
    ],
)
def test_a_rating_that_does_not_fit_is_refused(size, window, message):
    with pytest.raises(GlossError, match=message):
        arrange(PAIRWISE, image_size_px=size, window_size_px=window)


def overlap(a, a_size, b, b_size):
    return all(2 * abs(a[axis] - b[axis]) < a_size[axis] + b_size[axis] for axis in (0, 1))


@pytest.mark.parametrize(("size", "n"), [(512, 26), (316, 26), (128, 6), (64, 40), (512, 2)])
def test_a_ranking_is_in_whole_pixels_and_nothing_overlaps(size, n):
    layout = arrange_ranking(RANKING, image_size_px=(size, size), window_size_px=SXGA, n_items=n)
    assert len(layout.waiting) == len(layout.ranks) == n
    pictures = [(place, layout.picture_size) for place in (*layout.waiting, *layout.ranks)]
    boxes = [(layout.reference, (size, size)), (layout.candidate, (size, size)), (layout.button, layout.button_size)]
    for (a, a_size), (b, b_size) in combinations(boxes + pictures, 2):
        assert not overlap(a, a_size, b, b_size)
    for place, (width, height) in boxes + pictures:
        assert abs(place[0]) + width / 2 <= 640
        assert abs(place[1]) + height / 2 <= 512
        assert width % 2 == height % 2 == 0
        assert all(isinstance(value, int) for value in place)
    assert layout.picture_size[0] <= size, "no picture is enlarged"
    for i in range(n):
        assert layout.rank_at(layout.ranks[i]) == layout.placed_at(layout.ranks[i]) == i
        assert layout.waiting_at(layout.waiting[i]) == i
        assert layout.rank_at(layout.waiting[i]) is None


@pytest.mark.parametrize(
    ("size", "n", "message"),
    [
        ((255, 256), 6, "both must be even"),
        ((640, 640), 6, "The ranking of 6 images of 640 x 640 pixels does not fit into the window of 1280 x 1024"),
        ((512, 512), 200, "The ranking of 200 images .* name fewer stimuli"),
    ],
)
def test_a_ranking_that_does_not_fit_is_refused(size, n, message):
    with pytest.raises(GlossError, match=message):
        arrange_ranking(RANKING, image_size_px=size, window_size_px=SXGA, n_items=n)


@given(
    n=st.integers(1, 60),
    image=st.tuples(st.integers(1, 400), st.integers(1, 400)).map(lambda size: (2 * size[0], 2 * size[1])),
    area=st.tuples(st.integers(50, 2000), st.integers(50, 2000)),
)
def test_a_grid_fits_its_area_and_enlarges_nothing(n, image, area):
    grid = largest_grid(n, image_size=image, area=area, gap=8, smallest_px=2)
    if grid is None:
        return
    assert grid.size[0] <= area[0]
    assert grid.size[1] <= area[1]
    width, height = grid.picture_size
    assert width <= image[0]
    assert height <= image[1]
    assert width % 2 == height % 2 == 0
    # Sizes are rounded down to even pixels, so proportions are kept within two of them.
    assert abs(width * image[1] - height * image[0]) <= 2 * max(image)
    for centred in (False, True):
        places = grid.places((0, 0), centred=centred)
        assert len(set(places)) == n
        assert max(abs(x) for x, _ in places) + width / 2 <= area[0] / 2 + 1
        assert max(abs(y) for _, y in places) + height / 2 <= area[1] / 2 + 1


def test_pictures_that_fit_are_shown_at_their_own_size():
    """Two rows of three 300-pixel images, 16 pixels apart, are 932 wide and 616 high: one pixel less is too little."""
    exact = largest_grid(6, image_size=(300, 300), area=(932, 616), gap=16, smallest_px=32)
    assert exact.picture_size == (300, 300)
    assert (exact.columns, exact.rows) == (3, 2)
    assert largest_grid(6, image_size=(300, 300), area=(931, 616), gap=16, smallest_px=32).picture_size == (298, 298)


def test_the_scripted_pointer_presses_on_the_rating_and_on_the_button():
    layout = arrange(PAIRWISE, image_size_px=(64, 64), window_size_px=SXGA)
    pointer = ScriptedPointer()
    pointer.perform(rating_steps(25, layout))
    pressed = []
    for _ in range(8):
        pointer.tick()
        if pointer.getPressed()[0]:
            pressed.append(pointer.getPos())
    assert pressed == [(slider_x(25, layout), layout.slider[1]), layout.button]
    assert (slider_x(0, layout), slider_x(100, layout)) == (-320, 320)


def test_the_scripted_pointer_drags_with_its_button_down():
    steps = drag_steps((0, 0), (10, 20))
    assert [place for place, down in steps if down] == [(0, 0), (5, 10), (10, 20)]
    assert steps[0] == ((0, 0), False)
    assert steps[-1] == ((10, 20), False)
