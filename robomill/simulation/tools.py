"""Several tools: which cutter makes which step, how far its tip stands from the first one's, and which springs it has.

The robot's tool frame is that of one tool: of the first that cuts. The tip of a longer one stands farther along the
tool axis by the difference of their lengths, so the arm holds its flange farther back; springs of the tool follow it.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.compliance.spring import Spring
from robomill.cutting.tool import DISH
from robomill.cutting.tooling import Tooling
from robomill.errors import SetupError
from robomill.provenance import Finding
from robomill.rigid import transform
from robomill.robot.model import Robot
from robomill.simulation.setup import SimulationSetup
from robomill.toolpath.path import Toolpath
from robomill.units import format_si

FASTEST = 1.0  # m/s, of a feed


@dataclass(frozen=True, eq=False)
class Held:
    """What a tool changes: how much ``longer`` (m) it is than the first that cuts, the robot with its tip, its springs,
    and the steps (m,) bool that it makes."""

    longer: float
    robot: Robot
    springs: tuple[Spring, ...]
    steps: BoolArray


def cutting_numbers(path: Toolpath) -> IntArray:
    """Numbers of the tools that cut, in the order in which they begin to; 0 where the program does not say."""
    numbers = path.tool[path.cutting]
    _, first = np.unique(numbers, return_index=True)
    return np.asarray(numbers[np.sort(first)])


def tooling(setup: SimulationSetup, path: Toolpath) -> Tooling:
    """The cutter of every step; rapids of tools that never cut count as the first one's.

    Raises SetupError where a program cuts with several tools and no table says which they are, and CuttingError for a
    number that the table does not hold.
    """
    numbers = cutting_numbers(path)
    if not setup.tools:
        known = numbers[numbers > 0]
        if len(known) > 1:
            these = ", ".join(f"T{n}" for n in known)
            raise SetupError(
                f"Tools: the program cuts with {these}, and the set-up knows one cutter ({setup.cutter.title}); give a "
                "tool table with each of them.",
                where="tools",
            )
        return Tooling.single(setup.cutter, len(path))
    cutters = tuple(setup.cutter if n == 0 else setup.tools.cutter(int(n)) for n in numbers) or (setup.cutter,)
    index = np.zeros(len(path), dtype=np.int64)
    for i, n in enumerate(numbers):
        index[path.tool == n] = i
    return Tooling(cutters, index)


def farther(setup: SimulationSetup, path: Toolpath) -> FloatArray:
    """(m,) m: how much farther along its axis the tip of each step's tool stands than that of the first that cuts."""
    numbers = cutting_numbers(path)
    lengths = {n: tool.length for n, tool in setup.tools.items()}
    first = lengths.get(int(numbers[0]), 0.0) if len(numbers) else 0.0
    out = np.zeros(len(path))
    for n in np.unique(path.tool):
        if int(n) in lengths and len(numbers) and int(numbers[0]) in lengths:
            out[path.tool == n] = lengths[int(n)] - first
    return out


def held(setup: SimulationSetup, path: Toolpath) -> Iterator[Held]:
    """Every tool with what it changes; one for all where there is one."""
    made, beyond = tooling(setup, path), farther(setup, path)
    kinds = np.unique(np.column_stack([made.of_step, beyond]), axis=0)
    for n, longer in kinds:
        steps = (made.of_step == n) & (beyond == longer)
        springs = setup.springs
        if len(kinds) > 1 and (n > 0 or longer):
            springs = tuple(spring.of_tool(made.cutters[int(n)], float(longer)) for spring in springs)
        yield Held(float(longer), reaching(setup.robot, float(longer)), springs, steps)


def reaching(robot: Robot, farther: float) -> Robot:
    """The robot with a tool whose tip stands ``farther`` (m) along its axis, away from the spindle."""
    if farther == 0.0:
        return robot
    return robot.replace(T_tool=robot.T_tool @ transform(np.eye(3), [0.0, 0.0, -farther]))


def tool_notes(setup: SimulationSetup, path: Toolpath) -> tuple[Finding, ...]:
    """What a reader must know of the tools."""
    if not setup.tools:
        return _holders(setup, path)
    numbers = [int(n) for n in cutting_numbers(path)]
    found = [*setup.tools.findings, *setup.tools.notes(numbers)]
    beyond = farther(setup, path)[path.cutting]
    if beyond.any():
        length = format_si(setup.tools[numbers[0]].length, "mm", 2)
        text = (
            f"The robot's tool frame is taken as that of tool {numbers[0]} ({length} long), the first that cuts; the "
            "tips of the others stand as much farther as they are longer."
        )
        found.append(Finding("info", text, code="tool-frame"))
        other = float(beyond[np.argmax(np.abs(beyond))])
        than = f"{format_si(abs(other), 'mm', 1)} {'longer gives more' if other > 0 else 'shorter gives less'}"
        for spring in filter(lambda each: each.at_tip, setup.springs):
            text = (
                f"{spring.name.capitalize()}: its stiffness is that at the tip of tool {numbers[0]}; the tip of a tool "
                f"{than} across, by how much is not known, and the same is used."
            )
            found.append(Finding("warning", text, code="spring-at-tip"))
    return (*found, *_holders(setup, path))


def feed_notes(setup: SimulationSetup, path: Toolpath) -> tuple[Finding, ...]:
    """The fastest of the feeds that no cutter takes: more than its radius a tooth, or ``FASTEST`` where no speed is
    known."""
    tools, turns = tooling(setup, path), np.isfinite(path.n_s) & (path.n_s > 0)
    turn = path.v_f / np.where(turns, path.n_s, 1.0)
    odd = np.where(turns, turn > tools.each("radius") * tools.each("flutes"), path.v_f > FASTEST)
    odd &= path.cutting & (path.step_length > 0)
    if not odd.any():
        return ()
    i, lines = int(np.argmax(np.where(odd, path.v_f, 0.0))), len(np.unique(path.block[odd]))
    a_turn = f", {format_si(turn[i], 'mm', 1)} a revolution" if turns[i] else ""
    feed = format_si(path.v_f[i], "mm/min", 0)
    text = f"a feed of {feed}{a_turn}: no cutter takes that; check F and its unit."
    return (Finding("warning", text, int(path.block[i]), count=lines, code="feed-absurd"),)


def _holders(setup: SimulationSetup, path: Toolpath) -> tuple[Finding, ...]:
    """Tools whose tips go farther under the top of the stock than they stick out of their holders, once a tool."""
    stock, found = setup.stock_block, []
    inside = path.cutting & ((path.p[:, :2] >= stock.lower[:2]) & (path.p[:, :2] <= stock.upper[:2])).all(axis=1)
    under = np.where(inside, (stock.upper[2] - path.p[:, 2]) / np.maximum(path.k[:, 2], DISH), 0.0)
    for cutter, made in tooling(setup, path).steps_of_each():
        i = int(np.argmax(np.where(made, under, 0.0)))
        if cutter.stick_out is not None and made[i] and under[i] > cutter.stick_out:
            text = (
                f"the tip goes {format_si(under[i], 'mm')} under the top of the stock and the tool sticks out "
                f"{format_si(cutter.stick_out, 'mm')}: its holder meets the part where that is not cut wider before."
            )
            found.append(Finding("warning", text, int(path.block[i]), code="holder"))
    return tuple(found)
