"""Where the numbers of a changed robot come from: the blocks that a person changed, by hand, and no others."""

from pathlib import Path

import numpy as np
import pytest

import robomill as rm
from robomill.errors import ArgumentError, RobotError
from robomill.provenance import GIVEN
from robomill.robot.sources import BLOCKS, block_in_force, changed_blocks, is_of_robot

PAPER = rm.load_robot("slavkovic_5r")
TABLES = {"compliance.table_2", "compliance.table_3"}


def given(robot: rm.Robot) -> set[str]:
    return {block for block, said in robot.provenance.items() if said == GIVEN}


@pytest.mark.parametrize(
    ("changes", "blocks"),
    [
        ({"a_mm": [0, 1250, 0, 0, 300]}, {"geometry", "lengths"}),
        ({"alpha_deg": [90, 0, 90, -90, 80]}, {"geometry"}),
        ({"sign": [1, 1, 1, 1, -1]}, {"geometry"}),
        ({"limits_deg": (-100, 100)}, {"limits"}),
        ({"limits": np.full((5, 2), [-1.0, 1.0])}, {"limits"}),
        ({"T_tool": np.eye(4)}, {"tool"}),
        ({"tool_xyz_mm": (0, 0, 200)}, {"tool"}),
        ({"base_xyz_mm": (0, 0, 200)}, {"base"}),
        ({"C_theta": 2 * PAPER.C_theta}, {"compliance"}),
        ({"k_theta_kNm_per_rad": 1000.0}, {"compliance"}),
        ({"title": "mine"}, set()),
        ({"d": PAPER.d.copy(), "limits_all": PAPER.limits_all.tolist()}, set()),  # nothing is changed
    ],
)
def test_what_was_changed_was_given_in_code_and_the_rest_keeps_its_source(changes, blocks) -> None:
    other = PAPER.replace(**changes)
    assert given(other) == blocks
    assert {b: each for b, each in other.provenance.items() if b not in blocks} == {
        b: each for b, each in PAPER.provenance.items() if b not in blocks
    }


def test_a_source_that_is_given_beside_the_numbers_counts_and_says_nothing_of_other_blocks() -> None:
    sheet = rm.Provenance("measured", "data sheet")
    other = PAPER.replace(limits_deg=(-100, 100), base_xyz_mm=(0, 0, 500), provenance={"limits": sheet})
    assert other.provenance["limits"] == sheet
    assert given(other) == {"base"}
    assert other.provenance["lengths"].kind == "assumed"


def test_compliances_go_by_the_set_in_force_and_numbers_of_no_set_by_none() -> None:
    softer = PAPER.replace(C_theta=2 * PAPER.C_theta)
    assert softer.with_compliance_set("table_2") == PAPER
    measured = PAPER.replace(C_theta=2 * PAPER.C_theta, provenance={"compliance": rm.Provenance("measured", "May")})
    assert measured.replace(C_theta=3 * PAPER.C_theta).provenance["compliance"] == GIVEN
    mine = PAPER.replace(C_theta=2 * PAPER.C_theta, compliance_sets={"mine": 2 * PAPER.C_theta}, compliance_set="mine")
    assert given(mine) == {"compliance.mine"}
    with pytest.raises(RobotError, match="compliance set 'table_2' has other numbers than are given; leave"):
        PAPER.replace(C_theta=2 * PAPER.C_theta, compliance_set="table_2")


def test_a_source_is_a_provenance() -> None:
    with pytest.raises(RobotError, match="provenance: expected a Provenance, found 'mine'"):
        PAPER.replace(provenance={"limits": "mine"})
    with pytest.raises(RobotError, match="provenance: expected a Mapping, found 'mine'"):
        PAPER.replace(provenance="mine")


def test_it_is_written_and_read_and_a_number_that_came_back_is_still_of_who_gave_it(tmp_path: Path) -> None:
    turned = PAPER.replace(limits_deg=(-100, 100))
    again = rm.load_robot(rm.write_robot(tmp_path / "arm.toml", turned))
    assert again.provenance["limits"] == GIVEN
    assert turned.replace(limits=PAPER.limits).provenance["limits"] == GIVEN


def test_every_field_of_a_robot_that_holds_numbers_belongs_to_a_block() -> None:
    numbers = {"alpha", "a", "d", "theta_offset", "sign", "prismatic", "convention", "limits_all", "T_base", "T_tool"}
    assert {name for names in BLOCKS.values() for name in names} == numbers
    assert changed_blocks(PAPER, PAPER) == []
    assert TABLES <= {*changed_blocks(rm.load_robot("kuka_kr270"), PAPER)}


def test_a_named_set_alone_puts_its_numbers_in_force() -> None:
    robot = rm.load_robot("slavkovic_5r")
    other = robot.replace(compliance_set="table_3")
    assert other.compliance_set == "table_3"
    assert other.C_theta.tolist() == robot.with_compliance_set("table_3").C_theta.tolist()


def test_the_block_in_force_is_that_of_the_set_or_of_none() -> None:
    assert block_in_force(PAPER) == f"compliance.{PAPER.compliance_set}" == "compliance.table_2"
    assert block_in_force(PAPER.replace(compliance_set="table_3")) == "compliance.table_3"
    assert block_in_force(PAPER.replace(C_theta=1e-6)) == "compliance"


def test_a_robot_speaks_of_its_own_blocks_alone() -> None:
    mine = {*BLOCKS, "compliance", "compliance.table_2", "compliance.of_somebody"}
    others = {"", "force", "geometry.a", "compliances", "material", "limits_all", "tools"}
    assert {block for block in mine | others if is_of_robot(block)} == mine
    said = rm.Provenance("measured", "May")
    for block in mine:
        assert PAPER.replace(C_theta=1e-6, provenance={block: said}).provenance[block] == said
    for block in others - {""}:
        with pytest.raises(ArgumentError, match=block):
            PAPER.replace(provenance={block: said})


def test_numbers_of_no_set_are_changed_where_they_differ_or_were_a_set_s() -> None:
    """Between a named set, the same numbers under no name, and others under no name."""
    named, same, other = PAPER, PAPER.replace(C_theta=PAPER.C_theta), PAPER.replace(C_theta=2 * PAPER.C_theta)
    assert same.compliance_set == other.compliance_set == "user"
    for before, after, changed in (
        (named, same, True),
        (named, other, True),
        (same, same.replace(title="again"), False),
        (same, other, True),
        (other, same, True),
        (other, named, False),
        (same, named, False),
    ):
        assert ("compliance" in changed_blocks(before, after)) == changed
