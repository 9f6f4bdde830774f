"""``robomill compensate``: the file it writes, its record, and what it never writes over."""

import json
import shutil
from pathlib import Path

import pytest

import robomill as rm
from robomill.cli import main
from robomill.io.samples import samples_dir

SLOT = samples_dir() / "paper_flute"


def test_the_program_is_written_and_the_record_is_that_of_the_library(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    out = tmp_path / "new" / "corrected.nc"
    words = ["compensate", str(SLOT), "--out", str(out), "--components", "normal", "--bound-um", "5", "--json"]
    assert main(words) == 0
    record = json.loads(capsys.readouterr().out)
    found = rm.compensate(rm.load_setup(SLOT), "normal", bound_um=5)
    assert out.read_text() == found.text
    assert record["after_mm"]["max"] == pytest.approx(1e3 * found.after.max)
    assert record["components"] == ["normal"]
    assert record["files"][0]["path"] == str(out)
    assert main(["compensate", str(SLOT), "--out", str(out)]) == 0
    assert "replacing an older one" in capsys.readouterr().out


def test_the_source_is_never_written_over(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    folder = tmp_path / "work"
    shutil.copytree(SLOT, folder)
    program = (folder / "path.nc").read_text()
    copy = tmp_path / "copy.nc"
    copy.write_text(program)
    for place in (folder / "path.nc", folder / "setup.toml", folder / "x" / ".." / "setup.toml", copy):
        assert main(["compensate", str(folder / "setup.toml"), "--out", str(place)]) == 2
        assert "give another" in capsys.readouterr().err
    assert (folder / "path.nc").read_text() == copy.read_text() == program
    assert main(["compensate", str(folder), "--out", str(folder)]) == 2
    assert "folder" in capsys.readouterr().err


@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf", "(gefr\u00e4st)\n".encode("latin-1")])
@pytest.mark.parametrize("way", ["sub/path.nc", "new/../sub/path.nc"])
def test_the_source_is_kept_whatever_its_encoding_and_however_its_place_is_named(
    way: str, mark: bytes, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """A folder that is not there yet is made, and left again by the same name: then its program is no longer there."""
    text = (SLOT / "setup.toml").read_text().replace('"path.nc"', '"sub/path.nc"')
    (tmp_path / "setup.toml").write_text(text)
    (tmp_path / "sub").mkdir()
    program = mark + (SLOT / "path.nc").read_bytes()
    (tmp_path / "sub" / "path.nc").write_bytes(program)
    assert main(["compensate", str(tmp_path / "setup.toml"), "--out", str(tmp_path / way)]) == 2
    assert "would be lost" in capsys.readouterr().err
    assert (tmp_path / "sub" / "path.nc").read_bytes() == program


@pytest.mark.parametrize(
    ("words", "said"),
    [(("--components", "up"), "expected some of normal, axial, feed"), (("--bound-um", "0"), "Bound")],
)
def test_slips_are_told_and_nothing_is_written(
    words: tuple[str, ...], said: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    out = tmp_path / "x.nc"
    assert main(["compensate", str(SLOT), "--out", str(out), *words]) == 2
    assert said in capsys.readouterr().err
    assert not out.exists()


def test_the_corrected_program_is_checked_as_it_says_and_keeps_what_is_wanted_in_a_set_up(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """With the set-up's own program nothing more is to be said; beside another path ``--wanted`` does, or a file."""
    folder = tmp_path / "work"
    shutil.copytree(SLOT, folder)
    setup, out = folder / "setup_process.toml", folder / "c.nc"
    assert main(["compensate", str(setup), "--out", str(out)]) == 0
    assert f"to check  robomill simulate {setup} --program {out}" in capsys.readouterr().out
    before = rm.compensate(rm.load_setup(setup)).before.max
    other = folder / "other.toml"
    given = '[path]\nprogram = "c.nc"\nwanted = "path.nc"'
    other.write_text(setup.read_text().replace('[path]\nprogram = "path.nc"', given))
    elsewhere = folder / "elsewhere.toml"
    elsewhere.write_text(setup.read_text().replace('program = "path.nc"', 'program = "c.nc"'))
    for words in (
        [str(setup), "--program", str(out)],
        [str(elsewhere), "--wanted", str(folder / "path.nc")],
        [str(other), "--out", str(tmp_path / "run")],
        [str(tmp_path / "run" / "setup.toml")],
    ):
        assert main(["simulate", *words, "--json"]) == 0
        record = json.loads(capsys.readouterr().out)
        assert record["wanted"] == "path.nc"
        assert max(abs(record["wall"]["value_mm"]), abs(record["floor"]["value_mm"])) < 0.01 * before * 1e3
    assert main(["simulate", str(elsewhere), "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["wanted"] is None
    assert "wanted-path" in [each["code"] for each in record["findings"]]
    lines = "lines_mm = [[-50, 0, -2, 50, 0, -2]]\nfeed_mm_min = [1800]\n"
    elsewhere.write_text(setup.read_text().replace('program = "path.nc"', lines))
    assert main(["simulate", str(elsewhere), "--wanted", str(out)]) == 2
    assert "--wanted: it goes with a corrected program" in capsys.readouterr().err
