"""Places of Sinumerik programs by angle and radius about a pole (G110 to G112, AP, RP), and arcs by their angle (AR).

(840D sl, Programming Manual, Fundamentals: travel commands with polar coordinates; circular-path interpolation with
opening angle and centre, or opening angle and end.)
"""

import math
import re

from robomill.errors import GCodeError
from robomill.toolpath.gcode.sinumerik.shapes import SinumerikShapes
from robomill.toolpath.gcode.sinumerik.words import value_end
from robomill.toolpath.plane import polar, turned

_POLE = re.compile(r"\bG11([012])\b")
_POLAR = re.compile(r"\b(AP|RP)[ \t]*=[ \t]*(?:(AC|IC)(?=[ \t]*\())?")
_ANGLE = re.compile(r"\bAR[ \t]*=[ \t]*")
_PLACE = re.compile(r"\b([XYIJ])[ \t]*(?:=[ \t]*)?(?:(AC|IC)[ \t]*\(([^()]*)\)|([-+]?(?:\d+\.?\d*|\.\d+)))")
_FORM = re.compile(r"\b(?:I|J|CR[ \t]*=)[ \t]*[-+=.\d]")
_MOTION = re.compile(r"\bG0*([0-3])\b")
_MODES = re.compile(r"\bG9([01])\b")


class SinumerikPolar(SinumerikShapes):
    """Reads what says a place or an arc by an angle; ``SinumerikShapes`` reads the rest of a line."""

    middle: tuple[float, float] | None = None
    polar_radius: float | None = None
    polar_angle: float | None = None

    def sinumerik_line(self, code: str, line: int) -> str | None:
        """What is left of ``code`` (capitals, no comment); None where it is done."""
        left = super().sinumerik_line(code, line)
        if left is None or ("=" not in left and "G11" not in left):
            return left
        pole = _POLE.search(left)
        if pole is not None:
            self._put_pole(pole[1], left, line)
            return None
        if _POLAR.search(left):
            return self._to_polar(left, line)
        return self._by_angle(left, line) if _ANGLE.search(left) else left

    def _absolute(self, code: str) -> bool:
        mode = _MODES.search(code)
        return self.machine.absolute if mode is None else mode[1] == "0"

    def _motion(self, code: str) -> int:
        found = _MOTION.search(code)
        return self.machine.motion // 10 if found is None else int(found[1])

    def _in_plane(self, name: str, line: int, moves: bool = True) -> None:
        if self.machine.plane != 17 or (moves and self.bent) or any(self.machine.away[:2]):
            raise GCodeError.at(line, f"{name} is read in G17, from a known place and beside G0 to G3 alone.")

    # --- poles
    def _put_pole(self, kind: str, code: str, line: int) -> None:
        """G110 counts from where the tool is, G111 from zero, G112 from the pole before."""
        self._in_plane(f"G11{kind}", line, moves=False)
        said = {letter: self.value(inside or plain, line) for letter, _, inside, plain in _PLACE.findall(code)}
        if said.keys() != {"X", "Y"} or (kind == "2" and self.middle is None):
            raise GCodeError.at(line, f"G11{kind} needs X and Y, and G112 a pole before it; as in G111 X10 Y20.")
        here = self.machine.said_point()[:2]
        base = here if kind == "0" else [0.0, 0.0] if kind == "1" or self.middle is None else self.middle
        self.middle, self.polar_angle = (base[0] + said["X"], base[1] + said["Y"]), None

    def _to_polar(self, code: str, line: int) -> str:
        """AP= and RP= as X and Y; an arc without a form of its own turns about the pole."""
        self._in_plane("AP", line)
        if not self._absolute(code):
            raise GCodeError.at(line, "AP and RP in G91 are not read; write them in G90, and steps as AP=IC( ).")
        said: dict[str, tuple[str, float]] = {}
        while found := _POLAR.search(code):
            end = value_end(code, found.end())
            said[found[1]] = found[2] or "AC", self.value(code[found.end() : end], line)
            code = code[: found.start()] + code[end:]
        way, angle = said.get("AP", ("", math.nan))
        if way == "IC":
            angle += math.nan if self.polar_angle is None else self.polar_angle
        radius = self.polar_radius if "RP" not in said else said["RP"][1]
        if math.isnan(angle) or radius is None or radius < 0.0 or said.get("RP", ("AC",))[0] == "IC":
            text = "AP=IC( ) needs an AP before it, and RP, a radius of 0 or more, is given once at least"
            raise GCodeError.at(line, f"a polar place needs its angle AP and radius RP; {text}.")
        self.polar_angle, self.polar_radius = angle, radius
        u, v = self.middle or (0.0, 0.0)  # without a pole: the zero of the part
        x, y = polar(radius, math.radians(angle), u, v)
        form = ""
        if self._motion(code) in (2, 3) and not _FORM.search(code):
            at = [0.0, 0.0] if self.machine.arc_absolute else self.machine.said_point()
            form = f" I{u - at[0]:.12f} J{v - at[1]:.12f}"
        return f"{code} X{x:.12f} Y{y:.12f}{form}"

    # --- arcs
    def _by_angle(self, code: str, line: int) -> str:
        """AR= says how far an arc turns, beside its end or beside its centre."""
        self._in_plane("AR", line)
        found = _ANGLE.search(code)
        assert found is not None
        end = value_end(code, found.end())
        angle, rest = self.value(code[found.end() : end], line), code[: found.start()] + code[end:]
        motion, absolute, at = self._motion(rest), self._absolute(rest), self.machine.said_point()
        places: dict[str, float] = {}
        centre: dict[str, float] = {}
        for letter, way, inside, plain in _PLACE.findall(rest):
            steps = way == "IC" or (not way and (not absolute if letter in "XY" else not self.machine.arc_absolute))
            base = at["XY".index(letter) if letter in "XY" else "IJ".index(letter)]
            (places if letter in "XY" else centre)[letter] = self.value(inside or plain, line) + base * steps
        if motion not in (2, 3) or not 0.0 < angle < 360.0 or bool(places) == bool(centre):
            text = "AR is the angle of G2 or G3, between 0 and 360, beside the end (X, Y) or the centre (I, J)"
            raise GCodeError.at(line, f"{text}; mend the line.")
        half = math.radians(angle) / 2.0
        if places:
            chord = math.dist(at[:2], (places.get("X", at[0]), places.get("Y", at[1])))
            return f"{rest} R{math.copysign(chord / (2.0 * math.sin(half)), 180.0 - angle):.12f}"
        u, v = centre.get("I", at[0]), centre.get("J", at[1])
        t = 2.0 * half if motion == 3 else -2.0 * half
        x, y = turned(at[0] - u, at[1] - v, t, u, v)
        origin = [0.0, 0.0] if absolute else at
        return f"{rest} X{x - origin[0]:.12f} Y{y - origin[1]:.12f}"
