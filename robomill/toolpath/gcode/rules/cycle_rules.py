"""The rules of canned cycles G73, G74, G81 to G89: drilling, tapping and boring at one or many places.

``motion_rules`` says what rules are. ``m.cycle`` holds the words that stay in force from hole to hole, in the columns
of ``codes``: R, P, Q, I, J, K, and in the column of Z the bottom along whatever axis is drilled. ``m.keeps_heights``
says that a control (Fanuc, Haas) keeps R and the bottom as the heights that they are: G91 behind a hole in G90 counts
places from hole to hole, and not how deep they are. It also makes no hole for L0, and keeps its words.
``m.is_fanuc`` says that it taps and bores (G89) out to R alone, and is at rapid from there, and that it goes to the
next place at the height where it is, and that what one cycle says holds for others too, until G80. Pecks are Q deep, or
fall: the first is I, each next one J less, none below K (Haas).
"""

# mypy: disable-error-code="no-untyped-def, no-untyped-call"

import math

from robomill.toolpath.gcode.codes import I, J, K, L, P, Q, R, X, Z
from robomill.toolpath.gcode.rules.motion_rules import (
    FEED,
    INCH,
    INVERSE_TIME,
    NO_FEED,
    TRAVERSE,
    dwell,
    end_point,
    feed_speed,
    write_straight,
)
from robomill.toolpath.plane import axes, from_plane

PECK_CLEARANCE_MM, PECK_CLEARANCE_INCH = 0.254, 0.010
"""How far above the last bottom the rapid stops in G73 and G83."""
MAX_REPEATS = 100_000
MAX_PECKS = 100_000

(
    CYCLE_IN_INVERSE_TIME,
    NO_CLEARANCE,
    NO_BOTTOM,
    REPEATS,
    NO_DWELL,
    NO_PECK,
    PECK_OF_NOTHING,
    BACK_BORE_INCOMPLETE,
    SPINDLE_STANDS,
    WRONG_SPINDLE,
    CLEARANCE_BELOW_BOTTOM,
    TOO_MANY_PECKS,
    NO_ROOM,
) = range(20, 33)
"""Why a cycle is refused; the last one: the rows do not suffice for its moves."""


def is_cycle(motion: int) -> bool:
    """True for G73, G74 and G81 to G89."""
    return motion in (730, 740) or 810 <= motion <= 890


def is_tap(motion: int) -> bool:
    """True for G74 and G84."""
    return motion in (740, 840)


def takes_dwell(motion: int) -> bool:
    """True for G82, G86, G88 and G89, which need P."""
    return motion in (820, 860, 880, 890)


def pecks(motion: int) -> bool:
    """True for G73 and G83, which need Q."""
    return motion in (730, 830)


def cycle(m, w, motion: int, line: int, end, rows) -> int:
    """The cycle of a line, L times at its places; ``end`` (6,) is room to reckon in. 0, or why it is refused."""
    refusal = _check(m, w, motion)
    if refusal != 0:
        return refusal
    third = axes(m.plane)[2]
    current = m.p[third]
    if math.isnan(m.initial_level):
        m.initial_level = current
    _keep(m, w, third, pecks(motion))
    level, clearance, bottom = m.initial_level, m.cycle[R], m.cycle[Z]
    if not m.absolute and not m.keeps_heights:
        clearance += level
        bottom += clearance
    if w[L] == 0.0:
        m.motion = motion
        return 0
    if clearance < bottom:
        return CLEARANCE_BELOW_BOTTOM
    least = m.cycle[Q] if math.isnan(m.cycle[I]) else min(m.cycle[I], m.cycle[K])
    steps = (clearance - bottom) / least if pecks(motion) else 0.0
    if steps > MAX_PECKS:
        return TOO_MANY_PECKS
    repeats = 1 if math.isnan(w[L]) else int(w[L])
    if m.moves + 1 + repeats * (10 + 3 * math.ceil(steps)) > len(rows):
        return NO_ROOM
    m.motion = motion
    for axis in range(6):
        end[axis] = m.p[axis]
    if level < clearance:
        _go(m, TRAVERSE, line, end, clearance, rows)
        level = current = clearance
    clear = clearance if m.retract_r else level
    for repeat in range(repeats):
        refusal = end_point(m, w, end)
        if refusal != 0:
            return refusal
        above = current if repeat == 0 and (current > clearance or m.is_fanuc) else clear
        _go(m, TRAVERSE, line, end, above, rows)
        if above > clearance or (m.is_fanuc and above < clearance):
            _go(m, TRAVERSE, line, end, clearance, rows)
        _hole(m, motion, line, end, (clearance, clear, bottom), rows)
    for axis in range(6):
        m.p[axis] = end[axis]
    return 0


def _keep(m, w, third: int, pecking: bool) -> None:
    """Keep what a hole says for the next ones: as words, which G91 adds anew at each, or R and bottom as heights."""
    for column in (R, P, Q, I, J, K):
        if not math.isnan(w[column]):
            m.cycle[column] = w[column]
    if pecking and not math.isnan(w[Q]):
        m.cycle[I] = math.nan
    if not math.isnan(w[X + third]):
        m.cycle[Z] = w[X + third]
    if not (math.isnan(w[R]) and math.isnan(w[X + third])):
        m.kept_steps = not m.absolute
    if m.keeps_heights and not m.absolute:
        if not math.isnan(w[R]):
            m.cycle[R] += m.initial_level
        if not math.isnan(w[X + third]):
            m.cycle[Z] += m.cycle[R]


def _check(m, w, motion: int) -> int:
    """What a cycle needs: on its line, or kept from the line before if that was the same cycle."""
    same = m.motion == motion or (m.is_fanuc and is_cycle(m.motion))
    if m.feed == 0.0:
        return NO_FEED
    if m.feed_mode == INVERSE_TIME:
        return CYCLE_IN_INVERSE_TIME
    if _missing(w[R], m.cycle[R], same):
        return NO_CLEARANCE
    if _missing(w[X + axes(m.plane)[2]], m.cycle[Z], same):
        return NO_BOTTOM
    if w[L] < (0.0 if m.keeps_heights else 1.0) or w[L] > MAX_REPEATS:
        return REPEATS
    if takes_dwell(motion) and _missing(w[P], m.cycle[P], same):
        return NO_DWELL
    if pecks(motion) and _missing(w[Q], m.cycle[Q], same) and _missing(w[I], m.cycle[I], same):
        return NO_PECK
    if pecks(motion) and (w[Q] <= 0.0 or w[I] <= 0.0 or w[J] < 0.0 or w[K] <= 0.0):
        return PECK_OF_NOTHING
    if motion == 870 and not same and math.isnan(w[I] + w[J] + w[K]):
        return BACK_BORE_INCOMPLETE
    if motion in (860, 870, 880) and m.spindle == 0:
        return SPINDLE_STANDS
    return WRONG_SPINDLE if is_tap(motion) and m.spindle != (1 if motion == 840 else -1) else 0


def _missing(word: float, kept: float, same: bool) -> bool:
    return math.isnan(word) and (math.isnan(kept) or not same)


def _go(m, kind: int, line: int, end, height: float, rows) -> None:
    """A straight move to the place of ``end`` at a height."""
    end[axes(m.plane)[2]] = height
    row = rows[m.moves]
    row.line = line
    write_straight(m, kind, end, feed_speed(m) if kind == FEED else 0.0, row)
    m.moves += 1


def _hole(m, motion: int, line: int, end, heights, rows) -> None:
    """One hole, from above it at the first of its ``heights`` back to the second; the third is its bottom."""
    if motion == 870:
        _back_bore(m, line, end, heights, rows)
        return
    clearance, clear, bottom = heights
    if is_tap(motion):
        _tap(m, line, end, bottom, rows)
        dwell(m, 0.0 if math.isnan(m.cycle[P]) else m.cycle[P])
        _tap(m, line, end, clearance if m.is_fanuc else clear, rows)
        if m.is_fanuc and clear > clearance:
            _go(m, TRAVERSE, line, end, clear, rows)
        return
    if pecks(motion):
        falls = not math.isnan(m.cycle[I])
        peck = m.cycle[I] if falls else m.cycle[Q]
        depth = clearance - peck
        while depth > bottom:
            _go(m, FEED, line, end, depth, rows)
            if motion == 830:
                _go(m, TRAVERSE, line, end, clearance, rows)
            gap = PECK_CLEARANCE_INCH if m.unit_code == INCH else PECK_CLEARANCE_MM
            _go(m, TRAVERSE, line, end, depth + gap, rows)
            if falls:
                peck = max(peck - m.cycle[J], m.cycle[K])
            depth -= peck
    _go(m, FEED, line, end, bottom, rows)
    if takes_dwell(motion):
        dwell(m, m.cycle[P])
    if motion == 850 or (motion == 890 and m.is_fanuc):
        _go(m, FEED, line, end, clearance, rows)
    if motion == 880:  # the machine waits, and the retract is made by hand
        end[axes(m.plane)[2]] = clear
    else:
        _go(m, FEED if motion == 890 and not m.is_fanuc else TRAVERSE, line, end, clear, rows)


def _tap(m, line: int, end, height: float, rows) -> None:
    """Outside of G17 the reference taps along permuted axes; read as that machine would, on a Fanuc along its own."""
    first, second, third = axes(m.plane)
    u, v = end[first], end[second]
    end[0], end[1], end[2] = from_plane(m.plane if m.plane == 17 or m.is_fanuc else 37 - m.plane, u, v, height)
    _go(m, FEED, line, end, end[third], rows)
    end[first], end[second], end[third] = u, v, height


def _back_bore(m, line: int, end, heights, rows) -> None:
    """G87: beside the hole down to its bottom, in, up to K at feed and back, and out again."""
    clearance, clear, bottom = heights
    first, second, third = axes(m.plane)
    u, v = end[first], end[second]
    aside_u, aside_v = u + m.cycle[I + first], v + m.cycle[I + second]
    middle = m.cycle[I + third] + (0.0 if m.absolute else bottom)
    end[first], end[second] = aside_u, aside_v
    _go(m, TRAVERSE, line, end, clearance, rows)
    _go(m, TRAVERSE, line, end, bottom, rows)
    end[first], end[second] = u, v
    _go(m, TRAVERSE, line, end, bottom, rows)
    _go(m, FEED, line, end, middle, rows)
    _go(m, FEED, line, end, bottom, rows)
    end[first], end[second] = aside_u, aside_v
    _go(m, TRAVERSE, line, end, bottom, rows)
    _go(m, TRAVERSE, line, end, clear, rows)
    end[first], end[second] = u, v
    _go(m, TRAVERSE, line, end, clear, rows)
