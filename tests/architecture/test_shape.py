"""The shape of the code, read off the source: no circles, short functions, few parameters, nothing that nobody uses."""

from __future__ import annotations

import ast
import graphlib
import re
from fnmatch import fnmatch
from functools import cache
from pathlib import Path

import pytest
from vulture import Vulture
from vulture.core import Item

import robomill as rm
from robomill.compliance.springs import SPRINGS
from robomill.cutting.forces import FORCES

ROOT = Path(__file__).resolve().parents[2]
PRODUCT = sorted([*(ROOT / "robomill").rglob("*.py"), *(ROOT / "pages").glob("*.py"), ROOT / "app.py", ROOT / "run.py"])
MODULES = {".".join(p.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): p for p in PRODUCT}

MOST_LINES = 60
MOST_PARAMETERS = 6
# Functions that take more. The number only falls: whoever groups what belongs together lowers it.
MANY_PARAMETERS = 4
# Doors for people, who give by name what they have: each number has one keyword in SI and one in its unit.
DOORS = {"from_dh", "from_points", "place", "design_box", "__init__"}
# Longer functions, to be cut. Whoever shortens one strikes it out here.
LONG: set[str] = set()
# What keeps a state while it runs: the session, whoever reads a program line by line, long work, the drawing process.
RUNNING = (
    "robomill/ui/",
    "robomill/toolpath/gcode/",
    "robomill/toolpath/apt.py",
    "robomill/progress.py",
    "robomill/viz/rendered/render_queue.py",
    "robomill/viz/rendered/worker.py",
)
# What only readers of the public API, a library or an attribute of somebody else's object uses, with the reason.
UNUSED = {
    "over_time": "public: forces from arrays",
    "__signature__": "what completion and help ask a function for",
    "to_dataframe": "public name",
    "_check_value": "argparse's",
    "run_*": "the parser of the command line finds what a verb runs by its name",
    "wall_left_*": "the metrology panel asks for the walls by their side",
    "wall_right_*": "the same",
    "error_*": "records and panels ask for a section's measures by their names",
    "camera_position": "pyvista's",
    "parallel_projection": "pyvista's",
    "parallel_scale": "pyvista's",
    "clipping_range": "pyvista's",
    "verbose": "clarabel's",
    "doctype": "what the reader of XML calls where a file has one",
}


@cache
def tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def functions(path: Path) -> list[ast.FunctionDef]:
    return [node for node in ast.walk(tree(path)) if isinstance(node, ast.FunctionDef)]


def parts(name: str) -> list[str]:
    """a, a.b and a.b.c of a.b.c."""
    words = name.split(".")
    return [".".join(words[: k + 1]) for k in range(len(words))]


def imports(module: str, *, inside_functions: bool) -> set[str]:
    """Modules of the product that ``module`` imports; those needed for annotations alone count too.

    ``import a.b.c`` loads the packages a and a.b first, save those that the module itself stands in.
    """
    found: set[str] = set()

    def visit(node: ast.AST) -> None:
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.FunctionDef | ast.Lambda) and not inside_functions:
                continue
            if isinstance(child, ast.Import):
                found.update(alias.name for alias in child.names)
            elif isinstance(child, ast.ImportFrom):
                assert child.module is not None
                assert not child.level, f"{module}: imports name the package from its root"
                for alias in child.names:
                    inner = f"{child.module}.{alias.name}"
                    found.add(inner if inner in MODULES else child.module)
            visit(child)

    visit(tree(MODULES[module]))
    loaded = {part for name in found for part in parts(name)} - set(parts(module))
    return ((found | loaded) & set(MODULES)) - {module}


@pytest.mark.parametrize("inside_functions", [False, True], ids=["at the top", "inside functions too"])
def test_no_circle_among_imports(inside_functions: bool) -> None:
    graph = {module: imports(module, inside_functions=inside_functions) for module in MODULES}
    try:
        graphlib.TopologicalSorter(graph).prepare()
    except graphlib.CycleError as exc:
        pytest.fail(f"modules import each other: {' <- '.join(exc.args[1])}")


def said(function: ast.FunctionDef) -> int:
    """Lines of a docstring: what a public function takes and gives is told at length, and is no code."""
    first = function.body[0]
    return first.end_lineno - first.lineno + 1 if ast.get_docstring(function) is not None else 0


def test_functions_are_short() -> None:
    lengths = {
        (path.relative_to(ROOT), f.name): f.end_lineno - f.lineno + 1 - said(f)
        for path in PRODUCT
        for f in functions(path)
    }
    long = {f"{path}: {name}, {n} lines" for (path, name), n in lengths.items() if n > MOST_LINES and name not in LONG}
    assert not long, f"functions have at most {MOST_LINES} lines"


def test_functions_with_many_parameters_become_fewer() -> None:
    found = []
    for path in PRODUCT:
        for f in functions(path):
            a = f.args
            names = [*(p.arg for p in (*a.posonlyargs, *a.args, *a.kwonlyargs)), *(v for v in (a.vararg, a.kwarg) if v)]
            if f.name not in DOORS and len([n for n in names if n not in ("self", "cls")]) > MOST_PARAMETERS:
                found.append(f"{path.relative_to(ROOT)}:{f.lineno} {f.name}")
    assert len(found) <= MANY_PARAMETERS, "group what belongs together in a frozen dataclass:\n" + "\n".join(found)


def test_values_are_frozen() -> None:
    """A dataclass is a value: a change is a replacement, so that digests and caches may rest on it."""
    open_ones = {
        f"{path.relative_to(ROOT)} {node.name}"
        for path in PRODUCT
        for node in ast.walk(tree(path))
        if isinstance(node, ast.ClassDef)
        for mark in node.decorator_list
        if "dataclass" in ast.unparse(mark) and "frozen=True" not in ast.unparse(mark)
    }
    assert not {name for name in open_ones if not name.startswith(RUNNING)}


def test_lines_are_as_the_formatter_leaves_them() -> None:
    mark = "fmt: " + "skip"
    assert not [
        str(path.relative_to(ROOT)) for path in (*PRODUCT, *ROOT.glob("tests/**/*.py")) if mark in path.read_text()
    ]


def lines_of(f: ast.FunctionDef) -> range:
    return range(f.lineno, f.end_lineno + 1)


def unused(ignored: list[str]) -> list[Item]:
    """What no line of the product uses, parameters of doors left out, which go by name through a table.

    Force models and springs are found in their folders, not by name, and public names are for others.
    """
    doors = {(path, line) for path in PRODUCT for f in functions(path) if f.name in DOORS for line in lines_of(f)}
    found = (model.__name__ for model in (*FORCES.values(), *SPRINGS.values()))
    search = Vulture(ignore_names=[*ignored, *found, *rm.__all__])
    search.scavenge([str(path) for path in PRODUCT])
    return [
        item
        for item in search.get_unused_code(min_confidence=60)
        if item.typ != "variable" or (Path(item.filename), item.first_lineno) not in doors
    ]


def test_nothing_is_there_that_nobody_uses() -> None:
    dead = {f"{Path(item.filename).relative_to(ROOT)}:{item.first_lineno} {item.name}" for item in unused([*UNUSED])}
    assert not dead, "used by nothing, or by tests alone: delete it, or move it to the tests that need it"


def test_every_exception_is_still_needed() -> None:
    names = {item.name for item in unused([])}
    assert not {pattern for pattern in UNUSED if not any(fnmatch(name, pattern) for name in names)}


# What is no word of a number: coordinates and shares of a picture, cells of a CSV; and what is to follow.
DRAWN = {"drawn.py", "pictures.py", "tables.py"}
DRAWN_IN = {"sections_told.py verdict", "plain.py _section_line"}


def test_numbers_for_people_are_formatted_in_units_alone() -> None:
    """Minus signs, digits and thousands of what a report and the command line say are one formatter's business."""
    told = [path for path in PRODUCT if path.parent.name in ("report", "cli") and path.name not in DRAWN]
    found = {f"{path.name} {name}" for path in told for name in formatting(path)}
    assert found == DRAWN_IN


def formatting(path: Path) -> set[str]:
    """The functions of a file that give a number its decimals."""
    return {
        function.name
        for function in ast.walk(tree(path))
        if isinstance(function, ast.FunctionDef)
        for each in ast.walk(function)
        if isinstance(each, ast.FormattedValue)
        and isinstance(each.format_spec, ast.JoinedStr)
        and any(re.search(r"[efg%]$", str(part.value)) for part in specs(each.format_spec))
    }


def specs(spec: ast.JoinedStr) -> list[ast.Constant]:
    return [part for part in spec.values if isinstance(part, ast.Constant)]
