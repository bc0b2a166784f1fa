import re

import numpy as np
import pytest

from gloss_experiments.protocol import (
    Checks,
    Design,
    Display,
    Protocol,
    Slider,
    Texts,
    read_protocol,
    shipped_protocols,
)
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
    assert list(shipped_protocols()) == ["contrast", "doi", "pairwise", "ranking"]
    for name in shipped_protocols():
        protocol = read_protocol(name)
        assert protocol.name == name
        assert protocol.display.viewing_distance_cm == pytest.approx(60 * 2.54)
        assert protocol.display.image_width_deg == 3.2
    pairwise = read_protocol("pairwise")
    assert (pairwise.slider.low_label, pairwise.slider.high_label) == ("0, small difference", "100, large difference")
    assert (pairwise.kind, pairwise.design.repeats, pairwise.design.include_identical) == ("pairwise", 1, True)
    assert {read_protocol(name).design.repeats for name in ("contrast", "doi")} == {3}
    assert {read_protocol(name).design.catch_trials for name in shipped_protocols()} == {0}


def test_the_shipped_ranking_has_near_isogloss_couples():
    """Section 5.1: stimuli on isogloss contours round a reference of low gloss; eqs. 3 to 5 give their distances."""
    design = read_protocol("ranking").design

    def place(name):
        rho_d, rho_s, alpha = (float(part[1:]) for part in name.split("_"))
        return np.cbrt(rho_s + rho_d / 2) - np.cbrt(rho_d / 2), 1 - alpha

    c, d = place(design.reference)
    couples = [design.stimuli[i : i + 2] for i in range(0, 6, 2)]
    for sharper, stronger in couples:
        (c_1, d_1), (c_2, d_2) = place(sharper), place(stronger)
        assert d_1 > d_2, "the first differs more in d, the second more in c"
        assert c_2 > c_1
        near, far = sorted(np.hypot(x - c, 1.78 * (y - d)) for x, y in ((c_1, d_1), (c_2, d_2)))
        assert far / near < 1.26


def test_the_shipped_protocols_show_every_key():
    """As the message about a missing key says; those that most labs leave alone stand in comments."""
    texts = [path.read_text(encoding="utf-8") for path in shipped_protocols().values()]
    shown = set(re.findall(r"^(?:# )?(\w+) = ", "\n".join(texts), flags=re.MULTILINE))
    parts = {"design": Design, "display": Display, "slider": Slider, "texts": Texts, "checks": Checks}
    assert set(parts) <= set(Protocol.model_fields)
    assert {key for part in parts.values() for key in part.model_fields} <= shown


def test_any_language_and_defaults(tmp_path):
    protocol = read_protocol(write(tmp_path, MINIMAL))
    assert protocol.texts.question == "Wie glänzend?"
    assert protocol.design.repeats == 1


def test_the_hash_is_of_the_meaning(tmp_path):
    plain = read_protocol(write(tmp_path, MINIMAL)).sha256()
    assert read_protocol(write(tmp_path, "# a remark\n" + MINIMAL + "\n[design]\nrepeats = 1\n")).sha256() == plain
    for change in ("repeats = 2", "practice = 1", "break_every = 9"):
        assert read_protocol(write(tmp_path, MINIMAL + f"\n[design]\n{change}\n")).sha256() != plain
    checks = read_protocol(write(tmp_path, MINIMAL + "\n[checks]\nangle = 0.05\n"))
    assert checks.sha256() == plain, "the tolerances of the checks change nothing that an observer meets"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("format = 1", "format = 2"), "format = 2 is not allowed: input should be 1"),
        (('name = "mine"', 'name = "my_task"'), "name = 'my_task' is not allowed: .*pattern"),
        (
            ('kind = "magnitude"', 'kind = "sorting"'),
            "kind = 'sorting' is not allowed: .*'pairwise', 'magnitude' or 'ranking'",
        ),
        (("[slider]", "[slider]\nwidth_px = 50"), "slider.width_px = 50 is not allowed: .*101"),
        (("[slider]", "[slider]\nwidth = 50"), "unknown key 'slider.width'; allowed beside it are low_label"),
        (("[slider]", "[design]\npractice = true\n[slider]"), "design.practice = True is not allowed"),
        (("[slider]", "[checks]\nangle = true\n[slider]"), "checks.angle = True is not allowed"),
        (("[slider]", "[design]\nrepeats = 0\n[slider]"), "design.repeats = 0 is not allowed"),
        (('question = "Wie glänzend?"', ""), "'texts.question' is missing"),
        (("[slider]", "[slider"), "not valid TOML.*line"),
        (('kind = "magnitude"', 'kind = "ranking"'), "a ranking needs design.reference"),
        (("[slider]", '[design]\nreference = "a"\n[slider]'), "design.reference belongs to a ranking"),
        (("[slider]", '[design]\npairs = [["a", "b"]]\n[slider]'), "design.pairs belongs to a pairwise protocol"),
        (
            ("[slider]", '[design]\npairs = [["a", "b"], ["b", "a"]]\n[slider]'),
            "design.pairs has b with a twice; remove one",
        ),
        (("[slider]", '[design]\npairs = [["a", "b"]]\nstimuli = ["a"]\n[slider]'), "leave design.stimuli empty"),
        (
            ('kind = "magnitude"', 'kind = "ranking"\ndesign = {reference = "a", catch_trials = 1}'),
            "a ranking has no catch trials",
        ),
        (
            ("[texts]", '[texts]\nprogress = "{n}"'),
            r"texts.progress = '{n}' is not allowed: .*\{done\} and \{total\} alone",
        ),
        (("[slider]", "[design]\ntime_limit_s = 0\n[slider]"), "design.time_limit_s = 0 is not allowed"),
        (("[slider]", "[design]\nbreak_every = -1\n[slider]"), "design.break_every = -1 is not allowed"),
    ],
)
def test_a_wrong_value_is_named(tmp_path, change, message):
    with pytest.raises(GlossError, match=message) as error:
        read_protocol(write(tmp_path, MINIMAL.replace(*change)))
    assert "\n" not in str(error.value)
    assert "mine.toml" in str(error.value)


def test_an_unknown_name_lists_the_known_ones():
    with pytest.raises(
        GlossError, match=r"No protocol 'pairs'\. Give a TOML file or one of: contrast, doi, pairwise, ranking"
    ):
        read_protocol("pairs")


def pairwise_with_pairs(folder, table):
    (folder / "pairs.csv").write_text(table, encoding="utf-8")
    text = MINIMAL.replace("magnitude", "pairwise") + '[design]\npairs = "pairs.csv"\n'
    return write(folder, text)


def test_pairs_come_from_a_file_beside_the_protocol(tmp_path):
    protocol = read_protocol(pairwise_with_pairs(tmp_path, "stimulus_b,note,stimulus_a\nx,,y\ny,first,y\n"))
    assert protocol.design.pairs == (("y", "x"), ("y", "y"))
    again = Protocol.model_validate(protocol.model_dump(mode="json"))
    assert again == protocol, "a journal holds the pairs, not the name of their file"
    other = read_protocol(pairwise_with_pairs(tmp_path, "stimulus_a,stimulus_b\ny,x\n"))
    assert other.sha256() != protocol.sha256()


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ("stimulus_a,stimulus_b\nx,y\n\ny,x\n", "pairs.csv', line 4: y with x is in line 2 already"),
        ("stimulus_a,stimulus_b\nx,\n", "pairs.csv', line 2: a stimulus is missing"),
        ("stimulus_a,stimulus_b\n", "holds no pair"),
        ("a,b\nx,y\n", "lacks the column 'stimulus_a'"),
    ],
)
def test_a_list_of_pairs_that_cannot_be(tmp_path, table, message):
    with pytest.raises(GlossError, match=message):
        read_protocol(pairwise_with_pairs(tmp_path, table))


def test_a_list_of_pairs_that_is_not_there(tmp_path):
    path = pairwise_with_pairs(tmp_path, "")
    (tmp_path / "pairs.csv").unlink()
    with pytest.raises(GlossError, match="No list of pairs at"):
        read_protocol(path)
