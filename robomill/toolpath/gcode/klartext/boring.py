"""Bore milling of Heidenhain's dialogue: CYCL DEF 208.

Down in a helix that is Q334 deep a turn, from the set-up clearance on, once around at the depth, back to the middle and
out at rapid; Q351 1 is climb milling with M3. A bore as wide as the tool is drilled at once. (HEIDENHAIN, TNC 640,
User's Manual for Cycle Programming: bore milling.)
"""

from dataclasses import replace

from robomill.errors import GCodeError
from robomill.toolpath.gcode.cutters import size_of
from robomill.toolpath.gcode.klartext.cycles import BORE_MILLING, KlartextCycles
from robomill.toolpath.gcode.sinumerik.holes import Hole, Round
from robomill.toolpath.gcode.words import Block

MAX_TURNS = 10_000
_AS_WIDE = 1e-9


class KlartextBoring(KlartextCycles):
    """Mills bores; ``KlartextCycles`` says what a hole is."""

    oversize = 0.0

    def hole_of(self, line: int) -> Hole:
        """The hole of the cycle in force, and how 208 mills it."""
        hole = super().hole_of(line)
        if self.drill != BORE_MILLING:
            return hole
        hole = replace(hole, dwell=0.0)
        if self.oversize:
            text = f"CYCL DEF 208 with DR{self.oversize:+g} of TOOL CALL is not read; put it in the tool table."
            raise GCodeError.at(line, text)
        if self.q(370) != 0.0:
            raise GCodeError.at(
                line, "CYCL DEF 208 clears its bore in several paths (Q370), which is not read; give 0."
            )
        cutter = size_of(self.machine, Block(line), "CYCL DEF 208")[0]
        radius = 0.5 * self.q(335) - cutter
        if abs(radius) <= _AS_WIDE:
            return hole
        if radius < 0.0 or (self.q(342) == 0.0 and radius > cutter):
            text = f"CYCL DEF 208 has Q335={self.q(335):g}; expected one to two times the tool's {2.0 * cutter:g}"
            raise GCodeError.at(line, f"{text}, or the bore that is there already, as Q342.")
        if self.q(334) <= 0.0:
            raise GCodeError.at(line, "CYCL DEF 208 needs Q334, how deep a turn of its helix leads, above 0.")
        if (hole.clear - hole.bottom) / self.q(334) > MAX_TURNS:
            raise GCodeError.at(line, f"CYCL DEF 208 needs more than {MAX_TURNS} turns; give a larger Q334.")
        text = "CYCL DEF 208 is read as a helix that begins at +X; where on its circle it begins is the control's own"
        self.machine.findings.add("bore-milling", "info", line, text)
        return replace(hole, round=Round(radius, self.q(334), -1 if self.q(351, 1.0) < 0.0 else 1))
