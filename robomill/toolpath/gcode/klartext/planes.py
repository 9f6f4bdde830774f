"""Tilted working planes of Heidenhain's dialogue: PLANE SPATIAL and PLANE RESET.

SPA, SPB and SPC turn about the axes of the upright system, first about X, then Y, then Z, which is Z, then Y, then X
as each turn leaves them. TURN and MOVE turn the tool; STAY leaves that to a line L A+Q120 C+Q122, in which the control
puts what its machine needs. (HEIDENHAIN, TNC 640, User's Manual for Conversational Programming: the PLANE function.)
"""

import re

from robomill.errors import GCodeError
from robomill.toolpath.gcode.klartext.approach import KlartextApproach
from robomill.toolpath.gcode.klartext.values import NUMBER
from robomill.toolpath.gcode.offsets import frame_of
from robomill.toolpath.gcode.tilted import tilt, turned_by, upright

_SPATIAL = re.compile(rf"PLANE SPATIAL SPA ?({NUMBER}) SPB ?({NUMBER}) SPC ?({NUMBER})(.*)")
_BEHAVES = re.compile(
    rf" ?(?:MOVE|TURN|STAY|(?:DIST|ABST\.?|MB|F) ?(?:MAX|AUTO|{NUMBER})|(?:SEQ|SYM) ?[-+]|(?:TABLE|COORD) ROT)(?= |$)"
)
_END = rf"(?: R0)?(?: F ?(?:MAX|AUTO|{NUMBER}))?(?: M\d+)*"
_TO_PLANE = re.compile(rf"L(?: [ABC] ?\+? ?Q12[012])+{_END}")
_TURNED_BACK = re.compile(rf"L(?: [ABC] ?[-+]? ?(?:0+(?:\.0*)?|Q12[012]))+{_END}")
STAYS = "PLANE with STAY leaves the tool as it stands; turn it by L A+Q120 C+Q122 before any move."


class KlartextPlanes(KlartextApproach):
    """Reads planes; ``KlartextApproach`` reads what lies in them."""

    leans = False

    def plane_line(self, code: str, line: int) -> bool:
        """Tilt the plane, end it, or turn the tool to it; False for other lines."""
        machine = self.machine
        if machine.stuck == STAYS and _TO_PLANE.fullmatch(code):
            machine.stuck = ""
            return True
        if self.leans and _TURNED_BACK.fullmatch(code):
            self.leans = False
            return True
        found = _SPATIAL.fullmatch(code)
        reset = re.match(r"PLANE RESET\b(.*)", code)
        if found is None and reset is None:
            return False
        behaves = found[4] if found is not None else reset[1] if reset is not None else ""
        if _BEHAVES.sub("", behaves).strip():
            raise GCodeError.at(line, f"found {_BEHAVES.sub('', behaves).strip()[:20]!r} behind PLANE; mend that line.")
        a, b, c = (0.0 if found is None else self.number(found[place], line) for place in (1, 2, 3))
        self._before(line)
        if a == b == c == 0.0:
            self._end_plane("STAY" in behaves, code, line)
            return True
        for number in (120, 121, 122):
            self.machine.r_set.discard(1000 + number)  # what the machine needs, only its control knows
        tilt(machine, "PLANE SPATIAL", turned_by("ZYX", (c, b, a)))
        self.leans, self.pole = False, None
        machine.stuck = STAYS if "STAY" in behaves else ""
        return True

    def _before(self, line: int) -> None:
        if self.machine.tilted is None and frame_of(self.machine)[1] != 0.0:
            raise GCodeError.at(line, "PLANE inside of a rotation (CYCL DEF 10) is not read; end that before.")

    def _end_plane(self, stays: bool, code: str, line: int) -> None:
        for number in (120, 121, 122):
            self.set_q(f"Q{number}", 0.0, line)
        if self.machine.tilted is None:
            name = " ".join(code.split(" ")[:2])
            self.machine.findings.add("harmless-word", "ignored", line, f"{name} is left out: it moves nothing")
            return
        self.leans, self.pole = stays and self.machine.stuck != STAYS, None
        upright(self.machine)

    def need_upright_tool(self, line: int) -> None:
        """Raise GCodeError where a move at feed comes while the tool still leans."""
        if self.leans:
            text = "the tool still leans: PLANE RESET STAY does not turn it back; turn it by L A0 C0 before any cut."
            raise GCodeError.at(line, text)

    def _see(self, shift: list[float], angle: float, line: int) -> None:
        """No datum shift or rotation begins in a tilted plane; one that ends there ends with it."""
        before = frame_of(self.machine)
        if self.machine.tilted is not None and before != (shift, angle):
            if any(now not in (0.0, was) for now, was in zip(shift, before[0])) or angle:
                text = "a datum shift or rotation in a tilted plane is not read; end that before (PLANE RESET)."
                raise GCodeError.at(line, text)
            self.machine.stuck = "the datum shift has ended in a tilted plane; end that, too (PLANE RESET)."
        super()._see(shift, angle, line)

    def _mirror(self, letters: str, line: int) -> None:
        if self.machine.tilted is not None:
            raise GCodeError.at(line, "a mirror image in a tilted plane is not read; end that before (PLANE RESET).")
        super()._mirror(letters, line)
