import pytest

from gloss_experiments.protocol import read_protocol, shipped_protocols
from glossspace.errors import GlossError

MINIMAL = """
format = 1
name = "mine"
kind = "magnitude"
[slider]
low_label = "0"
high_label = "100"
[texts]
question = "Wie glänzend?"
instructions = "…"
"""


def write(folder, text):
    path = folder / "mine.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_the_shipped_protocols_are_the_paper_s():
    """Sections 3.2.3.2 and 3.3.3.2 of the gloss paper: 60 inches, 3.2 degrees, the labels, three repeats."""
    assert list(shipped_protocols()) == ["contrast", "doi", "pairwise"]
    for name in shipped_protocols():
        protocol = read_protocol(name)
        assert protocol.name == name
        assert protocol.display.viewing_distance_cm == pytest.approx(60 * 2.54)
        assert protocol.display.image_width_deg == 3.2
    pairwise = read_protocol("pairwise")
    assert (pairwise.slider.low_label, pairwise.slider.high_label) == ("0, small difference", "100, large difference")
    assert (pairwise.kind, pairwise.design.repeats, pairwise.design.include_identical) == ("pairwise", 1, True)
    assert {read_protocol(name).design.repeats for name in ("contrast", "doi")} == {3}


def test_any_language_and_defaults(tmp_path):
    protocol = read_protocol(write(tmp_path, MINIMAL))
    assert protocol.texts.question == "Wie glänzend?"
    assert protocol.design.repeats == 1


def test_the_hash_is_of_the_meaning(tmp_path):
    plain = read_protocol(write(tmp_path, MINIMAL)).sha256()
    assert read_protocol(write(tmp_path, "# a remark\n" + MINIMAL + "\n[design]\nrepeats = 1\n")).sha256() == plain
    assert read_protocol(write(tmp_path, MINIMAL + "\n[design]\nrepeats = 2\n")).sha256() != plain


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("format = 1", "format = 2"), "format = 2 is not allowed: input should be 1"),
        (('name = "mine"', 'name = "my_task"'), "name = 'my_task' is not allowed: .*pattern"),
        (('kind = "magnitude"', 'kind = "ranking"'), "kind = 'ranking' is not allowed: .*'pairwise' or 'magnitude'"),
        (("[slider]", "[slider]\nwidth_px = 50"), "slider.width_px = 50 is not allowed: .*101"),
        (("[slider]", "[slider]\nwidth = 50"), "unknown key 'slider.width'; allowed beside it are low_label"),
        (("[slider]", "[design]\nrepeats = 0\n[slider]"), "design.repeats = 0 is not allowed"),
        (('question = "Wie glänzend?"', ""), "'texts.question' is missing"),
        (("[slider]", "[slider"), "not valid TOML.*line"),
    ],
)
def test_a_wrong_value_is_named(tmp_path, change, message):
    with pytest.raises(GlossError, match=message) as error:
        read_protocol(write(tmp_path, MINIMAL.replace(*change)))
    assert "\n" not in str(error.value)
    assert "mine.toml" in str(error.value)


def test_an_unknown_name_lists_the_known_ones():
    with pytest.raises(GlossError, match=r"No protocol 'pairs'\. Give a TOML file or one of: contrast, doi, pairwise"):
        read_protocol("pairs")
