"""gloss ranking: do ranked stimuli follow the order that a gloss space predicts?"""

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import pandas as pd

from gloss_analysis.commands.observers import note_simulated, simulated_of
from glossspace.console import (
    FiniteNumber,
    JsonFlag,
    Seed,
    WholeNumber,
    note,
    print_json,
    print_table,
    print_text,
    progress_bar,
)
from glossspace.errors import GlossError
from glossspace.files import check_file_target
from glossspace.named_space import named_space, note_simulated_space

if TYPE_CHECKING:
    from gloss_analysis.ranking.rank_table import Rankings
    from gloss_analysis.ranking.ranking_study import RankingStudy
    from glossspace.metric import GlossSpace

__all__ = ["ranking"]

_TASK = "ranking"
_FIGURE_SUFFIXES = (".png", ".svg", ".pdf")


def ranking(
    table: Path,
    /,
    *,
    stimuli: Path | None = None,
    reference: str | None = None,
    task: str | None = None,
    space: str = "paper",
    ranked_by: Literal["gloss", "difference"] = "gloss",
    rank_1: Literal["least", "most"] = "least",
    tolerance: FiniteNumber = 0.004,
    permutations: WholeNumber = 9999,
    seed: Seed = 1,
    figure: Path | None = None,
    json: JsonFlag = False,
) -> None:
    """Whether ranked stimuli follow the order that a gloss space predicts (section 5.1 of the gloss paper).

    The predicted order is the gloss distance from a reference of low gloss.
    Compared with it: each participant's ranks, what participants agree on among
    themselves, and whether stimuli on one isogloss contour got similar ranks.

    Examples:

        gloss ranking study/dataset --space gloss-space.json

        gloss ranking ranks.csv --stimuli stimuli.csv --reference s18

        gloss ranking r.csv --stimuli s.csv --reference a --ranked-by difference

        gloss ranking r.csv --stimuli s.csv --reference a --figure r.svg --json

    Parameters
    ----------
    table
        A dataset folder, or a CSV file with the columns participant_id, stimulus, rank, optionally repeat. Equal ranks
        are ties; stimuli may be missing.
    stimuli
        A CSV file with the columns stimulus, rho_d, rho_s, alpha. By default what the dataset itself recorded.
    reference
        Name of the stimulus from which distances are measured; it need not be ranked. By default that of the dataset.
    task
        Name of the ranking task in the dataset; ranking by default.
    space
        A gloss-space.json, or the word paper for the gloss paper's space.
    ranked_by
        What was ranked: gloss, where only stimuli with no less of either dimension than the reference have a
        prediction; or difference from the reference.
    rank_1
        What rank 1 stands for: the least gloss or difference, or the most.
    tolerance
        Stimuli whose distances differ by no more lie on one isogloss contour.
    permutations
        Of every permutation test; all of them where there are no more.
    seed
        Of the permutations.
    figure
        A file for a picture of mean rank against predicted distance.
    """
    from gloss_analysis.ranking.rank_table import Rankings
    from gloss_analysis.ranking.ranking_study import predicted_order, study_ranking
    from glossspace.dataset import read_stimuli, read_stimulus_table
    from glossspace.metric import Paint

    if figure is not None and figure.suffix.lower() not in _FIGURE_SUFFIXES:
        raise GlossError(f"Invalid figure '{figure}'. Allowed: a file name that ends in {', '.join(_FIGURE_SUFFIXES)}.")
    if figure is not None:
        check_file_target(figure)
    if stimuli is None and table.exists() and not table.is_dir():
        raise GlossError(
            f"'{table}' does not tell what its stimuli are. Give --stimuli, a CSV file with the columns stimulus, "
            "rho_d, rho_s, alpha."
        )
    gloss_space = named_space(space)
    rankings, centre = _rankings(table, task, reference)
    known = read_stimuli(table) if stimuli is None else read_stimulus_table(stimuli)
    paints = {row.stimulus: Paint(row.rho_d, row.rho_s, row.alpha) for row in known.itertuples()}
    if rank_1 == "most":
        rankings = Rankings(rankings.participants, rankings.stimuli, -rankings.ranks)
    order = predicted_order(paints, reference=centre, space=gloss_space, ranked_by=ranked_by)
    with progress_bar() as progress:
        permuted = progress.add_task("Permutations")
        study = study_ranking(
            rankings, order, tolerance=tolerance, n_permutations=permutations, seed=seed,
            on_step=lambda done, total: progress.update(permuted, completed=done, total=total),
        )  # fmt: skip
    simulated = simulated_of(table, rankings.participants)
    note_simulated(simulated, rankings.participants)
    note_simulated_space(gloss_space)
    if figure is not None:
        _draw(study, gloss_space, len(simulated), figure)
        note(f"Figure: {figure}")
    for warning in study.warnings:
        note(warning)
    if json:
        asked = {"space": gloss_space.name, "reference": centre, "ranked_by": ranked_by, "simulated": simulated}
        print_json(asked | _document(study))
        return
    print_table(pd.DataFrame([asdict(one) for one in study.participants]))
    print_table(study.stimuli)
    print_text(*study.sentences)


def _rankings(table: Path, task: str | None, reference: str | None) -> "tuple[Rankings, str]":
    """Rankings, and the reference of those that were ranked round one."""
    from gloss_analysis.ranking.rank_table import from_rank_table, read_ranks
    from glossspace.dataset import read_rankings

    if not table.is_dir():
        if task is not None:
            raise GlossError(f"--task is of a dataset folder, and '{table}' is none. Leave --task out.")
        if reference is None:
            raise GlossError(f"'{table}' does not tell the reference. Give --reference, the name of a stimulus.")
        return read_ranks(table), reference
    ranked = read_rankings(table, task or _TASK)
    known = sorted(ranked["reference"].unique())
    if reference is None and len(known) > 1:
        raise GlossError(f"The dataset '{table}' has several references: {', '.join(known)}. Choose with --reference.")
    centre = known[0] if reference is None else reference
    own = ranked[ranked["reference"] == centre]
    if own.empty:
        raise GlossError(f"Nothing in '{table}' was ranked round {centre!r}. Allowed: {', '.join(known)}.")
    return from_rank_table(own, source=f"The dataset '{table}'"), centre


def _document(study: "RankingStudy") -> dict[str, Any]:
    contours = None if study.contours is None else asdict(study.contours)
    if contours is not None:
        level = np.asarray(contours.pop("level"))
        names = study.stimuli["stimulus"].to_numpy()
        contours["stimuli"] = [names[level == one].tolist() for one in np.unique(level) if np.sum(level == one) > 1]
    return {
        "participants": [asdict(one) for one in study.participants],
        "stimuli": study.stimuli.to_dict(orient="records"),
        "mean_tau_b": study.mean_tau_b,
        "mean_tau_b_p": study.mean_tau_b_p,
        "ceiling": study.ceiling,
        "concordance": study.concordance,
        "concordance_p": study.concordance_p,
        "contours": contours,
        "sentences": study.sentences,
        "warnings": study.warnings,
    }


def _draw(study: "RankingStudy", space: "GlossSpace", n_simulated: int, path: Path) -> None:
    from gloss_analysis.figures.ranking import draw_ranking
    from glossspace.files import whole_file

    simulated = " (simulated observers)" if "simulated" in str(space.provenance.get("observers")) else ""
    metric = f"gloss distance from the reference\n{space.name}{simulated}"
    drawn = draw_ranking(study, metric=metric, n_simulated=n_simulated)
    with whole_file(path) as temporary:
        drawn.savefig(temporary, dpi=170)
