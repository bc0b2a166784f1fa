"""The main job: from reflectance to a report, on small images."""

import base64
import json
import re
from collections import Counter

import numpy as np
import pytest

import gloss_pipeline.reproduce as pipeline
from gloss_analysis.report.folder import report_folder
from gloss_analysis.report.provenance import rendering_summary
from gloss_analysis.study.folder import dataset_folder, gloss_space_file, read_study, report_file, stimulus_folder
from glossspace import cli
from glossspace.dataset import read_simulated_observers
from glossspace.errors import GlossError
from glossspace.metric import GlossSpace, Paint
from glossspace.stimulus_set import StimulusSet, read_stimulus_set

# Every step is the real one, only the images are small and less exact than a study's own.
SMALL = {"size": 32, "quality": "draft"}


@pytest.fixture(scope="session")
def made(tmp_path_factory):
    return pipeline.reproduce_study(tmp_path_factory.mktemp("study"), **SMALL, n_jobs=2)


@pytest.fixture(scope="session")
def study(made):
    return made.report.parent


def test_every_stimulus_and_every_session_of_the_paper_is_there(study):
    # Sections 3.2.3 and 3.3.3 of the gloss paper: 27, 24 and 11 images; 378 pairs; each image rated three times.
    counts = [
        len(read_stimulus_set(stimulus_folder(study, name)).stimuli) for name in ("experiment1", "contrast", "doi")
    ]
    assert counts == [27, 24, 11]
    for name in ("experiment1", "contrast", "doi"):
        rendering = read_stimulus_set(stimulus_folder(study, name)).manifest["rendering"]
        assert (rendering["method"], rendering["target"]) == ("exact", {"max_code_error": 2.0, "fraction": 0.99})
    files = sorted(dataset_folder(study).glob("data/**/*_data.csv"))
    rows = Counter(
        (re.search("task-(.*)_data", path.name)[1], len(path.read_text("utf-8").splitlines()) - 1) for path in files
    )
    assert rows == {("pairwise", 378): 9, ("contrast", 72): 9, ("doi", 33): 9}


def test_simulated_weights_come_back(made):
    # They embody the answer: this tests the software. In the project's own simulations ordinal fits recover a
    # participant's ratio within about 7 %, and the mean of nine within a third of that.
    fit = made.analysis.fit.confirmatory
    true = read_simulated_observers(made.dataset).set_index("participant_id")["ratio"]
    assert set(fit.participants) == set(true.index)
    recovered = np.array([one.ratio for one in fit.individual])
    error = np.log(recovered / true[list(fit.participants)].to_numpy())
    assert np.abs(error).max() < 0.15
    assert abs(error.mean()) < 0.05
    low, high = fit.population_ci95
    assert low < np.exp(np.log(true).mean()) < high


def test_two_dimensions_are_found_and_stand_for_c_and_d(made):
    stress = [solution.stress1 for solution in made.analysis.dimensionality.curve]
    assert stress[0] > 2 * stress[1]
    assert stress[1] - stress[2] < 0.1 * (stress[0] - stress[1])  # the elbow of figure 5
    for index, axis in enumerate(("c", "d")):
        vector = made.analysis.axes.vectors[axis]
        assert vector.r_squared > 0.95
        assert vector.angle_deg[made.analysis.axes.order[index]] < 10
    cost = made.analysis.axes.rotation_stress1
    assert np.argmin(cost) == len(cost) // 2  # no rotation fits better


def test_ratings_rise_linearly_along_their_axes(made):
    for fit in made.analysis.fit.regressions.values():
        assert fit.r_squared > 0.9
        assert fit.slope_ci95[0] > 0


def test_the_gloss_space_can_be_used(made):
    space = GlossSpace.load(gloss_space_file(made.report.parent))
    assert space.weight_d == made.analysis.fit.confirmatory.population_ratio
    assert all("(simulated)" in name for name in space.provenance["observers"])


def test_the_report_is_one_file_with_the_papers_figures_and_says_what_is_simulated(study):
    page = report_file(study).read_text("utf-8")
    for number in range(2, 13):
        assert f"Fig. {number}:" in page
    assert not re.search(r"""(src|href)\s*=\s*["'](?!data:|#)""", page)  # nothing to fetch
    images = re.findall(r'src="data:image/(png|svg\+xml);base64,([^"]+)"', page)
    assert len(images) == page.count("<img") >= 14
    for kind, content in images:
        decoded = base64.b64decode(content, validate=True)
        assert decoded.startswith(b"\x89PNG" if kind == "png" else b"<?xml")
    assert "are programs, not people" in page
    assert "tests the software, not the paper" in page
    assert page.count("method exact; target 2 code values on 99 % of the pixels of every image; seed ") == 3
    assert "Real data." in page


def test_the_fitted_space_is_applied_as_in_section_5_of_the_paper(made, study):
    space = made.analysis.fit.space
    assert space.weight_d != GlossSpace().weight_d
    rings = read_stimulus_set(stimulus_folder(study, "ring"))
    reference, *others = (Paint(s.rho_d, s.rho_s, s.alpha) for s in rings.stimuli)
    assert reference == (0.193, 0.066, 0.07)  # figure 11's: c = .087, d = .93
    distances = [float(space.distance(reference, other)) for other in others]
    # six digits of rho_s and of alpha
    assert distances == pytest.approx([0.04] * 4 + [0.08] * 4, abs=2e-6)
    matched = read_stimulus_set(stimulus_folder(study, "matched"))
    white, *same = (Paint(s.rho_d, s.rho_s, s.alpha) for s in matched.stimuli)
    assert [paint[1:] for paint in (white, *same[:2])] == [(0.099, 0.04)] * 3  # figure 12, top row
    assert [float(space.distance(white, paint)) for paint in same[2:]] == pytest.approx([0, 0], abs=2e-6)
    for name, stimuli in (("ring", rings), ("matched", matched)):
        assert stimuli.manifest["rendering"]["target"] == {"max_code_error": 2.0, "fraction": 0.99}
        assert "(simulated observers)" in stimuli.manifest["title"]
        assert (stimuli.folder / f"{name}.png").read_bytes().startswith(b"\x89PNG")
        assert "(simulated observers)" in (stimuli.folder / f"{name}.svg").read_text("utf-8")


def test_run_again_it_makes_nothing_anew_and_gives_the_same_report(study):
    def state():
        kept = ("stimuli/*/images/*", "stimuli/*/luminance/*", "dataset/data/**/*.csv", "dataset/journals/*")
        return {path: path.stat().st_mtime_ns for pattern in kept for path in study.glob(pattern)}

    def report():
        files = [report_file(study), *(path for path in report_folder(report_file(study)).rglob("*") if path.is_file())]
        return {path: path.read_bytes() for path in files}

    before, written = state(), report()
    assert len(before) == 2 * (27 + 24 + 11 + 9 + 5) + 2 * 27  # 9 and 5 of the ring and the matched spheres
    report_file(study).unlink()
    pipeline.reproduce_study(study, **SMALL, n_jobs=1)
    assert state() == before
    assert report() == written  # also with another number of processes
    assert {"methods.md", "contents.json", "fig11-isogloss-ring.svg", "fig05-stress.pdf"} <= {p.name for p in written}


def test_other_settings_are_refused_in_the_same_folder(study):
    with pytest.raises(GlossError, match=r"holds a study made with seed 1 instead of 2\. Use another --out"):
        pipeline.reproduce_study(study, **SMALL, seed=2)


@pytest.mark.parametrize("settings", [{"size": 7}, {"seed": -1}, {"seed": 2**32}])
def test_settings_that_cannot_be_claim_no_folder(tmp_path, settings):
    with pytest.raises(GlossError, match=r"The (size|seed) must be"):
        pipeline.reproduce_study(tmp_path / "out", **settings)
    assert not (tmp_path / "out").exists()


def test_simulated_answers_never_go_into_a_dataset_of_others(tmp_path):
    dataset_folder(tmp_path).mkdir()
    with pytest.raises(GlossError, match=r"holds 'dataset', but no study of this command\. Use another --out"):
        pipeline.reproduce_study(tmp_path, **SMALL)


def test_a_study_of_another_version_is_told(tmp_path):
    (tmp_path / "study.json").write_text('{"format": "glossspace/study", "version": 2}')
    with pytest.raises(GlossError, match=r"version 2; this version reads 'glossspace/study', version 1"):
        pipeline.reproduce_study(tmp_path, **SMALL)


def test_sets_of_a_study_share_what_they_have_in_common_inside_its_folder(study):
    # Two levels of the diffuse part and of each of the DOI set's eleven roughnesses, which hold those of the other sets
    # but for four of the ring: at 12 and 6 o'clock of two contours.
    assert len(list((study / "stimuli" / "coefficients").iterdir())) == 2 * (1 + 11 + 4)


def test_a_report_on_an_older_set_says_its_quality(study):
    """Manifests from before error targets name a quality, and open as they did."""
    folder = stimulus_folder(study, "doi")
    manifest = json.loads((folder / "manifest.json").read_text("utf-8"))
    older = {"method": "coefficient path tracing", "quality": "draft", "seed": 7, "randomisations": 8}
    stimuli = StimulusSet(folder, "doi", (), {**manifest, "rendering": older})
    assert rendering_summary(stimuli).startswith("method coefficient path tracing; quality draft; seed 7; error of")
    assert rendering_summary(StimulusSet(folder, "doi", (), {"stimuli": [{}]})) == ""


def test_without_options_the_images_are_exact_and_of_512_pixels(monkeypatch, tmp_path):
    class Stop(Exception):
        pass

    def asked_for(study, **options):
        assert (study, options["quality"], options["size"], options["seed"]) == (tmp_path, "exact", 512, 1)
        raise Stop

    monkeypatch.setattr(pipeline, "reproduce_study", asked_for)
    with pytest.raises(Stop):
        cli.main(["reproduce", "--out", str(tmp_path)])


def test_interrupted_it_goes_on_where_it_was(study, tmp_path, monkeypatch):
    class Stop(Exception):
        pass

    def interrupted(*arguments, **options):
        if len(list(tmp_path.glob("dataset/data/**/*.csv"))) == 5:
            raise Stop
        return run_session(*arguments, **options)

    run_session = pipeline.run_session
    # The stimuli are those of the whole run: what is tested here is the sessions.
    monkeypatch.setattr(pipeline, "render_set", lambda *_, **__: None)
    monkeypatch.setattr(pipeline, "stimulus_folder", lambda _, name: stimulus_folder(study, name))
    monkeypatch.setattr(pipeline, "run_session", interrupted)
    monkeypatch.setattr(pipeline, "read_study", lambda _: (_ for _ in ()).throw(Stop))
    with pytest.raises(Stop):
        pipeline.reproduce_study(tmp_path, **SMALL)
    first = {path: path.stat().st_mtime_ns for path in tmp_path.glob("dataset/data/**/*.csv")}
    assert len(first) == 5
    monkeypatch.setattr(pipeline, "run_session", run_session)
    with pytest.raises(Stop):
        pipeline.reproduce_study(tmp_path, **SMALL)
    assert {path: path.stat().st_mtime_ns for path in first} == first
    for path in dataset_folder(study).glob("data/**/*.csv"):
        assert (tmp_path / path.relative_to(study)).read_bytes() == path.read_bytes()


def test_the_settings_of_a_study_are_kept_with_it(study):
    assert json.loads((study / "study.json").read_text("utf-8")) == {
        "format": "glossspace/study", "version": 1, "quality": "draft", "size": 32, "seed": 1
    }  # fmt: skip
    assert read_study(study).pairs.values.shape == (9, 351)
