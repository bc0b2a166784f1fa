"""How finely a solution is worked out: a ladder of levels, each with other grids than its neighbours."""

from dataclasses import dataclass

__all__ = ["LEVELS", "Level"]


@dataclass(frozen=True, kw_only=True)
class Level:
    """Numbers that trade time for accuracy. No two neighbours on the ladder share a grid.

    Attributes
    ----------
    width_over_gap : float
        Largest width of a cell over its distance from the sphere.
    nodes : int
        Nodes along a side of a cell.
    edge_points : int
        Of product integration, in each direction.
    light_lines : int
        Gauss points across the light, for the walls.
    cone_rays : int
        Rays towards the sphere, for a wall that it would cover wholly: what it hides has edges. What it returns is
        smooth and takes a quarter of them.
    lobe_samples : int
        Of the specular transport to the walls, a node.
    sphere_rows : int
        Of the sphere's grid.
    texels : int
        Of a wall texture, along a side of a cell.
    patch_texels : int
        Of the texture that lobes look up, along a side of a cell.
    sphere_texture_rows : int
        Of the sphere's irradiance.
    edge_passes : int
        Corrections of the walls' textures along edges.
    table_spacing : float
        Of the tables of specular radiance, in units of α.
    table_samples : int
        Lobe samples for a point of a table.
    light_points : int
        Gauss points across the part of the light that a lobe sees.
    lines : int
        Across a pixel that an edge runs through.
    wall_side, sphere_side : int
        Samples along a side of a pixel that shows one check, or the sphere alone.
    pixel_samples : int
        Lobe samples a pixel where α is too small for a table.
    """

    width_over_gap: float
    nodes: int
    edge_points: int
    light_lines: int
    cone_rays: int
    lobe_samples: int
    sphere_rows: int
    texels: int
    patch_texels: int
    sphere_texture_rows: int
    edge_passes: int
    table_spacing: float
    table_samples: int
    light_points: int
    lines: int
    wall_side: int
    sphere_side: int
    pixel_samples: int


LEVELS = (
    Level(
        width_over_gap=1.4, nodes=3, edge_points=8, light_lines=90, cone_rays=4096, lobe_samples=128, sphere_rows=32,
        texels=12, patch_texels=7, sphere_texture_rows=160, edge_passes=2, table_spacing=0.52, table_samples=233,
        light_points=16, lines=12, wall_side=1, sphere_side=2, pixel_samples=512,
    ),
    Level(
        width_over_gap=1.1, nodes=4, edge_points=9, light_lines=130, cone_rays=16384, lobe_samples=256, sphere_rows=40,
        texels=15, patch_texels=9, sphere_texture_rows=208, edge_passes=3, table_spacing=0.46, table_samples=610,
        light_points=18, lines=17, wall_side=2, sphere_side=3, pixel_samples=640,
    ),
    Level(
        width_over_gap=1.6, nodes=5, edge_points=11, light_lines=180, cone_rays=32768, lobe_samples=512, sphere_rows=48,
        texels=18, patch_texels=11, sphere_texture_rows=256, edge_passes=3, table_spacing=0.42, table_samples=987,
        light_points=20, lines=24, wall_side=1, sphere_side=2, pixel_samples=1280,
    ),
    Level(
        width_over_gap=0.7, nodes=4, edge_points=13, light_lines=250, cone_rays=65536, lobe_samples=1024,
        sphere_rows=64, texels=24, patch_texels=15, sphere_texture_rows=320, edge_passes=4, table_spacing=0.36,
        table_samples=2584, light_points=24, lines=33, wall_side=2, sphere_side=3, pixel_samples=8192,
    ),
    Level(
        width_over_gap=0.9, nodes=5, edge_points=15, light_lines=400, cone_rays=131072, lobe_samples=4096,
        sphere_rows=80, texels=30, patch_texels=20, sphere_texture_rows=400, edge_passes=4, table_spacing=0.3,
        table_samples=6765, light_points=30, lines=48, wall_side=3, sphere_side=4, pixel_samples=32768,
    ),
)  # fmt: skip
