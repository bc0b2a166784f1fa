"""What a simulated observer sees who looks at the images: contrast and sharpness of what a sphere reflects.

Nothing of the paint is used. The code values of the PNG become luminance through the display model of the stimulus set,
luminance becomes CIELAB lightness relative to the display's white, and inside the outline of the sphere, which the
manifest's scene gives, two numbers are measured. Lengths are in units of the sphere's radius R on the image, so that
they do not depend on the size of the images; G(s) is a Gaussian blur of standard deviation s that takes nothing from
beyond the outline.

**Contrast**: twice the standard deviation of ``G(R/8) - G(R/4)`` of lightness. A pattern of two lightnesses in equal
shares has just that difference. It is taken at a coarse scale, which the sphere's own shading is too smooth for and
which blurring by a rough lobe changes little.

**Sharpness**: minus the logarithm of the edge width, in steps of a tenth. The width of an edge is the range of
lightness around it, within R/6, over the slope there; the median over the steepest tenth of the sphere counts. For a
step blurred by a Gaussian of standard deviation σ the width is ``√(2π) σ``.

The two are independent channels in human vision too (Morgan 2017, Journal of Vision 17(6):16). Their units are an
assumption: one step of L*, and a change of edge width by a tenth, each taken as about what is just seen.
"""

from collections.abc import Sequence
from math import log, radians, tan
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from glossspace.display import DisplayModel
from glossspace.errors import GlossError
from glossspace.stimulus_set import StimulusSet

__all__ = ["contrast_and_sharpness", "image_axes", "lightness_of_luminance", "sphere_outline"]

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

WIDTH_STEP = 0.1
# Less than this is not called an edge: about what is just seen, and more than rounding to code values makes.
SMALLEST_RANGE = 1.0
STEEPEST_SHARE = 0.1
# The outline is an edge, but none of what is reflected: the outer half of this rim, in radii, is taken for wall, and
# nothing is measured in the inner half, where slopes still feel that.
RIM = 0.08


def image_axes(stimulus_set: StimulusSet, names: Sequence[str]) -> dict[str, tuple[float, float]]:
    """Contrast and sharpness of the reflections on each of the named stimuli.

    Parameters
    ----------
    stimulus_set
        The set. Its manifest must hold the display model and, as `gloss render` writes it, the scene.
    names
        Stimuli of the set.

    Returns
    -------
    dict
        ``{stimulus: (contrast, sharpness)}``; see the module for their units.

    Raises
    ------
    GlossError
        The manifest states no display or no scene with a sphere, or an image is not 8-bit grayscale.
    """
    width, height = stimulus_set.image_size
    display = _display(stimulus_set)
    outline = sphere_outline(_scene(stimulus_set), width=width, height=height)
    axes = {}
    for name in names:
        luminance = display.luminance(_code_values(stimulus_set, name), bits=8)
        if luminance.shape != outline.shape:
            raise GlossError(
                f"The image of '{name}' in '{stimulus_set.folder}' has {luminance.shape[1]} x {luminance.shape[0]} "
                f"pixels, but its manifest says {width} x {height}. Render the set again."
            )
        axes[name] = contrast_and_sharpness(lightness_of_luminance(luminance, white=display.white_cd_m2), outline)
    return axes


def contrast_and_sharpness(lightness: Array, outline: Mask) -> tuple[float, float]:
    """Contrast (L*) of the pattern inside an outline, and sharpness (steps of a tenth) of its edges.

    Parameters
    ----------
    lightness : array, shape (H, W)
        CIELAB L* of an image.
    outline : array of bool, shape (H, W)
        Where the sphere is; its area gives the radius R.

    Returns
    -------
    contrast, sharpness : float
        Where no edge is to be seen the sharpness is that of the widest edge that can be measured.

    Raises
    ------
    GlossError
        The sphere is less than 24 pixels wide.
    """
    rows, columns = np.nonzero(outline)
    radius = float(np.sqrt(rows.size / np.pi))
    if radius < 12:
        raise GlossError(f"The sphere is {2 * radius:.0f} pixels wide on the images; render them larger (--size).")
    box = slice(rows.min(), rows.max() + 1), slice(columns.min(), columns.max() + 1)
    field = lightness[box]
    depth = ndimage.distance_transform_edt(np.pad(outline[box], 1))[1:-1, 1:-1] / radius
    inside, interior = depth > RIM / 2, depth > RIM

    coarse = _blurred(field, inside, radius / 4)
    contrast = 2 * float(np.std((_blurred(field, inside, radius / 8) - coarse)[interior]))

    # Beyond it the field goes on smoothly, lest its end be taken for a reflected edge.
    filled = np.where(inside, field, coarse)
    slope = ndimage.gaussian_gradient_magnitude(filled, radius / 100)
    pattern = field - coarse
    window = 2 * round(radius / 6) + 1
    highest = ndimage.maximum_filter(np.where(inside, pattern, -np.inf), window)
    lowest = ndimage.minimum_filter(np.where(inside, pattern, np.inf), window)
    steep = interior & (slope >= np.quantile(slope[interior], 1 - STEEPEST_SHARE))
    steep &= highest - lowest >= SMALLEST_RANGE
    widest = window / radius
    width = float(np.median((highest - lowest)[steep] / slope[steep])) / radius if steep.any() else widest
    return contrast, -log(min(width, widest)) / log(1 + WIDTH_STEP)


def lightness_of_luminance(luminance_cd_m2: Array, *, white: float) -> Array:
    """CIELAB lightness L* of luminance relative to `white` (cd/m²).

    ``116 f(Y / Yn) - 16``, and ``(29/3)³ Y / Yn`` below ``(6/29)³`` (CIE 15).

    Examples
    --------
    >>> lightness_of_luminance(np.array([0.0, 100.0]), white=100.0).tolist()
    [0.0, 100.0]
    """
    share = np.asarray(luminance_cd_m2, dtype=float) / white
    return np.where(share > (6 / 29) ** 3, 116 * np.cbrt(share) - 16, (29 / 3) ** 3 * share)


def sphere_outline(scene: dict[str, Any], *, width: int, height: int) -> Mask:
    """Which pixels of a picture show the sphere of a scene: those whose ray through the pinhole meets it.

    Parameters
    ----------
    scene
        The section of a stimulus manifest: ``camera`` (position, target, field_of_view_deg, which spans the width) and
        ``sphere`` (center, radius).
    width, height
        Of the picture in pixels.

    Returns
    -------
    array of bool, shape (height, width)

    Examples
    --------
    >>> camera = {"position": [0, 0, 2], "target": [0, 0, 0], "field_of_view_deg": 90.0}
    >>> int(sphere_outline({"camera": camera, "sphere": {"center": [0, 0, 0], "radius": 1}}, width=4, height=4).sum())
    4
    """
    eye, target, center = (
        np.array(place, dtype=float)
        for place in (scene["camera"]["position"], scene["camera"]["target"], scene["sphere"]["center"])
    )
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    reach = tan(radians(scene["camera"]["field_of_view_deg"]) / 2)
    x = ((np.arange(width) + 0.5) * 2 / width - 1) * reach
    y = (height - (np.arange(height) + 0.5) * 2) / width * reach
    rays = forward + x[None, :, None] * right + y[:, None, None] * up
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    to_center = center - eye
    return np.asarray(to_center @ to_center - (rays @ to_center) ** 2 < scene["sphere"]["radius"] ** 2)


def _blurred(field: Array, inside: Mask, sd: float) -> Array:
    weight = ndimage.gaussian_filter(inside.astype(float), sd)
    total = ndimage.gaussian_filter(np.where(inside, field, 0.0), sd)
    return np.asarray(total / np.maximum(weight, np.finfo(float).tiny))


def _display(stimulus_set: StimulusSet) -> DisplayModel:
    try:
        return DisplayModel.from_dict(stimulus_set.manifest["display"])
    except (KeyError, TypeError) as error:
        raise GlossError(
            f"A simulated observer cannot look at the images in '{stimulus_set.folder}': the manifest's display lacks "
            f"{error}, so their luminance is not known. Render the set with `gloss render`, or use another observer."
        ) from None


def _scene(stimulus_set: StimulusSet) -> dict[str, Any]:
    scene = stimulus_set.manifest.get("scene")
    needed = {"camera": ("position", "target", "field_of_view_deg"), "sphere": ("center", "radius")}
    if isinstance(scene, dict) and all(
        isinstance(scene.get(part), dict) and set(keys) <= set(scene[part]) for part, keys in needed.items()
    ):
        return scene
    raise GlossError(
        f"A simulated observer cannot look at the images in '{stimulus_set.folder}': the manifest holds no scene with "
        "a camera and a sphere, so where to look is not known. Use a set of `gloss render`, or another observer."
    )


def _code_values(stimulus_set: StimulusSet, name: str) -> NDArray[np.uint8]:
    from PIL import Image

    path = stimulus_set.image_path(name)
    with Image.open(path) as image:
        if image.mode != "L":
            raise GlossError(
                f"'{path}' is no grayscale image of 8 bits (its mode is {image.mode}); save it as one, or use another "
                "observer than one that looks at images."
            )
        return np.asarray(image)
