"""Numbers of a set-up that can be meant, and hardly are: what they would be in another unit is said beside the result.

What is certainly a slip of unit is refused where it is given (``spelled``).
"""

from collections.abc import Iterator

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.compliance.springs.tool_bending import ToolBending
from robomill.cutting.tooling import Tooling
from robomill.kinematics.asked import longest_reach
from robomill.provenance import Finding
from robomill.robot.model import Robot
from robomill.robot.plausible import hardly_an_arm
from robomill.simulation.setup import SimulationSetup
from robomill.toolpath.path import Toolpath
from robomill.units import format_count, format_many, format_short, format_si

CODE, OTHERS, FRAME = "unit-doubt", "other-compliances", "tool-frame"
SLIP = "unit-slip"  # what nobody means: by such numbers nothing is judged
THIN = 0.6e-3  # m: the widest cutter there is, with its metres taken for mm
SMALL_PATH, NEAR, SHORT_TOOL = 2e-3, 0.05, 2e-3  # m
SLIGHT, HEAVY = 1.0, 20e3  # N: hardly a cut pushes less, or more
MUCH = 0.1  # of the tolerance
FINE, COARSE = 2e-6, 2e-3  # m a tooth


def unit_doubts(setup: SimulationSetup, path: Toolpath, F: FloatArray, pushed: BoolArray) -> tuple[Finding, ...]:
    """What looks like another unit, for F (m, 3) N and the steps ``pushed`` (m,) that are judged and cut."""
    told = [*_of_sizes(setup, path), *_of_robot(setup.robot, setup.T_MW[:3, 3])]
    told += [*_of_springs(setup), *_of_force(setup, F[pushed]), *_of_feed(setup, path, pushed)]
    doubts = tuple(Finding("suspicious", text, code=CODE) for text in told)
    return unit_slips(setup, path, F[pushed]) + doubts


def unit_slips(setup: SimulationSetup, path: Toolpath, F: FloatArray) -> tuple[Finding, ...]:
    """What was certainly meant in another unit, though each number by itself may be given; F (k, 3) N where it cuts."""
    told = [*_of_joints(setup), *_of_a_speck(setup, path), *_of_no_push(setup, F)]
    return tuple(Finding("suspicious", text, code=SLIP) for text in told)


def _of_joints(setup: SimulationSetup) -> Iterator[str]:
    """Joints as stiff or soft as no arm's are, where they count."""
    robot = setup.robot
    doubt = "" if robot.assumes_compliances or setup.measured_map is not None else hardly_an_arm(robot)
    if doubt:
        yield f"The joints: {doubt}: were their stiffnesses or compliances given in another unit?"


def _of_a_speck(setup: SimulationSetup, path: Toolpath) -> Iterator[str]:
    """A path that goes somewhere across its tool, and nowhere so far as to need one."""
    low, high = path.p.min(axis=0), path.p.max(axis=0)
    way = path.p - path.p[:1]
    across = np.abs(way - np.einsum("mi,mi->m", way, path.k)[:, None] * path.k).max()  # a plunge by itself may be short
    if path.cutting.any() and across > 1e-6 and (high - low).max() < min(SMALL_PATH, setup.cutter.diameter):
        size = format_many(high - low, "mm", 2, between=" × ")
        yield f"The whole path lies within {size}, less than the cutter is wide: were its points given in m?"


def _of_no_push(setup: SimulationSetup, F: FloatArray) -> Iterator[str]:
    """A force, stated by a person, as small as no cut's; none at all is a person's wish."""
    largest = float(np.nan_to_num(np.linalg.norm(F, axis=1)).max(initial=0.0))
    if not setup.force.follows_cut and 0.0 < largest < SLIGHT:
        yield f"Force: it never exceeds {format_short(largest, 'N')}, less than any cut: was it given in kN?"


def known_notes(setup: SimulationSetup) -> tuple[Finding, ...]:
    """Whether what the set-up knows of compliances is of others than are in force."""
    if setup.knowledge is None or setup.known is not None:
        return ()
    source = f" ({setup.knowledge.source})" if setup.knowledge.source else ""
    text = (
        f"How sure the compliances are is known{source}, but of others than are in force here: nothing is told of it. "
        "Give that robot's compliances, or identify these."
    )
    return (Finding("warning", text, code=OTHERS),)


def rigid_tool_notes(setup: SimulationSetup, tooling: Tooling, force: FloatArray) -> tuple[Finding, ...]:
    """Cutters that are taken as rigid though their stick-out is stated, and would bend by much of the tolerance under
    ``force`` (m, 3) N by feed, left and axis."""
    if setup.measured_map is not None or any(each.kind == ToolBending.kind for each in setup.springs):
        return ()
    across = np.nan_to_num(np.linalg.norm(force[:, :2], axis=1))
    found = []
    for cutter, made in tooling.steps_of_each():
        bent = ToolBending.first(cutter).lateral * float(across[made].max(initial=0.0))
        if cutter.stick_out is not None and bent > MUCH * setup.tolerance:
            text = (
                f"the cutter ({cutter.title}) sticks out by {format_si(cutter.stick_out, 'mm', 1)} and is taken as "
                f"rigid: solid carbide would bend by about {format_si(bent, 'mm')}; add the spring of its bending."
            )
            found.append(Finding("warning", text, code="rigid-tool"))
    return tuple(found)


def frame_notes(robot: Robot) -> tuple[Finding, ...]:
    """Whether the arm stands on the wrong side of its tool: at the tip's end of z_T, which runs up to the spindle."""
    along = float(-robot.T_tool[:3, 2] @ robot.T_tool[:3, 3])
    if along >= -SHORT_TOOL:
        return ()
    text = (
        f"The last axis's frame lies {format_short(-along, 'mm')} from the tip on the side of the part: z_T runs from "
        "the tip to the spindle, so the arm reaches the part from below here. A flange whose z points out at the tool "
        "wants a tool frame turned by 180° about x."
    )
    return (Finding("suspicious", text, code=FRAME),)


def _of_sizes(setup: SimulationSetup, path: Toolpath) -> Iterator[str]:
    """Cutter and path."""
    diameter = setup.cutter.diameter
    if diameter < THIN:
        yield f"The cutter is {format_short(diameter, 'mm')} wide: was its diameter given in m?"
    low, high = path.p.min(axis=0), path.p.max(axis=0)
    if (high - low).max() > 2.0 * (reach := longest_reach(setup.robot)):
        size = format_si(float((high - low).max()), "m", 1)
        yield f"The path is {size} long, more than the arm reaches ({format_si(reach, 'm', 1)}): are its points in mm?"


def _of_robot(robot: Robot, zero: FloatArray) -> Iterator[str]:
    """Where the part lies, and the tool."""
    chain = robot.chain
    off = zero - chain.T_0[:3, 3]
    from_axis = float(np.linalg.norm(np.cross(off, chain.T_0[:3, 2])))
    if not chain.prismatic[0] and from_axis < NEAR and abs(float(zero[2])) < NEAR and zero.any():
        place = format_many(zero, "mm", 1)
        yield (
            f"The part zero ({place}) lies in the foot of the robot, {format_si(from_axis, 'mm', 1)} from its first "
            "axis: was it given in m?"
        )
    tip = float(np.linalg.norm(robot.T_tool[:3, 3]))
    if 1e-6 < tip < SHORT_TOOL:
        yield f"The tool ends {format_short(tip, 'mm')} from the last axis's frame: was its place given in m?"


def _of_springs(setup: SimulationSetup) -> Iterator[str]:
    """What each spring doubts of itself, beside the cutters of the cut."""
    used = [setup.cutter, *(tool.cutter for tool in setup.tools.values() if tool.cutter is not None)]
    yield from filter(None, (spring.doubted(used) for spring in setup.springs))


def _of_force(setup: SimulationSetup, F: FloatArray) -> Iterator[str]:
    """A force that a person states; one from the material follows from it."""
    largest = float(np.nan_to_num(np.linalg.norm(F, axis=1)).max(initial=0.0))
    if not setup.force.follows_cut and largest > HEAVY:
        yield f"Force: it grows to {format_short(largest, 'N')}, more than any robot mills with: is it in N?"


def _of_feed(setup: SimulationSetup, path: Toolpath, pushed: BoolArray) -> Iterator[str]:
    """Feed per tooth, where the spindle's speed is stated; drills and threads go by their own."""
    known = pushed & np.isfinite(path.n_s) & (path.n_s > 0.0) & ~path.thread
    if not known.any() or setup.cutter.family.drills or setup.tools:
        return
    f_z = float(np.median(path.v_f[known] / (path.n_s[known] * setup.cutter.flutes)))
    if FINE <= f_z <= COARSE:
        return
    feed, speed = format_short(float(np.median(path.v_f[known])), "mm/min"), float(np.median(path.n_s[known]))
    asked = "is the feed in mm/s?" if f_z < FINE else "is the spindle's speed in 1/s?"
    yield (
        f"Each tooth takes {format_short(f_z, 'mm')} ({feed}, {format_short(speed, '1/min')}, "
        f"{format_count(setup.cutter.flutes, 'flute')}): {asked}"
    )
