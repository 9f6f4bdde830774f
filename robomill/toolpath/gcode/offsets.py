"""Where zero is: G10, G52, G54 to G59.3, G92 and its kin, and tool lengths G43, G49."""

from dataclasses import replace

from robomill.toolpath.gcode.codes import g_name
from robomill.toolpath.gcode.frames import frame_of, see_frame, turn_back, without_offsets
from robomill.toolpath.gcode.machine import XYZABC, Machine
from robomill.toolpath.gcode.rules.mode_rules import system_code
from robomill.toolpath.gcode.rules.motion_rules import rotate
from robomill.toolpath.gcode.standing import begins, measured, stand, stand_at_home
from robomill.toolpath.gcode.words import Block
from robomill.toolpath.tools import MOST, Tool
from robomill.units import from_si, to_si

SYSTEMS = {540: 1, 550: 2, 560: 3, 570: 4, 580: 5, 590: 6, 591: 7, 592: 8, 593: 9}
LAST_SYSTEM, MOST_EXTENDED = 9, 300
"""Behind these nine come those of G54.1 P1 (Fanuc) and G154 P1 (Haas), and on."""
_FANUC_TOOLS = (1, 10, 11, 12, 13)
_OFFSETS = range(2001, 2801)
"""A Fanuc's variables of its tools' lengths and radii."""
_CORNER_OFF = "with cutter compensation on; use G40 first."


def stored_system(machine: Machine, system: int) -> tuple[list[float], float]:
    """Origin (x, y, z, a, b, c) in program units and degrees, and rotation (deg) of a coordinate system."""
    if system > LAST_SYSTEM:
        origin, rotation = machine.extended.get(system, ([0.0] * 6, 0.0))
        return list(origin), rotation
    at = 5201 + 20 * system
    values = machine.store.values(at, 6)
    return [machine.from_user(v) for v in values[:3]] + values[3:], machine.store.numbered[at + 9]


def _store_axis(machine: Machine, system: int, axis: int, value: float) -> None:
    machine.store.numbered[5201 + 20 * system + axis] = machine.to_user(value) if axis < 3 else value


def _in_system(machine: Machine, absolute: list[float], origin: list[float], rotation: float) -> list[float]:
    point = [p - o for p, o in zip(absolute, origin)]
    point[0], point[1] = rotate(point[0], point[1], -rotation)
    if machine.store.numbered[5210]:
        g92 = machine.store.values(5211, 6)
        point = [p - (machine.from_user(g) if i < 3 else g) for i, (p, g) in enumerate(zip(point, g92))]
    return point


def system_name(machine: Machine, system: int) -> str:
    """``1`` -> ``"G54"``, ``12`` -> ``"G54.1 P3"``, of a Sinumerik ``14`` -> ``"G505"``."""
    return g_name(system_code(system)) if system <= LAST_SYSTEM else machine.further.format(system - LAST_SYSTEM)


def select_system(machine: Machine, block: Block, system: int) -> None:
    """G54 to G59.3, G54.1 P1 and on."""
    name = system_name(machine, system)
    machine.need_compensation_off(block, name)
    if system == machine.system:
        return
    turned, frame = machine.before_turn is not None, frame_of(machine)
    if turned and not machine.keeps_frame:
        raise block.refuse(f"{name} while coordinates are shifted or turned (G68, TRANS, ROT); end that first.")
    if machine.scale is not None and (machine.is_fanuc or not machine.other_control):
        raise block.refuse(f"{name} while coordinates are scaled or mirrored (G51, G51.1); end that first.")
    turn_back(machine)
    at = without_offsets(machine)
    origin, rotation = stored_system(machine, system)
    machine.p = _in_system(machine, at, origin, rotation)
    machine.g5x, machine.rotation, machine.system = origin, rotation, system
    machine.systems.append((len(machine.recorder), system))
    machine.store.numbered[5220] = float(system)
    if turned:
        see_frame(machine, *frame)


def select_extended(machine: Machine, block: Block, number: float) -> None:
    """G54.1 P, G154 P and G54 P (Fanuc, Haas): one of the coordinate systems behind G59."""
    if abs(number - round(number)) > 1e-4 or not 1 <= round(number) <= MOST_EXTENDED:
        raise block.refuse(f"P{number:g} is no coordinate system; expected P1 to P{MOST_EXTENDED}.")
    select_system(machine, block, LAST_SYSTEM + round(number))


def axis_offsets(machine: Machine, block: Block, code: int) -> None:
    """G52 and the G92 family."""
    machine.need_compensation_off(block, g_name(code))
    numbered = machine.store.numbered
    if code == 920 and measured(machine):
        stand(machine, block)
        return
    if code == 920 and begins(machine):
        if machine.other_control:
            stand(machine, block)
            return
        text = "G92 before the first move shifts part zero, as LinuxCNC takes the tool to stand at its own zero then"
        machine.note("zero-shifted", "warning", f"{text}; remove the line where it says where the tool stands")
    if code in (520, 920):
        if machine.other_control and any(machine.g92) and machine.shifted_by != code:
            text = f"{g_name(code)} on top of {g_name(machine.shifted_by)}, as a control adds them, is not read"
            raise block.refuse(f"{text}; end that before.")
        numbered[5210], machine.shifted_by = 1.0, code
        homes = stand_at_home(machine, block) if code == 920 else set()
        for axis, letter in enumerate(XYZABC):
            if letter not in block.words:
                continue
            value = block.words[letter]
            if code == 520:
                machine.p[axis] += machine.g92[axis] - value
                machine.g92[axis] = value
            elif axis not in homes:
                machine.g92[axis] += machine.p[axis] - value
                machine.p[axis] = value
        for axis in range(6):
            numbered[5211 + axis] = machine.to_user(machine.g92[axis]) if axis < 3 else machine.g92[axis]
        return
    numbered[5210] = 1.0 if code == 923 else 0.0
    new = [0.0] * 6
    if code == 923:
        new = [machine.from_user(v) if i < 3 else v for i, v in enumerate(machine.store.values(5211, 6))]
    machine.p = [p + old - n for p, old, n in zip(machine.p, machine.g92, new)]
    machine.g92 = new
    if code == 921:
        machine.store.put(5211, [0.0] * 6)


def set_data(machine: Machine, block: Block) -> None:
    """G10 L1, L2, L10, L11 and L20."""
    kind = round(block.words.get("l", -1.0))
    if machine.is_fanuc and kind in (12, 13) and {"p", "r"} <= block.words.keys() and machine.absolute:
        _set_radius(machine, block, kind == 13)
        return
    if machine.is_fanuc and kind in _FANUC_TOOLS:
        _leave_tool(machine, f"G10 L{kind}")
        return
    if kind not in (1, 2, 10, 11, 20):
        raise block.refuse("G10 needs L1, L2, L10, L11 or L20.")
    p = block.words.get("p")
    if p is None or abs(p - round(p)) > 1e-4:
        raise block.refuse("G10 needs P, a whole number.")
    if kind in (1, 10, 11):
        _set_tool(machine, block, kind, round(p))
        return
    if machine.is_fanuc:
        _set_as_fanuc(machine, block, kind, round(p))
        return
    if not 0 <= round(p) <= 9:
        raise block.refuse(f"G10 L{kind} has P{p:g}; coordinate systems run from 1 to 9 (0: the current one).")
    if "i" in block.words or "j" in block.words:
        raise block.refuse(f"G10 L{kind} takes no I or J.")
    system = round(p) or machine.system
    if kind == 20 and system == machine.system and measured(machine):
        stand(machine, block)
        return
    if kind == 20 and system == machine.system:
        for axis in stand_at_home(machine, block):
            del block.words[XYZABC[axis]]
    if machine.compensation is not None and system == machine.system:
        raise block.refuse(f"G10 L{kind} cannot move the current coordinate system {_CORNER_OFF}")
    if kind == 20 and "r" in block.words:
        raise block.refuse("G10 L20 takes no R.")
    _set_system(machine, block, kind, system)


def _leave_tool(machine: Machine, word: str) -> None:
    text = f"{word} sets a tool of the control, which is left out: the tool table holds"
    machine.note("tool-set", "warning", text)


def _set_as_fanuc(machine: Machine, block: Block, kind: int, number: int) -> None:
    """Fanuc's G10 L2 P1 to P6 places G54 to G59, L20 P1 and on G54.1 P1 and on: both by where they are."""
    if kind == 2 and number == 0:
        raise block.refuse(
            "G10 L2 P0 moves all coordinate systems on a Fanuc control, which is not read; move G54 (P1) instead."
        )
    most = 6 if kind == 2 else MOST_EXTENDED
    if not 1 <= number <= most:
        raise block.refuse(f"G10 L{kind} has P{number}; expected P1 to P{most}.")
    if "r" in block.words:
        raise block.refuse(f"G10 L{kind} takes no R on a Fanuc control; turn coordinates with G68.")
    if not machine.absolute:
        raise block.refuse(f"G10 L{kind} in G91 adds to where a coordinate system is; use G90 before it.")
    _set_system(machine, block, 2, number if kind == 2 else LAST_SYSTEM + number)


def _set_system(machine: Machine, block: Block, kind: int, system: int) -> None:
    words = block.words
    origin, rotation = stored_system(machine, system)
    absolute = without_offsets(machine)
    here = _in_system(machine, absolute, origin, rotation)
    new_rotation = words.get("r", rotation)
    new = list(origin)
    if kind == 20:
        wanted = [words.get(letter, h) for letter, h in zip(XYZABC, here)]
        old_xy, new_xy = rotate(here[0], here[1], new_rotation), rotate(wanted[0], wanted[1], new_rotation)
        new[0] += old_xy[0] - new_xy[0]
        new[1] += old_xy[1] - new_xy[1]
        for axis in range(2, 6):
            if XYZABC[axis] in words:
                new[axis] += here[axis] - wanted[axis]
    else:
        for axis, letter in enumerate(XYZABC):
            if letter in words:
                new[axis] = words[letter]
    if system > LAST_SYSTEM:
        machine.extended[system] = list(new), new_rotation
    else:
        for axis in range(6):
            _store_axis(machine, system, axis, new[axis])
        machine.store.numbered[5210 + 20 * system] = new_rotation
    _place(machine, block, f"G10 L{kind}", system)


def place_by_numbers(machine: Machine, block: Block) -> None:
    """Fanuc's #5221 and on say where G54 and on lie: a line that sets one of them places its system, as G10 L2 does."""
    for key, _ in block.settings if machine.is_fanuc else ():
        if isinstance(key, int) and key in _OFFSETS:
            _leave_tool(machine, f"#{key}")
        system, axis = divmod(key - 5201, 20) if isinstance(key, int) else (-1, 0)
        if system == 0 and axis < 6:
            raise block.refuse(f"#{key} moves all coordinate systems on a Fanuc control, which is not read; move G54.")
        if 1 <= system <= 6 and axis < 6:
            _place(machine, block, f"#{key}", system)


def _place(machine: Machine, block: Block, name: str, system: int) -> None:
    """A coordinate system lies where ``stored_system`` says from here on; the machine stays where it is."""
    machine.placed.setdefault(system, block.line)
    if system == machine.system:
        machine.need_compensation_off(block, name)
        if machine.before_turn is not None:
            moved = system_name(machine, system)
            raise block.refuse(f"{name} moves {moved} while coordinates are shifted or turned (G68); end that first.")
        new, new_rotation = stored_system(machine, system)
        point = [p - n for p, n in zip(_unrotated(machine), new)]
        point[0], point[1] = rotate(point[0], point[1], -new_rotation)
        machine.p = point
        machine.g5x, machine.rotation = new, new_rotation


def _unrotated(machine: Machine) -> list[float]:
    """The current point in machine axes, with the axis offsets left out as the reference does."""
    point = list(machine.p)
    point[0], point[1] = rotate(point[0], point[1], machine.rotation)
    return [p + o for p, o in zip(point, machine.g5x)]


def _set_tool(machine: Machine, block: Block, kind: int, number: int) -> None:
    words = block.words
    if number < 1:
        raise block.refuse(f"G10 L{kind} has P{number}; tool numbers start at 1.")
    if not any(letter in words for letter in "xyzabcrqij"):
        raise block.refuse(f"G10 L{kind} sets nothing; give Z, R or another word.")
    if machine.tools is not None and number not in machine.tools:
        raise block.refuse(f"tool {number} is not in the tool table; add it.")
    if machine.tools is None:
        machine.tools = _Assumed()
    tool = machine.tools[number]
    offset = list(tool.offset)
    if kind == 1:
        here = [0.0, 0.0, 0.0]
        sign = 1.0
    else:
        system = 9 if kind == 11 else machine.system
        absolute = [a + (machine.length_offset[i] if i < 3 else 0.0) for i, a in enumerate(without_offsets(machine))]
        here = _in_system(machine, absolute, *stored_system(machine, system))[:3]
        if kind == 11 and machine.store.numbered[5210]:
            here = [h + machine.from_user(v) for h, v in zip(here, machine.store.values(5211, 3))]
        sign = -1.0
    for axis, letter in enumerate("xyz"):
        if letter in words:
            offset[axis] = to_si(here[axis] + sign * words[letter], machine.unit)
    diameter = to_si(2.0 * words["r"], machine.unit) if "r" in words else tool.diameter
    place, orientation = (offset[0], offset[1], offset[2]), round(words.get("q", tool.orientation))
    changed = Tool(number, diameter, place, orientation, tool.name, tool.sized or "r" in words)
    machine.tools[number] = changed
    if machine.tool.number == number:
        machine.tool = changed


def _set_radius(machine: Machine, block: Block, wear: bool) -> None:
    """Fanuc's G10 L12 P R is the radius that D of that number means, L13 what its wear adds."""
    number, radius = round(block.words["p"]), to_si(block.words["r"], machine.unit)
    machine.tools = _Assumed() if machine.tools is None else machine.tools
    if not 1 <= number <= MOST:
        raise block.refuse(f"G10 has P{number}; tool numbers start at 1.")
    tool = machine.tools[number] if number in machine.tools else Tool(number)
    sizes = machine.radii.setdefault(number, [tool.diameter / 2.0, 0.0])
    sizes[wear] = radius
    machine.tools[number] = replace(tool, diameter=2.0 * sum(sizes), sized=True)


class _Assumed(dict[int, Tool]):
    """A table that has every tool, of no size, until G10 sets one."""

    def __missing__(self, number: int) -> Tool:
        return Tool(number, sized=False)

    def __contains__(self, number: object) -> bool:
        return True


def tool_length(machine: Machine, block: Block, code: int) -> None:
    """G43, G43.1, G43.2 and G49."""
    machine.need_compensation_off(block, g_name(code))
    if code == 490:
        machine.set_length_offset([0.0, 0.0, 0.0])
        machine.note_length(None)
        return
    if code == 431:
        offset = [block.words.get(letter, old) for letter, old in zip("xyz", machine.length_offset)]
        machine.set_length_offset(offset)
        machine.note_length(None)
        return
    if code == 432 and "h" not in block.words:
        raise block.refuse("G43.2 needs H, a tool number.")
    number = round(block.words["h"]) if "h" in block.words else machine.tool.number
    tool = machine.tool if "h" not in block.words else known_tool(machine, block, number)
    if machine.tools is None and number:
        machine.note(
            "no-tool-table", "info", f"{g_name(code)}: no tool table; the program is taken to say where the tip goes"
        )
    length = [from_si(v, machine.unit) for v in tool.offset]
    if code == 432:
        length = [old + new for old, new in zip(machine.length_offset, length)]
    machine.set_length_offset(length)
    machine.note_length(tool if code == 430 and tool.number else None)


def known_tool(machine: Machine, block: Block, number: int) -> Tool:
    """The tool, of no size if there is no table, or it is not there; 0 is the one in the spindle.

    Raises GCodeError where LinuxCNC is stated, which knows the tools of its table alone.
    """
    if number == 0:
        return machine.tool
    try:
        return machine.find_tool(number) or Tool(number)
    except KeyError:
        if machine.strict:
            raise block.refuse(f"tool {number} is not in the tool table; add it.") from None
    machine.note("tool-unknown", "warning", f"tool {number} is not in the tool table: its size is not known; add it")
    return Tool(number)
