"""What a table of load tests may hold: its columns with their units, and the lines ``# key: value`` of its head."""

import re
from collections.abc import Iterable, Sequence

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import LoadTestError
from robomill.identification.array_checks import UNIT_VECTOR
from robomill.io.columns import Columns, Layout, spelled
from robomill.provenance import KINDS, Kind

XYZ = "xyz"
WORLD = ("x", "y", "z", "a", "b")
ANGLE, _LENGTH, _FORCE, _MOMENT = ("deg", "rad"), ("mm", "um", "m", "in"), ("N", "kN"), ("N m", "kN m")
_ROTATION, _COMPLIANCE = ("mrad", "urad", "rad", "deg"), ("um/N", "mm/N", "m/N")
GAUGES = ("1", "2", "3")
ROTVEC = ("rotvec_x", "rotvec_y", "rotvec_z")
HEAD = {
    "provenance": KINDS,
    "frame": ("tool", "flange"),
    "angles": ("kuka", "robomill", "ur"),
}


POSTURE = ("s", "t", "status", "turn", "config", "conf")  # a controller's words on how the arm stood: not read


def axes(name: str) -> tuple[str, str, str]:
    """The three columns of a vector: "f" gives fx, fy, fz; "pulley_" gives pulley_x, ..."""
    return (f"{name}x", f"{name}y", f"{name}z")


def _all(names: Iterable[str], units: Sequence[str]) -> dict[str, Sequence[str]]:
    return {column: units for name in names for column in axes(name)}


SLIDING = {"torque": _FORCE, "angle": ("mm", "um")}
"""Units of what is given of a joint that slides in place of a torque and an angle."""
_UNITS: dict[str, Sequence[str]] = {
    **{f"theta{joint}": (*ANGLE, "mm", "m") for joint in range(1, 10)},
    **_all([""], _LENGTH),
    **dict.fromkeys(("a", "b", "c", "w", "p", "r", *ROTVEC), ANGLE),
    **_all(("f", "f0"), _FORCE),
    **_all(("d", "d0", "fp", "mp", "pulley_", "hook_", "load_point_", "gauge_point_"), _LENGTH),
    **_all(("m",), _MOMENT),
    **_all(("r",), _ROTATION),
    **_all(("cable_", *(f"gauge{k}_" for k in GAUGES)), ("1",)),
    **{f"c{row}{column}": _COMPLIANCE for row in XYZ for column in XYZ},
    **{f"reading{k}": _LENGTH for k in GAUGES},
    "joint": ("1",),
    "torque": (*_MOMENT, *SLIDING["torque"]),
    "angle": (*_ROTATION, *SLIDING["angle"]),
    "load": _FORCE,
    "noise": (*_LENGTH, "mrad", "urad"),
}
_ALIASES = {"force": "load", "pull": "load", "reading": "reading1", **{f"gauge_{a}": f"gauge1_{a}" for a in XYZ}}
LAYOUT = Layout(
    "Load tests",
    LoadTestError,
    _UNITS,
    "theta1_deg,...,Fx_N,...,dz_mm",
    aliases=_ALIASES,
    open_cells=frozenset(("noise", *(f"reading{k}" for k in GAUGES))),
)


def group(table: Columns, names: Sequence[str]) -> FloatArray | None:
    """(m, k) the named columns side by side, None if there is none of them; a part of them is refused."""
    present = [name for name in names if name in table]
    if not present:
        return None
    for name in names:
        if name not in table:
            needed = ", ".join(written(n) for n in names)
            raise table.place.refuse(
                f"column {written(name)} is missing beside {table.written(present[0])}; all of {needed} are needed."
            )
    return np.stack([table.values[name] for name in names], axis=-1)


def directions(table: Columns, name: str) -> FloatArray | None:
    """(m, 3) unit vectors from the columns of ``name``; a vector of another length is refused by its row."""
    u = group(table, axes(name))
    if u is None:
        return None
    size = np.linalg.norm(u, axis=1)
    odd = np.abs(size - 1.0) > UNIT_VECTOR
    if odd.any():
        k = int(np.argmax(odd))
        raise table.refuse(
            k, f"{name}x", f"found a direction of length {size[k]:.3g}, expected a unit vector in {{M}}."
        )
    return np.asarray(u / size[:, None])


def written(name: str) -> str:
    """A quantity as the header would write it: forces, moments, points and world coordinates start with a capital."""
    short = len(name) <= 3 and name[0] in "fm"
    capitals = name.upper() if name in (*WORLD, "c", "w", "p", "r") else name[:-1].upper() + name[-1] if short else name
    return "_".join(filter(None, (capitals, spelled(_UNITS[name][0]))))


def head_of(table: Columns) -> dict[str, str]:
    """What the remarks ``# key: value`` of the head declare. Raises LoadTestError for a value that is not known."""
    found: dict[str, str] = {}
    for line in table.remarks.splitlines():
        match = re.fullmatch(r"(\w+)\s*[:=]\s*(\w+)", line.strip())
        if match and (key := match[1].lower()) in HEAD:
            if match[2].lower() not in HEAD[key]:
                listed = ", ".join(HEAD[key])
                raise table.place.refuse(f"found '# {line:.60}', expected one of {listed} behind '{key}:'.")
            found[key] = match[2].lower()
    return found


def kind_of(head: dict[str, str]) -> Kind:
    """The provenance that the head declares; tests are measured unless it says more."""
    return head.get("provenance", "measured")  # type: ignore[return-value]
