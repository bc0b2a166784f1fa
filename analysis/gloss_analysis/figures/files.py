"""The pictures of any scaling solutions as files, each whole or not at all."""

import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, get_args

import numpy as np
import pandas as pd

from gloss_analysis.figures.configuration import draw_configuration_of, draw_subject_weights
from gloss_analysis.figures.diagnostics import draw_shepard, draw_stress_curve, draw_stress_per_point
from gloss_analysis.mds import MdsSolution
from glossspace.errors import GlossError
from glossspace.files import check_folder_target, whole_file

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["FileFormat", "save_mds_figures"]

FileFormat: TypeAlias = Literal["png", "svg"]


def save_mds_figures(
    solutions: MdsSolution | Sequence[MdsSolution],
    folder: str | Path,
    *,
    factor: "pd.Series | Sequence[Any] | None" = None,
    participant_factor: "pd.Series | Sequence[Any] | None" = None,
    regions: "Sequence[Sequence[float]] | np.ndarray | None" = None,
    random: np.ndarray | None = None,
    permuted: np.ndarray | None = None,
    held_out: np.ndarray | None = None,
    file_format: FileFormat = "png",
) -> tuple[Path, ...]:
    """Draw scaling solutions and write the pictures to a folder.

    A single solution gives `configuration`, `shepard`, `weights` and `stress-per-point`; several, which must differ in
    their number of dimensions, give these with the number in the name, as `configuration-2d`, and `stress-curve`.
    Weights are left out where they do not differ, as in the identity model.

    Parameters
    ----------
    solutions : MdsSolution or sequence of MdsSolution
    folder : path
        Made if need be; files of the same names are replaced.
    factor, participant_factor : Series or sequence, optional
        What stimuli and participants differ in; see `draw_configuration_of` and `draw_subject_weights`.
    regions : sequence, optional
        Ellipses for the two-dimensional solution; see `draw_configuration_of`.
    random, permuted, held_out : ndarray, shape (n_replicates, n_solutions), optional
        See `draw_stress_curve`.
    file_format : {"png", "svg"}

    Returns
    -------
    tuple of Path
        The files written. The same solutions give the same bytes with the same version of matplotlib.

    Raises
    ------
    GlossError
        There is no solution, two have the same number of dimensions, the format is not allowed, the folder cannot be
        written to, or see the functions that draw.
    """
    curve = (solutions,) if isinstance(solutions, MdsSolution) else tuple(solutions)
    dims = [solution.n_dims for solution in curve]
    if not curve or len(set(dims)) < len(dims):
        raise GlossError(f"Figures need solutions that differ in their number of dimensions; these have {dims}.")
    if file_format not in get_args(FileFormat):
        raise GlossError(f"Invalid file format {file_format!r}. Allowed: 'png', 'svg'.")
    check_folder_target(folder)
    drawn: dict[str, Figure] = {}
    if len(curve) > 1 or any(one is not None for one in (random, permuted, held_out)):
        drawn["stress-curve"] = draw_stress_curve(curve, random=random, permuted=permuted, held_out=held_out)
    for solution in curve:
        suffix = f"-{solution.n_dims}d" if len(curve) > 1 else ""
        own_regions = regions if solution.n_dims == 2 or len(curve) == 1 else None
        drawn[f"configuration{suffix}"] = draw_configuration_of(solution, factor=factor, regions=own_regions)
        drawn[f"shepard{suffix}"] = draw_shepard(solution)
        if solution.model != "identity" and np.ptp(solution.dimension_weights) > 1e-9:
            drawn[f"weights{suffix}"] = draw_subject_weights(solution, factor=participant_factor)
        drawn[f"stress-per-point{suffix}"] = draw_stress_per_point(solution)
    return tuple(_save(figure, Path(folder) / f"{name}.{file_format}") for name, figure in drawn.items())


def _save(figure: "Figure", path: Path) -> Path:
    import matplotlib

    # A fixed salt, no date and no program's name: the same figure gives the same bytes.
    metadata = {"Date": None} if path.suffix == ".svg" else {"Software": None}
    with (
        whole_file(path) as temporary,
        matplotlib.rc_context({"svg.hashsalt": "glossspace"}),
        warnings.catch_warnings(),
    ):
        # Names in a script that the font lacks show as boxes; whoever looks sees that.
        warnings.filterwarnings("ignore", message="Glyph .* missing from font")
        figure.savefig(temporary, format=path.suffix[1:], dpi=170, metadata=metadata)
    return path
