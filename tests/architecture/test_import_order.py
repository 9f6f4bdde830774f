"""Imports point down only: the order of the rooms, read off the source."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "robomill"

# Rooms from the ground up; those on one line may not import each other.
STOREYS = [
    {
        "wording",
        "units",
        "unit_words",
        "typed_numbers",
        "version",
        "arguments",
        "kinds",
        "arrays",
        "vectors",
        "rigid",
        "errors",
        "extras",
        "frames",
        "values",
        "lazy",
        "files",
        "compiled",
        "console",
        "csv_text",
        "interrupts",
        "provenance",
        "quantities",
        "spelled",
        "paper",
        "seals",
        "budgets",
        "progress",
    },
    {"robot"},
    {"kinematics", "cutting", "toolpath"},
    {"compliance", "surface"},
    {"workspace", "identification"},
    {"simulation"},
    {"improve"},
    {"report", "viz", "io"},
    {"study", "learn"},
    {"ui"},
    {"cli"},
    {"__main__"},
]
LEVEL = {room: level for level, rooms in enumerate(STOREYS) for room in rooms}
SCREEN = {"streamlit", "plotly", "pyvista", "pandas", "vtk", "matplotlib"}
ON_USE = {"frames": {"pandas"}}  # one door of the core to a table library, imported by whoever calls it
MAY_DRAW = {"report", "viz", "io", "ui", "cli", "__main__"}
MODULES = sorted(p for p in PACKAGE.rglob("*.py") if p.parent != PACKAGE or p.stem != "__init__")


def room_of(path: Path) -> str:
    first = path.relative_to(PACKAGE).parts[0]
    return first.removesuffix(".py")


def test_every_room_has_its_storey() -> None:
    assert {room_of(path) for path in MODULES} == set(LEVEL)


def imported(path: Path) -> set[str]:
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            names.update(f"{node.module}.{alias.name}" for alias in node.names)
            names.add(node.module)
    return names


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_a_room_imports_only_rooms_below(path: Path) -> None:
    room = room_of(path)
    for name in imported(path):
        parts = name.split(".")
        if parts[0] == "robomill" and len(parts) > 1 and parts[1] in LEVEL and parts[1] != room:
            lower = LEVEL[parts[1]] < LEVEL[room]
            ground = LEVEL[room] == 0 and LEVEL[parts[1]] == 0
            assert lower or ground, f"{path.relative_to(ROOT)} ({room}) imports {name}: imports point down only"
        if parts[0] in SCREEN:
            assert room in MAY_DRAW or parts[0] in ON_USE.get(room, ()), (
                f"{path.relative_to(ROOT)}: the core imports {parts[0]}"
            )


@pytest.mark.parametrize("path", sorted([*ROOT.glob("pages/*.py"), ROOT / "app.py"]), ids=lambda p: p.name)
def test_pages_are_thin(path: Path) -> None:
    lines = path.read_text().count("\n")
    assert lines <= 120, f"{path.name} has {lines} lines; a page has at most 120"


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_modules_can_be_read_at_a_sitting(path: Path) -> None:
    lines = path.read_text().count("\n")
    assert lines <= 400, f"{path.relative_to(ROOT)} has {lines} lines; 400 is too many"


def test_import_robomill_loads_no_screen_and_no_compiler() -> None:
    heavy = sorted({*SCREEN, "numba", "trimesh", "scipy", "clarabel"})
    code = f"import sys, robomill; print([m for m in {heavy!r} if m in sys.modules])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert found.strip() == "[]", f"import robomill also imports {found}"


# Of the screen's core: no page of their own.
CORE_ROOMS = {"entry", "comparing", "judged", "keeping", "posed", "serving", "sharing", "work"}
UI_ROOMS = sorted({path.parent.name for path in (PACKAGE / "ui").glob("*/__init__.py")} - CORE_ROOMS)


@pytest.mark.parametrize("room", UI_ROOMS)
def test_no_room_of_the_screen_knows_another(room: str) -> None:
    others = tuple(f"robomill.ui.{other}" for other in UI_ROOMS if other != room)
    for path in (PACKAGE / "ui" / room).rglob("*.py"):
        for name in imported(path):
            assert not name.startswith(others), f"{path.relative_to(ROOT)} imports {name}: what is shared is ui's core"


def test_the_core_of_the_screen_knows_no_room() -> None:
    inside = (file for room in CORE_ROOMS for file in (PACKAGE / "ui" / room).glob("*.py"))
    for path in (*(PACKAGE / "ui").glob("*.py"), *inside):
        for name in imported(path):
            assert not name.startswith(tuple(f"robomill.ui.{room}" for room in UI_ROOMS)), f"{path.name}: {name}"


def test_only_the_screen_imports_streamlit() -> None:
    for path in MODULES:
        if room_of(path) != "ui":
            assert not any(name.split(".")[0] == "streamlit" for name in imported(path)), path.relative_to(ROOT)
