"""Tools and feeds of Heidenhain's dialogue: TOOL CALL with its speed, feed and allowances, and F in lines that move."""

import re

from robomill.errors import GCodeError
from robomill.toolpath.gcode.klartext.iso import KlartextIso
from robomill.toolpath.gcode.klartext.values import NUMBER
from robomill.toolpath.gcode.sinumerik.lines import named_tool

_TOOL = re.compile(
    r"TOOL CALL ?(\d+|\"[^\"]*\"|Q[LR]?\d+)?(?: ([XYZ])\b)?"
    rf"((?: ?(?:DL|DR2?) ?{NUMBER}| ?(?:S|F[UZ]?)(?: ?{NUMBER})?(?![A-Z\d]))*)"
)
_SAID = re.compile(rf"(DL|DR2?|S|F[UZ]?) ?({NUMBER})")
BY_TOOTH = "FZ counts per tooth, and how many the tool has is not said; write F per minute, or FU per turn."


class KlartextTools(KlartextIso):
    """Calls tools; ``Klartext`` moves them."""

    oversize = 0.0
    turns: float | None = None
    """min^-1, as the last S says."""
    per_rev: float | None = None
    """Program units a turn, as the FU of the last TOOL CALL says."""

    def tool_call(self, code: str, line: int) -> str:
        """TOOL CALL; an S or F without a number says nothing."""
        found = _TOOL.fullmatch(code)
        if found is None or found[2] in ("X", "Y"):
            raise GCodeError.at(line, f"{code[:30]} is not read; expected a tool, Z and S, as TOOL CALL 1 Z S2000.")
        if found[1] is not None:
            self.tool_feed, self.per_rev, self.oversize = None, None, 0.0
        out = []
        said = {name: self.number(value, line) for name, value in _SAID.findall(found[3] or "")}
        if said.get("DL", 0.0) != 0.0:
            raise GCodeError.at(line, f"TOOL CALL has DL{said['DL']:+g}, which is not read; put it in the tool table.")
        if "FZ" in said:
            raise GCodeError.at(line, BY_TOOTH)
        self.oversize = said.get("DR", self.oversize)
        if "S" in said:
            self.turns = said["S"]
            out.append(f"S{self.turns:.9f}")
        if self._take_feed(said, line):
            out.append(self.feed_words("", "AUTO", line))
        if found[1] is not None:
            quoted = found[1].startswith('"')
            tool = named_tool(found[1][1:-1], line, self.machine) if quoted else f"T{self.number(found[1], line):.0f}"
            out.append(f"{tool} M6")
        return " ".join(out)

    def _take_feed(self, said: dict[str, float], line: int) -> bool:
        """Whether a feed is said, or an FU that was said before follows a new S."""
        if "F" in said:
            self.tool_feed, self.per_rev = said["F"] / self.tenth, None
            return True
        self.per_rev = said.get("FU", self.per_rev)
        if self.per_rev is None or not {"FU", "S"} & said.keys():
            return False
        if not self.turns:
            raise GCodeError.at(line, "FU counts per turn, and TOOL CALL has no S; give S beside it.")
        self.tool_feed = self.per_rev * self.turns
        return True

    def feed_words(self, per_turn: str, said: str, line: int) -> str:
        """F, or FU per turn; under M136 F counts per turn, too."""
        if said != "AUTO" and (per_turn or self.per_turn):
            return f"G95 F{self.number(said, line):.9f}"
        return f"G94 F{self.rate(said, line):.9f}"

    def compensated(self, side: str, line: int) -> str:
        """G40, G41 or G42 where R0, RL or RR is another one than before."""
        before, self.side = self.side, side
        if side != "0" and self.oversize:
            text = f"R{side} with DR{self.oversize:+g} of TOOL CALL is not read; put it in the tool table."
            raise GCodeError.at(line, text)
        return "" if side == before else {"0": "G40", "L": "G41", "R": "G42"}[side]
