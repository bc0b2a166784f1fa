"""The set renderer from end to end, on small images.

What solving costs is shared: `rendered` leaves its coefficients in the tests' cache, and most tests find them there.
"""

import csv
import json
import math
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from gloss_stimuli import exact_renderer, render
from gloss_stimuli.exact import LEVELS
from gloss_stimuli.images import read_codes, read_luminance
from gloss_stimuli.measurements import find_patches, measure
from gloss_stimuli.render import render_set, tone_curve
from gloss_stimuli.scene import Film, read_scene
from glossspace.errors import GlossError
from glossspace.files import sha256_of
from glossspace.stimulus_set import StimulusSet, read_stimulus_set

SIZE = 64
DRAFT = {"size": SIZE, "quality": "draft"}  # as `rendered` is made
NAMES = ["d0.03_s0.099_a0.04", "d0.767_s0.033_a0.04", "d0.193_s0.066_a0.1"]
SHIPPED_SCENE = Path(__file__).parents[2] / "stimuli" / "scenes" / "checkerboard_box.toml"
MESH = Path(__file__).parent / "data" / "mesh_scene" / "scene.toml"
RENDER = "from glossspace.cli import main; main()"


def files_of(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def images_of(stimuli: StimulusSet) -> list[Path]:
    return [path(s.name) for s in stimuli.stimuli for path in (stimuli.image_path, stimuli.luminance_path)]


def exact_codes(stimuli: StimulusSet, name: str) -> NDArray[np.float64]:
    """Code values before rounding, from the luminance file and the numbers of the manifest alone."""
    tone, display = stimuli.manifest["tone_curve"], stimuli.manifest["display"]
    power = (read_luminance(stimuli.luminance_path(name)) / np.float64(tone["adapting_luminance_cd_m2"])) ** (
        tone["exponent"]
    )
    shown = display["white_cd_m2"] * tone["gain"] * (power + 1 / tone["knee"]) / (power + tone["knee"])
    share = (shown - display["black_cd_m2"]) / (display["white_cd_m2"] - display["black_cd_m2"])
    return 255 * np.clip(share, 0, 1) ** (1 / display["gamma"])


def measurements_of(stimuli: StimulusSet) -> list[dict[str, str]]:
    with (stimuli.folder / "measurements.csv").open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def write_list(path: Path, *paints: str) -> Path:
    path.write_text("\n".join(["rho_d,rho_s,alpha", *paints]) + "\n", encoding="utf-8")
    return path


def write_scene(folder: Path, **lines: str) -> Path:
    """The shipped scene with some lines, found by their first word, written anew: ``slope="slope = 0.9"``."""
    text = SHIPPED_SCENE.read_text("utf-8").splitlines()
    for key, line in lines.items():
        (index,) = (k for k, old in enumerate(text) if old.split(" ", 1)[0] == key)
        text[index] = line
    path = folder / "scene.toml"
    path.write_text("\n".join(text), encoding="utf-8")
    return path


@pytest.fixture
def _nothing_is_solved(monkeypatch: pytest.MonkeyPatch) -> None:
    def solve(*arguments: object, **options: object) -> None:
        raise AssertionError("nothing should be solved")

    monkeypatch.setattr(exact_renderer, "solve", solve)


@pytest.fixture(scope="session")
def finer(few_paints: Path, tmp_path_factory: pytest.TempPathFactory) -> StimulusSet:
    """The same set from another seed, and from the two levels above those of `rendered`'s."""
    out = tmp_path_factory.mktemp("finer") / "out"
    return render_set(few_paints, out, size=SIZE, seed=2, max_code_error=0.99, fraction=0.9)


# What a set is


def test_a_set_is_complete_and_verified(rendered: StimulusSet) -> None:
    assert [s.name for s in rendered.stimuli] == NAMES
    assert rendered.image_size == (SIZE, SIZE)
    assert rendered.visual_angle_deg == 3.2
    manifest = rendered.manifest
    assert manifest["rendering"]["method"] == "exact"
    assert manifest["rendering"]["reason"] == "a box within its scope"
    assert manifest["rendering"]["target"] == {"max_code_error": 2.0, "fraction": 0.99}
    assert manifest["rendering"]["seed"] == 1
    assert manifest["scene"]["box"]["light_reflectance"] == 0.767
    assert manifest["scene"]["film"] == {"width": SIZE, "height": SIZE}
    for entry, stimulus in zip(manifest["stimuli"], rendered.stimuli, strict=True):
        assert (entry["c"], entry["d"], entry["lightness"]) == (stimulus.c, stimulus.d, stimulus.lightness)
        assert entry["clipped_pixels"] == 0
        assert entry["rendering"] == {"levels": [0, 1]}
        estimate = entry["error_estimate"]
        assert 0 < estimate["median"] < estimate["percentile_99"] < estimate["percentile_99_9"]
        assert estimate["reached_target"] is True
        assert 0.99 <= estimate["fraction_within_target"] <= 1
        luminance = read_luminance(rendered.luminance_path(stimulus.name))
        codes = read_codes(rendered.image_path(stimulus.name))
        assert luminance.shape == codes.shape == (SIZE, SIZE)
        assert codes.dtype == np.uint8
    assert sorted(p.name for p in rendered.folder.iterdir()) == [
        "composite.png", "finished", "images", "luminance", "manifest.json", "measurements.csv",
    ]  # fmt: skip


def test_codes_are_the_luminance_seen_through_the_manifests_curve_and_display(rendered: StimulusSet) -> None:
    """By the manifest's numbers alone, with the equations written out: what another laboratory would do."""
    for name in NAMES:
        # Half a code is rounding; 1e-6 is the order of the operations.
        difference = np.abs(read_codes(rendered.image_path(name)) - exact_codes(rendered, name))
        assert difference.max() <= 0.5 + 1e-6


def test_measurements_are_those_of_the_files(rendered: StimulusSet, tmp_path: Path) -> None:
    """Measured again on the luminance files, with white from a file too: a perfect diffuser is a paint like others."""
    white = render_set(write_list(tmp_path / "white.csv", "1,0,0.1"), tmp_path / "white", **DRAFT)
    scene = read_scene().with_film(Film(width=SIZE, height=SIZE))
    rows = measurements_of(rendered)
    assert [row["stimulus"] for row in rows] == NAMES
    assert rendered.manifest["measurements"]["sha256"] == sha256_of(rendered.folder / "measurements.csv")
    assert list(rows[0]) == list(rendered.manifest["measurements"]["columns"])
    for row, stimulus in zip(rows, rendered.stimuli, strict=True):
        expected = measure(
            find_patches(scene),
            stimulus,
            read_luminance(rendered.luminance_path(stimulus.name)).astype(float),
            read_luminance(white.luminance_path(white.stimuli[0].name)).astype(float),
            tone=tone_curve(scene),
            display=scene.display.model(),
        )
        for column, value in expected.items():
            if column != "stimulus":
                # White through float32, and seven digits of the table.
                assert float(row[column] or "nan") == pytest.approx(
                    math.nan if value is None else value, rel=2e-6, nan_ok=True
                )
        assert float(row["scene_luminance_ratio"]) > 1


def test_the_error_estimate_is_true(rendered: StimulusSet, finer: StimulusSet) -> None:
    """Against a solution from other random numbers and finer grids, whose own error is half as large."""
    assert [entry["rendering"] for entry in finer.manifest["stimuli"]] == [{"levels": [1, 2]}] * 3
    assert_difference_is_as_stated(rendered, finer)


def test_two_seeds_differ_by_what_both_say(rendered: StimulusSet, finer: StimulusSet, few_paints, tmp_path) -> None:
    other = render_set(few_paints, tmp_path / "other", seed=2, **DRAFT)
    assert [entry["rendering"] for entry in other.manifest["stimuli"]] == [{"levels": [0, 1]}] * 3
    assert_difference_is_as_stated(rendered, other)


def assert_difference_is_as_stated(one: StimulusSet, other: StimulusSet) -> None:
    for name, *entries in zip(NAMES, one.manifest["stimuli"], other.manifest["stimuli"], strict=True):
        errors = np.abs(exact_codes(one, name) - exact_codes(other, name))
        for percent, figure in ((50, "median"), (99, "percentile_99"), (99.9, "percentile_99_9")):
            # Independent errors add as squares. One difference a pixel, shared by 3 × 3 of them, knows its scatter to
            # 24 %; that pixels on an edge lend theirs to neighbours beside it makes the estimate too large in the tail.
            stated = math.hypot(*(entry["error_estimate"][figure] for entry in entries))
            assert 0.6 < np.percentile(errors, percent) / stated < 1.25


# What is made again, and what is not


@pytest.mark.usefixtures("_nothing_is_solved")
def test_finished_stimuli_are_not_made_again(own_copy: StimulusSet, few_paints: Path) -> None:
    before = files_of(own_copy.folder)
    for path in images_of(own_copy):
        os.utime(path, (1, 1))
    render_set(few_paints, own_copy.folder, **DRAFT)
    assert {path.stat().st_mtime for path in images_of(own_copy)} == {1.0}
    assert files_of(own_copy.folder) == before


@pytest.mark.usefixtures("_nothing_is_solved")
@pytest.mark.parametrize("damage", ["image", "luminance", "record", "record of another program"])
def test_only_the_damaged_stimulus_is_made_again(own_copy: StimulusSet, few_paints: Path, damage: str) -> None:
    before = files_of(own_copy.folder)
    record = own_copy.folder / "finished" / f"{NAMES[0]}.json"
    if damage == "image":
        own_copy.image_path(NAMES[0]).write_bytes(b"not a picture")
    elif damage == "luminance":
        own_copy.luminance_path(NAMES[0]).unlink()
    elif damage == "record":
        record.write_bytes(record.read_bytes()[:-20])
    else:
        record.write_text('{"key": "0"}')
    whole = [own_copy.image_path(name) for name in NAMES[1:]]
    for path in whole:
        os.utime(path, (1, 1))
    render_set(few_paints, own_copy.folder, **DRAFT)
    assert {path.stat().st_mtime for path in whole} == {1.0}
    assert files_of(own_copy.folder) == before


@pytest.mark.usefixtures("_nothing_is_solved")
def test_another_tone_curve_solves_nothing_and_leaves_luminance_alone(
    own_copy: StimulusSet, few_paints: Path, tmp_path: Path
) -> None:
    before = files_of(own_copy.folder)
    changed = render_set(few_paints, own_copy.folder, scene=write_scene(tmp_path, slope="slope = 0.9"), **DRAFT)
    after = files_of(own_copy.folder)
    assert changed.manifest["tone_curve"] != own_copy.manifest["tone_curve"]
    for name in NAMES:
        assert after[f"luminance/{name}.exr"] == before[f"luminance/{name}.exr"]
        assert after[f"images/{name}.png"] != before[f"images/{name}.png"]
        difference = np.abs(read_codes(changed.image_path(name)) - exact_codes(changed, name))
        assert difference.max() <= 0.5 + 1e-6  # rounding, and the order of operations


@pytest.mark.usefixtures("_nothing_is_solved")
def test_another_reflectance_solves_nothing_and_rewrites_that_stimulus_alone(
    own_copy: StimulusSet, tmp_path: Path
) -> None:
    kept = [own_copy.image_path(name) for name in NAMES[1:]]
    for path in kept:
        os.utime(path, (1, 1))
    paints = write_list(tmp_path / "paints.csv", "0.03,0.05,0.04", "0.767,0.033,0.04", "0.193,0.066,0.1")
    changed = render_set(paints, own_copy.folder, **DRAFT)
    assert {path.stat().st_mtime for path in kept} == {1.0}
    assert [s.name for s in changed.stimuli] == ["d0.03_s0.05_a0.04", *NAMES[1:]]
    assert [row["stimulus"] for row in measurements_of(changed)] == [s.name for s in changed.stimuli]


@pytest.mark.usefixtures("_nothing_is_solved")
def test_sets_share_what_they_have_in_common(rendered: StimulusSet, tmp_path: Path) -> None:
    """Another list of the same roughnesses, or without a lobe at all, finds its coefficients in the cache."""
    other = write_list(tmp_path / "other.csv", "0.193,0.066,0.1", "0.4,0.05,0.04", "0.4,0,0.2")
    stimuli = render_set(other, tmp_path / "other", **DRAFT)
    assert len(stimuli.stimuli) == 3
    # The stimulus that both sets hold is the same file.
    assert stimuli.image_path(NAMES[2]).read_bytes() == rendered.image_path(NAMES[2]).read_bytes()
    assert stimuli.luminance_path(NAMES[2]).read_bytes() == rendered.luminance_path(NAMES[2]).read_bytes()


@pytest.mark.usefixtures("_nothing_is_solved")
def test_another_viewing_distance_changes_visual_angles_and_no_image(
    own_copy: StimulusSet, few_paints: Path, tmp_path: Path
) -> None:
    before = measurements_of(own_copy)
    scene = write_scene(tmp_path, image_width_deg="image_width_deg = 6.4")
    changed = render_set(few_paints, own_copy.folder, scene=scene, **DRAFT)
    assert changed.visual_angle_deg == 6.4
    for old, new in zip(before, measurements_of(changed), strict=True):
        assert new["scene_edge_width_reflected_deg"] == old["scene_edge_width_reflected_deg"]
        # The width on the screen, and with it every angle on it, grows as the tangent of half the angle.
        factor = math.tan(math.radians(3.2)) / math.tan(math.radians(1.6))
        for kind in ("scene", "displayed"):
            column = f"{kind}_edge_width_visual_deg"
            # Seven digits of the table.
            assert float(new[column]) == pytest.approx(factor * float(old[column]), rel=2e-6)


@pytest.mark.usefixtures("_nothing_is_solved")
def test_other_settings_make_other_images_in_the_same_folder(
    own_copy: StimulusSet, finer: StimulusSet, few_paints: Path
) -> None:
    before = {path.name: path.read_bytes() for path in images_of(own_copy)}
    render_set(few_paints, own_copy.folder, size=SIZE, seed=2, max_code_error=0.99, fraction=0.9)
    after = {path.name: path.read_bytes() for path in images_of(own_copy)}
    assert after == {path.name: path.read_bytes() for path in images_of(finer)}
    assert all(after[name] != before[name] for name in before)


def test_an_interrupted_set_resumes_to_the_same_files(
    rendered: StimulusSet, few_paints: Path, tmp_path: Path, monkeypatch
) -> None:
    out, written = tmp_path / "out", []
    original = render.write_codes

    def interrupted(path: Path, codes: np.ndarray) -> None:
        if len(written) == 2:
            raise KeyboardInterrupt
        written.append(path)
        original(path, codes)

    monkeypatch.setattr(render, "write_codes", interrupted)
    with pytest.raises(KeyboardInterrupt):
        render_set(few_paints, out, **DRAFT)
    # Two are finished and valid, no manifest claims that the set is, and nothing is half-written.
    records = [json.loads(p.read_text()) for p in (out / "finished").iterdir()]
    assert len(records) == 2
    assert not (out / "manifest.json").exists()
    assert not list(out.rglob("*.part*"))
    monkeypatch.setattr(render, "write_codes", original)
    finished = out / records[0]["entry"]["image"]
    os.utime(finished, (1, 1))
    render_set(few_paints, out, **DRAFT)
    assert finished.stat().st_mtime == 1
    assert files_of(out) == files_of(rendered.folder)


def test_a_set_stays_valid_until_an_image_of_it_is_replaced(own_copy: StimulusSet, few_paints, monkeypatch) -> None:
    def solve(*arguments: object, **options: object) -> None:
        raise KeyboardInterrupt

    before = files_of(own_copy.folder)
    monkeypatch.setattr(exact_renderer, "solve", solve)
    with pytest.raises(KeyboardInterrupt):
        render_set(few_paints, own_copy.folder, **DRAFT, seed=3)
    assert files_of(own_copy.folder) == before
    assert read_stimulus_set(own_copy.folder).stimuli == own_copy.stimuli


def test_ctrl_c_ends_on_one_line_and_keeps_what_was_solved(
    rendered_alone: tuple[StimulusSet, set[str]], tmp_path: Path
) -> None:
    out, cache = tmp_path / "out", tmp_path / "cache"
    one = write_list(tmp_path / "one.csv", "0.193,0.066,0.1")
    options = ["--size", str(SIZE), "--quality", "draft", "--cache", str(cache)]
    command = [sys.executable, "-c", RENDER, "render", "--set", str(one), "--out", str(out), *options]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            # After the walls of the first level are solved, with most of the work to come.
            deadline = time.monotonic() + 120
            while not list(cache.glob("exact-*.npz")):
                assert process.poll() is None, process.stderr.read()
                assert time.monotonic() < deadline
                time.sleep(0.02)
            process.send_signal(signal.SIGINT)
            stdout, stderr = process.communicate(timeout=60)
        finally:
            process.kill()
    assert process.returncode == 130, stderr
    assert stdout == ""
    assert "Interrupted. What was finished is kept; run the same command again to go on." in " ".join(stderr.split())
    assert "Traceback" not in stderr
    assert not list(tmp_path.rglob("*.part*"))
    solved = {path: path.read_bytes() for path in cache.iterdir()}
    assert 1 <= len(solved) < 4
    # It goes on with what was kept, to the files of a run that nobody interrupted.
    render_set(one, out, cache=cache, **DRAFT)
    assert {path: path.read_bytes() for path in solved} == solved
    assert files_of(out) == files_of(rendered_alone[0].folder)


def test_same_seed_same_files_whatever_the_threads_the_process_and_the_company(
    rendered: StimulusSet, rendered_alone: tuple[StimulusSet, set[str]]
) -> None:
    alone, _ = rendered_alone
    assert [s.name for s in alone.stimuli] == NAMES[2:]
    for path in ("image_path", "luminance_path"):
        assert getattr(alone, path)(NAMES[2]).read_bytes() == getattr(rendered, path)(NAMES[2]).read_bytes()


# What a scene and a target ask for


@pytest.mark.usefixtures("_nothing_is_solved")
def test_a_display_of_16_bits_gets_finer_images_too(few_paints: Path, tmp_path: Path, rendered: StimulusSet) -> None:
    scene = write_scene(tmp_path, bits="bits = 16")
    stimuli = render_set(few_paints, tmp_path / "out", scene=scene, **DRAFT)
    for entry in stimuli.manifest["stimuli"]:
        name = entry["name"]
        assert entry["image_high_bit"] == f"images-16-bit/{name}.png"
        finer = stimuli.folder / entry["image_high_bit"]
        codes = read_codes(finer)
        assert codes.dtype == np.uint16
        # Half a code is rounding; 257 is 65535 / 255, and 1e-6 of an 8-bit code the order of operations.
        assert np.abs(codes - 257 * exact_codes(stimuli, name)).max() <= 0.5 + 257e-6
        # Whoever has no such display sees the same 8 bits as ever.
        assert stimuli.image_path(name).read_bytes() == rendered.image_path(name).read_bytes()
    finer.write_bytes(b"changed")
    with pytest.raises(GlossError, match=r"hash does not match its image_high_bit: .*images-16-bit"):
        read_stimulus_set(stimuli.folder)
    render_set(few_paints, tmp_path / "out", scene=scene, **DRAFT)
    assert read_codes(finer).dtype == np.uint16


def test_a_wide_film_is_the_middle_of_a_square_one(rendered: StimulusSet, tmp_path: Path) -> None:
    one = write_list(tmp_path / "one.csv", "0.193,0.066,0.1")
    wide = render_set(one, tmp_path / "wide", size="64x32", quality="draft")
    assert wide.image_size == (64, 32)
    assert read_codes(wide.image_path(NAMES[2])).shape == (32, 64)
    errors = np.abs(exact_codes(wide, NAMES[2]) - exact_codes(rendered, NAMES[2])[16:48])
    # Both are draft, with edges at the same places: two code values on 99 % of the pixels.
    assert np.mean(errors < 2) >= 0.99
    assert np.median(errors) < 0.1


def test_extremes_are_finite(tmp_path: Path) -> None:
    rows = ["0,0,0.1", "0,0.1,0.1", "0.5,0,0.1", "0,1,0.001", "0.7,0.3,0.3", "1,0,0.1"]
    stimuli = render_set(write_list(tmp_path / "extreme.csv", *rows), tmp_path / "out", size="4x2", quality="draft")
    luminance = {s.name: read_luminance(stimuli.luminance_path(s.name)) for s in stimuli.stimuli}
    for name, image in luminance.items():
        assert image.shape == (2, 4)
        assert np.isfinite(image).all(), name
        assert (image >= 0).all(), name
    # No paint takes light away from what a black sphere leaves.
    assert all((image >= luminance["d0_s0_a0.1"] * (1 - 1e-6)).all() for image in luminance.values())
    # A picture of eight pixels has no patches to measure.
    assert stimuli.manifest["measurements"]["patches"] is None
    assert set(measurements_of(stimuli)[0].values()) == {"d0_s0_a0.1", ""}


def test_a_target_out_of_reach_takes_the_whole_ladder_and_says_so(
    rendered: StimulusSet, few_paints: Path, tmp_path: Path, monkeypatch, capsys
) -> None:
    # A ladder whose two levels are in the cache; `test_exact_renderer` climbs the whole one.
    monkeypatch.setattr(exact_renderer, "LEVELS", LEVELS[:2])
    monkeypatch.setattr(exact_renderer, "LOOSE_CODE_ERROR", 0.0)
    stimuli = render_set(few_paints, tmp_path / "out", size=SIZE, max_code_error=1e-4, fraction=0.99)
    said = " ".join(capsys.readouterr().err.split())
    assert f"Short of the target, 0.0001 code values on 99 % of the pixels: {', '.join(NAMES)}." in said
    assert "is reached" not in said
    for entry in stimuli.manifest["stimuli"]:
        assert entry["rendering"] == {"levels": [0, 1]}
        assert entry["error_estimate"]["reached_target"] is False
        assert entry["error_estimate"]["fraction_within_target"] < 0.1  # the median alone is a hundred times larger


def test_what_was_reached_is_said(few_paints: Path, tmp_path: Path, rendered: StimulusSet, capsys) -> None:
    render_set(few_paints, tmp_path / "out", **DRAFT)
    said = " ".join(capsys.readouterr().err.split())
    worst = max(e["error_estimate"]["percentile_99_9"] for e in rendered.manifest["stimuli"])
    assert "paints: 3 stimuli by the method 'exact' (a box within its scope)." in said
    assert f"{worst:.2g} at 99.9 % of its pixels. The target, 2 code values on 99 % of the pixels, is reached." in said
    assert "clipped" not in said


@pytest.mark.usefixtures("_nothing_is_solved")
def test_clipped_pixels_are_counted_and_said(few_paints: Path, tmp_path: Path, rendered: StimulusSet, capsys) -> None:
    key = "maximum_luminance_cd_m2"
    scene = write_scene(tmp_path, **{key: f"{key} = 30.0"})
    stimuli = render_set(few_paints, tmp_path / "out", scene=scene, **DRAFT)
    brighter = [int((read_luminance(rendered.luminance_path(name)) > 30).sum()) for name in NAMES]
    assert [entry["clipped_pixels"] for entry in stimuli.manifest["stimuli"]] == brighter
    said = " ".join(capsys.readouterr().err.split())
    assert f"paints: {sum(brighter)} pixels lie outside the tone curve's range and are clipped" in said


# Other renderers


@pytest.mark.usefixtures("llvm")
def test_a_sphere_near_a_wall_is_traced_instead_and_this_is_said(tmp_path: Path, capsys) -> None:
    scene = write_scene(tmp_path, center="center = [0.0, -0.46, 0.0]")
    one = write_list(tmp_path / "one.csv", "0.193,0.066,0.1")
    stimuli = render_set(one, tmp_path / "out", size=8, max_code_error=20, fraction=0.5, scene=scene)
    reason = "the sphere is 0.04 from a wall, nearer than 0.1 of its radius"
    rendering = stimuli.manifest["rendering"]
    assert (rendering["method"], rendering["reason"]) == ("coefficients", reason)
    assert rendering["samples_a_randomisation"] == {"diffuse": 256, "sphere": 64, "wall": 16}
    assert stimuli.manifest["stimuli"][0]["rendering"] == {"randomisations": 8}
    said = " ".join(capsys.readouterr().err.split())
    assert f"paints: 1 stimulus by the method 'coefficients' ({reason})".replace("paints", "one") in said


@pytest.mark.usefixtures("llvm")
def test_coefficients_and_exact_agree(rendered: StimulusSet, few_paints: Path, tmp_path: Path) -> None:
    """Two methods that share nothing but the scene: each within what both say of their errors."""
    traced = render_set(
        few_paints, tmp_path / "out", size=SIZE, method="coefficients", max_code_error=20, fraction=0.5
    )  # fmt: skip
    assert traced.manifest["rendering"]["reason"] == "asked for"
    for name, one, other in zip(NAMES, rendered.manifest["stimuli"], traced.manifest["stimuli"], strict=True):
        errors = np.abs(exact_codes(rendered, name) - exact_codes(traced, name))
        stated = math.hypot(*(entry["error_estimate"]["percentile_99"] for entry in (one, other)))
        # Percentiles of a sum of two errors are at most about the root of the sum of their squares; 1.3 for how well
        # 8 randomisations and one difference know them.
        assert np.percentile(errors, 99) < 1.3 * stated
        means = [float(exact_codes(each, name).mean()) for each in (rendered, traced)]
        assert means[0] == pytest.approx(means[1], abs=0.1)  # 4,096 pixels with errors of about a code value


@pytest.mark.usefixtures("llvm")
def test_path_tracing_takes_the_samples_asked_for(few_paints: Path, tmp_path: Path) -> None:
    stimuli = render_set(few_paints, tmp_path / "out", size=4, method="path", samples_per_pixel=16, quality="draft")
    rendering = stimuli.manifest["rendering"]
    assert (rendering["method"], rendering["reason"]) == ("path", "asked for")
    assert rendering["samples_per_pixel_asked_for"] == 16
    for entry in stimuli.manifest["stimuli"]:
        assert entry["rendering"]["samples_per_pixel"] == 16
        assert entry["rendering"]["stopped_by"] == "number of samples"
    # It knows no white, so it measures nothing; the file is there all the same.
    assert set(measurements_of(stimuli)[0].values()) == {NAMES[0], ""}
    before = [path.read_bytes() for path in images_of(stimuli)]
    for path in images_of(stimuli):
        os.utime(path, (1, 1))
    render_set(few_paints, tmp_path / "out", size=4, method="path", samples_per_pixel=16, quality="draft")
    assert {path.stat().st_mtime for path in images_of(stimuli)} == {1.0}
    assert [path.read_bytes() for path in images_of(stimuli)] == before


@pytest.mark.usefixtures("llvm")
def test_a_mitsuba_scene_makes_a_set_like_any_other(few_paints: Path, tmp_path: Path) -> None:
    stimuli = render_set(few_paints, tmp_path / "out", scene=MESH, size="8x6", samples_per_pixel=64)
    assert stimuli.image_size == (8, 6)
    rendering = stimuli.manifest["rendering"]
    assert (rendering["method"], rendering["reason"]) == ("path", "it is a Mitsuba scene")
    assert set(rendering["scene_files"]) == {"scene.xml", "sky.exr", "icosahedron.ply"}
    for name in NAMES:
        assert np.abs(read_codes(stimuli.image_path(name)) - exact_codes(stimuli, name)).max() <= 0.5 + 1e-6
    # A file of the scene has changed: all is made again.
    scene = shutil.copytree(MESH.parent, tmp_path / "mesh") / "scene.toml"
    mesh = scene.parent / "icosahedron.ply"
    mesh.write_bytes(mesh.read_bytes() + b"\n")
    record = stimuli.folder / "finished" / f"{NAMES[0]}.json"
    before = record.read_bytes()
    render_set(few_paints, stimuli.folder, scene=scene, size="8x6", samples_per_pixel=64)
    assert record.read_bytes() != before


# What is refused


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"size": 15}, "even number from 2 to 4096, but is 15"),
        ({"size": 0}, "even number"),
        ({"size": 5000}, "even number"),
        ({"size": "64x"}, "even number from 2 to 4096, but is 64x"),
        ({"seed": -1}, "seed must be a whole number"),
        ({"seed": 2**32}, "seed must be a whole number from 0 to 4294967295, but is 4294967296"),
        ({"seed": True}, "seed must be a whole number"),
        ({"quality": "perfect"}, "Unknown quality 'perfect'. Allowed are draft and exact"),
        ({"max_code_error": 0.0}, "max-code-error must be a finite number above 0"),
        ({"fraction": 1.0}, "fraction must lie between 0 and 1"),
        ({"method": "radiosity"}, "Unknown method 'radiosity'"),
        ({"samples_per_pixel": 16}, r"\(--spp\) is for --method path alone; the method here is 'exact'"),
        ({"method": "path", "samples_per_pixel": 0}, "samples per pixel must be a whole number from 1"),
        ({"method": "exact", "scene": MESH}, "does not hold for the scene 'icosahedron': it is a Mitsuba scene"),
        ({"scene": "kitchen"}, "No scene 'kitchen'"),
        ({"cache": __file__}, "is a file, where a folder is needed"),
    ],
)
def test_bad_options_are_refused_before_anything_is_written(tmp_path: Path, few_paints: Path, options, message) -> None:
    with pytest.raises(GlossError, match=message):
        render_set(few_paints, tmp_path / "out", **options)
    assert not (tmp_path / "out").exists()


def test_an_impossible_list_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    with pytest.raises(GlossError, match=r"line 2: rho_d \+ rho_s must be at most 1"):
        render_set(write_list(tmp_path / "list.csv", "0.9,0.2,0.1"), tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_file_is_no_folder(few_paints: Path) -> None:
    with pytest.raises(GlossError, match="it is a file"):
        render_set(few_paints, few_paints, **DRAFT)
    with pytest.raises(GlossError, match="is a file, where a folder is needed"):
        render_set(few_paints, few_paints / "out", **DRAFT)


def test_a_tampered_image_is_found(own_copy: StimulusSet) -> None:
    own_copy.image_path(NAMES[0]).write_bytes(b"changed")
    with pytest.raises(
        GlossError, match=r"hash does not match its image.*d0\.03_s0\.099_a0\.04\.png.*Render the set again"
    ):
        read_stimulus_set(own_copy.folder)
