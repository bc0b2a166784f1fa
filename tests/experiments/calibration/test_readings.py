"""Tables of readings: strict in, whole out."""

import pytest

from gloss_experiments.calibration import Readings, read_readings, standard_patches, write_readings
from glossspace.errors import GlossError
from tests.experiments.calibration.screens import readings_of

HEADER = "purpose,position,red,green,blue,luminance_cd_m2"


def table(tmp_path, *rows, header=HEADER):
    path = tmp_path / "readings.csv"
    path.write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
    return path


def test_a_table_as_a_lab_writes_it(tmp_path):
    path = table(
        tmp_path,
        "fit, centre, 0, 0, 0, 0.7, , , , LS-110",
        "",
        "warm_up,full,255,255,255,107.5,12.5,.31,.33,LS-110",
        header=HEADER + ",minutes,x,y,photometer",
    )
    found = read_readings(path)
    assert (found.photometer, found.simulated) == ("LS-110", False)
    black, white = found.items
    assert (black.patch.codes, black.luminance_cd_m2, black.x, black.minutes) == ((0, 0, 0), 0.7, None, None)
    assert (white.patch.minutes, white.minutes, white.x, white.y) == (12.5, 12.5, 0.31, 0.33)


def test_what_is_written_is_read_again(tmp_path):
    readings = readings_of(patches=standard_patches(warm_up_min=20), noise=0.01)
    write_readings(tmp_path / "a.csv", readings)
    assert read_readings(tmp_path / "a.csv") == readings
    assert "simulated" in (tmp_path / "a.csv").read_text(encoding="utf-8").splitlines()[-1]


def test_the_photometer_may_be_stated(tmp_path):
    path = table(tmp_path, "fit,centre,0,0,0,0.7")
    assert read_readings(path).photometer == "not stated"
    assert read_readings(path, photometer="LS-110").photometer == "LS-110"
    write_readings(path, Readings(read_readings(path).items, "simulated"))
    with pytest.raises(GlossError, match="'simulated' made its readings, but 'LS-110' is stated"):
        read_readings(path, photometer="LS-110")


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ("Fit,centre,0,0,0,1", "line 2: the purpose is 'Fit'. Allowed: fit, verify"),
        (",centre,0,0,0,1", "line 2: the purpose is empty"),
        ("fit,top,0,0,0,1", "the position is 'top'. Allowed: centre, left, right, full"),
        ("fit,centre,256,0,0,1", "red is '256'. Allowed: a whole code value from 0 to 255"),
        ("fit,centre,0,-1,0,1", "green is '-1'"),
        ("fit,centre,0,0,0.5,1", "blue is '0.5'"),
        ("fit,centre,0,0,,1", "blue is empty"),
        ("fit,centre,0,0,0,", "the luminance is missing"),
        ("fit,centre,0,0,0,-0.1", "luminance_cd_m2 is '-0.1'. Allowed: a number from 0"),
        ("fit,centre,0,0,0,nan", "luminance_cd_m2 is 'nan'"),
        ("fit,centre,0,0,0,inf", "luminance_cd_m2 is 'inf'"),
        ("fit,centre,0,0,0,1e9", "luminance_cd_m2 is '1e9'"),
        ("fit,centre,0,0,0,bright", "luminance_cd_m2 is 'bright'"),
        ("warm_up,centre,255,255,255,100", "a warm-up reading needs its minutes"),
        ("fit,centre,0,0,0", "5 cells, but the header names 6"),
    ],
)
def test_rows_that_cannot_be(tmp_path, row, message):
    with pytest.raises(GlossError, match=message):
        read_readings(table(tmp_path, row))


def test_tables_that_cannot_be(tmp_path):
    with pytest.raises(GlossError, match="lacks the column 'luminance_cd_m2'"):
        read_readings(table(tmp_path, header=HEADER.removesuffix(",luminance_cd_m2")))
    with pytest.raises(GlossError, match="unknown column 'lum'"):
        read_readings(table(tmp_path, header=HEADER + ",lum"))
    with pytest.raises(GlossError, match="has no row"):
        read_readings(table(tmp_path))
    with pytest.raises(GlossError, match="the photometers A, B"):
        read_readings(table(tmp_path, "fit,centre,0,0,0,1,A", "fit,centre,1,1,1,1,B", header=HEADER + ",photometer"))
    with pytest.raises(GlossError, match="No table of readings"):
        read_readings(tmp_path / "no.csv")
    wide = table(tmp_path, "fit,centre,40000,0,0,1")
    assert read_readings(wide, bits=16).items[0].patch.red == 40000
