"""What is given in another kind than a public function takes is told in a sentence, by one law for all of them."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from numpy.typing import ArrayLike

import robomill as rm
from robomill.arguments import asked
from robomill.arrays import FloatArray, Numbers, Rows
from robomill.errors import ArgumentError

WRONG: list[Any] = [
    *(None, "x", b"x", 3, -1.5, 1 + 2j, float("nan"), True, object(), len, {"a": 1}, {}, [], [None], [[1], [1, 2]]),
    *(("a", "b", "c"), [[object()]], list(range(1, 10)), np.array(["a"]), np.zeros((0, 3))),
]
ARM = rm.load_robot("slavkovic_5r")
SETUP = rm.load_setup("paper_flute")
GRID = rm.Grid(x_mm=[0], y_mm=-1300, z_mm=0)
T_MT = rm.pose_from_world([0.0, -1.3, 0.0, 0.0, 0.0])
THETA = rm.inverse_kinematics(ARM, T_MT).theta
PATH = rm.Toolpath.from_points(p_mm=[[0, 0, -2], [40, 0, -2]], feed_mm_min=1800)
LINE = rm.Element("line", [[0, 0], [0.05, 0]], depth=0.002, v_f=0.03)
TESTS = rm.read_load_tests("nine_points", ARM)
AT: dict[str, Any] = {"robot": ARM, "theta": THETA}
DRAWING = rm.read_drawing("bracket")
# What is right of each function and class; every argument of it is then given wrongly.
RIGHT: dict[str, dict[str, Any]] = {
    "advise": {"setup": SETUP},
    "report_html": {"run": SETUP},
    "write_report": {"path": "report.html", "run": SETUP},
    "at_pose": AT,
    "box_grid": {"lower": [0, 0, 0], "upper": [1, 1, 0], "step": 0.5},
    "cartesian_compliance": AT,
    "compensate": {"setup": SETUP, "components": "nothing"},
    "compliance_map": {"robot": ARM, "grid": GRID},
    "copy_samples": {"folder": "copies", "names": ["nobody"]},
    "deflection": {"C_joint": np.zeros((5, 3, 3)), "F": [0, 100, 0]},
    "design": {"setup": SETUP, "measure": "nothing"},
    "frame_from_points": {"zero": [0, 1, 0], "on_x": [1, 1, 0], "in_xy": [0, 2, 0]},
    "geometric_jacobian": AT,
    "identify": {"robot": ARM, "tests": TESTS, "model": "nothing"},
    "inverse_kinematics": {"robot": ARM, "T_MT": T_MT},
    "joint_contributions": {"J_v": rm.geometric_jacobian(ARM, THETA)[:3], "C_theta": ARM.C_theta},
    "joint_frames": AT,
    "load_material": {},
    "load_robot": {"name_or_path": "slavkovic_5r"},
    "load_setup": {"path": "paper_flute"},
    "load_study": {"study": {}},
    "map_quantities": {"robot": ARM},
    "place": {"setup": SETUP, "x_mm": (0, 1), "y_mm": (-1300, -1299), "candidates": 0},
    "plane_grid": {"normal": "z", "at": 0.0, "lower": [0, 0, 0], "upper": [1, 1, 0], "step": 0.5},
    "pose_from_world": {"x_M": [0, -1, 0, 0, 0]},
    "process_force": {},
    "reach": {"robot": ARM, "grid": GRID},
    "read_drawing": {"path": "bracket"},
    "read_forces": {},
    "read_gcode": {"path_or_text": "G1 X1 F100\n"},
    "read_load_tests": {"path_or_text": "nine_points"},
    "read_points": {},
    "read_program": {"path": "heart"},
    "read_stock": {"path": "stock.stl"},
    "read_tool_table": {"given": "1,8"},
    "simulate": {},
    "task_jacobian": AT,
    "tool_pose": AT,
    "run_study": {"study": {}, "out": "out"},
    "sensitivity": {"setup": SETUP},
    "turn": {"setup": SETUP},
    "uncertainty": {"setup": SETUP, "measure": "nothing"},
    "world_from_pose": {"T_MT": T_MT},
    "write_gcode": {"path": "out.nc", "toolpath": PATH},
    "write_map": {"path": "out.csv"},
    "write_material": {"path": "out.toml", "material": rm.load_material(rm.material_names()[0])},
    "write_robot": {"path": "out.toml", "robot": ARM},
    "write_setup": {"path": "out.toml", "setup": SETUP},
    "write_stl": {"path": "out.stl"},
    "ConstantForce": {"F": (0, 100, 0)},
    "Cutter": {"kind": "flat", "diameter_mm": 8},
    "Element": {"shape": "line", "points": [[0, 0], [1, 0]], "depth": 0.002, "v_f": 0.03},
    "Finding": {"level": "info", "message": "said"},
    "ForceRecord": {},
    "GCodeSource": {},
    "Grid": {"x_mm": [0], "y_mm": 0, "z_mm": 0},
    "JointBending": {},
    "JointTests": {},
    "KienzleForce": {},
    "KienzleRow": {},
    "LayerCut": {"layer": "slots", "depth_mm": 2, "feed_mm_min": 600},
    "LinesSource": {},
    "LinkMasses": {},
    "LoadTests": {},
    "MeasuredForce": {},
    "MechanisticForce": {},
    "MechanisticRow": {},
    "PathForce": {"feed_normal": 100.0},
    "PointsSource": {"path": PATH},
    "Provenance": {"kind": "user", "source": "said"},
    "SimulationSetup": {
        "robot": ARM,
        "source": PATH,
        "cutter": SETUP.cutter,
        "force": SETUP.force,
        "part_zero_mm": (0, -1300, 0),
    },
    "Sketch": {"elements": (LINE,)},
    "SketchSource": {"sketch": rm.Sketch((LINE,))},
    "SpindleSpring": {},
    "Spread": {},
    "Stock": {"lower_mm": (0, 0, -10), "upper_mm": (50, 50, 0)},
    "TableTool": {},
    "ToolBending": {},
    "ToolTable": {},
    "Robot.from_dh": {"a_mm": [500, 400]},
    "Toolpath.from_points": {"p_mm": [[0, 0, -2], [40, 0, -2]], "feed_mm_min": 1800},
}
FUNCTIONS = [name for name in rm.__all__ if inspect.isfunction(getattr(rm, name))]
# Of what a person has in hand, what is asked of it.
HELD: dict[str, tuple[Any, dict[str, Any]]] = {
    "replace of a robot": (ARM.replace, {}),
    "replace of a set-up": (SETUP.replace, {}),
    "replace of a cutter": (SETUP.cutter.replace, {}),
    "replace of a sketch": (rm.Sketch((LINE,)).replace, {}),
    "with_compliance_set": (ARM.with_compliance_set, {"name": "table_2"}),
    "fields": (rm.compliance_map(ARM, GRID).fields, {}),
    "in_base": (SETUP.in_base, {"p": [0, 0, 0]}),
    "to_base": (SETUP.to_base, {"v": [0, 0, 1]}),
    "to_part": (SETUP.to_part, {"v": [0, 0, 1]}),
    "moved": (DRAWING.moved, {"origin": "corner"}),
    "of_layer": (DRAWING.of_layer, {"layer": "slots"}),
    "sketch": (DRAWING.sketch, {"cuts": [rm.LayerCut("slots", depth_mm=2, feed_mm_min=600)]}),
    "tilt": (rm.frame_from_points([0, 1, 0], [1, 1, 0], [0, 2, 0]).tilt, {"error": 1e-5}),
}
OF_ROBOTS = ("C_theta", "limits", "limits_deg", "k_theta_kNm_per_rad", "tool_xyz_mm")


def refused_or_done(call: Callable[..., Any], right: dict[str, Any], more: Sequence[str] = ()) -> None:
    known = [each.name for each in inspect.signature(call).parameters.values() if each.kind.name[:3] != "VAR"]
    for name in dict.fromkeys([*known, *right, *more]):
        for wrong in WRONG:
            try:
                call(**{**right, name: wrong})
            except rm.RobomillError:
                continue
            except Exception as slip:
                pytest.fail(f"{name}={wrong!r:.60} raises {type(slip).__name__}: {slip}")


@pytest.mark.parametrize("name", sorted({*RIGHT, *FUNCTIONS}))
def test_an_argument_of_another_kind_is_refused_by_every_public_function_and_class(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing else than a RobomillError leaves a public door, whatever comes in by it."""
    monkeypatch.chdir(tmp_path)
    first, _, method = name.partition(".")
    call = getattr(rm, first)
    refused_or_done(getattr(call, method) if method else call, RIGHT.get(name, {}))


@pytest.mark.parametrize("name", HELD)
def test_an_argument_of_another_kind_is_refused_by_what_a_person_holds(name: str) -> None:
    call, right = HELD[name]
    of = getattr(call, "__self__", None)
    fields = list(inspect.signature(type(of)).parameters) if name.startswith("replace") else []
    refused_or_done(call, right, [*fields, *(OF_ROBOTS if of is ARM and fields else ())])


@asked
def takes(
    one: float = 1.0,
    whole: int = 1,
    text: str = "",
    many: Sequence[str] = (),
    pair: tuple[float, float] = (0.0, 0.0),
    numbers: ArrayLike | None = None,
    rows: Rows | Literal["auto"] = "auto",
    line: Numbers = (),
    array: FloatArray | None = None,
    place: str | Path | None = None,
    named: Mapping[str, float] | None = None,
) -> None:
    """Uses nothing of it and fails."""
    raise AttributeError("of its own")


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"one": "2"}, "takes: one: expected a number, found '2'."),
        ({"whole": 1.5}, "takes: whole: expected a whole number, found 1.5."),
        ({"text": 3}, "takes: text: expected a text, found 3."),
        ({"many": "ab"}, "takes: many: expected a sequence of a text, found 'ab'."),
        ({"pair": (1.0, 2.0, 3.0)}, "takes: pair: expected (a number, a number), found (1.0, 2.0, 3.0)."),
        ({"numbers": "x"}, "takes: numbers: expected numbers, or None, found 'x'."),
        ({"rows": "x"}, "takes: rows: expected numbers or 'auto', found 'x'."),
        ({"line": [1, "b"]}, "takes: line: expected numbers, found 'b'."),
        ({"array": [[1], [1, 2]]}, "takes: array: expected numbers, or None, found [[1], [1, 2]]."),
        ({"array": [None]}, "takes: array: expected numbers, or None, found [None]."),
        ({"named": {"a": "b"}}, "takes: named: expected a mapping from a text to a number, or None, found {'a': 'b'}."),
        ({"place": 3}, "takes: place: expected a text or a Path, or None, found 3."),
    ],
)
def test_the_sentence_names_the_argument_and_what_it_takes(given: dict[str, Any], sentence: str) -> None:
    with pytest.raises(ArgumentError) as caught:
        takes(**given)
    assert str(caught.value) == sentence
    assert caught.value.where == next(iter(given))


def test_a_mistake_of_its_own_stays_what_it_is() -> None:
    """A call that was given what it takes and fails is a bug, and must be seen."""
    right = {"one": np.float64(2), "whole": 2.0, "text": "x", "many": ["a"], "pair": [1, 2], "numbers": [[1, 2]]}
    with pytest.raises(AttributeError, match="of its own"):
        takes(**right, rows=np.eye(3), line=np.ones(3), array=[1.0, 2.0], place=Path("x"))
