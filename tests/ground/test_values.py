"""Public values are values: read-only to the last array, equal by what they hold, short in a console, copied whole."""

from __future__ import annotations

import copy
import html.parser
import pickle
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from functools import cached_property as standard
from typing import Any

import numpy as np
import pytest

import robomill as rm
from robomill.identification.measured_field import MeasuredField
from robomill.io.samples import samples_dir
from robomill.lazy import cached_property
from robomill.surface.stock import Stock
from robomill.workspace.fields import compliance_map
from robomill.workspace.grid import Grid

LOAD_TESTS = samples_dir() / "load_tests"
MOST_DEEP = 6


def run(change: Any = lambda setup: setup) -> Any:
    return rm.simulate(change(rm.load_setup(samples_dir() / "paper_flute" / "setup.toml")))


@pytest.fixture(scope="module")
def result():
    return run()


@pytest.fixture(scope="module")
def values(result):
    """One of every public value, by name."""
    robot = rm.load_robot("slavkovic_5r")
    tests = rm.read_load_tests(LOAD_TESTS / "nine_points.csv", robot)
    field = compliance_map(robot, Grid([-0.2, 0.0], [-1.4, -1.3], [0.0]))
    C = np.broadcast_to(np.eye(3) * 1e-6, (2, 3, 3))
    return {
        "robot": robot,
        "setup": result.setup,
        "path": result.setup.toolpath,
        "cutter": result.setup.cutter,
        "stock": result.setup.stock_block,
        "ik": result.ik,
        "result": result,
        "sections": result.sections,
        "section": result.sections[0],
        "ideal": result.ideal,
        "error": result.error,
        "load tests": tests,
        "joint tests": rm.read_load_tests("joint,torque_Nm,angle_mrad\n1,300,0.214\n2,300,0.3"),
        "identification": rm.identify(robot, tests),
        "grid": field.grid,
        "field": field,
        "one quantity": field.field("C_yy"),
        "measured map": MeasuredField(np.array([[0.0, -1.3, 0.0], [0.1, -1.3, 0.0]]), C),
    }


def asked(value: Any) -> Iterator[tuple[str, Any]]:
    """Whatever a value offers by a public name without being called."""
    names = {each.name for each in fields(value)} if is_dataclass(value) else set()
    for owner in type(value).__mro__:
        names |= {n for n, kept in vars(owner).items() if isinstance(kept, property | cached_property | standard)}
    for name in sorted(names):
        if not name.startswith("_"):
            try:
                yield name, getattr(value, name)
            except rm.RobomillError:  # what this value cannot answer
                continue


def arrays(value: Any, name: str, seen: set[int], deep: int = 0) -> Iterator[tuple[str, np.ndarray]]:
    """Every array that hangs on a value, however deep, with the way there."""
    if isinstance(value, np.ndarray):
        yield name, value
    elif isinstance(value, dict):
        for key, item in value.items():
            yield from arrays(item, f"{name}[{key!r}]", seen, deep + 1)
    elif isinstance(value, tuple | list):
        for k, item in enumerate(value[:3]):
            yield from arrays(item, f"{name}[{k}]", seen, deep + 1)
    elif type(value).__module__.startswith("robomill") and id(value) not in seen and deep < MOST_DEEP:
        seen.add(id(value))
        for each, found in asked(value):
            yield from arrays(found, f"{name}.{each}", seen, deep + 1)


def test_no_array_of_a_public_value_can_be_written_to(values):
    open_ones = []
    for name, value in values.items():
        for way, array in arrays(value, name, set()):
            if array.flags.writeable:
                open_ones.append(way)
    assert not open_ones, "\n".join(open_ones)


@pytest.mark.parametrize("again", [copy.copy, copy.deepcopy, lambda v: pickle.loads(pickle.dumps(v))])
def test_a_copy_is_equal_and_as_closed_as_the_first(values, again):
    for name, value in values.items():
        twin = again(value)
        assert twin is not value
        assert twin == value, name
        assert hash(twin) == hash(value), name
        assert repr(twin) == repr(value)
        open_ones = [way for way, array in arrays(twin, name, set()) if array.flags.writeable]
        assert not open_ones


def test_equal_is_what_holds_the_same_and_nothing_else(values, result):
    setup, robot, path = result.setup, result.setup.robot, result.setup.toolpath
    assert run() == result
    assert run(lambda s: s.replace(tolerance=0.2e-3)) != result
    assert setup.replace(description="other words") == setup
    assert setup.replace(step=2e-3) != setup
    assert robot.replace(C_theta=robot.C_theta * (1.0 + 1e-15)) != robot
    assert rm.Toolpath(path.p, path.k, path.v_f, path.cutting, path.block, path.n_s, path.tool) == path
    assert rm.Toolpath(path.p + 1e-9, path.k, path.v_f, path.cutting, path.block, path.n_s, path.tool) != path
    assert setup.cutter.replace(diameter=setup.cutter.diameter) == setup.cutter
    assert setup.cutter.replace(flutes=5) != setup.cutter
    tests = values["load tests"]
    assert tests == rm.read_load_tests((LOAD_TESTS / "nine_points.csv").read_text(), robot)  # from a text, not a file
    assert tests != tests.without([int(tests.row[0])])
    assert set(values.values()) | {robot, setup} == set(values.values())
    for name, value in values.items():
        assert value != 1, name
        assert (value == "text") is False


def test_a_line_says_each_value_in_a_console_that_knows_ascii_only(values):
    for name, value in values.items():
        said = repr(value)
        assert said.startswith(f"<{type(value).__name__} "), name
        assert said.endswith(">")
        assert said.isascii(), said
        assert "\n" not in said
        assert len(said) < 330, said
        assert "0x" not in said


def test_what_the_lines_say(values):
    assert repr(values["robot"]) == "<Robot slavkovic_5r: 5 joints, standard D-H, compliance set 'table_2'>"
    assert repr(values["cutter"]) == "<Cutter 8.00 mm flat end mill, 3 flutes>"
    assert repr(values["path"]) == "<Toolpath 5 points, 100.0 mm at feed within 100.0 x 0.0 x 0.0 mm>"
    assert repr(values["result"]).startswith("<SimulationResult Reference groove (Slavkovic 2013): 0.251 mm, ok: The ")
    lost = rm.inverse_kinematics(values["robot"], rm.pose_from_world([9.0, 0.0, 0.0, 0.0, 0.0]))
    assert repr(lost) == "<IKResult not reached>"


class Checked(html.parser.HTMLParser):
    """Tags that are opened and closed in order, and the text between them."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: set[str] = set()
        self.said = ""
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.open.append(tag)
        self.tags.add(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.said += f"{data}|"


def test_a_notebook_shows_a_table_of_each(values):
    for name, value in values.items():
        page = Checked(value._repr_html_())
        assert page.tags <= {"table", "caption", "tr", "td", "th"}, name
        assert {"table", "caption"} <= page.tags
    assert "91.35|" in Checked(values["robot"]._repr_html_()).said
    assert "Diameter|8 mm|" in Checked(values["cutter"]._repr_html_()).said
    assert "… 95 more|" in Checked(values["path"].__class__._repr_html_(values["result"].path)).said


def test_a_name_is_text_in_a_notebook_whatever_is_in_it(values):
    name = "<script>alert('x')</script>"
    for value in (values["robot"].replace(name=name), values["setup"].replace(name=name)):
        page = Checked(value._repr_html_())
        assert "script" not in page.tags
        assert name in page.said


def test_what_cannot_be_judged_is_still_shown(result):
    block, aside = result.setup.stock_block, np.array([0.0, 1.0, 0.0])
    beside = run(lambda s: s.replace(stock=Stock(block.lower + aside, block.upper + aside)))
    assert "no deviation, missed: The path never touches the stock" in repr(beside)


def test_nobody_makes_an_array_of_a_value_writable_again() -> None:
    """NumPy lets whoever owns the memory: a result's array was written to after setflags(write=True)."""
    result = rm.simulate(rm.load_setup("paper_flute").replace(step_mm=5, cell_mm=0.5))
    again = pickle.loads(pickle.dumps(result))
    robot = result.setup.robot
    for one in (result, again, copy.deepcopy(result)):
        arrays = (one.delta, one.F, one.deviation, one.path.p, one.setup.T_MW, one.machined.z, one.delta_joint, one.C)
        for array in arrays:
            with pytest.raises(ValueError, match="WRITEABLE"):
                array.setflags(write=True)
    for array in (robot.C_theta, robot.a, robot.limits, result.groove(0.05).z_machined):
        with pytest.raises(ValueError, match="WRITEABLE"):
            array.setflags(write=True)


def test_small_values_say_themselves_in_a_line() -> None:
    cut = rm.load_setup("paper_flute/setup_process")
    square = rm.Element("rectangle", [[-0.02, -0.02], [0.02, 0.02]], depth=0.0015, v_f=0.02)
    said = {
        repr(rm.PathForce(feed_normal=100.0)),
        repr(rm.ConstantForce((0.0, 100.0, 0.0))),
        repr(cut.force),
        repr(cut.force.material),
        repr(cut.source),
        repr(rm.ToolBending(diameter_mm=8, stick_out_mm=40)),
        repr(square),
        repr(rm.Sketch((square,))),
        repr(rm.at_pose(cut.robot, cut.robot.home)),
        repr(rm.LayerCut("slots", depth_mm=3, feed_mm_min=600)),
    }
    assert max(map(len, said)) < 140
    assert all(words.isascii() and "\n" not in words for words in said)
    assert "<PathForce 100 N left of the feed>" in said
    assert "<Element rectangle of 2 points, 1.5 mm deep, 1200 mm/min>" in said


def known(x):
    setup = rm.load_setup("paper_flute")
    found = rm.identify(setup.robot, "one_joint_at_a_time" if x else "nine_points")
    return setup.replace(robot=found.applied_to(setup.robot), knowledge=found).known


SMALL = {
    "constant force": lambda x: rm.ConstantForce([0.0, 100.0 + x, 0.0]),
    "force record": lambda x: rm.ForceRecord([0.0, 0.1, 0.2, 0.3], [[10.0 + x, 20.0, -5.0]] * 4),
    "measured force": lambda x: rm.MeasuredForce.over_time([0.0, 0.1, 0.2, 0.3], [[10.0 + x, 20.0, -5.0]] * 4),
    "element": lambda x: rm.Element("line", [[0.0, 0.0], [0.05 + x * 1e-3, 0.0]], depth=2e-3, v_f=0.03),
    "sketch": lambda x: rm.Sketch((SMALL["element"](x),)),
    "sketch source": lambda x: rm.SketchSource(SMALL["sketch"](x)),
    "lines": lambda x: rm.LinesSource([[0.0, 0.0, -2e-3]], [[0.05 + x * 1e-3, 0.0, -2e-3]], [0.03]),
    "weights": lambda x: rm.LinkMasses([30.0 + x, 12.0], [[0.2, 0.0, 0.0], [0.1, 0.0, 0.0]]),
    "drawing": lambda x: rm.read_drawing("bracket").moved("centre" if x else "corner"),
    "knowledge": known,
}


@pytest.mark.parametrize("make", SMALL.values(), ids=SMALL)
def test_small_values_made_alike_are_equal_and_so_are_their_copies(make):
    one, other = make(0.0), make(1.0)
    assert one == make(0.0) != other
    assert hash(one) == hash(make(0.0))
    assert len({one, make(0.0), other}) == 2
    twin = pickle.loads(pickle.dumps(one))
    assert twin == one
    assert not any(array.flags.writeable for array in vars(twin).values() if isinstance(array, np.ndarray))
    assert len(repr(one)) < 200
    assert "array(" not in repr(one)
