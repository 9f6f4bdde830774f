"""Straight cuts by their angle (Sinumerik's ANG=, Fanuc's ,A), one alone or two that meet, and soft approaches, named.

(840D sl, Programming Manual, Fundamentals: contour definitions, one straight line and two; smooth approach and
retraction, which is refused by name. Fanuc 30i, Operator's Manual: direct drawing dimension input.)
"""

import math
import re

from robomill.errors import GCodeError
from robomill.toolpath.gcode.scan import COMMENT
from robomill.toolpath.gcode.sinumerik.lines import parted, spaced
from robomill.toolpath.gcode.sinumerik.polar import SinumerikPolar
from robomill.toolpath.gcode.sinumerik.words import value_end
from robomill.toolpath.plane import polar

_ANGLE = re.compile(r"\bANG[ \t]*=[ \t]*")
_COMMA = re.compile(r",\s*A\s*(?=[-+.\d])", re.IGNORECASE)
_PLACE = re.compile(r"\b([XY])[ \t]*(?:=[ \t]*)?(?:(AC|IC)[ \t]*\(([^()]*)\)|([-+]?(?:\d+\.?\d*|\.\d+)))")
_SOFT = re.compile(r"\b(?:(G[123]4[78])(?!\d)|(DISR|DISCL|DISRP|FAD)[ \t]*=)")
_SOFT_MODES = re.compile(r"\bG(?:14[0-3]|34[01])\b")
_OTHER_PLANE = re.compile(r"\bG1[89]\b")
_SOFTLY = {"1": "on a straight line", "2": "on a quarter of a circle", "3": "on a half circle"}
OFF_LINE = 2e-3
"""So far (program units) a place may lie beside the line that its angle says: they are printed in thousandths."""


class SinumerikAngles(SinumerikPolar):
    """Reads straight cuts by their angle; ``SinumerikPolar`` reads the rest of a line."""

    def sinumerik_line(self, code: str, line: int) -> str | None:
        """What is left of ``code`` (capitals, no comment); None where it is done."""
        soft = _SOFT.search(code)
        if soft is not None:
            self._refuse_soft(soft, line)
        if _SOFT_MODES.search(code):
            self.machine.findings.add("harmless-g", "ignored", line, "how to approach softly is left out: nothing does")
            code = _SOFT_MODES.sub("", code)
        left = super().sinumerik_line(code, line)
        return self._at_angle(left, line) if left is not None and _ANGLE.search(left) else left

    def fanuc_angle(self, raw: str, line: int) -> str:
        """A line of a Fanuc control with ``,A`` led to where that angle leads; any other as it is."""
        led = "," in raw and _COMMA.search(COMMENT.sub("", raw))
        return self._at_angle(self._of_fanuc(raw), line) if led else raw

    def _of_fanuc(self, code: str) -> str:
        return spaced(_COMMA.sub(" ANG=", COMMENT.sub("", code)).upper())

    def _refuse_soft(self, soft: re.Match[str], line: int) -> None:
        if soft[1]:
            does = "approaches a contour" if soft[1][-1] == "7" else "leaves a contour"
            what = f"{soft[1]} {does} {_SOFTLY[soft[1][1]]}"
        else:
            what = f"{soft[2]}= belongs to a soft approach (G147 to G348)"
        raise GCodeError.at(line, f"{what}, which is not read; write that way out with G1, G2 or G3.")

    def _at_angle(self, code: str, line: int) -> str:
        """ANG= with one of X and Y, with both, or alone before a line that has all three."""
        self._in_plane(self._said, line)
        angle, rest = self._taken(code, line)
        if self._motion(rest) not in (0, 1) or _OTHER_PLANE.search(rest):
            raise GCodeError.at(line, f"{self._said} is the angle of a straight cut (G0, G1) in G17; mend the line.")
        at, absolute = self.machine.said_point(), self._absolute(rest)
        along = polar(1.0, math.radians(angle))
        said = {
            letter: self.value(inside or plain, line) + at["XY".index(letter)] * (way == "IC" or not (way or absolute))
            for letter, way, inside, plain in _PLACE.findall(rest)
        }
        if len(said) == 2:
            beside = (said["X"] - at[0]) * along[1] - (said["Y"] - at[1]) * along[0]
            if abs(beside) > OFF_LINE:
                text = (
                    f"X and Y do not lie at {self._said}{angle:g} from where the tool is; leave one of the three out."
                )
                raise GCodeError.at(line, text)
            return rest
        if said:
            (letter, value), axis = next(iter(said.items())), 0 if "X" in said else 1
            if abs(along[axis]) < 1e-9:
                raise GCodeError.at(
                    line, f"a cut at {self._said}{angle:g} never comes to another {letter}; mend the line."
                )
            way = (value - at[axis]) / along[axis]
        else:
            way = self._way_to_next(at, along, line)
        x, y = at[0] + way * along[0], at[1] + way * along[1]
        origin = [0.0, 0.0] if absolute else at
        return f"{_PLACE.sub('', rest)} X{x - origin[0]:.12f} Y{y - origin[1]:.12f}"

    @property
    def _said(self) -> str:
        """What the word is called."""
        return ",A" if self.dialect.has_macros else "ANG="

    def _taken(self, code: str, line: int) -> tuple[float, str]:
        """The angle, and the line without it."""
        found = _ANGLE.search(code)
        assert found is not None
        end = value_end(code, found.end())
        return self.value(code[found.end() : end], line), code[: found.start()] + code[end:]

    def _way_to_next(self, at: list[float], along: tuple[float, float], line: int) -> float:
        """How far it is to where the cut of the next line begins, which says its end and its angle."""
        name, plain = self._said, self._of_fanuc if self.dialect.has_macros else _of_sinumerik
        text = f"{name} without X and Y needs a next line with all three, in G90, as in {name}45, then X50 Y20 {name}0."
        following = (plain(raw) for raw in self.file.lines[self.pc : self.pc + 20])
        code = next((each for each in following if each.strip()), "")
        if not _ANGLE.search(code) or not self._absolute(code):
            raise GCodeError.at(line, text)
        angle, rest = self._taken(self._values(code, line), line)
        said = {letter: self.value(inside or plain, line) for letter, way, inside, plain in _PLACE.findall(rest)}
        u, v = polar(1.0, math.radians(angle))
        meet = along[0] * v - along[1] * u
        if len(said) != 2 or "IC" in rest or abs(meet) < 1e-9:
            raise GCodeError.at(
                line, text if abs(meet) >= 1e-9 else "two cuts at one angle do not meet; mend the one or other."
            )
        return ((said["X"] - at[0]) * v - (said["Y"] - at[1]) * u) / meet


def _of_sinumerik(raw: str) -> str:
    return spaced(parted(raw)[0].upper())
