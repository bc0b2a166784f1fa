"""All pictures of a study's report: the gloss paper's figures from this run, and those that show how sure they are."""

from gloss_analysis import figures
from gloss_analysis.report.glossmeter import glossmeter_pictures
from gloss_analysis.report.numbers import counted
from gloss_analysis.report.pictures import Picture, drawn, finished
from gloss_analysis.study.analysis import StudyAnalysis
from gloss_analysis.study.examples import CityMap, ColourCircle
from gloss_analysis.study.folder import stimulus_folder

__all__ = ["report_pictures"]


def report_pictures(analysis: StudyAnalysis, cities: CityMap, circle: ColourCircle) -> dict[str, Picture]:
    """Draw all pictures, by the names under which the page and the table of the paper's figures know them.

    Those that need what the study does not have are left out: `hypotheses_c` without measurements in the images, `ring`
    and `matched` where nobody rendered them.
    """
    return {
        **_examples(cities, circle),
        **_dimensions(analysis),
        **_ratings(analysis),
        **_space(analysis),
        **_metric(analysis),
        **glossmeter_pictures(),
    }


def _examples(cities: CityMap, circle: ColourCircle) -> dict[str, Picture]:
    return {
        "map": drawn(
            "fig02-city-map",
            figures.draw_city_map(cities),
            "Map of ten US cities",
            "Fig. 2: the US map, from Table 1 alone.",
        ),
        "map_stress": drawn(
            "fig03-city-stress",
            figures.draw_stress_curve(cities.curve),
            "Stress against dimensions",
            "Fig. 3: stress of the cities.",
        ),
        "circle": drawn(
            "helm-colour-circle",
            figures.draw_colour_circle(circle),
            "Ten colour chips round a circle",
            "Helm's colour chips. Real observers.",
        ),
        "circle_weights": drawn(
            "helm-weights",
            figures.draw_participant_weights(circle),
            "Dimension weights of sixteen participants",
            "Dimension weights of Helm's participants. Real observers.",
        ),
    }


def _dimensions(analysis: StudyAnalysis) -> dict[str, Picture]:
    who, found = analysis.study.observers, analysis.dimensionality
    regions = " Ellipses: 95 % regions over resampled participants." if analysis.resampled is not None else ""
    return {
        "composite": drawn(
            "fig04-stimuli",
            figures.draw_composite(analysis.study.sets["experiment1"]),
            "The rendered spheres",
            "Fig. 4: the stimuli of Experiment 1, code values of the display that they were made for.",
            raster=True,
        ),
        "stress": drawn(
            "fig05-stress",
            figures.draw_stress_curve(
                found.curve, random=found.random, permuted=found.permuted, held_out=found.held_out.stress1
            ),
            "Stress against dimensions",
            "Fig. 5: stress, beside that of random and permuted judgements (median and middle 90 %) and of pairs left "
            "out.",
            observers=who,
        ),
        "plane": drawn(
            "fig06-configuration",
            figures.draw_configuration(analysis),
            "Two-dimensional configuration of the stimuli",
            "Fig. 6: the weighted solution, permuted and reflected only. Fill: lightness; shape: α; size: ρs. "
            f"Arrows: directions in which c and d rise.{regions}",
            observers=who,
        ),
        "shepard": drawn(
            "shepard-diagrams",
            figures.draw_shepard(analysis.plane),
            "Judged dissimilarities against distances for every participant",
            "Shepard diagrams of the two-dimensional solution, with each participant's Stress-1.",
            observers=who,
        ),
        "stress_parts": drawn(
            "stress-parts",
            figures.draw_stress_per_point(analysis.plane),
            "Part of every stimulus and participant in the stress",
            "Who and what the two-dimensional solution fits least.",
            observers=who,
        ),
        "rotation": drawn(
            "rotation-cost",
            figures.draw_rotation_cost(analysis),
            "Stress against rotation of the axes",
            "What turning the axes costs: how firmly the judgements fix them.",
            observers=who,
        ),
        "identity": drawn(
            "configuration-identity",
            figures.draw_identity_configuration(analysis),
            "Two-dimensional configuration without participants' weights",
            "The same judgements without participants' weights, turned so that c rises along dimension 1.",
            observers=who,
        ),
        "orthogonality": drawn(
            "orthogonality",
            figures.draw_orthogonality(analysis.orthogonality),
            "Part of the stress that turned and correlated axes take away, beside permutations",
            "Are the axes independent? What turned and what correlated axes take away of the mean square stress "
            "(line), and what they take away where independent axes are true (bars).",
            observers=who,
        ),
    }


def _ratings(analysis: StudyAnalysis) -> dict[str, Picture]:
    study, lines = analysis.study, analysis.fit.regressions
    bars = "Bars: 95 % t intervals over participants. Band: 95 % of the line."
    pictures = {
        key: drawn(
            name,
            figures.draw_ratings(analysis.rated[axis], axis, lines[axis]),
            f"Mean ratings against {axis}",
            f"Fig. {number}: magnitude estimates against {axis}. {bars}",
            observers=study.observers,
        )
        for key, name, axis, number in (("doi", "fig07-ratings-d", "d", 7), ("contrast", "fig08-ratings-c", "c", 8))
    }
    for axis, test in analysis.hypotheses.items():
        pictures[f"hypotheses_{axis}"] = drawn(
            f"hypotheses-{axis}",
            figures.draw_hypotheses(test.tested, study.stimuli, study.ratings[axis], confirmed=test.confirmed),
            f"Mean ratings against several forms of {axis}",
            f"{counted(len(test.tested), 'hypothesis', 'hypotheses').capitalize()} for {axis} on ratings, with 95 % "
            "intervals, and on judged pairs.",
            observers=study.observers,
        )
    return pictures


def _space(analysis: StudyAnalysis) -> dict[str, Picture]:
    study, fit = analysis.study, analysis.fit
    pictures = {
        "space": drawn(
            "fig09-gloss-space",
            figures.draw_gloss_space(study.sets["experiment1"].table(), fit.space),
            "Stimuli in the gloss space",
            "Fig. 9: the stimuli of Experiment 1 in the gloss space with the weights of this run. Orange: where the "
            "levels of d would lie at both ends of the weight's 95 % interval, about the middle of all.",
            observers=study.observers,
        ),
        "envelope": drawn(
            "fig10-envelope",
            figures.draw_envelope(),
            "Contrast gloss against lightness",
            "Fig. 10: the envelope of gloss space, from eq. 4.",
        ),
        "ratios": drawn(
            "axis-ratios",
            figures.draw_axis_ratios(fit.confirmatory, study.simulated, intervals=analysis.ratio_intervals),
            "Axis ratio of each participant",
            "Weight of d over that of c, by confirmatory scaling. Bars: 95 % from the participant's own judgements.",
            observers=study.observers,
        ),
    }
    who = "" if study.observers == "human" else f" {study.observers.capitalize()} observers."
    applied = {
        "ring": finished(
            "fig11-isogloss-ring",
            stimulus_folder(study.folder, "ring"),
            "ring",
            "Rendered spheres on contours of equal gloss distance",
            f"Fig. 11: spheres on contours of equal gloss distance from a reference, rendered.{who}",
        ),
        "matched": finished(
            "fig12-matched-spheres",
            stimulus_folder(study.folder, "matched"),
            "matched",
            "Rendered spheres of three lightnesses, above with the same physical, below with the same apparent gloss",
            "Fig. 12: white, gray and black spheres with the same physical gloss (above) and the same apparent gloss "
            f"(below), rendered.{who}",
        ),
    }
    return pictures | {key: picture for key, picture in applied.items() if picture is not None}


def _metric(analysis: StudyAnalysis) -> dict[str, Picture]:
    return {
        "predicted": drawn(
            "predicted-against-judged",
            figures.draw_predicted_against_judged(analysis.metric.fitted, metric="distance in the fitted space"),
            "Judged differences against distances in the fitted space",
            "Judged differences of pairs, mean of participants, against distances in the fitted space.",
            observers=analysis.study.observers,
        ),
        "metrics": drawn(
            "stress-of-metrics",
            figures.draw_metric_stress(analysis.metric.table()),
            "STRESS of each participant by several metrics",
            "How far each participant is from what several metrics predict, and from the other participants (STRESS of "
            "García et al.).",
            observers=analysis.study.observers,
        ),
    }
