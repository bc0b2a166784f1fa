"""Figures of scaling solutions: what is drawn and where, not how it looks."""

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest
from matplotlib.patches import Ellipse

import gloss_analysis
from gloss_analysis.figures import (
    draw_configuration_of,
    draw_shepard,
    draw_stress_curve,
    draw_stress_per_point,
    draw_subject_weights,
    save_mds_figures,
)
from gloss_analysis.figures.labels import levels_of
from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.judgements.judgement_table import read_table
from gloss_analysis.mds import scale
from glossspace.errors import GlossError
from glossspace.files import shipped_folder
from tests.analysis.solutions import solution_of

# As a user may name them: formulas, a leading underscore, both mean something else to matplotlib.
NAMES = ("$1 gloss$", "_hidden", "semi-matt", "a^2", "5 $")


def solution(n_dims, m=3, **options):
    rng = np.random.default_rng(n_dims)
    options = {"stimuli": NAMES, "noise": 0.1} | options
    return solution_of(rng.standard_normal((5, n_dims)), rng.uniform(0.3, 1.5, (m, n_dims)), **options)


def points_of(axes):
    """All points drawn with a symbol, shape (n, 2)."""
    return np.vstack([line.get_xydata() for line in axes.lines if line.get_marker() not in ("None", None, "")])


def in_rows(points):
    return points[np.lexsort(np.asarray(points).T)]


def written_names(axes):
    return sorted(text.get_text() for text in axes.texts)


def rendered(figure):
    figure.draw_without_rendering()  # warnings are errors: a name taken for a formula, a legend without room
    return figure


def test_a_plane_shows_every_stimulus_at_its_place_with_its_name():
    plane = solution(2)
    (axes,) = rendered(draw_configuration_of(plane)).axes
    assert in_rows(points_of(axes)).tolist() == in_rows(plane.coordinates).tolist()
    assert written_names(axes) == sorted(NAMES)
    assert not any(text.get_parse_math() for text in axes.texts)
    assert axes.get_aspect() == 1
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("dimension 1", "dimension 2")
    (low, high), (left, right) = axes.get_ylim(), axes.get_xlim()
    assert low < plane.coordinates[:, 1].min() < plane.coordinates[:, 1].max() < high
    assert left < plane.coordinates[:, 0].min() < plane.coordinates[:, 0].max() < right
    assert not list(draw_configuration_of(plane, labels=False).axes[0].texts)


def test_names_in_the_plane_do_not_cover_each_other_where_there_is_room():
    corners = np.array([[1.0, 1.0], [1.05, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]])
    (axes,) = rendered(draw_configuration_of(solution_of(corners, stimuli=("aaaa", "bbbb", "cccc", "dddd", "ee")))).axes
    boxes = [text.get_window_extent() for text in axes.texts]
    assert not any(one.overlaps(other) for k, one in enumerate(boxes) for other in boxes[:k])
    assert all(axes.bbox.x0 <= box.x0 and box.x1 <= axes.bbox.x1 for box in boxes)


def test_a_line_has_a_row_for_each_stimulus_in_order():
    line = solution(1)
    (axes,) = rendered(draw_configuration_of(line)).axes
    order = np.argsort(line.coordinates[:, 0])
    drawn = points_of(axes)
    assert drawn[np.argsort(drawn[:, 1]), 0].tolist() == line.coordinates[order, 0].tolist()
    assert [label.get_text() for label in axes.get_yticklabels()] == [NAMES[k] for k in order]
    assert not any(label.get_parse_math() for label in axes.get_yticklabels())


@pytest.mark.parametrize("n_dims", [3, 4])
def test_more_dimensions_are_shown_in_pairs_at_one_scale(n_dims):
    space = solution(n_dims)
    panels = rendered(draw_configuration_of(space)).axes
    assert len(panels) == n_dims * (n_dims - 1) / 2
    spans = []
    for axes in panels:
        first, second = (int(label.split()[-1]) - 1 for label in (axes.get_xlabel(), axes.get_ylabel()))
        assert in_rows(points_of(axes)).tolist() == in_rows(space.coordinates[:, [first, second]]).tolist()
        assert written_names(axes) == sorted(NAMES)
        spans += [np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim())]
    assert np.ptp(spans) < 1e-12  # the same half width added and subtracted: rounding


def test_a_factor_is_shown_by_colour_and_symbol_and_matched_by_name():
    plane = solution(2)
    factor = pd.Series(["_low", "$high$", "_low", "$high$"], index=[NAMES[k] for k in (4, 3, 2, 1)])
    with pytest.raises(GlossError, match="factor has no value for '\\$1 gloss\\$' \\(1 such\\)"):
        draw_configuration_of(plane, factor=factor)
    factor[NAMES[0]] = None
    figure = rendered(draw_configuration_of(plane, factor=factor))
    by_label = {level.label: level for level in levels_of(factor, NAMES)}
    assert {label: level.rows.tolist() for label, level in by_label.items()} == {
        "$high$": [1, 3],
        "_low": [2, 4],
        "not given": [0],
    }
    assert len({level.colour for level in by_label.values()}) == 3
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == list(by_label)
    drawn = {line.get_color(): line.get_xydata() for line in figure.axes[0].lines}
    for level in by_label.values():
        assert drawn[level.colour].tolist() == plane.coordinates[level.rows].tolist()


def test_levels_stand_in_the_order_of_categories():
    factor = pd.Categorical(["high", "low", "high"], categories=["low", "middle", "high"])
    assert [level.label for level in levels_of(pd.Series(factor), ("a", "b", "c"))] == ["low", "high"]
    assert [level.label for level in levels_of([0.25, 1.0, 0.25], ("a", "b", "c"))] == ["0.25", "1"]
    with pytest.raises(GlossError, match="factor of 2 values does not fit 3 names"):
        levels_of([1, 2], ("a", "b", "c"))
    with pytest.raises(GlossError, match="several values for 'a'"):
        levels_of(pd.Series([1, 2, 3], index=["a", "a", "b"]), ("a", "b"))


def test_many_levels_differ_in_colour_or_symbol():
    levels = levels_of(list(range(56)), [str(k) for k in range(56)])
    assert len({(level.colour, level.marker) for level in levels}) == 56


def test_regions_are_ellipses_round_their_centres():
    plane = solution(2)
    regions = [(x + 0.1, y, 0.9, 0.2, 30.0) for x, y in plane.coordinates]
    regions[2] = (np.nan,) * 5
    (axes,) = rendered(draw_configuration_of(plane, regions=regions)).axes
    ellipses = [patch for patch in axes.patches if isinstance(patch, Ellipse)]
    assert len(ellipses) == 4
    assert sorted(one.center for one in ellipses) == sorted((x, y) for x, y, *_ in (regions[k] for k in (0, 1, 3, 4)))
    assert {(one.width, one.height, one.angle) for one in ellipses} == {(1.8, 0.4, 30.0)}
    reach = [one.get_window_extent() for one in ellipses]
    assert all(axes.bbox.x0 < box.x0 and box.x1 < axes.bbox.x1 for box in reach)
    with pytest.raises(GlossError, match=r"Regions of shape \(2, 5\) do not fit 5 stimuli in 2 dimensions"):
        draw_configuration_of(plane, regions=[regions[0]] * 2)
    with pytest.raises(GlossError, match="stimuli in 3 dimensions. Allowed: two dimensions"):
        draw_configuration_of(solution(3), regions=regions)


def test_the_stress_curve_stands_beside_its_bands():
    curve = [solution(p) for p in (1, 2, 3)]
    rng = np.random.default_rng(0)
    random, permuted, held_out = (rng.uniform(0.2, 0.4, (40, 3)) for _ in range(3))
    held_out[:, 2] = np.nan  # no fold of that dimensionality could be fitted
    (axes,) = rendered(draw_stress_curve(curve, random=random, permuted=permuted, held_out=held_out)).axes
    lines = {line.get_label(): line.get_xydata() for line in axes.lines}
    assert lines["judgements"].tolist() == [[s.n_dims, s.stress1] for s in curve]
    assert lines["random data"][:, 1].tolist() == np.median(random, axis=0).tolist()
    assert len(axes.collections) >= 2
    low, high = np.quantile(permuted, [0.05, 0.95], axis=0)
    band = axes.collections[1].get_paths()[0].vertices
    assert {*low, *high} <= set(band[:, 1])
    (bars,) = axes.containers
    assert bars.lines[0].get_xydata()[:, 1] == pytest.approx(held_out[:, :2].mean(axis=0), rel=1e-12)
    ends = bars.lines[2][0].get_segments()
    errors = held_out[:, :2].std(axis=0, ddof=1) / np.sqrt(40)
    assert [np.ptp(one[:, 1]) / 2 for one in ends] == pytest.approx(errors, rel=1e-9)  # a difference of larger numbers
    assert axes.get_ylim()[0] == 0
    assert draw_stress_curve(curve).legends == []


def test_a_stress_curve_needs_solutions_and_fitting_bands():
    with pytest.raises(GlossError, match="needs solutions"):
        draw_stress_curve([])
    with pytest.raises(GlossError, match=r"random data has the shape \(4, 2\).* each of the 1 solutions"):
        draw_stress_curve([solution(2)], random=np.ones((4, 2)))


@pytest.mark.parametrize("m", [1, 3, 16])
def test_shepard_diagrams_show_all_judgements_of_each_participant(m):
    plane = solution(2, m=m, participants=tuple(f"${k}$" for k in range(m)))
    plane.dissimilarities[0, 3] = plane.disparities[0, 3] = np.nan
    figure = rendered(draw_shepard(plane))
    assert len(figure.axes) == m
    for k, axes in enumerate(figure.axes):
        judged = ~np.isnan(plane.disparities[k])
        distances, disparities = (line.get_xydata() for line in axes.lines)
        expected = np.column_stack([plane.dissimilarities[k], plane.distances[k]])[judged]
        assert distances.tolist() == expected.tolist()
        assert np.all(np.diff(disparities[:, 0]) >= 0)
        assert sorted(disparities[:, 1]) == sorted(plane.disparities[k, judged])
        # Nothing may be cut off: the axes are shared, and participants reach differently far.
        low, high = axes.get_ylim()
        assert low <= min(expected[:, 1].min(), disparities[:, 1].min())
        assert max(expected[:, 1].max(), disparities[:, 1].max()) <= high
        left, right = axes.get_xlim()
        assert left <= expected[:, 0].min() <= expected[:, 0].max() <= right
        if m > 1:
            assert (axes.get_title(), axes.title.get_parse_math()) == (f"${k}$", False)


def test_judgements_at_the_end_of_floating_point_are_not_drawn():
    data = Dissimilarities(("a", "b", "c", "d"), ("1",), np.array([[1e308, 2e307, 3e307, 5e307, 1e307, 8e307]]))
    with pytest.raises(GlossError, match=r"Judgements up to 1e\+308 cannot be drawn.* Divide them all by one number"):
        draw_shepard(scale(data, n_dims=2, model="identity", level="ratio"))


def test_shepard_diagrams_share_an_axis_only_for_like_scales():
    coordinates = np.random.default_rng(0).standard_normal((5, 2))
    alike = draw_shepard(solution_of(coordinates, np.ones((2, 2)))).axes
    assert alike[0].get_xlim() == alike[1].get_xlim()
    # Weights of 3 make distances 3 times and these judgements 9 times as large.
    unlike = draw_shepard(solution_of(coordinates, np.array([[1.0, 1.0], [3.0, 3.0]]))).axes
    assert unlike[1].get_xlim()[1] > 5 * unlike[0].get_xlim()[1]


def test_weights_in_the_plane_are_vectors_with_names_apart():
    plane = solution(2, m=16, participants=tuple(f"P{k}$" for k in range(16)))
    plane.dimension_weights[:] = 1 + np.linspace(0, 0.01, 32).reshape(16, 2)  # all but in one place
    (axes,) = rendered(draw_subject_weights(plane)).axes
    assert in_rows(points_of(axes)).tolist() == in_rows(plane.dimension_weights).tolist()
    from_origin = [line for line in axes.lines if line.get_xydata()[0].tolist() == [0, 0]]
    assert len(from_origin) == 16 + 1  # and the line of equal weights
    assert written_names(axes) == sorted(plane.participants)
    places = np.array(sorted(np.degrees(np.arctan2(*text.get_position()[::-1])) for text in axes.texts))
    assert np.diff(places).min() > 2.5  # degrees: about a line of text at that radius
    assert axes.get_xlim()[0] == axes.get_ylim()[0] == 0
    assert axes.get_xlim()[1] > max(text.get_position()[0] for text in axes.texts)


@pytest.mark.parametrize("n_dims", [1, 3])
def test_weights_in_other_dimensions_are_bars(n_dims):
    space = solution(n_dims, participants=("N1", "_N2", "$N$"))
    figure = rendered(draw_subject_weights(space))
    (axes,) = figure.axes
    assert sorted(bar.get_height() for bar in axes.patches) == sorted(space.dimension_weights.ravel())
    assert [label.get_text() for label in axes.get_xticklabels()] == ["N1", "_N2", "$N$"]
    assert len(figure.legends) == (n_dims > 1)


def test_a_solution_without_weights_has_no_picture_of_them():
    with pytest.raises(GlossError, match="identity model has no weights"):
        draw_subject_weights(solution(2, model="identity"))


def test_stress_per_point_is_sorted_and_named():
    plane = solution(2)
    stimuli, participants = rendered(draw_stress_per_point(plane)).axes
    for axes, parts, names in (
        (stimuli, plane.stress_per_point, plane.stimuli),
        (participants, plane.stress_per_source, plane.participants),
    ):
        assert [bar.get_width() for bar in axes.patches] == sorted(parts)
        assert [label.get_text() for label in axes.get_yticklabels()] == [names[k] for k in np.argsort(parts)]
    written = [text.get_text() for text in participants.texts]
    assert written == [f"{plane.source_stress1[k]:.3f}" for k in np.argsort(plane.stress_per_source)]
    assert len(draw_stress_per_point(solution(2, m=1)).axes) == 1


def test_a_perfect_fit_can_be_drawn():
    perfect = solution(2, noise=0.0)
    for figure in (draw_stress_per_point(perfect), draw_shepard(perfect), draw_stress_curve([perfect])):
        rendered(figure)


@pytest.mark.parametrize("file_format", ["png", "svg"])
def test_pictures_of_real_judgements_are_written_whole_and_reproducibly(tmp_path, file_format):
    data = read_table(shipped_folder(gloss_analysis.__file__, "data") / "helm1959.csv")
    plane = scale(data, n_dims=2, n_starts=4)
    before = dict(mpl.rcParams)
    written = save_mds_figures(plane, tmp_path / "new" / "folder", file_format=file_format)
    assert [path.name for path in written] == [
        f"{name}.{file_format}" for name in ("configuration", "shepard", "weights", "stress-per-point")
    ]
    assert sorted((tmp_path / "new" / "folder").iterdir()) == sorted(written)  # nothing half-written left
    start = b"\x89PNG" if file_format == "png" else b"<?xml"
    assert all(path.read_bytes().startswith(start) for path in written)
    again = save_mds_figures(plane, tmp_path / "again", file_format=file_format)
    assert [path.read_bytes() for path in again] == [path.read_bytes() for path in written]
    assert dict(mpl.rcParams) == before


def test_pictures_of_a_curve_carry_their_dimensions(tmp_path):
    curve = [solution_of(np.random.default_rng(p).standard_normal((4, p)), model="identity") for p in (1, 2)]
    regions = [(0.0, 0.0, 0.1, 0.1, 0.0)] * 4
    written = save_mds_figures(curve, tmp_path, regions=regions, random=np.ones((2, 2)))
    assert [path.stem for path in written] == [
        "stress-curve",
        *(f"{name}-{p}d" for p in (1, 2) for name in ("configuration", "shepard", "stress-per-point")),
    ]


def test_what_cannot_be_saved_is_refused(tmp_path):
    with pytest.raises(GlossError, match=r"differ in their number of dimensions; these have \[2, 2\]"):
        save_mds_figures([solution(2), solution(2)], tmp_path)
    with pytest.raises(GlossError, match="Invalid file format 'pdf'. Allowed: 'png', 'svg'"):
        save_mds_figures(solution(2), tmp_path, file_format="pdf")
    (tmp_path / "file").touch()
    with pytest.raises(GlossError, match="is a file, where a folder is needed"):
        save_mds_figures(solution(2), tmp_path / "file")
