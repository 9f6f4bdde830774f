"""Material rows as files: units by hand, back to the last bit, and one sentence for what is wrong."""

from __future__ import annotations

import tomllib

import pytest

from robomill.cutting.forces.kienzle import KienzleRow
from robomill.errors import CuttingError
from robomill.io.materials import load_material, material_from_toml, material_names, material_to_toml, sample_materials
from robomill.io.samples import samples_dir
from robomill.provenance import Provenance

ROW = """name = "mine"
title = "Mine"
alloy = "Al 1"
[coefficients]
Ktc_N_mm2 = 800.5
Kte_N_mm = 10
Krc_N_mm2 = 250
Kre_N_mm = 12.5
[provenance]
kind = "measured"
source = "a bench"
"""


def test_a_row_by_hand_is_in_si():
    row = material_from_toml(ROW)
    assert (row.name, row.title, row.alloy, row.provenance.source) == ("mine", "Mine", "Al 1", "a bench")
    assert (row.Ktc, row.Kte, row.Krc, row.Kre) == pytest.approx((800.5e6, 10e3, 250e6, 12.5e3))
    assert row.Kac is None
    assert not hasattr(row, "kc11")


def test_every_sample_is_its_file_and_comes_back():
    names = sorted(path.stem for path in (samples_dir() / "materials").glob("*.toml"))
    assert material_names() == names
    assert [row.name for row in sample_materials()] == names
    for row in sample_materials():
        written = tomllib.loads((samples_dir() / "materials" / f"{row.name}.toml").read_text())["coefficients"]
        factor = {"N_mm2": 1e6, "N_mm": 1e3}
        for key, value in written.items():
            field, _, unit = key.partition("_") if key[0] == "K" or key.startswith("kc11") else (key, "", "")
            assert getattr(row, field) == pytest.approx(value * factor.get(unit, 1.0), rel=1e-14), key
        assert material_from_toml(material_to_toml(row)) == row


def test_awkward_numbers_and_words_come_back_to_the_last_bit():
    row = KienzleRow(
        'a"b', "ä\\b", "Al\t7", Provenance("user", "x\ny"), kc11=1e9 / 3, mc=1 / 7, radial_ratio=0.0, axial_ratio=2 / 3
    )
    assert material_from_toml(material_to_toml(row)) == row


def test_a_file_by_its_path(tmp_path):
    (tmp_path / "mine.toml").write_text(ROW)
    assert load_material(tmp_path / "mine.toml") == material_from_toml(ROW)
    assert load_material(str(tmp_path / "mine.toml")).name == "mine"


@pytest.mark.parametrize(
    ("found", "replaced", "words"),
    [
        ("Kte_N_mm = 10", "Kte_N_mm = -1", "mine.toml: .*Kte"),
        ("Kte_N_mm = 10", "Kte_mm = 10", "Kte_mm: this key is not known here"),
        ('alloy = "Al 1"', "", "mine.toml, alloy: missing"),
        ('kind = "measured"', 'kind = "rumour"', "expected one of"),
        ("[coefficients]", "extra = 1\n[coefficients]", "extra: this key is not known here"),
        ("Kte_N_mm = 10", "", "Kte"),
    ],
)
def test_refusals_name_file_and_key(found, replaced, words):
    assert found in ROW
    with pytest.raises(CuttingError, match=words):
        material_from_toml(ROW.replace(found, replaced), "mine.toml")


def test_an_unknown_name_lists_those_there_are():
    with pytest.raises(CuttingError, match=f"'gold' is not known.*{material_names()[0]}"):
        load_material("gold")
    with pytest.raises(CuttingError, match=r"gold\.toml"):
        load_material("gold.toml")


def test_coefficients_of_no_law_or_of_two_are_refused():
    head, rest = ROW.split("[coefficients]\n")
    tail = rest[rest.index("[provenance]") :]
    with pytest.raises(
        CuttingError, match=r"\[coefficients\]: found no coefficient that is known; known are .*Ktc_N_mm2"
    ):
        material_from_toml(f"{head}[coefficients]\nhardness = 3\n{tail}")
    both = ROW.replace("[provenance]", "kc11_N_mm2 = 700\n[provenance]")
    with pytest.raises(
        CuttingError, match=r"found Ktc_N_mm2, .* and kc11_N_mm2; a row is of one law, so make 2 rows of"
    ):
        material_from_toml(both)
