"""A program with its moves led elsewhere: lines keep numbers, comments, feeds and other words; only places change.

Each move has become one or several pieces. Where a line makes one plain move its words are changed where they stand;
what makes several moves (a cycle, a rounded corner) or computes its words is written out; loops and subprograms are
written out in the order in which they are run. What was written is read again and compared, move by move.
"""

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import GCodeError
from robomill.toolpath.fitting import Piece
from robomill.toolpath.gcode.legs import Leg
from robomill.toolpath.gcode.program import TRAVERSE, Program
from robomill.toolpath.gcode.scan import AXES, CENTRES, ROTARY, Token, joined, notes, scan, unscaled, varies, without
from robomill.toolpath.gcode.trace import Executed, Modes
from robomill.toolpath.plane import axes
from robomill.units import format_plain, from_si

DIGITS, ANGLE_DIGITS = {"mm": 4, "in": 5}, 4
BY_RADIUS = math.radians(170.0)  # an arc of more is told by its centre: R is too rough there
STOPS, MOTIONS = {"M0", "M1", "M2", "M30", "M60"}, {"G0", "G1", "G2", "G3"}
CYCLES = {f"G{n}" for n in (73, 81, 82, 83, 85, 86, 89)}
ELSEWHERE = {"G28", "G30", "G53", "G5", "G5.1", "G5.2", "G33", "G33.1", "G76", "G74", "G84", "G87", "G88", "G31", "G63"}
TURNED_INTO_PLACES = {"G40", "G41", "G42", "G41.1", "G42.1", "G15", "G16", "G7", "G8"}
SCALES, AS_BEFORE = {"G50", "G51", "G50.1", "G51.1"}, ""
CORNERS = ("R=", "C=", "RND=", "RNDM=", "CHF=", "CHR=")
SHAPES = (*CORNERS, "CR=", "AR=", "TURN=", "ANG=")
PLACES = AXES + ROTARY + CENTRES + "R"
CALLS = {"M97", "M98", "M99", "M198", "M17", "G65", "G66", "G67"}
_CYCLE_CALL = re.compile(r"\s*(N\d+\s*)?(?:CYCLE\d+|HOLES\d+|MCALL\b.*)\s*(?:\(.*\))?\s*(;.*)?$", re.IGNORECASE)
_MODAL_CALL = re.compile(r"\s*(N\d+\s*)?MCALL\b", re.IGNORECASE)


@dataclass(eq=False)
class Rewritten:
    """The new ``text``; ``made`` are, move by move, the pieces as they are written, each with where it starts (tip, m);
    ``unrolled`` names what was written out."""

    text: str
    made: dict[int, list[tuple[FloatArray, Piece]]]
    unrolled: tuple[str, ...]


@dataclass(eq=False)
class Rewriter:
    """Writes ``program`` anew; ``pieces`` of its moves at feed, and ``ends`` (m, 3) m of all others, tell the tip."""

    program: Program
    dialect: str
    pieces: Mapping[int, list[Piece]]
    ends: FloatArray
    at: FloatArray = field(init=False)
    absolute_centre: bool = field(default=False, init=False)
    motion: str = field(default="", init=False)
    feed: float = field(default=math.nan, init=False)
    lines: list[str] = field(default_factory=list, init=False)
    made: dict[int, list[tuple[FloatArray, Piece]]] = field(default_factory=dict, init=False)
    unrolled: dict[str, None] = field(default_factory=dict, init=False)

    def write(self, text_lines: list[str], executed: list[Executed]) -> Rewritten:
        """The program from its lines and how they were executed."""
        self.at = np.array(self.program.start[0])
        self.others = {name for each in executed for name in each.modes.other}
        self.unrolled |= dict.fromkeys(sorted(self.others))
        index = [each.index for each in executed]
        in_order = all(a < b for a, b in pairwise(index)) and all(each.main for each in executed)
        if in_order:
            self._in_order(text_lines, executed)
        else:
            self.unrolled["loops and subprograms"] = None
            self._as_run(text_lines, executed)
        return Rewritten("\n".join(self.lines) + "\n", self.made, tuple(self.unrolled))

    def _in_order(self, text_lines: list[str], executed: list[Executed]) -> None:
        line = self.program.line
        first, last = (np.searchsorted(line, np.arange(len(text_lines) + 2), side) for side in ("left", "right"))
        if (np.diff(line) < 0).any():
            raise GCodeError("Program: its moves are not in the order of its lines; it cannot be written back.")
        run = {each.index: each for each in executed}
        for i, text in enumerate(text_lines):
            moves = range(int(first[i + 1]), int(last[i + 1]))
            if i not in run:
                self.lines.append(text)
            else:
                self._line(text, moves, run[i].modes, i + 1)

    def _as_run(self, text_lines: list[str], executed: list[Executed]) -> None:
        numbered: set[int] = set()
        before: Modes | None = None
        self.lines += text_lines[: executed[0].index if executed else 0]
        for each in executed:
            again = each.index in numbered
            text = re.sub(r"^(\s*/?\s*)N\d+\s*", r"\1", each.uncalled) if again else each.uncalled
            numbered.add(each.index)
            moves = range(each.first, each.last)
            if len(moves) or self._kept(text, before, each.modes):
                if not len(moves) and varies(text, self.dialect):
                    what = f"{text.strip()[:40]!r} is computed, and cannot be written back."
                    raise GCodeError.at(each.index + 1, what)
                self._line(text, moves, each.modes, each.index + 1)
            elif not again:
                self.lines += notes(text, self.dialect)
            before = each.modes
        self.lines += [line for line in text_lines[-1:] if line.strip() == "%"]  # what began as a tape ends as one

    def _kept(self, text: str, before: Modes | None, modes: Modes) -> bool:
        """Whether a line that makes no move is kept where loops and calls are written out."""
        tokens = scan(text)
        if tokens is None:
            return (before is not None and not before.places_as(modes)) or text.strip()[:1] in ("%", "")
        codes = {token.code for token in tokens}
        computes = any(token.letter and (token.value is None or token.letter in "LP#") for token in tokens)
        return not codes & CALLS and (not computes or "G10" in codes or "G4" in codes)

    # --- a line
    def _line(self, text: str, moves: range, modes: Modes, number: int) -> None:
        tokens = scan(text)
        codes = {token.code for token in tokens or ()}
        if not len(moves):
            self._still(text, tokens, codes, modes)
            return
        if codes & ELSEWHERE:
            self._as_it_was(text, moves, number)
            return
        if tokens is None:
            call = _CYCLE_CALL.match(text)
            if call is None:
                what = f"{text.strip()[:40]!r} moves the tool in a way that cannot be written back."
                raise GCodeError.at(number, what)
            tokens = scan(f"{call[1] or ''}{call[2] or ''}") or []
            self.unrolled["canned cycles"] = None
        legs = [leg for j in moves for leg in self._legs(j)]
        computed = any(token.letter and token.value is None for token in tokens)
        self._say(codes, tokens, computed)
        plain = len(moves) == 1 and not computed and not self.others and not codes & CYCLES
        if plain:
            self._edited(tokens, legs, modes)
        else:
            self._written_out(tokens, legs, modes, number)

    def _say(self, codes: set[str], tokens: list[Token], computed: bool) -> None:
        if codes & CYCLES:
            self.unrolled["canned cycles"] = None
        if any(token.letter in CORNERS for token in tokens):
            self.unrolled["rounded corners"] = None
        elif computed:
            self.unrolled["computed words"] = None

    def _still(self, text: str, tokens: list[Token] | None, codes: set[str], modes: Modes) -> None:
        """A line that makes no move."""
        if _MODAL_CALL.match(text):
            self.unrolled["canned cycles"] = None
            return
        if (left := unscaled(text)) is not None:
            self.lines += left
            return
        if self.others and tokens is not None:
            if codes & SCALES:
                return
            gone = {i for i, token in enumerate(tokens) if token.code in TURNED_INTO_PLACES or token.letter == "D"}
            if gone:
                tokens = without(tokens, gone)
                text = joined(tokens)
                if not any(token.letter and token.letter != "N" for token in tokens):
                    return
        if "G92" in codes and tokens is not None:
            text = joined(self._zeroed(tokens, modes))
        for code in codes & MOTIONS:
            self.motion = code
        for token in tokens or ():
            if token.letter == "F" and token.value is not None:
                self.feed = token.value
        self.lines.append(text)

    def _zeroed(self, tokens: list[Token], modes: Modes) -> list[Token]:
        """G92 says where the tool stands: it stands elsewhere now, so that the zero stays where it was."""
        meant = self.program.end[max(self.made)] if self.made else self.at
        moved = modes.words(self.at) - modes.words(meant)
        digits, out = DIGITS[modes.unit], list(tokens)
        for i, token in enumerate(tokens):
            if token.letter and token.letter in AXES and token.value is not None:
                value = token.value + float(moved[AXES.index(token.letter)])
                out[i] = token.said(self._number(value, digits, {token.letter: token}))
        return out

    def _as_it_was(self, text: str, moves: range, number: int) -> None:
        """A line that goes where only the machine knows, or with the spindle: kept where nothing is corrected."""
        program = self.program
        for j in moves:
            led = self.pieces[j][-1].end if j in self.pieces else self.ends[j]
            moved, lift = np.abs(program.end[j] - program.start[j]) > 1e-12, program.lift[j]
            if np.abs(np.where(moved, led - program.end[j] - lift, 0.0)).max() > 1e-7:
                raise GCodeError.at(
                    number, f"{text.strip()[:40]!r} cannot be led elsewhere; write its moves with G0 and G1."
                )
            start, self.at = self.at, np.where(moved, program.end[j], self.at)
            self.made[j] = [(start + lift, Piece(0.0, 1.0, self.at + lift))]
        self.motion = ""
        self.lines.append(text)

    # --- legs
    def _legs(self, j: int) -> Iterator[Leg]:
        program = self.program
        if j not in self.pieces:
            piece = Piece(0.0, 1.0, self.ends[j])
            yield Leg(j, piece, "G0" if program.kind[j] == TRAVERSE else "G1", program)
            return
        for piece in self.pieces[j]:
            yield Leg(j, piece, "G1" if piece.centre is None else "G3" if piece.sweep > 0.0 else "G2", program)

    def _words(self, leg: Leg, modes: Modes, tokens: Mapping[str, Token], all_axes: bool) -> dict[str, str]:
        """What leads a leg to its end: words by letter, and the point that they lead to becomes ``at``."""
        digits = DIGITS[modes.unit]
        base, goal = modes.words(self.at), modes.words(leg.end)
        found: dict[str, str] = {}
        for i, letter in enumerate(AXES):
            in_plane = leg.centre is not None and all_axes and i in axes(leg.plane)[:2]
            if letter in tokens or in_plane or abs(goal[i] - base[i]) > 0.6 * 10.0**-digits:
                value = goal[i] if modes.absolute else goal[i] - base[i]
                found[letter] = self._number(value, digits, tokens)
                base[i] = float(found[letter]) + (0.0 if modes.absolute else base[i])
        for i, letter in enumerate(ROTARY):
            if letter in tokens or abs(leg.rotary[i] - leg.rotary0[i]) > 1e-9:
                angle = modes.angles(leg.rotary)[i]
                angle -= 0.0 if modes.absolute else modes.angles(leg.rotary0)[i]
                found[letter] = self._number(angle, ANGLE_DIGITS, tokens)
        start, self.at, self.absolute_centre = self.at, modes.point(base), modes.arc_absolute
        if leg.centre is not None:
            found |= self._centre(leg, modes, start, tokens)
        self._keep(leg, start)
        return found

    def _centre(self, leg: Leg, modes: Modes, start: FloatArray, tokens: Mapping[str, Token]) -> dict[str, str]:
        assert leg.centre is not None
        digits = DIGITS[modes.unit]
        middle, begin = modes.words(leg.centre), modes.words(start)
        first, second, _ = axes(leg.plane)
        if tokens and self._as_before(leg, start, 0.5 * 10.0**-digits * modes.factor):
            return dict.fromkeys((*CENTRES, "R"), AS_BEFORE)
        if "R" in tokens and abs(leg.piece.sweep) < BY_RADIUS:
            size = math.hypot(middle[first] - begin[first], middle[second] - begin[second])
            return {"R": self._number(size, digits, tokens)}
        value = middle if modes.arc_absolute else middle - begin
        return {CENTRES[i]: self._number(value[i], digits, tokens) for i in sorted((first, second))}

    def _as_before(self, leg: Leg, start: FloatArray, near: float) -> bool:
        """Whether a whole arc is only shifted, so that steps to its centre, and its radius, are what they were."""
        program, j = self.program, leg.move
        if leg.piece.f1 - leg.piece.f0 < 1.0 or leg.centre is None or self.absolute_centre:
            return False
        shift = start - program.start[j]
        return bool(np.abs([leg.centre - program.centre[j] - shift, self.at - program.end[j] - shift]).max() < near)

    def _keep(self, leg: Leg, start: FloatArray) -> None:
        lift, piece = self.program.lift[leg.move], leg.piece
        made = Piece(piece.f0, piece.f1, self.at + lift, piece.centre, piece.sweep)
        self.made.setdefault(leg.move, []).append((start + lift, made))

    def _number(self, value: float, digits: int, tokens: Mapping[str, Token]) -> str:
        text = format_plain(float(value), digits)
        pointed = self.dialect == "fanuc" or any(token.text.endswith(".") for token in tokens.values())
        return f"{text}." if pointed and "." not in text else text

    # --- text
    def _edited(self, tokens: list[Token], legs: list[Leg], modes: Modes) -> None:
        """A line with one move: its words change where they stand; further pieces follow on lines of their own."""
        given = {token.letter: token for token in tokens if token.letter and token.letter not in "GM"}
        places = {letter: token for letter, token in given.items() if letter in AXES + ROTARY + "R"}
        stops = [i for i, token in enumerate(tokens) if token.code in STOPS] if len(legs) > 1 else []
        ends = [tokens[i].text for i in stops]
        if "F" in given:
            self.feed = given["F"].value or math.nan
        words = self._words(legs[0], modes, places, len(legs) > 1)
        if modes.inverse_time and legs[0].code != "G0":
            words["F"] = self._inverse(legs[0])
        first = without(tokens, set(stops))
        self.lines.append(joined(self._with(first, legs[0].code, words)))
        for leg in legs[1:]:
            self._further(leg, modes, given)
        if ends:
            self.lines[-1] += " " + " ".join(ends)

    def _further(self, leg: Leg, modes: Modes, given: Mapping[str, Token]) -> None:
        words = self._words(leg, modes, {letter: given[letter] for letter in ROTARY if letter in given}, True)
        if not words:
            return
        if modes.inverse_time:
            words["F"] = self._inverse(leg)
        motion = [leg.code] if leg.code != self.motion else []
        self.motion = leg.code
        self.lines.append(" ".join([*motion, *(f"{letter}{number}" for letter, number in words.items())]))

    def _inverse(self, leg: Leg) -> str:
        length = float(np.linalg.norm(self.made[leg.move][-1][1].end - self.made[leg.move][-1][0]))
        if leg.piece.centre is not None:
            length = abs(leg.piece.sweep) * float(
                np.linalg.norm((leg.piece.centre - leg.piece.end)[list(axes(leg.plane)[:2])])
            )
        return format_plain(from_si(float(self.program.v_f[leg.move]) / max(length, 1e-9), "1/min"), 4)

    def _with(self, tokens: list[Token], code: str, words: Mapping[str, str]) -> list[Token]:
        """The tokens with a motion and ``words`` in the place of theirs."""
        out, gone, left = list(tokens), set(), dict(words)
        has_motion = False
        for i, token in enumerate(out):
            if token.code in MOTIONS:
                has_motion = True
                out[i] = token if token.code == code else Token(code, "G", float(code[1:]))
            elif token.letter in left:
                number = left.pop(token.letter)
                out[i] = token if number == AS_BEFORE or token.value == float(number) else token.said(number)
            elif token.letter in (*PLACES, "P"):
                gone.add(i)
        new = [Token(f"{letter}{number}", letter) for letter, number in left.items() if number]
        if not has_motion and code != self.motion:
            new.insert(0, Token(code, "G"))
        self.motion = code
        return self._in_place(out, gone, new) if new else without(out, gone)

    def _in_place(self, tokens: list[Token], gone: set[int], new: list[Token]) -> list[Token]:
        """The tokens with ``new`` ones among those of places, in their usual order."""
        places = [i for i, token in enumerate(tokens) if token.letter and token.letter in PLACES]
        heads = [i for i, token in enumerate(tokens) if token.letter in ("N", "G") or token.text.startswith("/")]
        kept = [tokens[i] for i in places if i not in gone]
        ordered = sorted(kept + new, key=lambda token: ("G" + PLACES).index(token.letter))
        at = places[0] if places else (heads[-1] + 1 if heads else 0)
        out = gone | set(places)
        before, after = ([t for i, t in some if i not in out and not t.is_space] for some in _parted(tokens, at))
        gap = " " if any(token.is_space for token in tokens) or len(tokens) < 2 else ""
        words = [*before, *ordered, *after]
        if words[0].text.startswith("/") and len(words) > 1:
            words[:2] = [Token(joined(words[:2]), words[1].letter, words[1].value)]
        return [part for token in words for part in (Token(gap), token)][1:]

    def _written_out(self, tokens: list[Token], legs: list[Leg], modes: Modes, number: int) -> None:
        """A line whose moves are written one by one: its other words stay on the first of them."""
        kept, comments, ends = self._left_over(tokens, number)
        for n, leg in enumerate(legs):
            self._dwell(leg, n)
            words = self._words(leg, modes, {}, True)
            motion = [leg.code] if leg.code != self.motion or n == 0 else []
            self.motion = leg.code
            feed = [] if leg.code == "G0" else self._feed(leg, modes)
            line = [*kept, *motion, *(f"{letter}{value}" for letter, value in words.items()), *feed]
            if words or kept or feed:
                self.lines.append(" ".join([*line, *comments]))
                kept, comments = [], []
        if ends:
            self.lines.append(" ".join(ends))

    def _left_over(self, tokens: list[Token], number: int) -> tuple[list[str], list[str], list[str]]:
        """What stays of a line whose moves are written out: words, comments, and the words that stop the program."""
        drop = MOTIONS | CYCLES | (TURNED_INTO_PLACES if self.others else set())
        letters = {*PLACES, *SHAPES, "P", "Q", "L", "F", *(("D",) if self.others else ())}
        kept, comments, ends = [], [], []
        for token in tokens:
            if token.is_comment:
                comments.append(token.text)
            elif token.code in STOPS:
                ends.append(token.text)
            elif token.is_space or token.code in drop or token.letter in letters:
                continue
            elif token.letter and token.value is None:
                raise GCodeError.at(number, f"{token.text!r} is computed, and cannot be written back.")
            else:
                kept.append(token.text.strip())
        return kept, comments, ends

    def _feed(self, leg: Leg, modes: Modes) -> list[str]:
        """F where it is not in force yet."""
        if modes.inverse_time:
            return [f"F{self._inverse(leg)}"]
        feed = from_si(float(self.program.v_f[leg.move]), f"{modes.unit}/min")
        feed = feed / modes.speed if modes.per_turn and modes.speed else feed
        if abs(feed - self.feed) <= 1e-9 * max(feed, 1.0):
            return []
        self.feed = feed
        return [f"F{self._number(feed, 6, {})}"]

    def _dwell(self, leg: Leg, n: int) -> None:
        """A dwell that a cycle makes before a move."""
        seconds = float(self.program.dwell[leg.move])
        if n == 0 or seconds <= 0.0 or leg.piece.f0 > 0.0:
            return
        word = {"fanuc": "X", "sinumerik": "F"}.get(self.dialect, "P")
        self.lines.append(f"G4 {word}{self._number(seconds, 4, {})}")


def _parted(tokens: list[Token], at: int) -> tuple[list[tuple[int, Token]], list[tuple[int, Token]]]:
    """The tokens with their places, those before ``at`` and those from there on."""
    every = list(enumerate(tokens))
    return every[:at], every[at:]
