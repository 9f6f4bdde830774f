"""A project as part of an address: the example that it began with, and what differs from it, in 2000 characters.

What comes by an address is anyone's: it is read as a project's file is, by the same reader with its bounds, names no
file of the server, and is refused in one sentence.
"""

import base64
import json
import re
import zlib
from collections.abc import Mapping
from decimal import Decimal
from typing import Any

import tomli_w

from robomill.errors import ProjectError
from robomill.io.tables import parse_toml
from robomill.ui.project import DEFAULT_PRESET, Project, preset_setup, presets, project_from_toml, project_to_toml

PRESET, EDITS = "preset", "edits"
KEYS = (PRESET, EDITS)
VERSION = "1"
MOST = 2000  # characters of the edits: addresses of all browsers and mailers hold them
LARGEST = 200_000  # bytes of edits when they are unpacked
SHOWN = 8  # of the fingerprint, by which an example that has changed since is noticed
ADD, DROP, IN, DIGITS = "+", "-", "~", "#"
DAMAGED = "This link is damaged or cut off; ask for it once more, or for the project's file."


def packed(project: Project) -> dict[str, str] | None:
    """The parameters of an address that ``opened`` makes the same project of; None where its edits are too long."""
    base = _base(project.preset if project.preset in presets() else DEFAULT_PRESET)
    changed = _difference(_tables(base), _tables(project))
    if not changed:
        return {PRESET: base.preset}
    text = json.dumps([project.digest()[:SHOWN], changed], separators=(",", ":"), default=_exact)
    data = zlib.compress(text.encode(), 9, wbits=-15)
    edits = VERSION + base64.urlsafe_b64encode(data).decode().rstrip("=")
    return {PRESET: base.preset, EDITS: edits} if len(edits) <= MOST else None


def opened(said: Mapping[str, str]) -> Project:
    """The project of an address. Raises ProjectError with the reason, in one sentence."""
    name = said.get(PRESET, DEFAULT_PRESET)
    if name not in presets():
        raise ProjectError(
            f"This link begins with the example {name!r:.40}, which is not here; ask for the project's file."
        )
    base, edits = _base(name), said.get(EDITS, "")
    if not edits:
        return base
    shown, changed = _unpacked(edits)
    try:
        text = tomli_w.dumps(_changed(_tables(base), changed))
    except (TypeError, ValueError, RecursionError):
        raise ProjectError(DAMAGED) from None
    project = project_from_toml(text)
    if project.digest()[:SHOWN] != shown:
        raise ProjectError(
            "This link was made with another version of robomill, where its example had other numbers; ask for the "
            "project's file."
        )
    return project


def _base(name: str) -> Project:
    return Project(preset_setup(name), preset=name)


def _tables(project: Project) -> dict[str, Any]:
    return parse_toml(project_to_toml(project), "project", exact=True)


def _exact(number: Decimal) -> dict[str, str]:
    """A number with more digits than a float holds, as JSON carries it."""
    return {DIGITS: str(number)}


def _read(table: dict[str, Any]) -> Any:
    return Decimal(table[DIGITS]) if {*table} == {DIGITS} else table


def _unpacked(edits: str) -> tuple[str, dict[str, Any]]:
    """Fingerprint and edits of an address."""
    if edits[0] != VERSION:
        raise ProjectError(
            f"This link is of version {edits[0]!r}; this robomill reads version {VERSION}: ask for the project's file."
        )
    body = edits[1:]
    if len(body) > MOST or not re.fullmatch(r"[A-Za-z0-9_-]+", body):
        raise ProjectError(DAMAGED)
    try:
        stream = zlib.decompressobj(wbits=-15)
        data = stream.decompress(base64.urlsafe_b64decode(body + "=" * (-len(body) % 4)), LARGEST)
        if not stream.eof:  # cut off, or more than any project of this length has
            raise ValueError
        shown, changed = json.loads(data, object_hook=_read)
    except (ValueError, TypeError, ArithmeticError, RecursionError, zlib.error):
        raise ProjectError(DAMAGED) from None
    if not isinstance(shown, str) or not isinstance(changed, dict):
        raise ProjectError(DAMAGED)
    return shown, changed


def _difference(old: Mapping[str, Any], new: Mapping[str, Any]) -> dict[str, Any]:
    """What makes ``new`` of ``old``: keys put in, keys dropped, and the same of tables that both have."""
    added, within = {}, {}
    for key, value in new.items():
        if key in old and isinstance(value, dict) and isinstance(old[key], dict):
            if inner := _difference(old[key], value):
                within[key] = inner
        elif key not in old or _written(old[key]) != _written(value):  # as written: 0 is not -0
            added[key] = value
    dropped = [key for key in old if key not in new]
    return {mark: part for mark, part in ((ADD, added), (DROP, dropped), (IN, within)) if part}


def _written(value: Any) -> str:
    return json.dumps(value, default=_exact)


def _changed(old: Mapping[str, Any], by: Any) -> dict[str, Any]:
    """``old`` with a difference. Raises ValueError or TypeError for what is none."""
    if not isinstance(by, dict) or not {*by} <= {ADD, DROP, IN}:
        raise ValueError
    added, within = by.get(ADD, {}), by.get(IN, {})
    if not isinstance(added, dict) or not isinstance(within, dict) or not {*within} <= {*old}:
        raise ValueError
    new = {key: value for key, value in old.items() if key not in by.get(DROP, [])} | added
    for key, inner in within.items():
        if not isinstance(old[key], dict):
            raise ValueError
        new[key] = _changed(old[key], inner)
    return new
