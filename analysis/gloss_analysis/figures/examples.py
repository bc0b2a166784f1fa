"""Figure 2 of the gloss paper, and Helm's colour circle."""

from typing import TYPE_CHECKING

from gloss_analysis.figures.labels import name_points
from gloss_analysis.figures.style import BLUE, ORANGE, new_figure, tidy
from gloss_analysis.study.examples import HUE_ORDER, CityMap, ColourCircle

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["draw_city_map", "draw_colour_circle", "draw_participant_weights"]

_CHIP_COLOURS = dict(
    zip(
        HUE_ORDER,
        ("#a3316f", "#c0303a", "#e0b020", "#a8bb30", "#7fae3c", "#2f9d63", "#2f7fb8", "#5a62b5", "#7d52a8", "#93479a"),
        strict=True,
    )
)


def draw_city_map(cities: CityMap) -> "Figure":
    """Cities where scaling puts them (figure 2)."""
    figure = new_figure(5.4, 3.4)
    axes = figure.add_subplot(xlabel="miles east of the centre", ylabel="miles north", aspect="equal")
    places = cities.positions_miles
    axes.plot(places["east"], places["north"], "o", color=BLUE)
    for place in places.itertuples():
        axes.annotate(place.city, (place.east, place.north), xytext=(4, 5), textcoords="offset points", fontsize=8)
    axes.margins(0.15)
    tidy(axes)
    return figure


def draw_colour_circle(circle: ColourCircle) -> "Figure":
    """Helm's chips in the plane, with the dimension on which deficient participants weigh less upright."""
    figure = new_figure(4.4, 4.2)
    across, upright = 1 - circle.red_green, circle.red_green
    points = circle.solution.coordinates[:, [across, upright]]
    axes = figure.add_subplot(xlabel=f"dimension {across + 1}", ylabel=f"dimension {upright + 1}", aspect="equal")
    chips = [circle.solution.stimuli.index(name) for name in HUE_ORDER]
    closed = points[[*chips, chips[0]]]
    axes.plot(closed[:, 0], closed[:, 1], color="0.8", lw=0.9, zorder=0)
    for index in chips:
        name = circle.solution.stimuli[index]
        axes.plot(*points[index], "o", ms=10, color=_CHIP_COLOURS[name], mec="black", mew=0.6)
        axes.annotate(name, tuple(points[index]), xytext=(7, 6), textcoords="offset points", fontsize=8)
    axes.margins(0.16)
    tidy(axes)
    return figure


def draw_participant_weights(circle: ColourCircle) -> "Figure":
    """Participants' dimension weights, normal and deficient colour vision apart."""
    figure = new_figure(4.4, 4.2)
    across, upright = 1 - circle.red_green, circle.red_green
    axes = figure.add_subplot(
        xlabel=f"weight of dimension {across + 1}", ylabel=f"weight of dimension {upright + 1}", aspect="equal"
    )
    groups = (
        ("normal colour vision", circle.normal, "o", BLUE),
        ("red-green deficient", circle.deficient, "s", ORANGE),
    )
    for label, names, marker, colour in groups:
        rows = [circle.solution.participants.index(name) for name in names]
        weights = circle.solution.dimension_weights[rows]
        axes.plot(weights[:, across], weights[:, upright], marker, color=colour, label=label)
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=0)
    axes.legend(frameon=False, fontsize=8, loc="lower left")
    tidy(axes)
    # The others lie too close together to be named.
    deficient = [circle.solution.participants.index(name) for name in circle.deficient]
    axes.margins(x=0.12)
    name_points(figure, axes, circle.solution.dimension_weights[deficient][:, [across, upright]], circle.deficient)
    return figure
