"""Tilted working planes: G68.2 with G53.1 (Fanuc), CYCLE800 (Sinumerik), PLANE SPATIAL (Heidenhain).

What stands in a tilted plane is read as if it were upright, and its points and tool axes are turned into the part at
the end. How a machine swivels there is its own: the tool is taken to be clear of the part until X, Y and Z are given.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.errors import GCodeError
from robomill.toolpath.gcode.codes import COORDINATES, MOTION, NON_MODAL, g_name
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.rules.mode_rules import system_code
from robomill.toolpath.gcode.rules.motion_rules import RAPID, TRAVERSE, to_frame
from robomill.toolpath.gcode.words import Block

_SHIFTS = frozenset({100, 520, 920, 921, 922, 923})
_TURNS = frozenset({160, 510, 511, 541, 680, 682, 1010, 1540, *range(1100, 1300, 10), *range(5050, 6000, 10)})


@dataclass(frozen=True, eq=False)
class Plane:
    """A plane whose axes are the columns of ``R`` (3, 3) in the part; its point ``read`` (3,) m, as it is read, lies at
    ``place`` (3,) m there."""

    R: FloatArray
    read: FloatArray
    place: FloatArray

    def in_part(self, p: FloatArray) -> FloatArray:
        """Points p (n, 3) m of the part, from where they are read."""
        return self.place + (p - self.read) @ self.R.T


def turned_by(axes: str, degrees: tuple[float, ...]) -> FloatArray:
    """(3, 3): turns, each about an axis ("X", "Y", "Z") as the turns before it have left it."""
    out = np.eye(3)
    for axis, angle in zip(axes, degrees):
        k, t = "XYZ".index(axis), math.radians(angle)
        turn = np.eye(3)
        u, v = (k + 1) % 3, (k + 2) % 3
        turn[u, u] = turn[v, v] = math.cos(t)
        turn[v, u], turn[u, v] = math.sin(t), -math.sin(t)
        out = out @ turn
    return out


Place = tuple[float, float, float]
UNMOVED = (0.0, 0.0, 0.0)


def tilt(machine: Machine, name: str, R: FloatArray, origin: Place = UNMOVED, moved: Place = UNMOVED) -> None:
    """The plane with axes ``R`` about ``origin`` is in force, its zero ``moved`` along those axes (program units).

    Raises GCodeError where coordinates are turned or scaled, or rotary axes stand elsewhere than at 0: but for G68.2
    and CYCLE800, before which programs turn them to where those will.
    """
    block = Block(machine.line)
    machine.need_compensation_off(block, name)
    if machine.rotation != 0.0 or machine.scale is not None or machine.polar_words:
        raise block.refuse(f"{name} while coordinates are turned, mirrored or scaled is not read; end that before.")
    if any(abs(angle) > 1e-9 for angle in machine.p[3:]):
        if name not in ("G68.2", "CYCLE800") or any(machine.g5x[3:]) or any(machine.g92[3:]):
            raise block.refuse(f"{name} while A, B or C stand elsewhere than at 0 is not read; turn them back before.")
        machine.left = machine.p[3:]
        machine.stand_at([0.0] * 3)
    if machine.plane != 17:
        raise block.refuse(f"{name} is read in G17 alone; write that before.")
    zero, place = [0.0] * 3, [0.0] * 3
    to_frame(machine, 0.0, 0.0, 0.0, zero)
    to_frame(machine, *origin, place)
    aside = R @ np.array(moved) * machine.factor
    machine.set_tilted(Plane(R, np.array(zero), np.array(place) + aside))
    machine.stuck, machine.leans = "", False
    text = (
        f"{name} tilts the working plane, and the tool with it: how the machine swivels there is not known, so it is "
        "taken to be clear of the part until X, Y and Z are given again"
    )
    machine.note("tilted-plane", "info", text)
    machine.set_away((True, True, True))


def upright(machine: Machine, stays: bool = False) -> None:
    """The plane is as it was, and so is the tool, if it ``stays`` not as it was turned until A, B or C are said."""
    machine.need_compensation_off(Block(machine.line), "The end of a tilted plane")
    machine.leans = stays and (machine.leans or (machine.tilted is not None and machine.tilted.R[2, 2] < 1.0 - 1e-9))
    if machine.tilted is not None:
        machine.set_tilted(None)
        machine.set_away((True, True, True))
    machine.stuck, machine.tilt_due = "", None
    if machine.left:
        machine.stand_at(machine.left)
        machine.left = []


def of_fanuc(machine: Machine, block: Block, code: int) -> bool:
    """G68.2 says the plane by Euler's angles, G53.1 turns the tool to it, G69 ends it; False for other words."""
    words = block.words
    if code == 682:
        if words.get("p", 0.0) != 0.0 or not {"i", "j", "k"} <= words.keys():
            raise block.refuse("G68.2 is read with Euler's angles I, J and K and an origin X, Y and Z alone; mend it.")
        if machine.tilted is not None:
            raise block.refuse("G68.2 in a plane that is tilted already is not read; end that by G69 before.")
        angles = words.pop("i"), words.pop("j"), words.pop("k")
        origin = words.pop("x", 0.0), words.pop("y", 0.0), words.pop("z", 0.0)
        words.pop("p", None)
        machine.tilt_due = turned_by("ZXZ", angles), origin
        machine.stuck = "G68.2 is not followed by G53.1, which turns the tool to its plane; write it before any move."
        return True
    if code == 531 and machine.tilt_due is not None:
        words.pop("p", None)
        (R, origin), machine.tilt_due = machine.tilt_due, None
        tilt(machine, "G68.2", R, origin)
        return True
    if code == 690 and (machine.tilted is not None or machine.tilt_due is not None):
        upright(machine, stays=True)
        return True
    return False


def check(machine: Machine, block: Block) -> None:
    """Raise GCodeError for what would shift or turn a tilted plane, or where a move waits for the tool to be turned."""
    if machine.stuck and block.words.keys() & set("xyzijkr"):
        raise block.refuse(machine.stuck)
    if machine.leans:
        _check_lean(machine, block)
    if machine.tilted is None:
        return
    shifts = [code for code in (*block.g.values(), *block.unknown_g) if code in _SHIFTS | _TURNS]
    if block.g.get(COORDINATES, system_code(machine.system)) != system_code(machine.system):
        shifts.append(block.g[COORDINATES])
    if shifts:
        raise block.refuse(f"{g_name(shifts[0])} in a tilted plane is not read; end that before.")


def _check_lean(machine: Machine, block: Block) -> None:
    """After G69 and CYCLE800() the tool stands as it was turned, until A, B or C are said."""
    if block.words.keys() & set("abc"):
        machine.leans = False
        return
    moves = block.words.keys() & set("xyz") and block.g.get(NON_MODAL, 0) not in (280, 300, 530)
    if moves and block.g.get(MOTION, machine.motion) != RAPID:
        raise block.refuse("the end of the plane leaves the tool as it was turned; turn A, B and C back before a cut.")


def drop_positioning(planes: Any, columns: dict[str, Any]) -> None:
    """Rapids at angles between a tilted plane and upright ones lean no tool: the plane alone says how it swivels."""
    rotary0, rotary = columns["rotary0"], columns["rotary"]
    edges, moves = {row for row, _ in planes}, len(rotary)
    rows = np.flatnonzero((rotary0.any(axis=1) | rotary.any(axis=1)) & (columns["kind"] == TRAVERSE))
    if not len(rows):
        return
    cut = 1 + np.flatnonzero((np.diff(rows) > 1) | np.isin(rows[1:], list(edges)))
    still0, still = rotary0.copy(), rotary.copy()
    for run in np.split(rows, cut):
        begin, end = int(run[0]), int(run[-1]) + 1
        before = begin in edges or not rotary0[begin].any()
        after = end in edges or end == moves or not rotary0[end].any()
        if edges & {begin, end} and before and after:
            still0[begin:end] = still[begin:end] = 0.0
    columns["rotary0"], columns["rotary"] = still0, still


def check_rotary(planes: Any, columns: dict[str, Any]) -> None:
    """Raise GCodeError at the first move that turns A, B or C in a tilted plane."""
    starts = [row for row, _ in planes]
    for (row, plane), end in zip(planes, [*starts[1:], len(columns["line"])]):
        turned = columns["rotary"][row:end].any(axis=1)
        if plane is not None and turned.any():
            line = int(columns["line"][row + int(np.argmax(turned))])
            raise GCodeError.at(line, "A, B or C in a tilted plane is not read; end the plane before.")


def stand(planes: Any, p: FloatArray, k: FloatArray, first: IntArray) -> tuple[FloatArray, FloatArray]:
    """Points p (n, 3) m and tool axes k (n, 3) in the part; ``first`` (m,) are the first points of the moves.

    Outside of tilted planes both are as they are told. A move that leads into another plane is straight, and the tool
    turns along it evenly.
    """
    p, k = p.copy(), np.broadcast_to(k, p.shape).copy()
    bounds = [*(int(first[row]) if row < len(first) else len(p) for row, _ in planes), len(p)]
    for (_, plane), begin, end in zip(planes, bounds, bounds[1:]):
        if plane is not None:
            p[begin:end] = plane.in_part(p[begin:end])
            k[begin:end] = plane.R[:, 2]
    for row, _ in planes:
        if 0 < row < len(first):
            begin, end = int(first[row]) - 1, int(first[row + 1]) - 1 if row + 1 < len(first) else len(p) - 1
            share = np.linspace(0.0, 1.0, end - begin + 1)[:, None]
            p[begin : end + 1] = p[begin] + share * (p[end] - p[begin])
            k[begin : end + 1] = _between(k[begin], k[end], share)
    return p, k


def _between(a: FloatArray, b: FloatArray, share: FloatArray) -> FloatArray:
    """Unit vectors on the great circle from a to b, each (3,), at shares (n, 1) of the angle between them."""
    across = b - (a @ b) * a
    size = float(np.linalg.norm(across))
    if size < 1e-12:
        if a @ b > 0.0:
            return np.broadcast_to(a, (len(share), 3))
        across = np.cross(a, np.eye(3)[int(np.argmin(np.abs(a)))])
        size = float(np.linalg.norm(across))
    angle = share * math.acos(float(np.clip(a @ b, -1.0, 1.0)))
    return np.cos(angle) * a + np.sin(angle) * across / size


def turn_between(planes: Any, number: int, before: FloatArray, after: FloatArray) -> float:
    """The angle (rad) by which the tool turns on the move at which a plane of ``planes`` begins.

    Its axes ``before`` and ``after`` that move, each (3,), are those of the rotary axes: outside of tilted planes.
    """
    old, new = planes[number - 1][1] if number else None, planes[number][1]
    before, after = before if old is None else old.R[:, 2], after if new is None else new.R[:, 2]
    return math.acos(float(np.clip(before @ after, -1.0, 1.0)))
