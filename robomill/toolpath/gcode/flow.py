"""O words: which lines open, close and branch, found once; subroutines by name."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from robomill.errors import GCodeError
from robomill.toolpath.gcode.words import normalise

KEYWORDS = (
    *("sub", "endsub", "call", "do", "while", "repeat", "if", "elseif", "else", "endif"),
    *("break", "continue", "endwhile", "endrepeat", "return"),
)
"""In the order in which they are tried; what follows a keyword is its argument."""

_LINE = re.compile(r"/?\d*(?:n[\d.]+)?o(<[^>]*>|\d+)(.*)", re.DOTALL)
_CLOSES = {"endwhile": "while", "endrepeat": "repeat", "endif": "if", "endsub": "sub"}


@dataclass
class Node:
    """A structure: the index of its first and last line, and the branches of an ``if`` in between."""

    kind: str
    label: str
    start: int
    end: int = -1
    branches: list[int] = field(default_factory=list)
    has_break: bool = False

    def next_branch(self, index: int) -> int:
        """The branch (or the end) after line ``index``."""
        return next((b for b in self.branches if b > index), self.end)


@dataclass
class OLine:
    """An O word: its keyword (empty for a bare one), label, argument text and the structure it belongs to."""

    keyword: str
    label: str
    argument: str
    node: Node | None = None
    problem: str = ""


@dataclass
class Structure:
    """All O words of a file by line index, and its subroutines by label."""

    lines: dict[int, OLine] = field(default_factory=dict)
    subs: dict[str, Node] = field(default_factory=dict)
    bare: dict[str, int] = field(default_factory=dict)


def split(text: str) -> tuple[str, str, str] | None:
    """Label, keyword and argument of a normalised line that starts with an O word; None if it has none."""
    found = _LINE.match(text)
    if found is None:
        return None
    label = found[1][1:-1] if found[1][0] == "<" else str(int(found[1][:18]))
    rest = found[2]
    for keyword in KEYWORDS:
        if rest.startswith(keyword):
            return label, keyword, rest[len(keyword) :]
    return label, "", rest


def scan(lines: Sequence[str]) -> Structure:
    """The structure of a file. Mismatches become problems of their line, raised only if it is executed."""
    structure = Structure()
    open_nodes: dict[tuple[str, str], list[Node]] = {}
    seen: dict[str, dict[str, int]] = {}
    sub: Node | None = None
    for index, raw in enumerate(lines):
        if "o" not in raw and "O" not in raw:
            continue
        try:
            text = normalise(raw, index + 1)
        except GCodeError:
            continue
        parts = split(text)
        if parts is None:
            continue
        label, keyword, argument = parts
        entry = OLine(keyword, label, argument)
        structure.lines[index] = entry
        if keyword == "":
            if not argument or argument[0] in "(;":
                structure.bare.setdefault(label, index)
            continue
        if keyword == "sub":
            sub = _open_sub(structure, entry, index, sub)
            continue
        if keyword == "endsub":
            if sub is None or sub.label != label:
                entry.problem = f"O{label} endsub closes nothing; there is no open O{label} sub."
            else:
                entry.node, sub.end, sub = sub, index, None
            continue
        scope = sub.label if sub is not None else ""
        _place(open_nodes.setdefault((scope, label), []), seen.setdefault(scope, {}), entry, index)
    return structure


def _open_sub(structure: Structure, entry: OLine, index: int, sub: Node | None) -> Node:
    node = Node("sub", entry.label, index)
    entry.node = node
    if sub is not None:
        entry.problem = f"O{entry.label} sub stands inside O{sub.label} sub; close that one with endsub first."
    elif entry.label in structure.subs:
        first = structure.subs[entry.label].start + 1
        entry.problem = f"O{entry.label} sub is defined twice; the first is on line {first}."
    else:
        structure.subs[entry.label] = node
    return node


def _place(stack: list[Node], seen: dict[str, int], entry: OLine, index: int) -> None:
    keyword, label = entry.keyword, entry.label
    top = stack[-1] if stack else None
    if keyword == "while" and top is not None and top.kind == "do":
        entry.node, top.end = stack.pop(), index
    elif keyword in ("do", "while", "repeat", "if"):
        entry.node = Node(keyword, label, index)
        first = seen.setdefault(label, index)
        if first != index:
            entry.problem = f"O{label} {keyword}: the label is used on line {first + 1} already; choose another."
        stack.append(entry.node)
    elif keyword in _CLOSES:
        if top is None or top.kind != _CLOSES[keyword]:
            entry.problem = f"O{label} {keyword} closes nothing; there is no open O{label} {_CLOSES[keyword]}."
        else:
            entry.node, top.end = stack.pop(), index
    elif keyword in ("else", "elseif"):
        if top is None or top.kind != "if":
            entry.problem = f"O{label} {keyword} belongs to no O{label} if."
        else:
            entry.node = top
            top.branches.append(index)
    elif keyword in ("break", "continue"):
        if top is None or top.kind == "if":
            entry.problem = f"O{label} {keyword} is in no O{label} loop."
        else:
            entry.node = top
            top.has_break |= keyword == "break"
            if top.kind == "repeat":
                entry.problem = f"O{label} {keyword} is in a repeat loop; it works in while and do loops only."
