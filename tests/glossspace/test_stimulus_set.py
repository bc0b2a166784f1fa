"""The stimulus-set contract, on sets written here by hand: no renderer is needed."""

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from glossspace.errors import GlossError
from glossspace.files import sha256_of
from glossspace.stimulus_set import Stimulus, read_stimulus_set, stimulus_name, write_manifest

REFLECTANCE = st.floats(0, 0.5)
ALPHA = st.floats(1e-6, 1)


def make_set(folder: Path, **changes: object) -> Path:
    """A set of two paints whose files hold arbitrary bytes."""
    entries = []
    for paint in (Stimulus.of(0.193, 0.066, 0.07), Stimulus.of(0.767, 0.099, 0.04)):
        entry = {"name": paint.name, "rho_d": paint.rho_d, "rho_s": paint.rho_s, "alpha": paint.alpha}
        hashes = {}
        for kind, suffix in (("image", "png"), ("luminance", "exr")):
            path = folder / kind / f"{paint.name}.{suffix}"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(f"{kind} of {paint.name}".encode())
            entry[kind] = f"{kind}/{path.name}"
            hashes[kind] = sha256_of(path)
        entries.append({**entry, "sha256": hashes})
    manifest = {
        "name": "two",
        "image": {"width": 512, "height": 512},
        "viewing": {"image_width_deg": 3.2},
        "display": {"black_cd_m2": 0.7},
        "stimuli": entries,
    }
    write_manifest(folder, {**manifest, **changes})
    return folder


def edit(folder: Path, change) -> None:
    path = folder / "manifest.json"
    document = json.loads(path.read_text())
    change(document)
    path.write_text(json.dumps(document))


def test_a_set_reads_as_it_was_written(tmp_path: Path) -> None:
    stimuli = read_stimulus_set(make_set(tmp_path))
    assert stimuli.name == "two"
    assert stimuli.image_size == (512, 512)
    assert stimuli.visual_angle_deg == 3.2
    assert stimuli.manifest["format"] == "glossspace/stimulus-set"
    assert stimuli.manifest["version"] == 1
    name = stimuli.stimuli[0].name
    assert stimuli.image_path(name).read_bytes() == f"image of {name}".encode()
    assert stimuli.luminance_path(name).read_bytes() == f"luminance of {name}".encode()


def test_the_table_holds_the_papers_numbers(tmp_path: Path) -> None:
    table = read_stimulus_set(make_set(tmp_path)).table()
    assert list(table.columns) == ["stimulus", "rho_d", "rho_s", "alpha", "c", "d", "lightness"]
    gray, white = table.to_dict("records")
    # Gloss paper fig. 11 (c = .087, d = .93) and fig. 12 (c = .0578, printed .057); N5 and N9 have L* near 51 and 90.
    assert gray["c"] == pytest.approx(0.087, abs=5e-4)
    assert gray["d"] == pytest.approx(0.93, abs=1e-12)
    assert white["c"] == pytest.approx(0.0578, abs=5e-5)
    assert gray["lightness"] == pytest.approx(51.04, abs=5e-3)
    assert white["lightness"] == pytest.approx(90.2, abs=0.1)


@given(REFLECTANCE, REFLECTANCE, ALPHA, REFLECTANCE, REFLECTANCE, ALPHA)
def test_names_tell_any_two_stimuli_apart(d1, s1, a1, d2, s2, a2) -> None:
    assert (stimulus_name(d1, s1, a1) == stimulus_name(d2, s2, a2)) == ((d1, s1, a1) == (d2, s2, a2))


@given(REFLECTANCE, REFLECTANCE, ALPHA)
def test_a_name_gives_its_parameters_back(rho_d: float, rho_s: float, alpha: float) -> None:
    parts = stimulus_name(rho_d, rho_s, alpha).split("_")
    assert [part[0] for part in parts] == ["d", "s", "a"]
    assert [float(part[1:]) for part in parts] == [rho_d, rho_s, alpha]


def test_name_of_an_experiment_1_stimulus() -> None:
    assert stimulus_name(0.193, 0.066, 0.07) == "d0.193_s0.066_a0.07"
    assert Stimulus.of(-0.0, 0, 1e-5).name == "d0_s0_a0.00001"


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ((-0.1, 0.1, 0.1), r"rho_d must be at least 0, but is -0\.1"),
        ((0.1, -0.1, 0.1), r"rho_s must be at least 0, but is -0\.1"),
        ((0.1, 0.1, 0.0), r"alpha must be above 0, but is 0"),
        ((0.1, 0.1, -0.2), r"alpha must be above 0, but is -0\.2"),
        ((0.95, 0.1, 0.1), r"rho_d \+ rho_s must be at most 1, but 0\.95 \+ 0\.1 = 1\.05"),
        ((float("nan"), 0.1, 0.1), r"rho_d must be a finite number, but is nan"),
    ],
)
def test_impossible_paints_are_refused(values: tuple[float, float, float], message: str) -> None:
    with pytest.raises(GlossError, match=message):
        Stimulus.of(*values)


@pytest.mark.parametrize("kind", ["image", "luminance"])
def test_a_changed_file_is_found(tmp_path: Path, kind: str) -> None:
    stimuli = read_stimulus_set(make_set(tmp_path))
    path = {"image": stimuli.image_path, "luminance": stimuli.luminance_path}[kind](stimuli.stimuli[1].name)
    path.write_bytes(path.read_bytes() + b"!")
    with pytest.raises(GlossError, match=f"hash does not match its {kind}.*Render the set again or restore") as caught:
        read_stimulus_set(tmp_path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)
    assert len(read_stimulus_set(tmp_path, verify=False).stimuli) == 2


def add_high_bit_images(folder: Path) -> None:
    """Give every stimulus a further file, as sets for a display of 16 bits have them."""

    def add(manifest: dict) -> None:
        for entry in manifest["stimuli"]:
            path = folder / f"{entry['name']}-16-bit.png"
            path.write_bytes(b"finer")
            entry["image_high_bit"] = path.name
            entry["sha256"]["image_high_bit"] = sha256_of(path)

    edit(folder, add)


def test_further_files_are_verified_too(tmp_path: Path) -> None:
    stimuli = read_stimulus_set(make_set(tmp_path))
    add_high_bit_images(tmp_path)
    assert read_stimulus_set(tmp_path).stimuli == stimuli.stimuli
    path = tmp_path / f"{stimuli.stimuli[1].name}-16-bit.png"
    path.write_bytes(b"coarser")
    with pytest.raises(GlossError, match=f"hash does not match its image_high_bit: '{path}'.*Render the set again"):
        read_stimulus_set(tmp_path)
    assert len(read_stimulus_set(tmp_path, verify=False).stimuli) == 2
    path.unlink()
    with pytest.raises(GlossError, match=f"image_high_bit of 'd0.767_.*' is missing: there is no '{path}'"):
        read_stimulus_set(tmp_path, verify=False)


def test_a_hash_without_a_file_is_damage(tmp_path: Path) -> None:
    edit(make_set(tmp_path), lambda m: m["stimuli"][0]["sha256"].update(image_high_bit="0" * 64))
    with pytest.raises(GlossError, match=r"manifest\.json' names no file for the image_high_bit of 'd0\.193"):
        read_stimulus_set(tmp_path)


def test_a_missing_file_is_found_even_unverified(tmp_path: Path) -> None:
    make_set(tmp_path)
    next((tmp_path / "image").iterdir()).unlink()
    with pytest.raises(GlossError, match=r"image of 'd.*' is missing.*restore it"):
        read_stimulus_set(tmp_path, verify=False)


def test_a_missing_folder_and_a_missing_manifest_are_told_apart(tmp_path: Path) -> None:
    with pytest.raises(GlossError, match="the folder does not exist.*gloss render"):
        read_stimulus_set(tmp_path / "nowhere")
    with pytest.raises(GlossError, match=r"holds no manifest\.json.*gloss render"):
        read_stimulus_set(tmp_path)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda m: m.update(version=2), "of version 2, but this program reads up to 1. Install a newer"),
        (lambda m: m.update(version="1"), "no valid version: '1'"),
        (lambda m: m.update(version=True), "no valid version: True"),
        (lambda m: m.update(format="something/else"), "no stimulus manifest: its format is 'something/else'"),
        (lambda m: m.pop("name"), "no valid 'name'"),
        (lambda m: m.update(stimuli=[]), "no valid 'stimuli'"),
        (lambda m: m.update(viewing=3.2), "no valid 'viewing'"),
        (lambda m: m.update(image={}), "no valid 'image.width': None"),
        (lambda m: m["image"].update(height="512"), "no valid 'image.height': '512'"),
        (lambda m: m.update(viewing={"image_width_deg": 0}), "no valid 'viewing.image_width_deg': 0"),
        (lambda m: m["stimuli"][0].update(name=5), "has no valid name: 5"),
        (lambda m: m["stimuli"][0].update(name=" "), "has no valid name: ' '"),
        (lambda m: m["stimuli"][0].update(rho_d=10**400), "cannot be: rho_d must be a finite number, but is 1000"),
        (lambda m: m["stimuli"][0].pop("alpha"), "lacks 'alpha'"),
        (lambda m: m["stimuli"].append("d0_s0_a1"), "lacks 'name'"),
        (lambda m: m["stimuli"][0].update(rho_d=1.5), r"cannot be: rho_d \+ rho_s"),
        (lambda m: m["stimuli"][0].update(alpha="rough"), "cannot be: alpha must be a finite number, but is 'rough'"),
        (lambda m: m["stimuli"][0].update(sha256={}), "no hash for the image"),
        (lambda m: m["stimuli"][0].update(sha256=None), "no hash for the image"),
        (lambda m: m["stimuli"][0].update(luminance=None), "names no file for the luminance of 'd0.193_s0.066_a0.07'"),
        (lambda m: m["stimuli"].append(dict(m["stimuli"][0])), "lists the stimulus 'd0.193_s0.066_a0.07' twice"),
    ],
)
def test_a_damaged_manifest_is_named_on_one_line(tmp_path: Path, change, message: str) -> None:
    edit(make_set(tmp_path), change)
    with pytest.raises(GlossError, match=message) as caught:
        read_stimulus_set(tmp_path)
    assert "\n" not in str(caught.value)
    assert "manifest.json" in str(caught.value)


def test_an_unknown_stimulus_is_named(tmp_path: Path) -> None:
    with pytest.raises(GlossError, match="'two'.*has no stimulus 'd1_s0_a1'"):
        read_stimulus_set(make_set(tmp_path)).image_path("d1_s0_a1")
