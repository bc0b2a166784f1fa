"""The set renderer from end to end, on small images."""

import json
import os
from pathlib import Path

import numpy as np
import pytest

from gloss_stimuli import passes, render
from gloss_stimuli.images import read_codes, read_luminance
from gloss_stimuli.quality import QUALITIES, Quality
from gloss_stimuli.render import render_set
from glossspace.errors import GlossError
from glossspace.stimulus_set import read_stimulus_set

SIZE = 16


@pytest.fixture(autouse=True)
def _tiny_qualities(monkeypatch: pytest.MonkeyPatch) -> None:
    tiny = Quality(name="tiny", randomisations=8, diffuse_samples=16, sphere_samples=16, wall_samples=8)
    monkeypatch.setitem(QUALITIES, "tiny", tiny)


def files_of(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def test_a_set_is_complete_and_verified(tmp_path: Path, few_paints: Path) -> None:
    stimuli = render_set(few_paints, tmp_path / "out", size=SIZE, quality="tiny")
    assert [s.name for s in stimuli.stimuli] == ["d0.03_s0.099_a0.04", "d0.767_s0.033_a0.04", "d0.193_s0.066_a0.1"]
    assert stimuli.image_size == (SIZE, SIZE)
    assert stimuli.visual_angle_deg == 3.2
    manifest = stimuli.manifest
    assert manifest["rendering"]["quality"] == "tiny"
    assert manifest["rendering"]["samples_per_pixel"] == {"diffuse": 128, "sphere": 128, "wall": 64}
    assert manifest["scene"]["box"]["light_reflectance"] == 0.767
    for entry, stimulus in zip(manifest["stimuli"], stimuli.stimuli, strict=True):
        assert (entry["c"], entry["d"], entry["lightness"]) == (stimulus.c, stimulus.d, stimulus.lightness)
        assert entry["clipped_pixels"] == 0
        assert 0 < entry["error_estimate"]["median"] < entry["error_estimate"]["percentile_99_9"]
        luminance = read_luminance(stimuli.luminance_path(stimulus.name))
        codes = read_codes(stimuli.image_path(stimulus.name))
        assert luminance.shape == codes.shape == (SIZE, SIZE)
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == [
        "composite.png", "finished", "images", "luminance", "manifest.json",
    ]  # fmt: skip


def test_codes_are_the_luminance_seen_through_the_manifests_curve_and_display(tmp_path: Path, few_paints: Path) -> None:
    """By the manifest's numbers alone, with the equations written out: what another laboratory would do."""
    stimuli = render_set(few_paints, tmp_path / "out", size=SIZE, quality="tiny")
    tone, display = stimuli.manifest["tone_curve"], stimuli.manifest["display"]
    for stimulus in stimuli.stimuli:
        y = (read_luminance(stimuli.luminance_path(stimulus.name)) / np.float64(tone["adapting_luminance_cd_m2"])) ** (
            tone["exponent"]
        )
        shown = display["white_cd_m2"] * tone["gain"] * (y + 1 / tone["knee"]) / (y + tone["knee"])
        share = (shown - display["black_cd_m2"]) / (display["white_cd_m2"] - display["black_cd_m2"])
        exact = 255 * share ** (1 / display["gamma"])
        # Half a code is rounding; 1e-6 is the order of the operations.
        assert np.abs(read_codes(stimuli.image_path(stimulus.name)) - exact).max() <= 0.5 + 1e-6


def test_finished_stimuli_are_not_made_again(tmp_path: Path, few_paints: Path, monkeypatch) -> None:
    out = tmp_path / "out"
    render_set(few_paints, out, size=SIZE, quality="tiny")
    images = [p for p in out.rglob("*") if p.suffix in (".png", ".exr") and p.name != "composite.png"]
    assert len(images) == 6
    for path in images:
        os.utime(path, (1, 1))
    monkeypatch.setattr(passes, "trace_pass", _forbidden)
    render_set(few_paints, out, size=SIZE, quality="tiny")
    assert {p.stat().st_mtime for p in images} == {1.0}


def test_only_the_damaged_stimulus_is_made_again(tmp_path: Path, few_paints: Path) -> None:
    out = tmp_path / "out"
    stimuli = render_set(few_paints, out, size=SIZE, quality="tiny")
    before = files_of(out)
    damaged, whole = (stimuli.image_path(stimuli.stimuli[k].name) for k in (0, 1))
    damaged.write_bytes(b"not a picture")
    os.utime(whole, (1, 1))
    render_set(few_paints, out, size=SIZE, quality="tiny")
    assert whole.stat().st_mtime == 1
    assert files_of(out) == before


def test_an_interrupted_set_resumes_to_the_same_files(tmp_path: Path, few_paints: Path, monkeypatch) -> None:
    render_set(few_paints, tmp_path / "whole", size=SIZE, quality="tiny")
    out, written = tmp_path / "out", []
    original = render.write_codes

    def interrupted(path: Path, codes: np.ndarray) -> None:
        if len(written) == 2:
            raise KeyboardInterrupt
        written.append(path)
        original(path, codes)

    monkeypatch.setattr(render, "write_codes", interrupted)
    with pytest.raises(KeyboardInterrupt):
        render_set(few_paints, out, size=SIZE, quality="tiny")
    # Two are finished and valid, no manifest claims that the set is, and nothing is half-written.
    records = [json.loads(p.read_text()) for p in (out / "finished").iterdir()]
    assert len(records) == 2
    assert not (out / "manifest.json").exists()
    assert not list(out.rglob("*.part*"))
    monkeypatch.setattr(render, "write_codes", original)
    finished = out / records[0]["entry"]["image"]
    os.utime(finished, (1, 1))
    render_set(few_paints, out, size=SIZE, quality="tiny")
    assert finished.stat().st_mtime == 1
    assert files_of(out) == files_of(tmp_path / "whole")


def test_sets_that_share_a_cache_share_passes(tmp_path: Path, few_paints: Path, monkeypatch) -> None:
    cache = tmp_path / "cache"
    render_set(few_paints, tmp_path / "a", size=SIZE, quality="tiny", cache=cache)
    assert len(list(cache.iterdir())) == 3  # the diffuse pass and two roughnesses
    monkeypatch.setattr(passes, "trace_pass", _forbidden)
    other = tmp_path / "other.csv"
    other.write_text("rho_d,rho_s,alpha\n0.4,0.05,0.1\n0.4,0.05,0.04\n0.4,0,0.2\n", encoding="utf-8")
    stimuli = render_set(other, tmp_path / "b", size=SIZE, quality="tiny", cache=cache)
    assert len(stimuli.stimuli) == 3


def test_other_settings_make_other_images_in_the_same_folder(tmp_path: Path, few_paints: Path) -> None:
    out = tmp_path / "out"
    first = files_of(render_set(few_paints, out, size=SIZE, quality="tiny", seed=1).folder / "images")
    second = files_of(render_set(few_paints, out, size=SIZE, quality="tiny", seed=2).folder / "images")
    assert first.keys() == second.keys()
    assert all(first[name] != second[name] for name in first)


def test_extremes_are_finite(tmp_path: Path) -> None:
    paints = tmp_path / "extreme.csv"
    rows = ["0,0,0.1", "0,0.1,0.1", "0.5,0,0.1", "0,1,0.001", "0.7,0.3,0.3", "1,0,0.1"]
    paints.write_text("\n".join(["rho_d,rho_s,alpha", *rows]), encoding="utf-8")
    stimuli = render_set(paints, tmp_path / "out", size=2, quality="tiny")
    for stimulus in stimuli.stimuli:
        luminance = read_luminance(stimuli.luminance_path(stimulus.name))
        assert np.isfinite(luminance).all()
        assert (luminance >= 0).all()


def test_the_error_estimate_is_true(tmp_path: Path, few_paints: Path) -> None:
    """Two renderings with other seeds differ by what their estimates say: the root of two times the error of one."""
    one, two = (
        render_set(few_paints, tmp_path / str(seed), size=64, quality="tiny", seed=seed, cache=tmp_path / "cache")
        for seed in (1, 2)
    )
    for stimulus, entry in zip(one.stimuli, one.manifest["stimuli"], strict=True):
        tone, display = render.tone_curve(render.read_scene()), render.display_model(render.read_scene())
        a, b = (display.exact_codes(108 * tone(read_luminance(s.luminance_path(stimulus.name)))) for s in (one, two))
        difference = np.abs(a - b) / np.sqrt(2)
        estimate = entry["error_estimate"]
        # 8 randomisations know a variance to 50 % a pixel, all pixels together to a few per cent; the normal law is
        # rough for path tracing's heavy tails, which matter most in the rare percentiles.
        assert np.percentile(difference, 50) == pytest.approx(estimate["median"], rel=0.3)
        assert np.percentile(difference, 99) == pytest.approx(estimate["percentile_99"], rel=0.5)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"size": 15}, "even number from 2 to 4096, but is 15"),
        ({"size": 0}, "even number"),
        ({"size": 5000}, "even number"),
        ({"seed": -1}, "seed must be a whole number"),
        ({"quality": "perfect"}, "Unknown quality 'perfect'"),
        ({"scene": "kitchen"}, "No scene 'kitchen'"),
        ({"cache": __file__}, "is a file, where a folder is needed"),
    ],
)
def test_bad_options_are_refused_before_anything_is_written(tmp_path: Path, few_paints: Path, options, message) -> None:
    with pytest.raises(GlossError, match=message):
        render_set(few_paints, tmp_path / "out", **options)
    assert not (tmp_path / "out").exists()


def test_a_file_is_no_folder(tmp_path: Path, few_paints: Path) -> None:
    with pytest.raises(GlossError, match="it is a file"):
        render_set(few_paints, few_paints, size=SIZE, quality="tiny")
    with pytest.raises(GlossError, match="is a file, where a folder is needed"):
        render_set(few_paints, few_paints / "out", size=SIZE, quality="tiny")


def test_a_tampered_image_is_found(tmp_path: Path, few_paints: Path) -> None:
    stimuli = render_set(few_paints, tmp_path / "out", size=SIZE, quality="tiny")
    stimuli.image_path("d0.03_s0.099_a0.04").write_bytes(b"changed")
    with pytest.raises(
        GlossError, match=r"hash does not match its image.*d0\.03_s0\.099_a0\.04\.png.*Render the set again"
    ):
        read_stimulus_set(tmp_path / "out")


def _forbidden(*arguments: object, **options: object) -> None:
    raise AssertionError("nothing should be traced")
