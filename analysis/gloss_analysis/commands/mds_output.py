"""What `gloss mds` says: tables for people, documents for machines."""

from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from glossspace.console import note, print_table

if TYPE_CHECKING:
    from gloss_analysis.dimensionality.study import DimensionalityStudy
    from gloss_analysis.mds import MdsSolution
    from gloss_analysis.uncertainty.bootstrap import BootstrapResult

__all__ = [
    "bootstrap_document", "dimensionality_document", "print_dimensionality", "print_regions", "print_solutions",
    "solution_document",
]  # fmt: skip


def solution_document(solution: "MdsSolution") -> dict[str, Any]:
    """What one solution puts on stdout as JSON; `--out` keeps all of it."""
    names = (
        "n_dims", "stress1", "stress2", "normalized_raw_stress", "proxscal_normalized_raw_stress",
        "dispersion_accounted_for", "tucker_phi", "source_stress1", "stress_per_point", "coordinates",
        "dimension_weights", "starts", "best_hits", "start_spread", "search", "converged", "warnings",
    )  # fmt: skip
    document = {name: getattr(solution, name) for name in names}
    return document | ({"transforms": solution.transforms} if solution.model == "generalised" else {})


def dimensionality_document(study: "DimensionalityStudy") -> dict[str, Any]:
    """Everything that speaks for a number of dimensions, and the recommendation with its reasons."""
    advice, held_out = study.recommendation, study.held_out
    return {
        "dims": study.dims,
        "stress1": study.stress1,
        "random_stress1": study.random,
        "permuted_stress1": study.permuted,
        "held_out_stress1": held_out.stress1,
        "held_out_rank_correlation": held_out.rank_correlation,
        "recommended": advice.n_dims,
        "agreed": advice.agreed,
        "reasons": advice.reasons,
        "p_overall": advice.p_overall,
        "p_structure": advice.p_structure,
        "p_drop": advice.p_drop,
        "warnings": held_out.warnings,
    }


def bootstrap_document(regions: "BootstrapResult") -> dict[str, Any]:
    """Intervals and regions of a bootstrap, without its replicates."""
    document: dict[str, Any] = {
        "resample": regions.resample,
        "replicates": len(regions.stress1),
        "degenerate": regions.n_degenerate,
        "stress1_ci95": regions.stress_interval(),
        "coordinates_ci95": regions.coordinate_intervals(),
        "dimension_weights_ci95": regions.weight_intervals(),
        "warnings": regions.warnings,
    }
    if regions.solution.n_dims >= 2:
        document["ellipses95"] = [
            {"stimulus": one.stimulus, "centre": one.centre, "semi_axes": one.semi_axes, "angle_deg": one.angle_deg}
            for one in regions.ellipses()
        ]
        if regions.solution.model == "weighted":
            document["own_spread_ratio_ci95"] = regions.ratio_interval()
    return document


def print_solutions(solutions: "tuple[MdsSolution, ...]") -> None:
    """Stress of each solution; of a single one also the configuration and the weights."""
    curve = [(s.n_dims, s.stress1, s.stress2, s.tucker_phi, s.starts, s.best_hits, s.converged) for s in solutions]
    columns = ["dimensions", "Stress-1", "Stress-2", "Tucker's phi", "starts", "best hits", "converged"]
    print_table(pd.DataFrame(curve, columns=columns))
    for solution in solutions:
        names = [f"dim {index + 1}" for index in range(solution.n_dims)]
        if len(solutions) == 1:
            configuration = _named("stimulus", solution.stimuli, names, solution.coordinates)
            print_table(configuration.assign(**{"part of stress": solution.stress_per_point}), title="Configuration")
            if solution.model != "identity":
                weights = _named("participant", solution.participants, names, solution.dimension_weights)
                print_table(weights.assign(**{"Stress-1": solution.source_stress1}), title="Dimension weights")
            if solution.n_dims == 1:
                note(f"Search: {solution.search}")
        for warning in solution.warnings:
            note(f"{solution.n_dims} dimensions: {warning}")


def print_dimensionality(study: "DimensionalityStudy") -> None:
    """Stress beside that of random and permuted data, prediction of held-out pairs, and the recommendation."""
    table = pd.DataFrame(
        {
            "dimensions": study.dims,
            "Stress-1": study.stress1,
            "of permuted data, lowest 5 %": np.quantile(study.permuted, 0.05, axis=0),
            "of random data, mean": study.random.mean(axis=0),
            "of held-out pairs": study.held_out.mean_stress1,
            "rank correlation of held-out pairs": study.held_out.mean_rank_correlation,
        }
    )
    print_table(table, title="How many dimensions?")
    advice = study.recommendation
    for reason in advice.reasons:
        print(f"- {reason}")
    print("Recommended: none." if advice.n_dims is None else f"Recommended: {advice.n_dims}.")
    for warning in study.held_out.warnings:
        note(warning)


def print_regions(regions: "BootstrapResult") -> None:
    """95 % intervals of stress and weights, and regions of the stimuli."""
    rows = [("Stress-1", *regions.stress_interval())]
    if regions.solution.model == "weighted" and regions.solution.n_dims >= 2:
        rows.append(("spread along dim 2 over dim 1 in own spaces, geometric mean", *regions.ratio_interval()))
    title = f"95 % intervals of {len(regions.stress1)} resamplings of {regions.resample}"
    print_table(pd.DataFrame(rows, columns=["quantity", "from", "to"]), title=title)
    if regions.solution.n_dims >= 2:
        ellipses = [(one.stimulus, *one.semi_axes, one.angle_deg) for one in regions.ellipses()]
        columns = ["stimulus", "semi-major", "semi-minor", "angle (degrees)"]
        print_table(pd.DataFrame(ellipses, columns=columns), title="95 % regions in the plane of dims 1 and 2")
    for warning in regions.warnings:
        note(warning)


def _named(label: str, names: tuple[str, ...], columns: list[str], values: np.ndarray) -> pd.DataFrame:
    return pd.DataFrame({label: names} | dict(zip(columns, values.T, strict=True)))
