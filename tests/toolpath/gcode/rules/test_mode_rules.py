"""Which lines are done at once and which are left to the interpreter, line by line; and what each has changed."""

import numpy as np
import pytest

from robomill.toolpath.gcode.flow import Calls, Structure
from robomill.toolpath.gcode.lines import Lines
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.program import Move
from robomill.toolpath.gcode.rules import flow_rules, line_rules, mode_rules

# Lines after "G1 F100", and whether they are plain; every word that no rule here uses leaves its line.
PLAIN = {
    "": True,
    "(a remark)": True,
    "N5": True,
    "F200": True,
    "S100 M3": True,
    "M5 M9": True,
    "M8": True,
    "G17": True,
    "G90": True,
    "G91.1": True,
    "G99": True,
    "G80": True,
    "G1": True,
    "G0": True,
    "G21": True,
    "G54": True,
    "X1": True,
    "A5": True,
    "G1 X1 Y2 Z-3 A1 B2 C3": True,
    "G2 X1 I0.5": True,
    "G3 X1 Y1 R5": True,
    "G2 I1 P2": False,
    "I1": False,
    "R1": False,
    "G1 X1 R1": False,
    "G1 @1 ^90": True,
    "G1 @1 Z2": False,  # in no direction
    "^45": True,
    "G1 @1 X1": False,
    "G1 ^90 Y0": False,
    "G80 @1": False,
    "G0 X1 J1": False,
    "G1 X1 K1": False,
    "P1": False,
    "Q1": False,
    "L1": False,
    "G1 X1 P1": False,
    "G1 X1 Q1": False,
    "G1 X1 L1": False,
    "G80 X1": False,
    "G80 C1": False,
    "G80 I1": False,
    "G80 R1": False,
    "G20": False,
    "G55": False,
    "G2 X1": False,
    "G4 P1": False,
    "G53 G0 X1": False,
    "G81 Z-1 R1": True,
    "G81 Z-1 R1 A1": False,
    "G81 Z-1 R1 I1": False,
    "G81 R1": False,
    "G81 Z-1 R1 P1": False,
    "G81 Z-1 R1 Q1": False,
    "G82 Z-1 R1 P1": False,  # a dwell: the control says in which unit
    "G82 Z-1 R1 P1 Q1": False,
    "G83 Z-1 R1 Q1": True,
    "G83 Z-1 R1 Q1 P1": False,
    "G74 Z-1 R1 P1": False,
    "G84 Z-1 R1 P1": False,
    "G88 Z-1 R1 P1": False,
}


def machine_after(text: str) -> tuple[Machine, Lines]:
    machine, lines = Machine(None), Lines(text.encode())
    machine.moves = 0
    return machine, lines


def run(machine: Machine, lines: Lines, first: int, count: int, rows: list[Move]) -> int:
    none = Structure(Calls()).plain
    return flow_rules.run(machine, machine.store.arrays, lines.plain_text, none, (first, count), rows)[0]


@pytest.mark.parametrize("line", PLAIN)
def test_which_lines_are_done_at_once(line: str) -> None:
    machine, lines = machine_after(f"G1 F100\nM3 S60\n{line}\nF7\n")
    rows = [Move() for _ in range(20)]
    assert run(machine, lines, 0, 2, rows) == 2
    before = machine.spindle, machine.feed, machine.motion, list(machine.p)
    assert run(machine, lines, 2, 2, rows) == (2 if PLAIN[line] else 0)
    if not PLAIN[line]:
        assert (machine.spindle, machine.feed, machine.motion, list(machine.p)) == before
    else:
        assert machine.feed == 7.0


def test_as_many_lines_are_done_as_there_is_room_for_moves() -> None:
    machine, lines = machine_after("F100\nG0 X1\n(one)\nG1 X2\nX3\nX4\nM2\n")
    rows = [Move() for _ in range(3)]
    assert run(machine, lines, 0, 7, rows) == 5
    assert (machine.moves, machine.p[0]) == (3, 3.0)
    assert [row.line for row in rows] == [2, 4, 5]
    machine.moves = 0
    assert run(machine, lines, 5, 2, rows) == 1  # and M2 is left
    assert machine.p[0] == 4.0


LOOKED_AT = ("spindle", "mist", "flood", "absolute", "arc_absolute", "retract_r", "plane", "feed_mode", "feed", "speed")


def test_words_switch_what_they_name_and_leave_the_rest() -> None:
    """One word after the other, as the handbook says what it does."""
    does = [
        ("M7", {"mist": True}),
        ("M8", {"flood": True}),
        ("M9", {"mist": False, "flood": False}),
        ("M8", {"flood": True}),
        ("M4", {"spindle": -1}),
        ("M3", {"spindle": 1}),
        ("M5", {"spindle": 0}),
        ("G91", {"absolute": False}),
        ("G90.1", {"arc_absolute": True}),
        ("G99", {"retract_r": True}),
        ("G90", {"absolute": True}),
        ("G91.1", {"arc_absolute": False}),
        ("G98", {"retract_r": False}),
        ("G18", {"plane": 18}),
        ("G19", {"plane": 19}),
        ("G17", {"plane": 17}),
        ("F30", {"feed": 30.0}),
        ("G95", {"feed_mode": 950, "feed": 0.0}),
        ("F2 S5", {"feed": 2.0, "speed": 5.0}),
        ("G93 F9", {"feed_mode": 930}),  # its F is of this line alone
        ("G94 F40", {"feed_mode": 940, "feed": 40.0}),
        ("S0", {"speed": 0.0}),
    ]
    machine, lines = machine_after("\n".join(line for line, _ in does) + "\n")
    expected = {name: getattr(machine, name) for name in LOOKED_AT}
    for i, (line, change) in enumerate(does):
        expected |= change
        assert run(machine, lines, i, 1, [Move()]) == 1, line
        assert {name: getattr(machine, name) for name in LOOKED_AT} == expected, line


def test_each_coordinate_system_has_its_code() -> None:
    codes = [540, 550, 560, 570, 580, 590, 591, 592, 593]
    assert [mode_rules.system_code(system) for system in range(1, 10)] == codes


@pytest.mark.parametrize(
    ("line", "sets"),
    [
        ("#1=2", {1: 2.0}),
        (" # 1 = - 2.5 (so)", {1: -2.5}),
        ("#1=2 #3=[1+3]", {1: 2.0, 3: 4.0}),
        ("#5601=7", {5601: 7.0}),
        ("#[1+1]=3", {2: 3.0}),
        ("#10=5 #11=#10", {10: 5.0, 11: 0.0}),  # as it was before the line
        ("#1=1 #1=2", {1: 2.0}),
        ("N10 #1=2", {1: 2.0}),
        (" ".join(f"#{k}={k}" for k in range(1, 51)), {k: float(k) for k in range(1, 51)}),
        (" ".join(f"#{k}={k}" for k in range(1, 52)), None),  # more than a line may set
        ("#0=1", None),
        ("#5602=1", None),
        ("#1.5=1", None),
        ("#1 2", None),
        ("#1=", None),
        ("#1", None),
        ("#", None),
        ("#1=2 X1", None),
        ("X1 #1=2", None),
        ("#<new>=1", None),
    ],
)
def test_what_a_line_sets(line: str, sets: dict[int, float] | None) -> None:
    store, data = Machine(None).store, line.encode()
    untouched = np.array(store.numbered)
    count = line_rules.read_line(store.arrays, data, 0, len(data))
    if sets is None:
        assert count == line_rules.NOT_PLAIN
        return
    assert count == line.count("=")
    line_rules.apply_settings(store.arrays, count)
    for key, value in sets.items():
        assert store.get(key) == value
        untouched[key] = value
    np.testing.assert_array_equal(store.numbered, untouched)


def test_names_that_are_known_are_set_too() -> None:
    store = Machine(None).store
    store.set("a", 1.0)
    store.set("_mine", 2.0)
    flow_rules.enter_names(store.arrays)
    store.set("a", 5.0)
    data = b"#<a>=[#<a>+1] #<_mine>=#<a>"
    assert line_rules.read_line(store.arrays, data, 0, len(data)) == 2
    line_rules.apply_settings(store.arrays, 2)
    assert (store.get_named("a"), store.get_named("_mine")) == (6.0, 5.0)
    store.arrays.level[0] -= 1
    assert (store.get_named("a"), store.get_named("_mine")) == (1.0, 5.0)
