"""Tilted working planes of Heidenhain's dialogue: PLANE SPATIAL, EULER, VECTOR, RELATIV, RESET and CYCL DEF 19.

SPA, SPB and SPC turn about the axes of the upright system, first about X, then Y, then Z, which is Z, then Y, then X
as each turn leaves them; A, B and C of CYCL DEF 19 do so, too, on most machines. Euler's angles turn about Z, X as that
leaves it, and Z as both do. RELATIV turns the plane in force by one angle about its own axis. VECTOR gives the normal
(N), and the direction of X (B), of which what lies along the normal is taken off. TURN and MOVE turn the tool; STAY
leaves that to a line L A+Q120 C+Q122, in which the control puts what its machine needs. (HEIDENHAIN, TNC 640, User's
Manual for Conversational Programming: the PLANE function.)
"""

import re

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import GCodeError
from robomill.toolpath.gcode.frames import frame_of
from robomill.toolpath.gcode.klartext.approach import KlartextApproach
from robomill.toolpath.gcode.klartext.values import NUMBER
from robomill.toolpath.gcode.machine import Scale
from robomill.toolpath.gcode.tilted import tilt, turned_by, upright

_SPATIAL = re.compile(rf"PLANE SPATIAL SPA ?({NUMBER}) SPB ?({NUMBER}) SPC ?({NUMBER})(.*)")
_EULER = re.compile(rf"PLANE EULER EULPR ?({NUMBER}) EULNU ?({NUMBER}) EULROT ?({NUMBER})(.*)")
_RELATIVE = re.compile(rf"PLANE RELATIVE? ?SP([ABC]) ?({NUMBER})(.*)")
_VECTOR = re.compile(
    r"PLANE VECTOR" + "".join(rf" {name} ?({NUMBER})" for name in ("BX", "BY", "BZ", "NX", "NY", "NZ")) + "(.*)"
)
_OF_MACHINE = {"PROJECTED": "PLANE SPATIAL", "POINTS": "PLANE VECTOR", "AXIAL": "PLANE SPATIAL"}
_BEHAVES = re.compile(
    rf" ?(?:MOVE|TURN|STAY|(?:DIST|ABST\.?|MB|F) ?(?:MAX|AUTO|{NUMBER})|(?:SEQ|SYM) ?[-+]|(?:TABLE|COORD) ROT)(?= |$)"
)
_ANGLE = re.compile(rf"([ABC]) ?({NUMBER})")
_CYCLE_19 = re.compile(rf"((?:[ABC] ?{NUMBER} ?)*)((?:(?:F|ABST\.?|SETUP|DIST) ?(?:MAX|{NUMBER}) ?)*)")
_END = rf"(?: R0)?(?: F ?(?:MAX|AUTO|{NUMBER}))?(?: M\d+)*"
_TO_PLANE = re.compile(rf"L(?: [ABC] ?\+? ?Q12[012])+{_END}")
_TURNED_BACK = re.compile(rf"L(?: [ABC] ?[-+]? ?(?:0+(?:\.0*)?|Q12[012]))+{_END}")
STAYS = "the plane leaves the tool as it stands (STAY, CYCL DEF 19); turn it by L A+Q120 C+Q122 before any move."
ASKEW = 1e-3
"""B and N of PLANE VECTOR may lean towards each other by so much (the cosine): they are printed in few digits."""

WORD = re.compile(rf"(?<![A-Z])(I?)(PR|PA|T[XYZ]|[XYZABC])[ \t]*({NUMBER})")
Words = dict[str, tuple[str, float]]
"""By letter: "I" where it counts as a step, and the value."""


class KlartextPlanes(KlartextApproach):
    """Reads planes; ``KlartextApproach`` reads what lies in them."""

    leans = False

    def plane_line(self, code: str, line: int) -> bool:
        """Tilt the plane, end it, or turn the tool to it; False for other lines."""
        machine = self.machine
        if machine.tilted is not None and machine.stuck in ("", STAYS) and _TO_PLANE.fullmatch(code):
            machine.stuck = ""
            return True
        if self.leans and _TURNED_BACK.fullmatch(code):
            self.leans = False
            return True
        if code[:5] != "PLANE":
            return False
        said = self._said_plane(code, line)
        if said is None:
            return False
        R, behaves = said
        if _BEHAVES.sub("", behaves).strip():
            raise GCodeError.at(line, f"found {_BEHAVES.sub('', behaves).strip()[:20]!r} behind PLANE; mend that line.")
        self._to_plane(" ".join(code.split(" ")[:2]), R, "STAY" in behaves, line)
        return True

    def _said_plane(self, code: str, line: int) -> tuple[FloatArray, str] | None:
        """The axes of the plane that a line says, as columns, and how the machine shall go there; None for others."""
        if (reset := re.match(r"PLANE RESET\b(.*)", code)) is not None:
            return np.eye(3), reset[1]
        for pattern, axes in ((_SPATIAL, "XYZ"), (_EULER, "ZXZ")):
            if (found := pattern.fullmatch(code)) is not None:
                a, b, c = (self.number(found[place], line) for place in (1, 2, 3))
                return turned_by(axes, (a, b, c)) if axes == "ZXZ" else turned_by("ZYX", (c, b, a)), found[4]
        if (found := _RELATIVE.fullmatch(code)) is not None:
            before = np.eye(3) if self.machine.tilted is None else self.machine.tilted.R
            turn = turned_by("XYZ"["ABC".index(found[1])], (self.number(found[2], line),))
            return before @ turn, found[3]
        if (found := _VECTOR.fullmatch(code)) is not None:
            values = [self.number(each, line) for each in found.groups()[:6]]
            return _by_vectors(np.array(values[:3]), np.array(values[3:]), line), found[7]
        kind = code.split(" ")[1] if " " in code else ""
        if kind in _OF_MACHINE:
            text = (
                f"PLANE {kind} is not read, as it counts otherwise than by angles in space; write {_OF_MACHINE[kind]}."
            )
            raise GCodeError.at(line, text)
        return None

    def _to_plane(self, name: str, R: FloatArray, stays: bool, line: int) -> None:
        """The plane whose axes are the columns of ``R``; an upright one ends what is tilted."""
        self._before(line)
        if np.allclose(R, np.eye(3), rtol=0.0, atol=1e-12):
            self._end_plane(stays, name, line)
            return
        for number in (120, 121, 122):
            self.machine.r_set.discard(1000 + number)  # what the machine needs, only its control knows
        tilt(self.machine, name, R)
        self.leans, self.pole = False, None
        self.machine.stuck = STAYS if stays else ""

    def _other_cycle(self, number: int, part: str | None, rest: str, line: int) -> str | None:
        """CYCL DEF 19 tilts the plane; without F nothing but a line L A+Q120 C+Q122 turns the tool there."""
        if number != 19 or part == "0":
            return super()._other_cycle(number, part, rest, line)
        found = _CYCLE_19.fullmatch(rest)
        if found is None:
            raise GCodeError.at(line, f"CYCL DEF 19.{part} {rest[:20]} is not read; expected A, B and C.")
        said = {letter: self.number(value, line) for letter, value in _ANGLE.findall(found[1])}
        R = turned_by("ZYX", (said.get("C", 0.0), said.get("B", 0.0), said.get("A", 0.0)))
        self._to_plane("CYCL DEF 19", R, not found[2], line)
        if self.machine.tilted is not None:
            text = "A, B and C of CYCL DEF 19 are read as angles in space, as PLANE SPATIAL has them; some machines"
            self.machine.findings.add(
                "cycle-19", "warning", line, f"{text} take them as places of their rotary axes: write PLANE there"
            )
        return None

    def words_of(self, kind: str, code: str, line: int) -> Words:
        """The places of a line that moves. Raises GCodeError for one that is said twice, or that counts otherwise."""
        found = WORD.findall(code)
        words = {letter: (step, self.number(value, line)) for step, letter, value in found}
        if len(words) < len(found):
            raise GCodeError.at(line, "a place is said twice in this line; give each letter once.")
        if kind in ("L", "LN", "C", "CR", "CT") and words.keys() & {"PR", "PA"}:
            raise GCodeError.at(line, f"PR and PA stand in LP and CP, not in {kind}; mend the line.")
        if self.machine.tilted is not None and re.search(r"M ?130(?!\d)", code):
            raise GCodeError.at(line, "M130 gives a place beside the tilted plane, which is not read; end that before.")
        return words

    def _before(self, line: int) -> None:
        if frame_of(self.machine)[1] != 0.0:
            raise GCodeError.at(line, "PLANE inside of a rotation (CYCL DEF 10) is not read; end that before.")

    def _end_plane(self, stays: bool, name: str, line: int) -> None:
        for number in (120, 121, 122):
            self.set_q(f"Q{number}", 0.0, line)
        if self.machine.tilted is None:
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

    def rescale(self, mirrored: tuple[float, float], size: float, stretched: Scale | None, line: int) -> None:
        if self.machine.tilted is not None and (mirrored, size, stretched) != ((1.0, 1.0), 1.0, None):
            text = "a mirror image or scale in a tilted plane is not read; end that before (PLANE RESET)."
            raise GCodeError.at(line, text)
        super().rescale(mirrored, size, stretched, line)


def _by_vectors(b: FloatArray, n: FloatArray, line: int) -> FloatArray:
    """(3, 3): Z along ``n``, X along ``b`` without what of it lies along ``n``; each (3,)."""
    sizes = float(np.linalg.norm(b)), float(np.linalg.norm(n))
    if min(sizes) < 1e-9:
        raise GCodeError.at(line, "PLANE VECTOR needs directions B and N that are not 0; mend them.")
    x, z = b / sizes[0], n / sizes[1]
    if abs(x @ z) > ASKEW:
        raise GCodeError.at(line, "PLANE VECTOR has B and N that are not at right angles; mend them.")
    x = x - (x @ z) * z
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])
