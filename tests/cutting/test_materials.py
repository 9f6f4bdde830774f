"""Material rows: what is refused, and that the sample rows say where they come from."""

import math
import re

import numpy as np
import pytest

from robomill.cutting.forces.kienzle import KienzleRow
from robomill.cutting.forces.mechanistic import MechanisticRow
from robomill.cutting.materials import PUBLISHED, alternatives
from robomill.errors import CuttingError
from robomill.io.materials import load_material, material_from_toml, material_names, material_to_toml, sample_materials
from robomill.provenance import Provenance
from robomill.quantities import quantities
from robomill.units import to_si

ROW = {
    "name": "al",
    "title": "Aluminium",
    "alloy": "Al",
    "provenance": Provenance("measured", "dynamometer, 3 May"),
    "Ktc": 7e8,
    "Kte": 2e4,
    "Krc": 2e8,
    "Kre": 2e4,
    "Kac": 2e8,
    "Kae": 1e3,
}
KIENZLE = {**{name: ROW[name] for name in ("name", "title", "alloy", "provenance")}, "kc11": 7e8, "mc": 0.25}


def test_samples_are_the_paper_s_six_rows_and_two_of_kienzle():
    rows = sample_materials()
    assert sum(row.kind == "mechanistic" for row in rows) == 6
    assert sum(row.kind == "kienzle" for row in rows) == 2
    for row in rows:
        assert row.name in material_names()
        assert len(row.provenance.source) > 20
    first = load_material("al7075_t6_carbide_ref190")
    assert first.Ktc == pytest.approx(767.01e6)
    assert first.Kae == pytest.approx(700.0)
    assert load_material("al6061_t6_carbide_ref160").Kac is None


def test_files_round_trip():
    for row in [*sample_materials(), MechanisticRow(**{**ROW, "title": 'with "quotes", \\ and\ttabs'})]:
        assert material_from_toml(material_to_toml(row)) == row


def test_alternatives_share_alloy_and_kind():
    row = MechanisticRow(**ROW)
    other = row.replace(name="b")
    kienzle = KienzleRow(**{**KIENZLE, "name": "c"})
    assert alternatives(row, [kienzle, other, row, row.replace(name="d", alloy="steel")]) == (other,)


def test_a_coefficient_that_is_changed_is_given_in_code_and_one_that_is_not_keeps_its_source():
    row = MechanisticRow(**ROW)
    assert row.replace(Ktc=8e8).provenance.kind == "user"
    assert row.replace(Ktc=8e8, Kte=row.Kte).provenance.kind == "user"
    assert row.replace(Ktc=row.Ktc, title="Ours").provenance == row.provenance
    assert row.replace(Ktc=8e8, provenance=row.provenance).provenance == row.provenance


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"Ktc": -7e8}, "Material 'al', Ktc: found −700 N/mm²; expected 10 N/mm² to 50\u202f000 N/mm²."),
        ({"Ktc": 0.0}, "Ktc: found 0 N/mm²"),
        ({"Kre": -1.0}, "Kre: found −0.001 N/mm; expected 0 N/mm to 1000 N/mm"),
        ({"Ktc": None}, "Material 'al', Ktc: found nothing; expected 10 N/mm²"),
        ({"Kre": None}, "Kre: found nothing"),
        ({"Kac": None}, "Kae is given without Kac"),
        ({"Kae": None}, "Kac is given without Kae"),
        ({"mc": None}, "mc: found nothing"),
        ({"kc11": None}, "kc11: found nothing"),
        ({"mc": 1.0}, "mc: found 1; expected 0 to less than 1"),
        ({"Ktc": 767.0}, "Ktc: found 0.000767 N/mm²"),
        ({"Ktc": 7e14}, "Ktc: found 7e+08 N/mm²"),
        ({"Kte": 2e7}, "Kte: found 20\u202f000 N/mm"),
        ({"Krc": math.nan}, "Krc: found nan"),
        ({"Krc": "soft"}, "Krc: found 'soft'"),
        ({"name": ""}, "needs a name"),
        ({"provenance": Provenance("user", " ")}, "needs a source"),
    ],
)
def test_refused_rows(change, sentence):
    with pytest.raises(CuttingError) as refusal:
        KienzleRow(**{**KIENZLE, **change}) if set(change) <= {"mc", "kc11"} else MechanisticRow(**{**ROW, **change})
    assert sentence in str(refusal.value)
    assert refusal.value.where is not None


TEXT = material_to_toml(MechanisticRow(**ROW))


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("not toml at all [", "row.toml: this is not a readable TOML file"),
        (
            TEXT.replace("Ktc_N_mm2", "Ktc"),
            "row.toml, [coefficients], Ktc: this key is not known here; known are: Kac_N_mm2",
        ),
        (
            TEXT.replace("Ktc_N_mm2 = 700.0", 'Ktc_N_mm2 = "hard"'),
            "Ktc_N_mm2: expected a number in N/mm2, found 'hard'",
        ),
        (TEXT.replace("Ktc_N_mm2 = 700.0", "Ktc_N_mm2 = true"), "expected a number in N/mm2, found True"),
        (TEXT.replace("Ktc_N_mm2 = 700.0", "Ktc_N_mm2 = -700.0"), "row.toml: Material 'al', Ktc: found −700"),
        (TEXT.replace("Ktc_N_mm2 = 700.0", ""), "row.toml, [coefficients], Ktc_N_mm2: missing"),
        (
            TEXT.replace("Kac_N_mm2", "Kac"),
            "row.toml, [coefficients], Kac: this key is not known here; known are: Kac_N_mm2",
        ),
        (TEXT.replace("Ktc_N_mm2", "kc11_N_mm2 = 700.0\nKtc_N_mm2"), "[coefficients]: found Ktc_N_mm2, Kte_N_mm, "),
        (TEXT.replace("Ktc_N_mm2", "mc = 0.2\nKtc_N_mm2"), "and mc; a row is of one law, so make 2 rows of it."),
        (re.sub("(?m)^K.*$", "", TEXT), "found no coefficient that is known; known are Ktc_N_mm2, Kte_N_mm,"),
        (TEXT.replace('kind = "measured"', 'kind = "guess"'), "[provenance], kind: expected one of paper, measured"),
        (TEXT.replace("[provenance]", "[origin]"), "row.toml, provenance: missing; add it"),
        (TEXT.split("[provenance]")[0], "row.toml, provenance: missing; add it"),
        (TEXT.replace('alloy = "Al"', "alloy = 7075"), "row.toml, alloy: expected text in quotes, found 7075"),
        ("extra = 1\n" + TEXT, "row.toml, extra: this key is not known here"),
    ],
)
def test_refused_files(text, sentence):
    with pytest.raises(CuttingError) as refusal:
        material_from_toml(text, "row.toml")
    assert sentence in str(refusal.value)


def test_refused_names_and_unreadable_files(tmp_path):
    with pytest.raises(CuttingError, match=r"'unobtainium' is not known: give a .toml file or one of al"):
        load_material("unobtainium")
    with pytest.raises(CuttingError, match="cannot be opened"):
        load_material(tmp_path / "missing.toml")
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"\x89PNG\x00\x01")
    with pytest.raises(CuttingError, match="this is not a text file; expected a material row"):
        load_material(binary)


def test_an_added_file_loads_by_path(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(TEXT, encoding="utf-8")
    assert load_material(path).Ktc == to_si(700.0, "N/mm2")


def test_a_kienzle_row_is_its_specific_force_at_any_chip() -> None:
    """k_c = k_c1.1 (h / 1 mm)^-mc: a tenth of the chip has 10^mc times the specific force."""
    row = KienzleRow(**KIENZLE, radial_ratio=0.4, axial_ratio=0.1)
    (term,) = row.terms
    for chip_mm in (1.0, 0.1, 0.05):
        h = chip_mm * 1e-3
        width_force = 7e8 * chip_mm**-0.25 * h
        assert math.isclose(term.Kt * h**term.exponent, width_force, rel_tol=1e-12)
        assert math.isclose(term.Kr * h**term.exponent, 0.4 * width_force, rel_tol=1e-12)
        assert math.isclose(term.Ka * h**term.exponent, 0.1 * width_force, rel_tol=1e-12)


@pytest.mark.parametrize("missing", ["name", "title", "alloy"])
def test_a_row_without_a_name_a_title_or_an_alloy_is_refused(missing: str) -> None:
    with pytest.raises(CuttingError):
        MechanisticRow(**{**ROW, missing: ""})


@pytest.mark.parametrize("name", material_names())
def test_a_row_names_the_coefficients_of_its_kind(name: str) -> None:
    row = load_material(name)
    kinds = {
        "mechanistic": ("Ktc", "Kte", "Krc", "Kre", "Kac", "Kae"),
        "kienzle": ("kc11", "mc", "radial_ratio", "axial_ratio"),
    }
    assert tuple(quantities(type(row))) == kinds["kienzle" if name.endswith("kienzle") else "mechanistic"]


def test_what_a_row_does_not_give_is_named_and_can_be_assumed() -> None:
    """A share of the tangential force is that share at any chip, whatever the kind of the row."""
    kienzle = load_material("al_wrought_cured_kienzle")
    mechanistic = load_material("al6061_t6_carbide_ref160")
    assert (kienzle.missing, kienzle.unknown) == (("radial_ratio", "axial_ratio"), ("radial", "axial"))
    assert (mechanistic.missing, mechanistic.unknown) == (("Kac", "Kae"), ("axial",))
    for row in (kienzle, mechanistic):
        assert row.completed({"radial": None, "axial": None}) is row
        whole = row.completed({"radial": 0.4, "axial": 0.1})
        assert (whole.unknown, whole.provenance.kind, whole.alloy) == ((), "assumed", row.alloy)
        assert row.title in whole.title
        for chip in (1e-5, 1e-4):
            tangential, radial, axial = (
                sum(getattr(term, K) * chip**term.exponent for term in whole.terms) for K in ("Kt", "Kr", "Ka")
            )
            assert tangential == pytest.approx(sum(term.Kt * chip**term.exponent for term in row.terms))
            assert axial == pytest.approx(0.1 * tangential)
            if row is kienzle:
                assert radial == pytest.approx(0.4 * tangential)
    assert kienzle.completed({"radial": 0.4}).unknown == ("axial",)
    known = MechanisticRow(**ROW)
    assert known.completed({"radial": 0.4, "axial": 0.1}).Krc == known.Krc


def test_the_published_shares_are_those_of_the_rows_for_aluminium() -> None:
    chips = np.linspace(0.02e-3, 0.2e-3, 50)
    for part, K in (("radial", "Kr"), ("axial", "Ka")):
        shares = np.array(
            [
                sum(getattr(t, K) * chips**t.exponent for t in row.terms)
                / sum(t.Kt * chips**t.exponent for t in row.terms)
                for row in sample_materials()
                if row.kind == "mechanistic" and part not in row.unknown
            ]
        )
        low, high = PUBLISHED[part]
        assert low <= shares.min() <= 1.1 * low
        assert 0.95 * high <= shares.max() <= high
