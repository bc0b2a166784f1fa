"""Figures 11 and 12 as they are drawn: spheres at their places, contours at their distances."""

import numpy as np
import pytest

from gloss_stimuli.applied_figures import draw_isogloss_ring, draw_matched_spheres, save_figure
from gloss_stimuli.images import write_codes
from gloss_stimuli.isogloss_ring import isogloss_ring
from gloss_stimuli.matched_spheres import matched_spheres
from glossspace.metric import GlossSpace, Paint
from glossspace.stimulus_set import StimulusSet

SIMULATED = GlossSpace(weight_d=2.5, name="ours $1", provenance={"observers": ["01 (simulated)"]})


@pytest.fixture
def pictured(tmp_path):
    """Pictures of one gray each, 30 by 20, in the place of rendered spheres: what is tested is where they go."""

    def make(applied):
        stimuli = applied.stimuli.stimuli
        entries = []
        for code, stimulus in enumerate(stimuli):
            write_codes(tmp_path / f"{stimulus.name}.png", np.full((20, 30), code, dtype=np.uint8))
            entries.append({"name": stimulus.name, "image": f"{stimulus.name}.png"})
        return StimulusSet(tmp_path, "x", stimuli, {"image": {"width": 30, "height": 20}, "stimuli": entries})

    return make


@pytest.mark.parametrize("space", [GlossSpace(), SIMULATED])
@pytest.mark.parametrize("n", [3, 8])
def test_spheres_lie_at_their_coordinates_and_do_not_overlap(pictured, space, n):
    ring = isogloss_ring(space, n=n)
    axes = draw_isogloss_ring(ring, pictured(ring)).axes[0]
    boxes = np.array([image.get_extent() for image in axes.images])
    centres = np.column_stack([boxes[:, :2].mean(axis=1), boxes[:, 2:].mean(axis=1)])
    assert centres == pytest.approx(ring.table[["c", "d"]].to_numpy())
    assert [int(image.get_array()[0, 0]) for image in axes.images] == list(range(len(ring.table)))
    for a, (left, right, low, high) in enumerate(boxes):
        for other in boxes[a + 1 :]:
            assert right <= other[0] or other[1] <= left or high <= other[2] or other[3] <= low
    # 30 by 20 pixels look so where the axis of d is stretched by the weight
    width, height = boxes[0, 1] - boxes[0, 0], boxes[0, 3] - boxes[0, 2]
    assert width / (height * space.weight_d) == pytest.approx(1.5)
    assert axes.get_aspect() == pytest.approx(space.weight_d)
    inside = [*axes.get_xlim(), *axes.get_ylim()]
    assert (boxes[:, 0] > inside[0]).all()
    assert (boxes[:, 1] < inside[1]).all()
    assert (boxes[:, 2] > inside[2]).all()
    assert (boxes[:, 3] < inside[3]).all()


def test_contours_have_their_distance_and_are_dotted_where_no_paint_is(pictured):
    ring = isogloss_ring(reference=Paint(0.193, 0.01, 0.02), n=4)
    axes = draw_isogloss_ring(ring, pictured(ring)).axes[0]
    own = ring.table[["c", "d"]].to_numpy()[0]
    for number, radius in enumerate((0.04, 0.08)):
        solid, dotted = axes.lines[2 * number : 2 * number + 2]
        assert dotted.get_linestyle() == ":"
        for line in (solid, dotted):
            c, d = line.get_data()
            known = np.isfinite(c)
            assert np.hypot(c[known] - own[0], 1.78 * (d[known] - own[1])) == pytest.approx(radius)
        c, d = solid.get_data()
        assert np.nanmin(c) >= 0
        assert np.nanmax(d) < 1
        assert np.nanmax(dotted.get_data()[1]) > 1
    texts = [text.get_text() for text in axes.texts]
    assert texts == ["D = 0.04", "D = 0.08", "reference"]


def test_matched_spheres_stand_in_two_rows_with_their_numbers(pictured):
    matched = matched_spheres(SIMULATED)
    figure = draw_matched_spheres(matched, pictured(matched))
    names = [s.name for s in matched.stimuli.stimuli]
    shown = [names[int(axes.images[0].get_array()[0, 0])] for axes in figure.axes]
    by_name = matched.table.set_index("stimulus")
    assert [by_name.loc[name, "rho_d"] for name in shown] == [0.767, 0.193, 0.03] * 2
    assert [by_name.loc[name, "same_physical"] for name in shown[:3]] == [True] * 3
    assert [by_name.loc[name, "same_apparent"] for name in shown[3:]] == [True] * 3
    labels = [axes.get_xlabel().splitlines()[0] for axes in figure.axes]
    # gloss paper, eqs 3 and 4, for rho_s = .099 on white, gray and black
    assert labels == ["c = 0.058, d = 0.96", "c = 0.122, d = 0.96", "c = 0.238, d = 0.96", *["c = 0.058, d = 0.96"] * 3]
    assert figure.get_suptitle() == "Space: ours $1 (simulated observers)"


def test_a_place_without_a_paint_stays_empty(pictured):
    matched = matched_spheres(reference=Paint(0.03, 0.099, 0.04))
    figure = draw_matched_spheres(matched, pictured(matched))
    empty = [index for index, axes in enumerate(figure.axes) if not axes.images]
    assert empty == [3]
    assert "no paint of this lightness" in figure.axes[3].texts[0].get_text()


def test_files_are_png_svg_and_pdf_and_the_same_every_time(pictured, tmp_path):
    ring = isogloss_ring(SIMULATED, n=3)
    rendered = pictured(ring)
    png, svg, pdf = save_figure(draw_isogloss_ring(ring, rendered), tmp_path / "one.two")
    assert (png.name, svg.name, pdf.name) == ("one.two.png", "one.two.svg", "one.two.pdf")
    assert pdf.read_bytes().startswith(b"%PDF")
    assert png.read_bytes().startswith(b"\x89PNG")
    assert "ours $1 (simulated observers)" in svg.read_text("utf-8")
    again = save_figure(draw_isogloss_ring(ring, rendered), tmp_path / "again")
    assert [path.read_bytes() for path in again] == [one.read_bytes() for one in (png, svg, pdf)]
