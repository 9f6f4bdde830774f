"""Joints added, taken out and moved, and the table in the other Denavit-Hartenberg convention."""

from collections.abc import Callable
from functools import partial

import streamlit as st

from robomill.robot.checks import MAX_JOINTS, MIN_JOINTS
from robomill.robot.joints import (
    CONVENTIONS,
    in_other_convention,
    read_in_other_convention,
    with_joints,
    with_new_joint,
)
from robomill.robot.model import Robot
from robomill.ui import pieces, session
from robomill.ui.entry import inputs
from robomill.ui.robot import files

CHOSEN = "robot.joint"
WORDS = {"standard": "standard", "modified": "modified (Craig)"}


def joints(robot: Robot) -> None:
    """Which convention the table is in, and which joints it has."""
    with st.expander(f"Convention: {WORDS[robot.convention]} Denavit-Hartenberg"):
        other = WORDS[CONVENTIONS[robot.convention]]
        pieces.note(
            f"Rewriting keeps the robot: every pose stays, α and a move by one row, and what has no row goes into the "
            f"{'tool' if robot.convention == 'standard' else 'base'} frame."
        )
        _act(f"Rewrite as {other}: the same robot", "robot.rewrite", "sync_alt", in_other_convention)
        pieces.note("If the numbers were meant that way from the start, read them so. It is another robot then.")
        _act(f"Read these numbers as {other}", "robot.reread", "translate", read_in_other_convention)
    with st.expander("Add, remove or move a joint"):
        _rows(robot)


def _rows(robot: Robot) -> None:
    chosen = min(int(session.kept(CHOSEN, robot.rows - 1)), robot.rows - 1)
    names = {i: f"Joint {i + 1}" for i in range(robot.rows)}
    inputs.choice("Joint", CHOSEN, names, chosen, lambda i: session.keep(CHOSEN, i), inputs.LISTED)
    order = list(range(robot.rows))
    up, down = (_swapped(order, chosen, chosen + step) for step in (-1, 1))
    rest = [i for i in order if i != chosen]
    with st.container(horizontal=True, gap="small"):
        _act("Up", "robot.joint.up", "arrow_upward", partial(with_joints, rows=up), chosen - 1, chosen == 0)
        last = chosen == robot.rows - 1
        _act("Down", "robot.joint.down", "arrow_downward", partial(with_joints, rows=down), chosen + 1, last)
        few = robot.rows <= MIN_JOINTS
        _act("Remove", "robot.joint.remove", "delete", partial(with_joints, rows=rest), max(chosen - 1, 0), few)
    full, after = robot.rows >= MAX_JOINTS, chosen + 1
    with st.container(horizontal=True, gap="small"):
        for slides, label in ((False, "Add one that turns"), (True, "Add one that slides")):
            key = f"robot.joint.add.{'slides' if slides else 'turns'}"
            _act(label, key, "add", partial(with_new_joint, at=after, slides=slides), after, full)
    pieces.note(
        f"Compliance, limits and offset go with their joint. A new one stands after joint {chosen + 1}, and its "
        f"compliance is assumed. robomill computes arms of {MIN_JOINTS} to {MAX_JOINTS} joints."
    )


def _swapped(order: list[int], i: int, j: int) -> list[int]:
    """``order`` with two of its places exchanged, where both are there."""
    new = list(order)
    if 0 <= j < len(new):
        new[i], new[j] = new[j], new[i]
    return new


def _act(
    label: str, key: str, icon: str, change: Callable[[Robot], Robot], chosen: int | None = None, off: bool = False
) -> None:
    """A button that puts another robot into the project; ``chosen`` is the joint in hand then."""

    def act() -> None:
        files.put(change(session.project().setup.robot))
        if chosen is not None:
            session.keep(CHOSEN, chosen)

    inputs.button(label, key, icon, act, disabled=off)
