"""All numbers of the report as tables, one CSV file each: what its figures show, and what its text says."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from gloss_analysis.figures.scaling import configuration_regions
from gloss_analysis.report.glossmeter import glossmeter_tables
from gloss_analysis.report.paper_figures import PaperFigure
from gloss_analysis.report.pictures import Picture
from gloss_analysis.report.provenance import file_hashes, render_error, rendering_summary, software_versions
from gloss_analysis.study.analysis import StudyAnalysis
from gloss_analysis.study.comparison import Comparison

__all__ = ["as_csv", "report_tables"]


def report_tables(
    analysis: StudyAnalysis,
    comparison: Sequence[Comparison],
    paper: Sequence[PaperFigure],
    pictures: dict[str, Picture],
) -> dict[str, pd.DataFrame]:
    """Collect the tables of a report, by the names of their files without ending.

    Tables of what observers did have a column `observers`, so that no simulated answer passes for a person's.
    """
    judged = {
        "paper-and-run": pd.DataFrame(
            [(row.quantity, row.paper, row.run, row.why) for row in comparison if row.judged],
            columns=["quantity", "paper", "this_run", "why"],
        ),
        "stress": _stress(analysis),
        "configuration": _configuration(analysis),
        "axes": _axes(analysis),
        "ratings-c": analysis.rated["c"],
        "ratings-d": analysis.rated["d"],
        "regressions": _regressions(analysis),
        "orthogonality": _orthogonality(analysis),
        "own-weights": _own_weights(analysis),
        "tasks": _tasks(analysis),
        "metric": _metric(analysis),
    }
    for axis, test in analysis.hypotheses.items():
        judged[f"hypotheses-{axis}"] = test.compared.merge(test.confirmed, on="hypothesis")
    judged = {name: table.assign(observers=analysis.study.observers) for name, table in judged.items()}
    each = {
        "axis-weights": _weights(analysis),
        "indscal-weights": _indscal_weights(analysis),
        "metric-participants": analysis.metric.table(),
        "consistency": _consistency(analysis),
    }
    programs = analysis.study.simulated_participants
    for name, table in each.items():
        kinds = np.where(table["participant_id"].isin(programs), "simulated", "human")
        judged[name] = table.assign(observers=kinds)
    return (
        judged
        | glossmeter_tables()
        | {
            "equations": pd.DataFrame(
                [(row.quantity, row.paper, row.run, row.why) for row in comparison if not row.judged],
                columns=["quantity", "paper", "this_run", "why"],
            ),
            "figures-of-the-paper": pd.DataFrame(
                [(row.number, row.shows, pictures[row.key].name if row.key else "", row.here) for row in paper],
                columns=["figure", "shows", "file", "here"],
            ),
            "stimuli": analysis.study.stimuli,
            "rendering": _rendering(analysis),
            "software": pd.DataFrame(software_versions().items(), columns=["name", "version"]),
            "sources": pd.DataFrame(file_hashes(analysis.study.folder).items(), columns=["file", "sha256"]),
        }
    )


def as_csv(table: pd.DataFrame) -> bytes:
    """A table as UTF-8 CSV; numbers to ten significant digits, so that rounding of the last ones does not show."""
    return table.to_csv(index=False, float_format="%.10g", lineterminator="\n").encode("utf-8")


def _stress(analysis: StudyAnalysis) -> pd.DataFrame:
    found = analysis.dimensionality
    columns: dict[str, np.ndarray] = {"dimensions": np.array(found.dims), "stress1": found.stress1}
    for name, replicates in (("random", found.random), ("permuted", found.permuted)):
        for label, part in (("median", 0.5), ("low", 0.05), ("high", 0.95)):
            columns[f"{name}_{label}"] = np.nanquantile(replicates, part, axis=0)
    columns["held_out_mean"] = np.array([_mean(column) for column in found.held_out.stress1.T])
    return pd.DataFrame(columns)


def _configuration(analysis: StudyAnalysis) -> pd.DataFrame:
    reading = analysis.axes
    points = analysis.plane.coordinates[:, reading.order] * reading.sign
    table = analysis.coordinates.assign(dimension_c=points[:, 0], dimension_d=points[:, 1])
    regions = configuration_regions(analysis)
    if regions:
        table = table.assign(
            region_centre_c=[one.centre[0] for one in regions],
            region_centre_d=[one.centre[1] for one in regions],
            region_semi_major=[one.semi_axes[0] for one in regions],
            region_semi_minor=[one.semi_axes[1] for one in regions],
            region_angle_deg=[one.angle_deg for one in regions],
        )
    return table.assign(
        identity_1=analysis.axes.identity_rotated[:, 0], identity_2=analysis.axes.identity_rotated[:, 1]
    )


def _axes(analysis: StudyAnalysis) -> pd.DataFrame:
    """Per axis: which dimension stands for it, and how near the fitted direction lies to that dimension."""
    reading = analysis.axes
    rows = []
    for index, axis in enumerate(("c", "d")):
        dimension = int(reading.order[index])
        weighted, turned = reading.vectors[axis], reading.identity_vectors[axis]
        rows.append(
            {
                "axis": axis,
                "dimension": dimension + 1,
                "angle_deg": float(weighted.angle_deg[dimension]),
                "r_squared": weighted.r_squared,
                "identity_angle_deg": float(turned.angle_deg[index]),
                "identity_r_squared": turned.r_squared,
            }
        )
    return pd.DataFrame(rows)


def _regressions(analysis: StudyAnalysis) -> pd.DataFrame:
    rows = []
    for axis, line in analysis.fit.regressions.items():
        ends = analysis.r_squared_intervals[axis] or (np.nan, np.nan)
        row: dict[str, float | str] = {"axis": axis, "n_stimuli": line.n_stimuli, "intercept": line.intercept}
        row |= {"slope": line.slope, "slope_low": line.slope_ci95[0], "slope_high": line.slope_ci95[1]}
        row |= {"r_squared": line.r_squared, "r_squared_low": ends[0], "r_squared_high": ends[1]}
        for fit in line.polynomials:
            row |= {f"r_squared_order_{fit.order}": fit.r_squared}
            row |= {f"leave_one_out_error_order_{fit.order}": fit.leave_one_out_error}
        rows.append(row)
    return pd.DataFrame(rows)


def _weights(analysis: StudyAnalysis) -> pd.DataFrame:
    """Axis ratio of each participant with the interval of their own judgements, and the truth of simulated ones."""
    confirmatory, true = analysis.fit.confirmatory, analysis.study.true_ratios
    unknown = (np.nan, np.nan)
    return pd.DataFrame(
        [
            {
                "participant_id": name,
                "ratio": one.ratio,
                "ratio_low": analysis.ratio_intervals.get(name, unknown)[0],
                "ratio_high": analysis.ratio_intervals.get(name, unknown)[1],
                "stress1": one.stress1,
                "true_ratio": true.get(name, np.nan),
            }
            for name, one in zip(confirmatory.participants, confirmatory.individual, strict=True)
        ]
    )


def _orthogonality(analysis: StudyAnalysis) -> pd.DataFrame:
    found = analysis.orthogonality
    return pd.DataFrame(
        [
            ("independent", found.stress1, np.nan, np.nan, np.nan),
            ("rotated", found.stress1_rotated, found.drop_rotated, np.median(found.null_rotated), found.p_rotated),
            (
                "correlated",
                found.stress1_correlated,
                found.drop_correlated,
                np.median(found.null_correlated),
                found.p_correlated,
            ),
        ],
        columns=["axes", "stress1", "drop", "drop_permuted_median", "p"],
    )


def _own_weights(analysis: StudyAnalysis) -> pd.DataFrame:
    found = analysis.indscal
    known = found.p_value is not None
    rows = [
        ("shared", found.stress1_shared, np.nan, np.nan, np.nan),
        ("own", found.stress1, found.share_taken, np.median(found.null) if known else np.nan, found.p_value),
    ]
    if found.stress1_combined is not None:
        rows.append(("own, of the best combinations of the axes", found.stress1_combined, np.nan, np.nan, np.nan))
    return pd.DataFrame(rows, columns=["weights", "stress1", "drop", "drop_permuted_median", "p"])


def _indscal_weights(analysis: StudyAnalysis) -> pd.DataFrame:
    """Weights of squared differences along axes of sum of squares 1: what INDSCAL prints."""
    found = analysis.indscal
    weights = pd.DataFrame(found.squared_weights, columns=list(found.axes))
    weights.insert(0, "participant_id", found.participants)
    return weights


def _tasks(analysis: StudyAnalysis) -> pd.DataFrame:
    """Mean ratings beside the scale that the judged pairs make, of the stimuli of both tasks."""
    parts = [
        pd.DataFrame(
            {"axis": one.axis, "stimulus": one.stimuli, "rating": one.rating, "pairs_scale_value": one.scale_value}
        )
        for one in analysis.tasks
    ]
    return pd.concat(parts, ignore_index=True)


def _metric(analysis: StudyAnalysis) -> pd.DataFrame:
    check = analysis.metric
    rows = []
    for name, one, against in (
        ("fitted", check.fitted, None),
        ("paper", check.against_paper.second, check.against_paper),
        ("unweighted", check.against_unweighted.second, check.against_unweighted),
    ):
        f_ratio, p = (np.nan, np.nan) if against is None else (against.f_ratio, against.p_value)
        rows.append((name, one.pooled_stress, one.mean_stress, one.n_pairs, f_ratio, p))
    names = ["space", "pooled_stress", "mean_stress", "n_pairs", "f_of_fitted_over_it", "p"]
    return pd.DataFrame(rows, columns=names)


def _consistency(analysis: StudyAnalysis) -> pd.DataFrame:
    judges = {one.participant_id: one for one in analysis.judges}
    raters = {axis: {one.participant_id: one for one in found} for axis, found in analysis.raters.items()}
    rows = []
    for name in analysis.study.participants:
        row: dict[str, object] = {"participant_id": name}
        row["identical_pairs_mean"] = judges[name].identical_mean if name in judges else np.nan
        flags = []
        for axis, found in raters.items():
            one = found.get(name)
            row[f"retest_{axis}"] = np.nan if one is None else one.retest_correlation
            row[f"agreement_{axis}"] = np.nan if one is None else one.agreement
            flags += [] if one is None else [f"ratings along {axis}: {flag}" for flag in one.flags]
        rows.append(row | {"flags": "; ".join(flags)})
    return pd.DataFrame(rows)


def _rendering(analysis: StudyAnalysis) -> pd.DataFrame:
    rows = []
    for name, stimuli in analysis.study.sets.items():
        error = render_error([stimuli])
        median, tail = (np.nan, np.nan) if error is None else (error.median, error.percentile_99_9)
        rows.append((name, len(stimuli.stimuli), median, tail, rendering_summary(stimuli)))
    columns = ["set", "n_stimuli", "error_median_codes", "error_percentile_99_9_codes", "rendering"]
    return pd.DataFrame(rows, columns=columns)


def _mean(values: np.ndarray) -> float:
    known = values[np.isfinite(values)]
    return float(known.mean()) if len(known) else float("nan")
