"""Every key of every file, from the readers and the declarations: tables for the page of file formats."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from generators import traced
from generators.words import LABELS, WORDS
from robomill.compliance.gravity import LinkMasses
from robomill.compliance.springs import SPRINGS
from robomill.cutting.forces import FORCES
from robomill.cutting.tool import Cutter
from robomill.cutting.tool_table import TableTool
from robomill.io.columns import Layout, spelled
from robomill.io.materials import LAWS
from robomill.io.measured import forces, load_test_columns, profiles
from robomill.io.measured.load_test_columns import written
from robomill.io.robot.reader import SPELLED, STEMS
from robomill.io.robot.robots import load_robot
from robomill.io.setups import tool_tables
from robomill.quantities import Quantity, quantities
from robomill.robot.model import Robot
from robomill.simulation.given import PART_TURN, PART_ZERO
from robomill.simulation.setup import SimulationSetup
from robomill.surface.stock import Stock
from robomill.toolpath.sketch import Element, Sketch
from robomill.toolpath.source import GCodeSource
from robomill.workspace.quantities import map_quantities

HEAD = "| key | meaning | value | where it is left out |\n|---|---|---|---|"
Rows = list[tuple[str, str, str, str]]


class UnsaidKeyError(Exception):
    """A key of a file that no sentence explains, or a sentence about a key that no file has."""


def pages() -> dict[str, str]:
    """The generated pieces by name."""
    return {
        "format_setup.md": _setup(),
        "format_robot.md": _robot(),
        "format_material.md": _material(),
        "format_tools.md": _tools(),
        "format_tbl.md": _tbl(),
        "format_load_tests.md": _columns(load_test_columns.LAYOUT, _LOAD_TESTS),
        "format_force.md": _columns(forces.LAYOUT, _FORCE),
        "format_profile.md": _columns(profiles.LAYOUT, _PROFILE),
        "format_map.md": _map(),
    }


# ---- TOML ----------------------------------------------------------------------------------------------------------
def _setup() -> str:
    found = dict(traced.setup_keys())
    numbers = quantities(SimulationSetup)
    top = {numbers["tolerance"].key: numbers["tolerance"]}
    said = ["### At the top", _table(found.pop((traced.OWN, "")), WORDS["setup"], top)]
    parts: list[tuple[str, str, str, Mapping[str, Quantity]]] = [
        ("[tolerance_mm]", "tolerance_mm", "", {}),
        ("[robot]", "robot", "", {}),
        ("[path]", "path", "", _by_key(GCodeSource)),
        ("[path.sketch]", "path.sketch", "", _by_key(Sketch)),
        ("[[path.sketch.elements]]", "path.sketch.elements", "", _by_key(Element)),
        ("[part]", "part", "", {PART_ZERO.key: PART_ZERO, PART_TURN.key: PART_TURN}),
        ("[stock]", "stock", "", _by_key(Stock)),
        ("[cutter]", "cutter", "", _by_key(Cutter)),
        ("[[tools]]", "tools", "", _by_key(TableTool)),
        *((f'[force] with kind = "{kind}"', "force", kind, _by_key(model)) for kind, model in FORCES.items()),
        ("[force.record]", "force.record", "", {}),
        *((f'[[springs]] with kind = "{kind}"', "springs", kind, _by_key(spring)) for kind, spring in SPRINGS.items()),
        ("[measured_map]", "measured_map", "", {}),
        ("[links]", "links", "", _by_key(LinkMasses)),
        ("[uncertainty]", "uncertainty", "", {}),
        ("[numerics]", "numerics", "", {each.key: each for each in numbers.values()}),
    ]
    found["tools", ""] -= set(_by_key(Cutter))  # which stand with [cutter]; the page says so
    for title, table, kind, declared in parts:
        words = {key: text for key, text in WORDS[table].items() if not kind or key in found[table, kind]}
        said += [f"### `{title}`", _purpose(table, kind), _table(found.pop((table, kind)), words, declared)]
    said += ["### `[provenance]`", _PROVENANCE, _table(found["provenance.cutter", ""], WORDS["provenance"], {})]
    rest = {table for table, _ in found if table.rpartition(".")[2] not in ("provenance", "source")}
    rest = {table for table in rest if not table.startswith(("provenance.", "robot.definition", "force.material_def"))}
    if rest:
        raise UnsaidKeyError(f"Tables of a set-up that the page of file formats does not have: {sorted(rest)}.")
    return "\n\n".join(each for each in said if each)


_PROVENANCE = (
    'One entry a block, `cutter = { kind = "paper", source = "section 5.2" }`; the blocks of a set-up are `path`, '
    "`part`, `cutter`, `force`, `stock`, `tolerance`, `measured_map`, those of a robot stand with its file."
)


_TOOLS = "One entry a tool: these keys and those of `[cutter]`. What nobody states of a cutter is assumed and said."


def _purpose(table: str, kind: str) -> str:
    if table == "force":
        model = FORCES[kind]
        return _sentence(f"{model.title}. {model.hint or ''} {_head(model)}")
    if table == "springs":
        spring = SPRINGS[kind]
        return _sentence(f"{spring.title}. {spring.hint or ''}")
    return _TOOLS if table == "tools" else ""


def _head(cls: type) -> str:
    """The first paragraph of a docstring, on one line."""
    return " ".join((cls.__doc__ or "").partition("\n\n")[0].split())


def _robot() -> str:
    found = traced.robot_keys()
    declared = quantities(Robot)
    stems = [STEMS.get(name, name) for name, each in declared.items() if each.unit in SPELLED]
    joint_words = {**{stem: LABELS[stem] for stem in stems}, **WORDS["joint"]}
    said = ["### At the top", _table(found[traced.OWN, ""], WORDS["robot file"], {})]
    said += ["### `[[joint]]`", _table(_stems(found["joint", ""]), _of_stems(found["joint", ""], joint_words), {})]
    for table in ("base", "tool"):
        keys = found[table, ""]
        said += [f"### `[{table}]`", _table(_stems(keys), _of_stems(keys, WORDS[table]), {})]
    sets = {name for robot in ("slavkovic_5r", "kuka_kr270") for name in load_robot(robot).compliance_sets}
    keys = (found["compliance", ""] - sets) | {"C_theta_SI", "k_theta_Nm_per_rad"}
    said += ["### `[compliance]` and its sets `[compliance.NAME]`", _table(keys, WORDS["compliance"], {})]
    return "\n\n".join(said)


def _stems(keys: Iterable[str]) -> set[str]:
    """Keys that differ in their unit alone, as one: "a_mm, a_m"."""
    return set(_grouped(keys).values())


def _grouped(keys: Iterable[str]) -> dict[str, str]:
    """Stem -> its spellings, joined."""
    out: dict[str, list[str]] = {}
    for key in sorted(keys, key=lambda key: (key.endswith(("_m", "_rad")), key)):
        stem, _, unit = key.rpartition("_")
        out.setdefault(stem if unit in ("mm", "m", "deg", "rad") else key, []).append(key)
    return {stem: ", ".join(spelled) for stem, spelled in out.items()}


def _of_stems(keys: Iterable[str], words: Mapping[str, str]) -> dict[str, str]:
    return {spelled: words[stem] for stem, spelled in _grouped(keys).items() if stem in words}


def _material() -> str:
    found = traced.material_keys()
    said = ["### At the top", _table(found[traced.OWN, ""], WORDS["material"], {})]
    left = set(found["coefficients", ""])
    for law in LAWS:
        keys = {each.key for each in quantities(law).values()}
        left -= keys
        said += [f"### `[coefficients]`, {law.kind}", _head(law), _table(keys, {}, _by_key(law))]
    if left:
        raise UnsaidKeyError(f"Coefficients of no law: {sorted(left)}.")
    return "\n\n".join(said)


def _tools() -> str:
    declared = {**_by_key(TableTool), **_by_key(Cutter)}
    return _table(set(declared) | {"name"}, {"name": WORDS["tools"]["name"]}, declared)


def _tbl() -> str:
    declared = _by_key(TableTool)
    rows = [
        f"| `{letter}` | {declared[key].label if key in declared else key} |"
        for letter, key in tool_tables._OF_TBL.items()
    ]
    rows.append("| `D` | Diameter; below 0: compensation to the other side |")
    silent = ", ".join(f"`{letter}`" for letter in sorted(tool_tables._SILENT))
    rows.append(f"| {silent} | passed over |")
    return "\n".join(["| word | meaning |", "|---|---|", *rows])


def _by_key(cls: type) -> dict[str, Quantity]:
    return {each.key: each for each in quantities(cls).values()}


def _table(keys: set[str], words: Mapping[str, str], declared: Mapping[str, Quantity]) -> str:
    """Rows for every key, in words or from its declaration; every sentence must have its key."""
    unsaid = sorted(keys - set(words) - set(declared))
    idle = sorted(set(words) - keys)
    if unsaid or idle:
        raise UnsaidKeyError(
            f"Keys without a sentence: {unsaid}; sentences without a key: {idle}. See generators/words.py."
        )
    in_order = [key for key in words if key in keys] + [key for key in declared if key in keys and key not in words]
    rows: Rows = []
    for key in in_order:
        if key in words:
            rows.append((key, words[key], "", ""))
        else:
            each = declared[key]
            rows.append((key, _meaning(each), _value(each), _default(each)))
    if all(not value and not default for _, _, value, default in rows):
        body = [f"| {_code(key)} | {_cell(meaning)} |" for key, meaning, _, _ in rows]
        return "\n".join(["| key | meaning |", "|---|---|", *body])
    return "\n".join([HEAD, *(f"| {_code(key)} | {_cell(m)} | {_cell(v)} | {_cell(d)} |" for key, m, v, d in rows)])


def _meaning(each: Quantity) -> str:
    said = LABELS.get(each.key) or LABELS.get(each.name)
    return said or _sentence(f"{each.label[:1].upper()}{each.label[1:]}. {each.hint or ''}")


def _value(each: Quantity) -> str:
    if each.kind == "choice":
        return ", ".join(f'`"{code}"`' for code in each.options)
    if each.kind == "array":
        length, *rest = each.shape
        count = "a list of numbers" if length is None and not rest else f"{length} numbers"
        return "rows of " + f"{rest[0]} numbers" if rest else count
    without = "" if each.written_none is None else f"; {each.short(each.written_none)} for none"
    return each.expected.removesuffix(", or left out") + without


def _default(each: Quantity) -> str:
    if each.needed and each is not PART_ZERO and each is not PART_TURN:
        return "is needed"
    if each is PART_ZERO or each is PART_TURN:
        return "0"
    if each.default is None:
        return "not given"
    plain = {"switch": lambda on: f"`{str(on).lower()}`", "choice": lambda code: f'`"{code}"`'}
    return plain.get(each.kind, each.short)(each.default)


def _code(keys: str) -> str:
    return ", ".join(f"`{key}`" for key in keys.split(", "))


def _sentence(text: str) -> str:
    return " ".join(text.split())


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")


# ---- CSV -----------------------------------------------------------------------------------------------------------
_COMPLIANCES = tuple(f"c{i}{j}" for i in "xyz" for j in "xyz")
_LOAD_TESTS: tuple[tuple[str, Sequence[str], str], ...] = (
    ("joint coordinates", tuple(f"theta{j}" for j in range(1, 10)), "the pose; mm or m where the joint slides"),
    ("place", ("x", "y", "z"), "of the tool tip (or the flange: `# frame: flange`) in {M}"),
    ("tilt", ("a", "b"), "of the tool, with X, Y, Z; with `C` three angles as a controller shows them"),
    ("turn", ("c",), "with A and B: `# angles: kuka` or `# angles: robomill` says how they are read"),
    ("FANUC's angles", ("w", "p", "r"), "R = R_z(R) R_y(P) R_x(W)"),
    ("rotation vector", load_test_columns.ROTVEC, "about itself by its own length; `rx, ry, rz` under `# angles: ur`"),
    ("force", ("fx", "fy", "fz"), "on the tool, in {M}"),
    ("moment", ("mx", "my", "mz"), "on the tool about the tip, in {M}"),
    ("preload", ("f0x", "f0y", "f0z"), "the force of the unloaded reading; differences are used"),
    ("displacement", ("dx", "dy", "dz"), "measured, in {M}"),
    ("reading at preload", ("d0x", "d0y", "d0z"), "the unloaded reading; differences are used"),
    ("rotation", ("rx", "ry", "rz"), "measured, in {M}"),
    ("load point", ("fpx", "fpy", "fpz"), "where the force acts, from the tool tip, in {T}"),
    ("measuring point", ("mpx", "mpy", "mpz"), "where the displacement is read, from the tool tip, in {T}"),
    ("load point", tuple(f"load_point_{a}" for a in "xyz"), "the same in the frame of the flange"),
    ("measuring point", tuple(f"gauge_point_{a}" for a in "xyz"), "the same in the frame of the flange"),
    ("pull", ("load",), "of a cable, or the load of measured compliances"),
    ("cable", tuple(f"cable_{a}" for a in "xyz"), "unit vector along the pull, in {M}"),
    ("pulley", tuple(f"pulley_{a}" for a in "xyz"), "where the cable leads to, in {M}"),
    ("hook", tuple(f"hook_{a}" for a in "xyz"), "where the cable pulls, in {M}"),
    *((f"gauge {k}", tuple(f"gauge{k}_{a}" for a in "xyz"), "unit vector of what is read, in {M}") for k in "123"),
    ("readings", tuple(f"reading{k}" for k in "123"), "of the gauges; a cell may be empty"),
    ("noise", ("noise",), "standard deviation of one reading"),
    ("measured compliance", _COMPLIANCES, "eq. (17): `Cxy` is dx by Fy"),
    ("joint", ("joint",), "number of the joint that was loaded alone"),
    ("torque", ("torque",), "on that joint"),
    ("angle", ("angle",), "by which it turned (or slid)"),
)
_FORCE = (
    ("time", ("t",), "from the first cut on, rapids and dwells included; rising, without gaps"),
    ("path length", ("s",), "of path at feed from its start, rapids left out; in place of time"),
    ("along the path", forces.COMPONENTS["path"], "feed, left of the feed, out of the part"),
    ("in axes", forces.COMPONENTS["M"], 'of the robot, or of the part with `force_axes = "part"`'),
)
_PROFILE = (
    ("station", ("station",), "along the groove"),
    ("offset", ("offset",), "of its centre, left of the feed positive"),
)


def _columns(layout: Layout, groups: Sequence[tuple[str, Sequence[str], str]]) -> str:
    """A table of columns: each quantity of the layout is in exactly one group."""
    grouped = [name for _, names, _ in groups for name in names]
    if sorted(grouped) != sorted(layout.units):
        raise UnsaidKeyError(f"{layout.subject}: columns differ: {set(grouped) ^ set(layout.units)}.")
    rows = ["| what | columns | units | meaning |", "|---|---|---|---|"]
    for title, names, meaning in groups:
        units = [spelled(unit) or "1" for unit in layout.units[names[0]]]
        shown = [_column(layout, name) for name in names]
        listed = f"`{shown[0]}` … `{shown[-1]}`" if len(shown) > 4 else ", ".join(f"`{name}`" for name in shown)
        rows.append(f"| {title} | {listed} | {', '.join(units)} | {meaning} |")
    if layout.aliases:
        said = ", ".join(f"`{other}` for `{name}`" for other, name in layout.aliases.items())
        rows += ["", f"Other names are read, too: {said}."]
    return "\n".join(rows)


def _column(layout: Layout, name: str) -> str:
    if layout is load_test_columns.LAYOUT:
        found = written(name)
        return found[0].upper() + found[1:] if name in _COMPLIANCES else found
    capital = name[0].upper() + name[1:] if name.startswith("f_") else name
    return "_".join(filter(None, (capital, spelled(layout.units[name][0]))))


def _map() -> str:
    """The quantities of a map, of the paper's robot: those of single joints once."""
    robot = load_robot("slavkovic_5r")
    rows = ["| `--quantity` | column | what it is | formula |", "|---|---|---|---|"]
    for name, each in map_quantities(robot).items():
        tail = name.rpartition("_")[2]
        if tail.isdigit() and tail != "1":
            continue
        shown = name[: -len(tail)] + "J" if tail == "1" else name
        column = each.column.replace(name, shown)
        title = each.title.replace("joint 1", "joint J")
        formula = each.formula.replace("C_1,", "C_J,").replace("C_θ1", "C_θJ")
        meaning = each.meaning.replace("joint 1", "joint J").replace("Joint 1", "Joint J")
        rows.append(f"| `{shown}` | `{column}` | {title}: {_cell(meaning)} | {_cell(formula)} |")
    return "\n".join(rows)
