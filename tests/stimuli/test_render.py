"""The set renderer from end to end, on small images.

What solving costs is shared: `rendered` leaves its coefficients in the tests' cache, and most tests find them there.
"""

import math
import os
import shutil
from pathlib import Path

import numpy as np
import pytest

from gloss_stimuli import exact_renderer
from gloss_stimuli.exact import LEVELS
from gloss_stimuli.images import read_codes, read_luminance
from gloss_stimuli.measurements import find_patches, measure
from gloss_stimuli.render import render_set, tone_curve
from gloss_stimuli.scene import Film, read_scene
from glossspace.errors import GlossError
from glossspace.files import sha256_of
from glossspace.stimulus_set import StimulusSet, read_stimulus_set
from tests.stimuli.small_sets import (
    DRAFT,
    MESH,
    NAMES,
    SIZE,
    exact_codes,
    images_of,
    measurements_of,
    write_list,
    write_scene,
)

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
