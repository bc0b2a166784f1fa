"""The coefficient path tracer: one pass gives the image of every (ρd, ρs) at once.

Light that reaches the camera has met the sphere i times diffusely and j times specularly, so a pixel is the polynomial
``Σ C_ij ρd^i ρs^j``. Each path samples these meetings with probabilities of its own and adds its weight to the
coefficient of its (i, j). Two kinds of pass share the work:

- *diffuse*: j = 0. It knows no lobe, hence no α: one pass serves all stimuli of all sets.
- *specular*: j ≥ 1, one pass for each α. Its numbers are small off the sphere, so wall pixels get fewer samples.

The box, the sphere and the light are intersected in closed form. Next-event estimation and reflected rays are combined
by the balance heuristic; a path ends by Russian roulette on the walls, and where its order in (ρd, ρs) is full. Sample
points are a lattice, shifted by a hash of pixel, dimension and seed, so that each seed is an independent randomisation.
One lane owns one pixel and loops over its samples, so the sums never depend on the number of threads.
"""

import hashlib
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gloss_stimuli.lattice import lattice_generator
from gloss_stimuli.scene import Scene
from gloss_stimuli.ward_lobe import lobe_value_and_pdf, sample_lobe

__all__ = ["ORDER", "diffuse_exponents", "specular_exponents", "trace_pass"]

ORDER = 4

# Random numbers a path vertex takes: light point (2), direction (2), choice of lobe (1), Russian roulette (1).
NUMBERS_A_VERTEX = 6
# Camera position and three vertices come from the lattice; later vertices matter little and take plain hashed numbers.
LATTICE_DIMENSIONS = 2 + 3 * NUMBERS_A_VERTEX
# Share of specular reflections at the sphere, before and after the first one, without which a path adds nothing.
NEEDED_SPECULAR_SHARE = 0.8
LATER_SPECULAR_SHARE = 0.3


def diffuse_exponents() -> tuple[tuple[int, int], ...]:
    """Exponents (i, j) of a diffuse pass: ρd^0 … ρd^4."""
    return tuple((i, 0) for i in range(ORDER + 1))


def specular_exponents() -> tuple[tuple[int, int], ...]:
    """Exponents (i, j) of a specular pass: j ≥ 1 and i + j ≤ 4, lowest total order first."""
    return tuple((order - j, j) for order in range(1, ORDER + 1) for j in range(1, order + 1))


def trace_pass(
    scene: Scene,
    pixels: NDArray[np.uint32],
    *,
    samples: int,
    seed: int,
    alpha: float | None = None,
) -> NDArray[np.float32]:
    """Mean luminance coefficients (cd/m²) of `pixels`, from one randomisation.

    Parameters
    ----------
    scene : Scene
        What to render; the sphere's lobe form is taken from it.
    pixels : array of uint32, shape (P,)
        Row-major indices into the film.
    samples : int
        Paths a pixel, a power of two.
    seed : int
        Any integer; other seeds give independent estimates.
    alpha : float, optional
        Roughness of the lobe for a specular pass; None for the diffuse pass.

    Returns
    -------
    array of float32, shape (M, P)
        One row for each of `diffuse_exponents()` or `specular_exponents()`.

    Notes
    -----
    A Mitsuba variant must be set: see `gloss_stimuli.variant.use_llvm`.
    """
    import drjit as dr
    import mitsuba as mi

    exponents = diffuse_exponents() if alpha is None else specular_exponents()
    # Opaque: these change between passes, and a literal would be compiled into a new kernel each time.
    opaque_alpha = dr.opaque(mi.Float, 1.0 if alpha is None else alpha)
    count = dr.opaque(mi.UInt32, samples)
    width = dr.opaque(mi.UInt32, scene.film.width)
    height = scene.film.height
    # Hashed, since the key is added to the pixel: neighbouring seeds would repeat the numbers of neighbouring pixels.
    digest = hashlib.sha256(str(seed).encode()).digest()
    key = tuple(dr.opaque(mi.UInt32, int.from_bytes(digest[k : k + 4], "little")) for k in (0, 4))
    generator = mi.UInt32(np.array(lattice_generator(samples, LATTICE_DIMENSIONS), dtype=np.uint32))
    step = dr.opaque(mi.UInt32, (1 << 32) // samples % (1 << 32))
    points = _Points(mi.UInt32(pixels), generator, step, key)
    world = _World(scene)
    axes = tuple(mi.Vector3f(*axis) for axis in scene.camera.axes())
    half_width = math.tan(math.radians(scene.camera.field_of_view_deg) / 2)

    pixel = points.pixel
    column, row = mi.Float(pixel % width), mi.Float(pixel // width)

    def camera_direction(sample: Any) -> Any:
        u, v = points.draw(sample, mi.UInt32(0))
        right, up, forward = axes
        x = (2 * (column + u) / mi.Float(width) - 1) * half_width
        y = (height - 2 * (row + v)) / mi.Float(width) * half_width
        return dr.normalize(forward + x * right + y * up)

    zero = dr.zeros(mi.Float, len(pixels))
    state = (
        mi.Point3f(zero), mi.Vector3f(zero, zero, zero + 1),  # ray
        zero + 0, zero + 0,  # weight of the path; density of its last direction
        mi.UInt32(pixel * 0), mi.UInt32(pixel * 0),  # diffuse and specular meetings with the sphere
        mi.UInt32(pixel * 0), mi.UInt32(pixel * 0),  # depth, sample
        mi.Mask(zero > 1), mi.Mask(zero > 1),  # alive, starts on the sphere
        [mi.Float(zero) for _ in exponents],
    )  # fmt: skip

    def unfinished(*state: Any) -> Any:
        return state[7] < count

    def bounce(
        origin: Any, direction: Any, weight: Any, density: Any, diffuse: Any, specular: Any, depth: Any, sample: Any,
        alive: Any, on_sphere: Any, sums: list[Any],
    ) -> tuple[Any, ...]:  # fmt: skip
        fresh = ~alive
        origin = dr.select(fresh, mi.Point3f(*scene.camera.position), origin)
        direction = dr.select(fresh, camera_direction(sample), direction)
        weight = dr.select(fresh, 1, weight)
        diffuse, specular = dr.select(fresh, 0, diffuse), dr.select(fresh, 0, specular)
        depth = dr.select(fresh, 0, depth)
        on_sphere &= ~fresh

        hit = world.intersect(origin, direction, on_sphere)
        frame = mi.Frame3f(hit.normal)
        incident = frame.to_local(-direction)

        # A ray that finds the light: seen directly, or weighed against the light sample of the vertex before.
        light_density = dr.square(hit.distance) / (world.light_area * dr.maximum(direction.y, 1e-6))
        found = dr.select(depth == 0, 1, density / (density + light_density))
        from_hit = dr.select(hit.on_light, weight * world.luminance * found, 0)

        base = 2 + NUMBERS_A_VERTEX * depth
        light_u, light_v = points.draw(sample, base)
        direction_u, direction_v = points.draw(sample, base + 2)
        choice, roulette = points.draw(sample, base + 4)

        # A sample on the light.
        to_light = world.light_point(light_u, light_v) - hit.point
        distance2 = dr.squared_norm(to_light)
        to_light = to_light * dr.rsqrt(distance2)
        cos_light = to_light.y
        outgoing = frame.to_local(to_light)
        cos_o = outgoing.z
        lit = (cos_o > 0) & (cos_light > 1e-6) & ~hit.on_light
        lit &= hit.on_sphere | ~world.sphere_blocks(hit.point, to_light)
        pdf_light = distance2 / (world.light_area * dr.select(lit, cos_light, 1))
        arriving = dr.select(lit, weight * world.luminance, 0)
        share = mi.Float(0)
        if alpha is not None:
            share = dr.select(specular == 0, NEEDED_SPECULAR_SHARE, LATER_SPECULAR_SHARE)
            share = dr.select(hit.on_sphere, share, 0)
        pdf_cosine = dr.maximum(cos_o, 0) / math.pi
        by_diffuse = arriving * pdf_cosine / (pdf_light + (1 - share) * pdf_cosine)
        from_hit += dr.select(hit.on_sphere, 0, hit.reflectance * by_diffuse)
        from_diffuse = dr.select(hit.on_sphere, by_diffuse, 0)
        terms = [(diffuse, specular, from_hit), (diffuse + 1, specular, from_diffuse)]
        if alpha is not None:
            value, pdf = lobe_value_and_pdf(incident, outgoing, opaque_alpha, scene.sphere.lobe)
            from_specular = dr.select(hit.on_sphere, arriving * value / (pdf_light + share * pdf), 0)
            terms.append((diffuse, specular + 1, from_specular))
        for index, (i, j) in enumerate(exponents):
            for has_i, has_j, amount in terms:
                sums[index] = sums[index] + dr.select((has_i == i) & (has_j == j), amount, 0)

        # The next direction.
        cosine = mi.warp.square_to_cosine_hemisphere(mi.Point2f(direction_u, direction_v))
        pdf_cosine = cosine.z / math.pi
        outgoing, density = cosine, (1 - share) * pdf_cosine
        factor = dr.select(hit.on_sphere, 1 / (1 - share), hit.reflectance)
        if alpha is not None:
            mirrored = hit.on_sphere & (choice < share)
            lobe_direction = sample_lobe(incident, direction_u, direction_v, opaque_alpha)
            value, pdf = lobe_value_and_pdf(incident, lobe_direction, opaque_alpha, scene.sphere.lobe)
            usable = mirrored & (pdf > 0)
            outgoing = dr.select(mirrored, lobe_direction, outgoing)
            density = dr.select(mirrored, share * pdf, density)
            factor = dr.select(mirrored, dr.select(usable, value / dr.select(usable, share * pdf, 1), 0), factor)
            specular = specular + dr.select(mirrored, 1, 0)
            diffuse = diffuse + dr.select(hit.on_sphere & ~mirrored, 1, 0)
            # A path that has not been specular yet must still become so within the order.
            full = diffuse + dr.maximum(specular, 1) > ORDER
        else:
            diffuse = diffuse + dr.select(hit.on_sphere, 1, 0)
            full = diffuse > ORDER

        # Absorption by the wall as in nature, except at the first hit, where the pixel needs every path.
        survival = dr.select((depth > 0) & ~hit.on_sphere, hit.reflectance, 1)
        alive = ~hit.on_light & ~full & (factor > 0) & (roulette < survival)
        weight = weight * factor / dr.select(survival > 0, survival, 1)
        sample = dr.select(alive, sample, sample + 1)
        return (
            mi.Point3f(hit.point), mi.Vector3f(frame.to_world(outgoing)), weight, density, diffuse, specular,
            depth + 1, sample, alive, hit.on_sphere, sums,
        )  # fmt: skip

    state = dr.while_loop(state, unfinished, bounce, label="coefficient paths")
    scale = dr.rcp(mi.Float(count))
    rows = [total * scale for total in state[-1]]
    dr.eval(rows)
    result = np.stack([np.asarray(row) for row in rows])
    if not np.isfinite(result).all():
        raise FloatingPointError(f"The path tracer made {np.count_nonzero(~np.isfinite(result))} values not finite.")
    return result


class _Points:
    """Numbers in [0, 1) for (pixel, sample, dimension): a lattice shifted by a hash, plain hashes beyond it."""

    def __init__(self, pixel: Any, generator: Any, step: Any, key: tuple[Any, ...]) -> None:
        self.pixel, self._generator, self._step, self._key = pixel, generator, step, key

    def draw(self, sample: Any, dimension: Any) -> tuple[Any, Any]:
        """The numbers of `dimension` and of the one after it."""
        import drjit as dr
        import mitsuba as mi

        inside = dimension + 1 < LATTICE_DIMENSIONS
        # Beyond the lattice each sample has its own hash; 4096 dimensions outlast every path.
        counter = dimension + dr.select(inside, 0, (sample + 1) * 4096)
        shifts = mi.sample_tea_32(self.pixel + self._key[0], counter + self._key[1], 5)
        numbers = []
        for offset, shift in enumerate(shifts):
            z = dr.gather(mi.UInt32, self._generator, dr.select(inside, dimension + offset, 0))
            lattice = dr.select(inside, sample * z * self._step, 0)
            numbers.append(mi.Float((lattice + shift) >> 8) * 2**-24)  # 24 bits: never rounds to one
        return numbers[0], numbers[1]


class _Hit:
    """Where a ray ends: on the sphere, on the light, or on a wall of some reflectance."""

    def __init__(self, point: Any, normal: Any, distance: Any, on_sphere: Any, on_light: Any, reflectance: Any) -> None:
        self.point, self.normal, self.distance = point, normal, distance
        self.on_sphere, self.on_light, self.reflectance = on_sphere, on_light, reflectance


class _World:
    """Box, sphere and light, intersected in closed form."""

    def __init__(self, scene: Scene) -> None:
        import mitsuba as mi

        self._box = scene.box
        self._low, self._high = mi.Point3f(*scene.box.minimum), mi.Point3f(*scene.box.maximum)
        self._center, self._radius = mi.Point3f(*scene.sphere.center), scene.sphere.radius
        self._light = scene.light
        self.luminance = scene.light.luminance_cd_m2
        self.light_area = scene.light.size_xz[0] * scene.light.size_xz[1]

    def sphere_blocks(self, point: Any, direction: Any) -> Any:
        """Whether the sphere lies between a wall's point and the ceiling."""
        along, depth2 = self._closest(point, direction)
        return (along > 0) & (depth2 > 0)

    def light_point(self, u: Any, v: Any) -> Any:
        """Point of the light for two uniform numbers."""
        import mitsuba as mi

        (x, z), (width, depth) = self._light.center_xz, self._light.size_xz
        return mi.Point3f(x + (u - 0.5) * width, self._box.maximum[1], z + (v - 0.5) * depth)

    def _closest(self, point: Any, direction: Any) -> tuple[Any, Any]:
        """Distance along the ray to the point nearest the center, and r² minus its squared distance from there."""
        import drjit as dr

        to_center = self._center - point
        along = dr.dot(direction, to_center)
        return along, self._radius**2 - dr.squared_norm(to_center - along * direction)

    def intersect(self, origin: Any, direction: Any, on_sphere: Any) -> _Hit:
        """First surface a ray from inside the box meets; a ray that starts on the convex sphere never meets it."""
        import drjit as dr
        import mitsuba as mi

        along, depth2 = self._closest(origin, direction)
        meets = ~on_sphere & (along > 0) & (depth2 > 0)
        sphere_distance = along - dr.sqrt(dr.maximum(depth2, 0))

        # The box is left through the nearest of the three faces ahead; those behind cannot be met again by rounding.
        face = dr.select(direction > 0, self._high, self._low)
        parallel = direction == 0
        distances = dr.select(parallel, dr.inf, (face - origin) / dr.select(parallel, 1, direction))
        wall_distance = dr.maximum(dr.min(distances), 0)
        through_x = distances.x <= dr.minimum(distances.y, distances.z)
        through_y = ~through_x & (distances.y <= distances.z)
        through_z = ~through_x & ~through_y

        wall = origin + wall_distance * direction
        wall.x = dr.select(through_x, face.x, wall.x)
        wall.y = dr.select(through_y, face.y, wall.y)
        wall.z = dr.select(through_z, face.z, wall.z)
        inward = mi.Vector3f(
            dr.select(through_x, -dr.sign(direction.x), 0),
            dr.select(through_y, -dr.sign(direction.y), 0),
            dr.select(through_z, -dr.sign(direction.z), 0),
        )
        cell = mi.Vector3i(dr.floor((wall - self._low) / self._box.check_size))
        parity = dr.select(through_x, cell.y + cell.z, dr.select(through_y, cell.x + cell.z, cell.x + cell.y)) & 1
        reflectance = dr.select(parity == 0, self._box.dark_reflectance, self._box.light_reflectance)

        (x, z), (width, depth) = self._light.center_xz, self._light.size_xz
        on_light = ~meets & through_y & (direction.y > 0)
        on_light &= (dr.abs(wall.x - x) <= width / 2) & (dr.abs(wall.z - z) <= depth / 2)

        outward = dr.normalize(origin + sphere_distance * direction - self._center)
        return _Hit(
            point=dr.select(meets, self._center + self._radius * outward, wall),
            normal=dr.select(meets, mi.Vector3f(outward), inward),
            distance=dr.select(meets, sphere_distance, wall_distance),
            on_sphere=meets,
            on_light=on_light,
            reflectance=dr.select(on_light, 0.0, reflectance),
        )
