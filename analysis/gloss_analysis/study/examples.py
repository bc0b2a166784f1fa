"""Two sets of real data with a known answer, run through the same engine: US cities, and Helm's colour chips."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

import gloss_analysis
from gloss_analysis.axes.orientation import rotated_to
from gloss_analysis.dimensionality.stress_curve import stress_curve
from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.judgements.judgement_table import read_table
from gloss_analysis.mds import MdsSolution, scale
from glossspace.files import shipped_folder

__all__ = ["CityMap", "ColourCircle", "city_map", "colour_circle"]

# Helm's ten chips round the hue circle, by their names: from red-purple over yellow, green and blue to purple.
HUE_ORDER = ("RPur", "Red", "Yel", "Gy1", "Gy2", "Green", "Blue", "BlP", "Pur1", "Pur2")


@dataclass(frozen=True)
class CityMap:
    """Ten US cities put on a map by their airline distances (Table 1 and figures 2 and 3 of the gloss paper).

    Attributes
    ----------
    curve : tuple of MdsSolution
        Ratio scaling in 1 to 5 dimensions.
    positions_miles : DataFrame
        `city`, `east`, `north`: the two-dimensional solution in miles, turned and reflected towards the true map.
    largest_error_miles : float
        Largest difference between a distance on the map and the table's.
    """

    curve: tuple[MdsSolution, ...]
    positions_miles: pd.DataFrame
    largest_error_miles: float


def city_map(*, seed: int = 1) -> CityMap:
    """Recover the US map from the distances between cities."""
    folder = shipped_folder(gloss_analysis.__file__, "data")
    data = read_table(folder / "us_cities.csv")
    curve = stress_curve(data, model="identity", level="ratio", seed=seed)
    plane = curve[1].coordinates
    first, second = data.pairs
    table = data.values[0]
    distances = np.linalg.norm(plane[first] - plane[second], axis=1)
    miles = plane * ((distances @ table) / (distances @ distances))
    places = pd.read_csv(folder / "us_city_positions.csv").set_index("city").loc[list(data.stimuli)]
    # A degree of longitude shrinks with the cosine of the latitude; good enough to tell north from south.
    east = places["longitude_deg"].to_numpy() * np.cos(np.radians(places["latitude_deg"].mean()))
    turned = rotated_to(miles, np.column_stack([east, places["latitude_deg"].to_numpy()]))
    error = np.abs(np.linalg.norm(turned[first] - turned[second], axis=1) - table)
    positions = pd.DataFrame({"city": data.stimuli, "east": turned[:, 0], "north": turned[:, 1]})
    return CityMap(curve, positions, float(error.max()))


@dataclass(frozen=True)
class ColourCircle:
    """Helm's (1959) colour chips, judged by real observers with normal and with deficient colour vision.

    Attributes
    ----------
    data : Dissimilarities
    solution : MdsSolution
        Weighted, ordinal, two dimensions.
    normal, deficient : tuple of str
        Participants by their colour vision; some took part twice.
    in_hue_order : bool
        Whether the chips lie round the configuration's centre in the order of their hues.
    radius_variation : float
        Standard deviation over mean of the chips' distances to the centre, each dimension at unit spread: 0 for a
        perfect circle.
    red_green : int
        The dimension on which deficient participants weigh less.
    relative_weight : Series
        Per participant, weight of the red-green dimension over that of the other.
    """

    data: Dissimilarities
    solution: MdsSolution
    normal: tuple[str, ...]
    deficient: tuple[str, ...]
    in_hue_order: bool
    radius_variation: float
    red_green: int
    relative_weight: pd.Series


def colour_circle(*, seed: int = 1) -> ColourCircle:
    """Scale Helm's data in two dimensions and read the colour circle from it."""
    data = read_table(shipped_folder(gloss_analysis.__file__, "data") / "helm1959.csv")
    solution = scale(data, n_dims=2, seed=seed)
    deficient = tuple(name for name in data.participants if name.startswith("CD"))
    normal = tuple(name for name in data.participants if name not in deficient)
    weights = pd.DataFrame(solution.dimension_weights, index=list(data.participants))
    drop = weights.loc[list(normal)].mean() - weights.loc[list(deficient)].mean()
    red_green = int(drop.idxmax())
    unit = solution.coordinates / solution.coordinates.std(axis=0)
    radius = np.linalg.norm(unit, axis=1)
    return ColourCircle(
        data=data,
        solution=solution,
        normal=normal,
        deficient=deficient,
        in_hue_order=_in_order(unit, [data.stimuli.index(name) for name in HUE_ORDER]),
        radius_variation=float(radius.std() / radius.mean()),
        red_green=red_green,
        relative_weight=weights[red_green] / weights[1 - red_green],
    )


def _in_order(points: np.ndarray, expected: list[int]) -> bool:
    """Whether the points lie round the centre in the expected cyclic order, in either sense."""
    angle = np.arctan2(points[expected, 1], points[expected, 0])
    steps = np.diff(np.append(angle, angle[0])) % (2 * np.pi)
    # Steps that are all forward sum to one turn; all backward to one turn less, counted forward.
    turns = round(float(steps.sum() / (2 * np.pi)))
    return turns in (1, len(expected) - 1)
