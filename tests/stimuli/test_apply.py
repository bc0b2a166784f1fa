"""A gloss space applied: rendered sets with their tables and figures, and the two commands."""

import json
from pathlib import Path

import pytest

from gloss_stimuli.apply import render_isogloss_ring, render_matched_spheres
from gloss_stimuli.isogloss_ring import isogloss_ring
from gloss_stimuli.matched_spheres import matched_spheres
from gloss_stimuli.sets import read_stimulus_list
from glossspace import cli
from glossspace.dataset import read_stimulus_table
from glossspace.errors import GlossError
from glossspace.metric import GlossSpace, Paint
from glossspace.stimulus_set import StimulusSet, read_stimulus_set
from tests.stimuli.small_sets import DRAFT, files_of


@pytest.fixture(scope="module")
def matched(rendered: StimulusSet, tmp_path_factory: pytest.TempPathFactory) -> StimulusSet:
    """The paper's spheres, whose one roughness is among those of `rendered`."""
    return render_matched_spheres(tmp_path_factory.mktemp("matched") / "out", **DRAFT)


def test_the_set_is_that_of_the_builder_with_table_list_and_figure(matched: StimulusSet) -> None:
    expected = matched_spheres()
    folder = matched.folder
    assert read_stimulus_set(folder).stimuli == expected.stimuli.stimuli
    assert (matched.name, matched.manifest["title"]) == ("matched", expected.stimuli.title)
    assert matched.manifest["rendering"]["target"] == {"max_code_error": 2.0, "fraction": 0.99}
    assert all(entry["error_estimate"]["reached_target"] for entry in matched.manifest["stimuli"])
    # The table is one that every analysis takes, the list one that `gloss render` takes.
    table = read_stimulus_table(folder / "stimuli.csv")
    assert table.to_dict("list") == expected.table[["stimulus", "rho_d", "rho_s", "alpha"]].to_dict("list")
    assert read_stimulus_list(folder / "stimuli.toml") == expected.stimuli
    assert (folder / "matched.png").read_bytes().startswith(b"\x89PNG")
    assert "<svg" in (folder / "matched.svg").read_text("utf-8")


@pytest.mark.usefixtures("_nothing_is_solved")
def test_again_nothing_is_rendered(matched: StimulusSet) -> None:
    def state() -> dict[Path, int]:
        made = (path for kind in ("images", "luminance", "finished") for path in (matched.folder / kind).iterdir())
        return {path: path.stat().st_mtime_ns for path in made}

    before, content = state(), files_of(matched.folder)
    render_matched_spheres(matched.folder, **DRAFT)
    assert state() == before
    assert len(before) == 15
    assert files_of(matched.folder) == content


def test_pictures_of_paints_that_left_the_set_are_replaced_and_no_others(own_copy: StimulusSet, monkeypatch) -> None:
    folder = own_copy.folder  # three paints of somebody's own are in it
    theirs = {name: content for name, content in files_of(folder).items() if name.startswith(("images", "luminance"))}
    first = render_matched_spheres(folder, **DRAFT)
    second = render_matched_spheres(folder, rho_ds=[0.767, 0.42], **DRAFT)
    there = files_of(folder)
    gone = {s.name for s in first.stimuli} - {s.name for s in second.stimuli}
    own = {s.name for s in own_copy.stimuli}
    assert len(gone) == 4
    for kind, suffix in (("images", "png"), ("luminance", "exr"), ("finished", "json")):
        assert {Path(name).stem for name in there if name.startswith(kind)} == own - gone | {
            s.name for s in second.stimuli
        }
        assert not [name for name in gone if f"{kind}/{name}.{suffix}" in there]
    assert {name: there[name] for name in theirs if Path(name).stem not in gone} == {
        name: content for name, content in theirs.items() if Path(name).stem not in gone
    }


def test_the_ring_follows_the_space(rendered: StimulusSet, tmp_path: Path, capsys) -> None:
    space = GlossSpace(name="ours", weight_d=2.5, provenance={"observers": ["01 (simulated)"]})
    options = {"reference": Paint(0.193, 0.01, 0.1), "radii": [0.05], "n": 4, "space": space}
    ring = render_isogloss_ring(tmp_path / "ring", **options, **DRAFT)
    expected = isogloss_ring(space, reference=options["reference"], radii=[0.05], n=4)
    assert ring.stimuli == expected.stimuli.stimuli
    assert len(ring.stimuli) == 4  # c - .05 is below 0
    assert {s.alpha for s in ring.stimuli} == {0.1, 0.12, 0.08}  # .1 -+ .05 / 2.5
    assert "1 of 4 points are left out" in " ".join(capsys.readouterr().err.split())
    assert "simulated observers" in (tmp_path / "ring" / "ring.svg").read_text("utf-8")
    assert "simulated observers" in ring.manifest["title"]


def test_names_of_spaces_may_hold_anything(matched: StimulusSet, tmp_path: Path) -> None:
    space = GlossSpace(name='a "b" \\ c\n\x07 ρ 😀')
    made = render_matched_spheres(tmp_path / "out", space=space, rho_ds=[0.767], **DRAFT)
    assert 'a "b" \\ c   ρ 😀' in made.manifest["title"]


def test_a_mistake_claims_no_folder(tmp_path: Path) -> None:
    with pytest.raises(GlossError, match="The size must be an even number"):
        render_matched_spheres(tmp_path / "out", size=7)
    with pytest.raises(GlossError, match="Invalid radii"):
        render_isogloss_ring(tmp_path / "out", radii=[])
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(("name", "content"), [("stimuli.csv", "stimulus,rho_d,rho_s,alpha\n"), ("stimuli.toml", "")])
def test_a_table_or_list_of_somebody_else_is_not_replaced(tmp_path: Path, name: str, content: str) -> None:
    (tmp_path / name).write_text(content)
    with pytest.raises(GlossError, match=rf"{name}' is there, was not made by this command, .* Choose another folder"):
        render_matched_spheres(tmp_path, **DRAFT)
    assert [path.name for path in tmp_path.iterdir()] == [name]
    assert (tmp_path / name).read_text() == content


def test_commands_give_the_options_on(tmp_path: Path, monkeypatch) -> None:
    class Stop(Exception):
        pass

    def called(expected: dict[str, object]):
        def render(out: Path, **options: object) -> None:
            assert out == tmp_path / "out"
            assert {key: options[key] for key in expected} == expected
            raise Stop

        return render

    shared = {
        "size": "64", "quality": "draft", "max_code_error": 1.0, "fraction": 0.9, "seed": 7,
        "scene": "checkerboard_box", "cache": tmp_path / "cache",
    }  # fmt: skip
    words = (
        f"--out {tmp_path}/out --size 64 --quality draft --max-code-error 1 --fraction .9 --seed 7 --scene "
        f"checkerboard_box --cache {tmp_path}/cache"
    ).split()
    ring = {"reference": Paint(0.1, 0.2, 0.3), "radii": [0.05, 0.1], "n": 5, "space": GlossSpace()} | shared
    monkeypatch.setattr("gloss_stimuli.apply.render_isogloss_ring", called(ring))
    with pytest.raises(Stop):
        cli.main(["render-ring", "--reference", ".1,.2,.3", "--radii", ".05,.1", "--n", "5", *words])
    spheres = {"reference": Paint(0.1, 0.2, 0.3), "rho_ds": [0.1, 0.5], "space": GlossSpace()} | shared
    monkeypatch.setattr("gloss_stimuli.apply.render_matched_spheres", called(spheres))
    with pytest.raises(Stop):
        cli.main(["render-matched", "--reference", ".1,.2,.3", "--rho-d", ".1,.5", *words])


def test_the_command_prints_one_document_or_one_line(matched: StimulusSet, tmp_path: Path, capsys) -> None:
    space = tmp_path / "space.json"
    GlossSpace(name="ours", provenance={"observers": ["01 (simulated)"]}).save(space)
    words = [
        "render-matched",
        "--size",
        "64",
        "--quality",
        "draft",
        "--space",
        str(space),
        "--out",
        str(tmp_path / "a"),
    ]
    cli.main([*words, "--json"])
    captured = capsys.readouterr()
    document = json.loads(captured.out)
    assert document["stimuli"] == [s.name for s in matched_spheres().stimuli.stimuli]
    assert (document["set"], document["space"], document["reached_target"]) == ("matched", "ours", True)
    assert all(Path(document[key]).is_file() for key in ("manifest", "table"))
    assert [Path(path).name for path in document["figures"]] == ["matched.png", "matched.svg"]
    assert all(Path(path).is_file() for path in document["figures"])
    assert "rests on simulated participants" in " ".join(captured.err.split())
    cli.main(words)
    assert capsys.readouterr().out == f"5 stimuli of matched in {tmp_path / 'a'}\n"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("render-ring --reference 1,2", "Invalid --reference '1,2'. Allowed: three numbers"),
        ("render-ring --reference 0,0,nan", "Invalid --reference '0,0,nan'"),
        ("render-ring --radii x", "Invalid --radii 'x'. Allowed: numbers with commas"),
        ("render-ring --radii ''", "Invalid --radii"),
        ("render-ring --n 2", "Invalid n = 2"),
        ("render-ring --n 2.5", "not a whole number"),
        ("render-ring --space no.json", "No gloss space at 'no.json'"),
        ("render-ring --size 7", "The size must be an even number"),
        ("render-matched --rho-d .95", "rho_d + rho_s must be at most 1, but 0.95 + 0.099"),
        ("render-matched --rho-d .1,.1", "one or several different ones"),
        ("render-matched --quality best", "--quality"),
    ],
)
def test_mistakes_are_one_line_and_code_2(tmp_path: Path, capsys, words: str, message: str) -> None:
    with pytest.raises(SystemExit) as stop:
        cli.main([*words.split(), "--out", str(tmp_path / "out")])
    assert stop.value.code == 2
    captured = capsys.readouterr()
    assert message in captured.err
    assert captured.err.count("\n") == 1
    assert captured.out == ""
    assert not (tmp_path / "out").exists()
