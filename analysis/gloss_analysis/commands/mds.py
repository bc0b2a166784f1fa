"""gloss mds: scaling of judged dissimilarities."""

import os
import re
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from gloss_analysis.commands.mds_output import (
    bootstrap_document,
    dimensionality_document,
    print_dimensionality,
    print_regions,
    print_solutions,
    solution_document,
)
from gloss_analysis.commands.observers import note_simulated, simulated_of
from gloss_analysis.commands.waiting import FITTING
from glossspace.console import (
    JsonFlag,
    NumberOfJobs,
    Seed,
    WholeNumber,
    note,
    noted_if_slow,
    print_json,
    progress_bar,
)
from glossspace.errors import GlossError
from glossspace.files import check_folder_target, check_replaceable

if TYPE_CHECKING:
    from gloss_analysis.dimensionality.study import DimensionalityStudy
    from gloss_analysis.mds import MdsSolution
    from gloss_analysis.uncertainty.bootstrap import BootstrapResult

__all__ = ["mds"]

# Starts and replicates: more would not end.
_MOST = 1_000_000


def mds(
    table: Path,
    /,
    *,
    dims: str = "1:5",
    model: Literal["identity", "weighted", "generalised"] = "weighted",
    level: Literal["ratio", "interval", "spline", "ordinal"] = "ordinal",
    ties: Literal["primary", "secondary"] = "primary",
    unconditional: bool = False,
    repeats: Literal["weighted", "mean", "median"] = "weighted",
    starts: WholeNumber = 100,
    replicates: WholeNumber = 0,
    bootstrap: WholeNumber = 0,
    seed: Seed = 1,
    jobs: NumberOfJobs = 1,
    backend: Literal["threads", "dask"] = "threads",
    scheduler: str | None = None,
    out: Path | None = None,
    figures: Path | None = None,
    json: JsonFlag = False,
) -> None:
    """Scale judged dissimilarities: stress and configuration in one or more numbers of dimensions.

    Examples:

        gloss mds study/dataset --dims 1:5

        gloss mds colours.csv --dims 2 --bootstrap 1000 --figures figures

        gloss mds study/dataset --dims 1:5 --replicates 20

        gloss mds miles.csv --dims 2 --level ratio --out map.json --json

    Parameters
    ----------
    table
        A dataset folder; a CSV file with the columns participant_id, stimulus_a, stimulus_b, dissimilarity and, if
        judgements count differently, weight; or a square matrix in a CSV file, of one participant. A pair that was not
        judged is absent or empty; zero is data.
    dims
        One number of dimensions, or a range such as 1:5.
    model
        weighted: participants weight the dimensions of a common space. generalised: each sees a linear
        transformation of it. identity: all see the same space.
    level
        What of the judgements is trusted: their order, a smooth monotone curve of them, their intervals, their ratios.
    ties
        Ordinal only: primary lets equal judgements differ in distance, secondary does not.
    unconditional
        All participants share one transformation, their judgements being on one scale.
    repeats
        How repeats of a pair enter: by their mean, weighted by their number; by their mean; by their median.
    starts
        Starting configurations for each number of dimensions.
    replicates
        With a range of dimensions: also scale so many random and permuted data sets, predict held-out pairs, and
        recommend a number of dimensions with reasons. 20 is a good number.
    bootstrap
        With one number of dimensions: resample participants so many times, for 95 % regions and intervals.
    seed
        Of everything random.
    jobs
        Threads, 0 for one a core; the result does not depend on it.
    backend
        dask: the cluster at --scheduler does --replicates and --bootstrap in place of this machine's threads.
    scheduler
        Address of a Dask scheduler, such as tcp://host:8786.
    out
        With one number of dimensions: a JSON file for the whole solution.
    figures
        A folder for figures.
    """
    from gloss_analysis.cluster import workers
    from gloss_analysis.dimensionality.stress_curve import stress_curve
    from gloss_analysis.dimensionality.study import study_dimensionality
    from gloss_analysis.judgements.judgement_table import read_judgements
    from gloss_analysis.judgements.participant_remarks import judgement_remarks
    from gloss_analysis.judgements.reliability import reliability
    from gloss_analysis.uncertainty.bootstrap import bootstrap as resample

    wanted = _dimensions(dims)
    _check_extras(wanted, starts=starts, replicates=replicates, bootstrap=bootstrap, out=out, figures=figures)
    data, judgements = read_judgements(table, repeats=repeats)
    simulated = simulated_of(table, data.participants)
    remarks = judgement_remarks(data, judgements)
    room = len(data.stimuli) - 1
    if wanted[0] <= room < wanted[-1]:
        note(f"{len(data.stimuli)} stimuli have room for {room} dimensions at most; more of them are left out.")
        wanted = range(wanted[0], room + 1)
    n_jobs = min(jobs or _MOST, os.cpu_count() or 1)
    _compile()
    assumed: dict[str, Any] = {"model": model, "level": level, "ties": ties, "conditional": not unconditional}
    study: DimensionalityStudy | None = None
    regions: BootstrapResult | None = None
    with workers(backend, scheduler), progress_bar() as progress:
        task = progress.add_task("Scaling", total=len(wanted))
        if replicates:
            study = study_dimensionality(
                data, dims=wanted, **assumed, n_starts=starts, n_replicates=replicates, seed=seed, n_jobs=n_jobs,
                on_step=lambda done, total: progress.update(task, completed=done, total=total),
            )  # fmt: skip
            solutions = study.curve
        else:
            solutions = stress_curve(
                data, dims=wanted, **assumed, n_starts=starts, seed=seed, n_jobs=n_jobs,
                on_solution=lambda _: progress.advance(task),
            )  # fmt: skip
        if bootstrap:
            again = progress.add_task("Resampling", total=bootstrap)
            regions = resample(
                data, solutions[0], n_replicates=bootstrap, seed=seed, n_jobs=n_jobs,
                on_step=lambda done, total: progress.update(again, completed=done, total=total),
            )  # fmt: skip
    note_simulated(simulated, data.participants)
    if out is not None:
        solutions[0].save(out)
    if figures is not None:
        _draw(solutions, study, regions, figures)
    if json:
        print_json(
            {"stimuli": data.stimuli, "participants": data.participants, "simulated": simulated}
            | assumed
            | {"seed": seed, "warnings": remarks}
            | {"reliability": [] if judgements is None else [asdict(one) for one in reliability(judgements)]}
            | {"solutions": [solution_document(one) for one in solutions]}
            | ({} if study is None else {"dimensionality": dimensionality_document(study)})
            | ({} if regions is None else {"bootstrap": bootstrap_document(regions)})
        )
        return
    print_solutions(solutions)
    if study is not None:
        print_dimensionality(study)
    if regions is not None:
        print_regions(regions)
    for remark in remarks:
        note(remark)


def _check_extras(
    dims: range, *, starts: int, replicates: int, bootstrap: int, out: Path | None, figures: Path | None
) -> None:
    for name, number, least in (
        ("--starts", starts, 1),
        ("--replicates", replicates, 0),
        ("--bootstrap", bootstrap, 0),
    ):
        if not least <= number <= _MOST:
            raise GlossError(f"Invalid {name} {number}. Allowed: {least} to {_MOST:,}.")
    if len(dims) > 1 and (bootstrap or out is not None):
        option = "--bootstrap" if bootstrap else "--out"
        raise GlossError(f"{option} is about one solution. Give one number of dimensions, such as --dims 2.")
    if len(dims) == 1 and replicates:
        raise GlossError("--replicates compares numbers of dimensions. Give a range, such as --dims 1:5.")
    if figures is not None:
        check_folder_target(figures)
        if out is not None and out.resolve() == figures.resolve():
            raise GlossError(f"--out and --figures are both '{out}'. Give a file and a folder of other names.")
    if out is not None:
        from gloss_analysis.mds import load_solution

        check_replaceable(out, load_solution, what="scaling solution")


def _compile() -> None:
    """Let the solver's kernels be compiled by a tiny problem, and say so if that takes long."""
    from gloss_analysis.judgements.square_matrix import from_matrices
    from gloss_analysis.mds import scale

    with noted_if_slow(FITTING):
        scale(from_matrices([[0, 1, 2], [1, 0, 4], [2, 4, 0]]), n_dims=2, n_starts=1)


def _draw(
    solutions: "tuple[MdsSolution, ...]",
    study: "DimensionalityStudy | None",
    regions: "BootstrapResult | None",
    folder: Path,
) -> None:
    from gloss_analysis.figures import save_mds_figures

    ellipses = None
    if regions is not None and solutions[0].n_dims == 2:
        ellipses = [(*one.centre, *one.semi_axes, one.angle_deg) for one in regions.ellipses()]
    beside: dict[str, Any] = {}
    if study is not None:
        beside = {"random": study.random, "permuted": study.permuted, "held_out": study.held_out.stress1}
    for path in save_mds_figures(solutions, folder, regions=ellipses, **beside):
        note(f"Figure: {path}")


def _dimensions(text: str) -> range:
    # A number of dimensions has few digits, whatever the study.
    written = re.fullmatch(r"([0-9]{1,6})(?::([0-9]{1,6}))?", text.strip())
    first, last = (int(written[1]), int(written[2] or written[1])) if written else (0, 0)
    if not 1 <= first <= last:
        raise GlossError(f"Invalid --dims {text!r}. Allowed: one number such as 2, or a range such as 1:5.")
    return range(first, last + 1)
