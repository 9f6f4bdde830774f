"""Patterns of holes in Heidenhain's dialogue: CYCL DEF 220 and 221, which drill at once, and PATTERN DEF, which waits
for CYCL CALL PAT.

(HEIDENHAIN, TNC 640, User's Manual for Cycle Programming: cycles for point patterns; PATTERN DEF.)
"""

import math
import re
from dataclasses import replace
from itertools import groupby

from robomill.errors import GCodeError
from robomill.toolpath.gcode.klartext.boring import KlartextBoring
from robomill.toolpath.gcode.klartext.values import NUMBER
from robomill.toolpath.gcode.program import TRAVERSE
from robomill.toolpath.gcode.words import Block
from robomill.toolpath.plane import polar, turned

MOST_HOLES = 10_000
_FORM = re.compile(r" ?(POS|ROW|PAT|FRAME|PITCHCIRC|CIRC) ?\d* ?\(([^()]*)\)")
_SAID = re.compile(rf" ?(NUMX|NUMY|NUM|ROTX|ROTY|ROT|START|STEP|DX|DY|D|X|Y|Z) ?({NUMBER})(?= |$|[A-Z])")
_WANTS = {
    "POS": "X Y",
    "ROW": "X Y D NUM",
    "PAT": "X Y DX DY NUMX NUMY",
    "FRAME": "X Y DX DY NUMX NUMY",
    "CIRC": "X Y D NUM",
    "PITCHCIRC": "X Y D STEP NUM",
}
_MAY = {"POS": "Z", "ROW": "ROT Z", "PAT": "ROT ROTX ROTY Z", "FRAME": "ROT ROTX ROTY Z", "CIRC": "START Z"}
_FEED = re.compile(rf"F ?(?:MAX|AUTO|{NUMBER})")

Place = tuple[float, float, float]
"""X and Y of a hole, and how much higher than Q203 its surface lies."""


class KlartextPatterns(KlartextBoring):
    """Drills patterns; ``KlartextBoring`` and its kin say what a hole is."""

    pattern_places: tuple[Place, ...] = ()
    visits = False

    def pattern(self, number: int, line: int) -> None:
        """CYCL DEF 220 and 221 drill at once, on a circle or in lines."""
        if self.drill == 0:
            text = f"CYCL DEF {number} repeats a cycle, but none is defined; write CYCL DEF 200 before."
            raise GCodeError.at(line, text)
        if number == 220:
            count = self._asked(241, number, line)
            first, last, step = self.q(245), self.q(246), self.q(247)
            if step == 0.0:
                whole = abs(abs(last - first) - 360.0) < 1e-6
                step = (last - first) / max(count if whole else count - 1, 1)
            angles = [math.radians(first + k * step) for k in range(count)]
            radius = 0.5 * abs(self.q(244))
            points = [polar(radius, t, self.q(216), self.q(217)) for t in angles]
        else:
            columns, rows = self._asked(242, number, line), self._asked(243, number, line)
            t = math.radians(self.q(224))
            points = []
            for row in range(rows):
                for column in range(columns) if row % 2 == 0 else reversed(range(columns)):
                    u, v = column * self.q(237), row * self.q(238)
                    points.append(turned(u, v, t, self.q(225), self.q(226)))
        if len(points) > MOST_HOLES:
            raise GCodeError.at(line, f"CYCL DEF {number} has more than {MOST_HOLES} holes; split it.")
        hole = self.hole_of(line)
        if self.machine.p[2] < hole.retract and not self.machine.away[2]:
            self._to(TRAVERSE, line, hole.retract)
        low = replace(hole, retract=hole.clear) if self.q(301, 1.0) == 0.0 else hole
        self.drill_at(points[:-1], low, line)
        self.drill_at(points[-1:], hole, line)

    def _asked(self, number: int, cycle: int, line: int) -> int:
        value = self.q(number)
        if not 1.0 <= value <= MOST_HOLES:
            raise GCodeError.at(line, f"CYCL DEF {cycle} has Q{number}={value:g} repeats; expected 1 to {MOST_HOLES}.")
        return round(value)

    # --- PATTERN DEF
    def pattern_line(self, code: str, line: int) -> bool:
        """Keep the places of PATTERN DEF; False for other lines."""
        if not code.startswith("PATTERN DEF"):
            return False
        text, places = code.removeprefix("PATTERN DEF"), []
        while found := _FORM.match(text):
            places += self._holes_of_form(found[1], found[2], line)
            text = text[found.end() :]
            if len(places) > MOST_HOLES:
                raise GCodeError.at(line, f"PATTERN DEF has more than {MOST_HOLES} holes; split it.")
        if text.strip() or not places:
            known = ", ".join(f"{name}1" for name in _WANTS)
            raise GCodeError.at(line, f"found {text.strip()[:20]!r} in PATTERN DEF; expected {known} and brackets.")
        self.pattern_places = tuple(places)
        return True

    def _holes_of_form(self, form: str, text: str, line: int) -> list[Place]:
        said = {name: self.number(value, line) for name, value in _SAID.findall(text)}
        wants, may = _WANTS[form].split(), _MAY.get(form, "START Z").split()
        if _SAID.sub("", text).strip() or not set(wants) <= said.keys() <= {*wants, *may}:
            raise GCodeError.at(line, f"{form} ({text[:30]}) of PATTERN DEF is not read; it needs {', '.join(wants)}.")
        if said.get("ROTX", 0.0) or said.get("ROTY", 0.0):
            raise GCodeError.at(line, f"{form} with ROTX or ROTY is not read; write its places as POS1, POS2 ...")
        count = {name: self._how_many(said[name], form, line) for name in ("NUM", "NUMX", "NUMY") if name in said}
        u, v, z = said["X"], said["Y"], said.get("Z", 0.0)
        if form == "POS":
            return [(u, v, z)]
        if form in ("CIRC", "PITCHCIRC"):
            step, n = said.get("STEP", 360.0 / count["NUM"]), count["NUM"]
            angles = [math.radians(said.get("START", 0.0) + k * step) for k in range(n)]
            return [(*polar(0.5 * abs(said["D"]), t, u, v), z) for t in angles]
        nx, ny = (count["NUM"], 1) if form == "ROW" else (count["NUMX"], count["NUMY"])
        if nx * ny > MOST_HOLES:
            raise GCodeError.at(line, f"PATTERN DEF has more than {MOST_HOLES} holes; split it.")
        dx, dy, t = said.get("DX", said.get("D", 0.0)), said.get("DY", 0.0), math.radians(said.get("ROT", 0.0))
        cells = [(i, j) for j in range(ny) for i in (range(nx) if j % 2 == 0 else reversed(range(nx)))]
        if form == "FRAME":
            cells = [(i, j) for i, j in cells if i in (0, nx - 1) or j in (0, ny - 1)]
        return [(*turned(i * dx, j * dy, t, u, v), z) for i, j in cells]

    def _how_many(self, value: float, form: str, line: int) -> int:
        if not 1.0 <= value <= MOST_HOLES or abs(value - round(value)) > 1e-6:
            raise GCodeError.at(line, f"{form} of PATTERN DEF has {value:g} holes; expected 1 to {MOST_HOLES}.")
        return round(value)

    def cycle_call(self, code: str, line: int) -> str | None:
        """CYCL CALL PAT drills the pattern, once its M words are done."""
        found = re.match(r"CYCL CALL PAT\b(.*)", code)
        if found is None:
            return super().cycle_call(code, line)
        if not self.pattern_places:
            raise GCodeError.at(line, "CYCL CALL PAT calls at a pattern, and none is defined; write PATTERN DEF.")
        text = self.called(_FEED.sub("", found[1]), line)
        self.visits = True
        return text

    def drill_if_due(self, block: Block) -> None:
        """Drill the pattern, above which the tool stays at Q204, or as high as it stood where that is more."""
        if not (self.visits and self.due and self.drill):
            super().drill_if_due(block)
            return
        self.visits = self.due = False
        machine, line = self.machine, block.line
        stood = -math.inf if machine.away[2] else machine.p[2]
        groups = [
            (z, [place[:2] for place in some]) for z, some in groupby(self.pattern_places, lambda place: place[2])
        ]
        holes = []
        for self.raised, _ in groups:
            holes.append(self.hole_of(line))
        self.raised = 0.0
        height = max(stood, *(hole.retract for hole in holes))
        if stood < height and not machine.away[2]:
            self._to(TRAVERSE, line, height)
        for hole, (_, points) in zip(holes, groups):
            self.drill_at(points, replace(hole, retract=height), line)
