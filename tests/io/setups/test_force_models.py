"""Force models in a set-up: units by hand, files looked for beside it, and what comes back equal."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.cutting.forces import FORCES
from robomill.cutting.forces.measured import ForceRecord, MeasuredForce
from robomill.cutting.tool import Cutter
from robomill.errors import ProjectError, RobomillError
from robomill.io.beside import Beside
from robomill.io.materials import load_material, material_to_toml
from robomill.io.setups.force_models import force_from_table, force_to_table
from robomill.io.tables import Table

CUTTER = Cutter("flat", 8e-3)


def read(folder=None, **data):
    return force_from_table(Table(data, "setup.toml, [force]"), CUTTER, Beside(folder))


def again(force):
    return read(**force_to_table(force))


def test_fixed_forces_are_in_newtons():
    force = read(kind="path", feed_N=-60, feed_normal_N=100.5, axial_N=-20)
    assert (force.feed, force.feed_normal, force.axial) == (-60.0, 100.5, -20.0)
    assert again(force) == force


def test_every_kind_is_known_and_no_other():
    with pytest.raises(ProjectError, match=f"expected one of {', '.join(FORCES)}, found 'magic'"):
        read(kind="magic")
    for kind, model in FORCES.items():
        assert model.kind == kind


@pytest.mark.parametrize("kind", ["mechanistic", "kienzle"])
def test_a_sample_material_is_named_and_any_other_is_written_out(kind, tmp_path):
    name = "al7075_t6_carbide_ref190" if kind == "mechanistic" else "al_wrought_cured_kienzle"
    force = read(kind=kind, material=name)
    assert force.material == load_material(name)
    table = force_to_table(force)
    assert table["material"] == name
    assert "material_definition" not in table
    changes = {"Ktc": force.material.Ktc * 1.1} if kind == "mechanistic" else {"mc": 0.31}
    mine = read(kind=kind, material_definition=material_to_toml(force.material.replace(**changes)))
    assert mine.material == force.material.replace(**changes)
    written = force_to_table(mine)
    assert "material" not in written, "the sample of that name is another row"
    assert again(mine).material == mine.material
    # A file beside the set-up goes before a sample.
    (tmp_path / "row.toml").write_text(material_to_toml(mine.material))
    assert read(tmp_path, kind=kind, material="row.toml").material == mine.material
    assert read(tmp_path, kind=kind, material=name).material == load_material(name)


def test_the_other_rows_of_its_alloy_come_with_it():
    force = read(kind="mechanistic", material="al6061_t6_carbide_ref160")
    assert all(row.alloy == "Al 6061" and row != force.material for row in force.alternatives)


RECORD = {"axis": "path", "frame": "M", "source": "s", "x": [[0.0], [0.5], [1.0], [2.5]], "F_N": [[1, 2, 3]] * 4}


def test_a_record_in_the_set_up_itself():
    force = read(kind="measured", record=RECORD | {"notes": ["a", "b"]}, cutoff_Hz=0)
    np.testing.assert_array_equal(force.record.x, [0.0, 0.5, 1.0, 2.5])
    np.testing.assert_array_equal(force.record.F, [[1, 2, 3]] * 4)
    assert (force.record.axis, force.record.frame, force.record.source) == ("path", "M", "s")
    assert force.record.notes == ("a", "b")
    with pytest.raises(ProjectError, match="xx: this key is not known here"):
        read(kind="measured", record=RECORD | {"notes": [], "xx": 1})


def test_a_record_comes_back_to_the_last_bit():
    rng = np.random.default_rng(0)
    record = ForceRecord(np.cumsum(rng.random(9)), rng.normal(size=(9, 3)) * 100, "time", "path", "bench", ("n",))
    for cutoff in (None, 12.5):
        found = again(MeasuredForce(record, cutoff=cutoff, start=0.25))
        np.testing.assert_array_equal(found.record.x, record.x)
        np.testing.assert_array_equal(found.record.F, record.F)
        assert (found.record.source, found.record.notes) == ("bench", ("n",))
        assert (found.cutoff, found.start) == (cutoff, 0.25)


def test_a_recorded_file_is_looked_for_beside_the_set_up(tmp_path):
    rows = "\n".join(f"{0.1 * i:.1f},{i},{-i},{2 * i}" for i in range(6))
    (tmp_path / "cut.csv").write_text("t_s,F_feed_N,F_feed_normal_N,F_axial_N\n" + rows + "\n")
    on_tool = read(tmp_path, kind="measured", file="cut.csv")
    np.testing.assert_allclose(on_tool.record.F[3], [3, -3, 6])
    on_part = read(tmp_path, kind="measured", file="cut.csv", force_on="part")
    np.testing.assert_allclose(on_part.record.F[3], [-3, 3, -6])
    with pytest.raises(RobomillError, match=r"cut\.csv"):
        read(kind="measured", file="cut.csv")
