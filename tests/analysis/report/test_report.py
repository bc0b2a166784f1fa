"""The report of a study: one page that needs nothing else, and files for a paper beside it."""

import base64
import csv
import json
import re
import shutil
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from gloss_analysis.confirmatory.scaling import confirm_axes
from gloss_analysis.report import write_report
from gloss_analysis.study.analysis import StudyAnalysis
from gloss_analysis.study.folder import Study, read_study, stimulus_folder
from glossspace.errors import GlossError
from glossspace.metric import contrast_gloss, distinctness
from tests.analysis.study_folders import SETS, make_study


def page_of(report):
    return report.page.read_text("utf-8")


def words_of(page):
    """What a person reads of a page or can look up: without its style and without the data of its pictures."""
    return re.sub(r"<style>.*?</style>|data:image[^\"]*", "", page, flags=re.DOTALL)


def table_of(report, name):
    return pd.read_csv(report.folder / "tables" / f"{name}.csv", dtype={"participant_id": str})


class TestPage:
    def test_it_needs_no_other_file_and_no_network(self, written):
        page = page_of(written)
        assert not re.search(r"""(src|href)\s*=\s*["'](?!data:|#)""", page)
        assert "http" not in words_of(page)
        images = re.findall(r'src="data:image/(png|svg\+xml);base64,([^"]+)"', page)
        assert len(images) == page.count("<img")
        for kind, content in images:
            decoded = base64.b64decode(content, validate=True)
            assert decoded.startswith(b"\x89PNG" if kind == "png" else b"<?xml")

    def test_every_link_within_it_leads_somewhere(self, written):
        page = page_of(written)
        assert set(re.findall(r'href="#([^"]+)"', page)) <= set(re.findall(r'id="([^"]+)"', page))

    def test_each_figure_of_the_paper_has_its_counterpart_or_a_reason(self, written):
        # The paper has figures 1 to 14. Without rendered spheres of the fitted space, 11 and 12 are missing.
        rows = table_of(written, "figures-of-the-paper")
        assert rows["figure"].tolist() == list(range(1, 15))
        without = rows[rows["file"].isna()]
        assert without["figure"].tolist() == [1, 11, 12, 13, 14]
        assert without["here"].str.startswith("None: ").all()
        for number in range(2, 11):
            assert f"Fig. {number}:" in page_of(written)

    def test_each_section_begins_with_what_the_data_support(self, written, simulated):
        page = words_of(page_of(written))
        findings = re.findall(r'<p class="finding">(.*?)</p>', page, flags=re.DOTALL)
        assert (
            len(findings) == page.count("<h2") - 4 + 5
        )  # not the tables, real data, people, provenance; five in parts
        ratio = simulated.fit.confirmatory.population_ratio
        assert any(f"counts {ratio:.2f} times as much" in finding for finding in findings)

    def test_simulated_observers_are_called_so(self, written):
        page = page_of(written)
        assert "are programs, not people" in page
        assert page.count("tests the software, not the paper") > 5
        for caption in re.findall("<figcaption>(.*?)</figcaption>", page):
            # Known maps, equations, real people, and the glossmeter, in which no observer took part
            own = re.match(
                r"Fig\. (2|3|4|10):|Helm|Dimension weights of Helm|Figure 6 of the glossmeter|KKX|The same Ward",
                caption,
            )
            assert own or caption.endswith("Simulated observers."), caption


class TestFiles:
    def test_what_it_says_it_wrote_is_there(self, written):
        there = {
            path.relative_to(written.folder).as_posix()
            for path in written.folder.rglob("*")
            if path.is_file() and path.name != "contents.json"
        }
        assert there == set(written.files)
        stems = {name.split(".")[0] for name in there if name.startswith("figures/")}
        assert len(stems) >= 18
        assert all({f"{stem}.svg", f"{stem}.pdf"} <= there for stem in stems)

    def test_vector_figures_have_their_letters_and_no_date(self, written):
        for path in written.folder.glob("figures/*.svg"):
            tree = ET.fromstring(path.read_text("utf-8"))
            assert not [element for element in tree.iter() if element.tag.endswith(("}date", "}text"))]
        for path in written.folder.glob("figures/*.pdf"):
            content = path.read_bytes()
            assert content.startswith(b"%PDF")
            assert b"CreationDate" not in content
            assert b"/FontFile2" in content  # TrueType within the file
            assert b"/Type3" not in content  # which journals refuse

    def test_tables_of_answers_say_whose_they_are(self, written):
        for name in ("axis-weights", "ratings-c", "ratings-d", "regressions", "stress", "metric", "consistency"):
            assert set(table_of(written, name)["observers"]) == {"simulated"}

    def test_tables_hold_the_numbers_of_the_analysis(self, written, simulated):
        weights = table_of(written, "axis-weights").set_index("participant_id")
        true = simulated.study.simulated.set_index("participant_id")["ratio"]
        assert weights["true_ratio"].to_dict() == true.to_dict()
        data = simulated.study.pairs
        paints = simulated.study.stimuli.set_index("stimulus").loc[list(data.stimuli)]
        places = np.column_stack([contrast_gloss(paints["rho_d"], paints["rho_s"]), distinctness(paints["alpha"])])
        ratios = [one.ratio for one in confirm_axes(data, places, axes=("c", "d")).individual]
        # Ten digits are written.
        assert weights["ratio"].tolist() == pytest.approx(ratios, rel=1e-9)
        assert (weights["ratio_low"] < weights["ratio"]).all()
        rated = table_of(written, "ratings-d").set_index("stimulus")
        own = simulated.study.ratings["d"]
        # Equalised ranges leave the mean over everybody as it is.
        assert rated["rating"].mean() == pytest.approx(own["rating"].mean(), rel=1e-9)
        assert (rated["ci_low"] < rated["rating"]).all()

    def test_hypotheses_for_both_axes_are_tested_on_ratings_and_pairs(self, written, simulated):
        # What is measured in the images of `study_folders` has no widths of edges.
        assert "Not tested: edge width." in page_of(written)
        found = table_of(written, "hypotheses-d").set_index("hypothesis")
        assert found.index.tolist() == ["1 - alpha", "1 - sqrt(alpha)", "-log(alpha)", "1/alpha"]
        rated = table_of(written, "ratings-d")
        alpha = simulated.study.stimuli.set_index("stimulus").loc[rated["stimulus"], "alpha"].to_numpy()
        forms = {"1 - alpha": -alpha, "1 - sqrt(alpha)": -np.sqrt(alpha), "-log(alpha)": np.log(alpha)}
        for name, values in forms.items():
            r = np.corrcoef(values, rated["rating"])[0, 1]
            assert found.loc[name, "r_squared"] == pytest.approx(r**2, rel=1e-8)  # tables hold ten digits
        # Judged by 1 - alpha.
        assert found["stress1"].idxmin() == found["r_squared"].idxmax() == "1 - alpha"
        assert table_of(written, "hypotheses-c")["stress1"].idxmin() == 2
        assert {"figures/hypotheses-c.svg", "figures/hypotheses-d.svg"} <= set(written.files)

    def test_own_weights_are_set_beside_shared_ones(self, written, simulated):
        found = table_of(written, "own-weights").set_index("weights")
        fit = simulated.fit.confirmatory
        # With the coordinates given INDSCAL is the individual fits: the root mean square of their stress.
        own = np.sqrt(np.mean([one.stress1**2 for one in fit.individual]))
        assert found.loc["own", "stress1"] == pytest.approx(own, rel=1e-6)  # two searches for one minimum
        assert found.loc["shared", "stress1"] == pytest.approx(fit.shared.stress1, rel=1e-6)
        taken = 1 - (own / fit.shared.stress1) ** 2
        assert found.loc["own", "drop"] == pytest.approx(taken, rel=1e-3)  # of two numbers that are near each other
        # Their own ratios are 1.5 to 2, and their noise is 1.5 hundredths of the slider.
        assert found.loc["own", "p"] == 0.01
        assert "Participants weigh the axes differently" in page_of(written)
        weights = table_of(written, "indscal-weights").set_index("participant_id")
        ratios = table_of(written, "axis-weights").set_index("participant_id")["ratio"]
        scale = simulated.coordinates["d"].std() / simulated.coordinates["c"].std()
        assert np.sqrt(weights["d"] / weights["c"]).to_dict() == pytest.approx((ratios * scale).to_dict(), rel=1e-4)

    def test_ratings_are_compared_with_the_scale_of_the_pairs(self, written):
        found = table_of(written, "tasks")
        # Rated and judged: see `study_folders.SETS`.
        assert found["axis"].value_counts().to_dict() == {"c": 4, "d": 3}
        along = found[found["axis"] == "c"]
        r = np.corrcoef(along["pairs_scale_value"], along["rating"])[0, 1]
        assert "4 of 6 rated stimuli were judged in pairs too" in page_of(written)
        assert f"Ratings over MDS scale values: r² = {r**2:.3f}" in page_of(written)

    def test_every_table_is_whole_csv(self, written):
        for path in written.folder.glob("tables/*.csv"):
            header, *rows = csv.reader(path.read_text("utf-8").splitlines())
            assert rows
            assert len(set(header)) == len(header)
            assert all(len(row) == len(header) for row in rows)

    def test_the_same_analysis_gives_the_same_bytes(self, written, simulated, tmp_path):
        again = write_report(simulated, tmp_path / "report.html")
        assert again.page.read_bytes() == written.page.read_bytes()
        assert again.files == written.files
        for name in written.files:
            assert (again.folder / name).read_bytes() == (written.folder / name).read_bytes(), name

    def test_spheres_rendered_from_the_space_are_shown(self, simulated, tmp_path):
        shutil.copytree(simulated.study.folder, tmp_path / "study")
        moved = replace(simulated, study=replace(simulated.study, folder=tmp_path / "study"))
        drawing = b'<?xml version="1.0"?><svg xmlns="http://www.w3.org/2000/svg"/>'
        for name in ("ring", "matched"):
            stimulus_folder(tmp_path / "study", name).mkdir()
            (stimulus_folder(tmp_path / "study", name) / f"{name}.svg").write_bytes(drawing)
        (stimulus_folder(tmp_path / "study", "ring") / "ring.pdf").write_bytes(b"%PDF-1.4")
        report = write_report(moved, tmp_path / "page.html")
        assert report.folder == tmp_path / "page"
        assert {"figures/fig11-isogloss-ring.svg", "figures/fig11-isogloss-ring.pdf"} <= set(report.files)
        assert (report.folder / "figures/fig12-matched-spheres.svg").read_bytes() == drawing
        assert page_of(report).count(base64.b64encode(drawing).decode()) == 2
        rows = table_of(report, "figures-of-the-paper").set_index("figure")
        assert rows.loc[11, "file"] == "fig11-isogloss-ring"


class TestOnePerson:
    def test_nothing_is_called_simulated_and_what_cannot_be_known_is_left_out(self, alone, tmp_path):
        report = write_report(alone, tmp_path / "report.html")
        page = words_of(page_of(report))
        methods = (report.folder / "methods.md").read_text("utf-8")
        assert "simulated" not in page.lower()
        assert "simulated" not in methods.lower()
        assert "<b>Human observers:</b> 01." in page
        assert not re.search(r"\bnan\b", page, flags=re.IGNORECASE)
        assert alone.resampled is None
        assert "too few for an interval" in methods
        assert "One person (01) took part." in methods
        assert "whose error no manifest tells" in methods
        assert not [name for name in report.files if "hypotheses-c" in name]
        assert "Do participants weigh the axes differently?" not in page
        assert set(table_of(report, "consistency")["observers"]) == {"human"}
        assert np.isnan(table_of(report, "regressions")["r_squared_low"]).all()


class TestReading:
    def test_who_took_part(self, simulated, alone):
        assert simulated.study.observers == "simulated"
        assert alone.study.observers == "human"
        mixed = replace(simulated.study, simulated_participants=("01",))
        assert mixed.observers == "human and simulated"
        assert simulated.study.participants == ("01", "02", "03", "04")

    def test_identical_pairs_are_judgements_but_no_pairs_to_scale(self, simulated):
        n = len(SETS["experiment1"])
        assert isinstance(simulated, StudyAnalysis)
        assert isinstance(simulated.study, Study)
        assert simulated.study.pairs.values.shape == (4, n * (n - 1) // 2)
        assert len(simulated.study.judgements) == 4 * (n * (n - 1) // 2 + n)

    def test_a_study_without_a_set(self, tmp_path):
        folder = make_study(tmp_path / "study", [1.8])
        shutil.rmtree(folder / "stimuli" / "doi")
        with pytest.raises(GlossError, match=r"No stimulus set at .*doi"):
            read_study(folder)


class TestCommand:
    def test_it_writes_page_and_folder_and_says_where(self, gloss, tmp_path):
        folder = make_study(tmp_path / "study", [1.6, 2.0])
        code, out, err = gloss("report", folder, "--json", "--jobs", 2)
        assert code == 0, err
        document = json.loads(out)
        assert document["observers"] == "simulated"
        assert document["report"] == str(folder / "report.html")
        assert document["folder"] == str(folder / "report")
        assert (folder / "report" / "methods.md").is_file()
        assert "Independence of the axes" in err
        # A second run replaces what it wrote, and nothing is called foreign.
        before = {name: (folder / "report" / name).read_bytes() for name in document["files"]}
        code, out, err = gloss("report", folder)
        assert (code, out.split()) == (0, [str(folder / "report.html"), str(folder / "report")])
        assert "Not ours" not in err
        assert {name: (folder / "report" / name).read_bytes() for name in before} == before

    def test_a_file_in_the_place_of_the_folder(self, refused, tmp_path):
        (tmp_path / "report").write_text("mine")
        assert "is a file, where a folder is needed" in refused("report", tmp_path)
