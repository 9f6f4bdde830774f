"""Mirror images and scales of Heidenhain's dialogue: CYCL DEF 8, 11 and 26.

8 mirrors about the datum in force, 11 enlarges all axes about it by one factor, 26 each axis by its own about a centre;
a factor of 1 ends them. (HEIDENHAIN, TNC 640, User's Manual for Cycle Programming: coordinate transformation cycles.)
"""

import re

from robomill.errors import GCodeError
from robomill.toolpath.gcode.klartext.values import NUMBER, KlartextValues
from robomill.toolpath.gcode.machine import Scale
from robomill.toolpath.gcode.words import Block

_FACTOR = re.compile(rf"SCL ?({NUMBER})")
_OF_AXIS = re.compile(rf" ?([XYZ]|CC[XYZ]) ?({NUMBER})(?= |$|[A-Z])")
LEAST, MOST = 1e-6, 99.999999
"""Factors that the cycles take."""
_UNIFORM = (
    "the scale of CYCL DEF 11 is read as that of X, Y and Z; a control whose machine parameter 7410 leaves the axis of "
    "the tool out keeps Z as it is"
)


class KlartextScaling(KlartextValues):
    """Reads what mirrors and scales."""

    mirrored: tuple[float, float] = (1.0, 1.0)
    size = 1.0
    stretched: Scale | None = None
    pole: tuple[int, float, float] | None = None

    def mirror(self, letters: str, line: int) -> None:
        """CYCL DEF 8.1: X and Y are mirrored about the datum; without letters they are as they were."""
        if not re.fullmatch(r"(?:[XY]\b ?)*", letters):
            raise GCodeError.at(line, f"CYCL DEF 8.1 {letters[:20]} is not read; expected X, Y or both.")
        mirrored = (-1.0 if "X" in letters else 1.0, -1.0 if "Y" in letters else 1.0)
        self.rescale(mirrored, self.size, self.stretched, line)

    def scale(self, text: str, line: int) -> None:
        """CYCL DEF 11.1 SCL: all axes by one factor."""
        found = _FACTOR.fullmatch(text)
        if found is None:
            raise GCodeError.at(line, f"CYCL DEF 11.1 {text[:20]} is not read; expected SCL and a factor.")
        size = self._factor(found[1], "CYCL DEF 11", line)
        if size != 1.0:
            self.machine.findings.add("scale-axes", "info", line, _UNIFORM)
        self.rescale(self.mirrored, size, self.stretched, line)

    def stretch(self, text: str, line: int) -> None:
        """CYCL DEF 26.1: axes by their own factors, which stay where they are not given, about CCX, CCY, CCZ."""
        said = dict(_OF_AXIS.findall(text))
        if not said.keys() & set("XYZ") or _OF_AXIS.sub("", text).strip():
            text = f"CYCL DEF 26.1 {text[:30]} is not read; expected factors of X, Y and Z and their centre CCX, CCY."
            raise GCodeError.at(line, text)
        before = self.stretched or Scale()
        factors = [
            self._factor(said[letter], "CYCL DEF 26", line) if letter in said else old
            for letter, old in zip("XYZ", before.factors)
        ]
        centre = [
            self.number(said[f"CC{letter}"], line) if f"CC{letter}" in said else old
            for letter, old in zip("XYZ", before.centre)
        ]
        now = Scale(tuple(factors), tuple(centre)) if any(f != 1.0 for f in factors) else None  # type: ignore[arg-type]
        self.rescale(self.mirrored, self.size, now, line)

    def _factor(self, said: str, cycle: str, line: int) -> float:
        factor = self.number(said, line)
        if not LEAST <= factor <= MOST:
            raise GCodeError.at(line, f"{cycle} has a factor of {factor:g}; expected {LEAST:f} to {MOST:f}.")
        return factor

    def rescale(self, mirrored: tuple[float, float], size: float, stretched: Scale | None, line: int) -> None:
        """Words are mirrored and scaled so from here on."""
        if (mirrored, size, stretched) == (self.mirrored, self.size, self.stretched):
            return
        self.machine.need_compensation_off(Block(line), "CYCL DEF 8, 11 or 26")
        if stretched is not None and (mirrored != (1.0, 1.0) or size != 1.0):
            raise GCodeError.at(line, "CYCL DEF 26 beside a mirror image or CYCL DEF 11 is not read; end those first.")
        self.mirrored, self.size, self.stretched, self.pole = mirrored, size, stretched, None
        factors = (mirrored[0] * size, mirrored[1] * size, size)
        self.machine.set_scale(stretched or (Scale(factors) if factors != (1.0, 1.0, 1.0) else None))

    def unscale(self, line: int) -> None:
        """Nothing is mirrored or scaled any more (CYCL DEF 247)."""
        self.rescale((1.0, 1.0), 1.0, None, line)

    def similar(self, what: str, line: int) -> float:
        """How many times larger lengths in the plane are. Raises GCodeError where X and Y differ."""
        if self.machine.scale is None:
            return 1.0
        x, y = (abs(factor) for factor in self.machine.scale.factors[:2])
        if x != y:
            raise GCodeError.at(line, f"{what} while X and Y are scaled unlike is none; end CYCL DEF 26 before it.")
        return x
