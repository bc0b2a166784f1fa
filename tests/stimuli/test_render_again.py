"""What of a set is made again, and what is not: after a change, a fault, an interruption."""

import json
import math
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from gloss_stimuli import exact_renderer, render
from gloss_stimuli.images import read_codes
from gloss_stimuli.render import render_set
from glossspace.stimulus_set import StimulusSet, read_stimulus_set
from tests.stimuli.small_sets import (
    DRAFT,
    NAMES,
    RENDER,
    SIZE,
    exact_codes,
    files_of,
    images_of,
    measurements_of,
    write_list,
    write_scene,
)


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
