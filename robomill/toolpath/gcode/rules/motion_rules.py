"""The rules of motion: feeds, end points, arcs and frames of G0, G1, G2 and G3, each stated here and nowhere else.

Every function is plain Python on an object with attributes. The interpreter hands in the ``Machine`` and lists; for
long stretches of plain lines they are compiled (see ``stretches``) and get a record of ``records.STATE`` and rows of
``records.MOVE`` instead. So nothing here may use more of Python than numba knows.

``m`` is the machine: lengths in program units (mm or inch), angles in degrees. ``w`` are the words of a line in the
columns that ``codes`` names, NaN where a word is not given. G codes are ten times their number (G1 -> 10). ``row`` is
the move that is written: m, rad, m/s in the machine frame. Functions that can refuse return a code, 0 for "can be
done"; ``moves.SENTENCES`` says what each code means, with the figures that are left in ``m.figures``.
"""

# mypy: disable-error-code="no-untyped-def, no-untyped-call"
# One function serves lists, arrays, objects and records: no annotation would say more than the names.

import math

from robomill.toolpath.gcode.codes import ANGLE, RADIUS, F, I, J, K, P, R, X
from robomill.toolpath.plane import axes, centre_by_radius, from_plane, polar, swept, turned
from robomill.toolpath.tools import MOST
from robomill.units import from_si, to_si

RAPID, LINE, CLOCKWISE, COUNTERCLOCKWISE = 0, 10, 20, 30
INCH, INVERSE_TIME, PER_TURN, CONSTANT_SPEED = 200, 930, 950, 970
TRAVERSE, FEED, ARC, TAP, PROBE = 0, 1, 2, 3, 4
"""Kinds of moves."""

SPIRAL_MM, SPIRAL_INCH = 0.02 * math.sqrt(2.0), 0.002 * math.sqrt(2.0)
"""The radii to start and end of an arc given by its centre may differ by this much, or by"""
SPIRAL_SHARE = 1e-3
"""this share of the larger radius, whichever is more, but never by more than 100 times the first figure."""
RADIUS_INCH = 0.00005
RADIUS_MM = from_si(to_si(RADIUS_INCH, "in"), "mm")
"""A radius below this is none; half a chord may exceed a given radius by this much."""
MINUTE = to_si(1.0, "min")

(
    NO_FEED_ON_LINE,
    NO_FEED,
    NO_SPEED,
    ARC_AFTER_G40,
    ARC_IN_NO_PLANE,
    ARC_WITHOUT_FORM,
    ARC_WITH_TWO_FORMS,
    ARC_ACROSS_PLANE,
    ARC_CENTRE_INCOMPLETE,
    RADIUS_WITHOUT_END,
    ARC_ON_ITS_CENTRE,
    ARC_OFF_ITS_CIRCLE,
    RADIUS_TO_START,
    RADIUS_TOO_SMALL,
    NO_ANGLE,
    NO_DIRECTION,
) = range(1, 17)
"""Why a move is refused."""


# --- what a line without a motion word does, feed and speed
def implied_motion(m, axes: bool, centre: bool) -> int:
    """The motion of a line that names none: the one in force, if there are words for it; -1 for none."""
    if axes or (centre and is_arc(m.motion)):
        return m.motion
    return -1


def keep_motion(m, motion: int) -> None:
    """G0, G1, G2 or G3 is in force; as ``straight`` it outlasts cycles and G80, for controls that take it up again."""
    m.motion = motion
    m.straight = motion


def is_arc(motion: int) -> bool:
    """True for G2 and G3."""
    return motion in (CLOCKWISE, COUNTERCLOCKWISE)


def spindle_speed(m) -> float:
    """Commanded turns per second; 0 at constant surface speed, which is not modelled."""
    return m.speed / MINUTE if m.spindle_mode == CONSTANT_SPEED else 0.0


def turning(m) -> float:
    """Turns per second as the spindle turns: 0 where it stands still, NaN where the diameter says how fast (G96)."""
    if m.spindle == 0:
        return 0.0
    return m.speed / MINUTE if m.spindle_mode == CONSTANT_SPEED else math.nan


def feed_speed(m) -> float:
    """Feed rate, m/s (per turn: at the commanded spindle speed)."""
    per_second = spindle_speed(m) if m.feed_mode == PER_TURN else 1.0 / MINUTE
    return m.feed * m.factor * per_second


def check_feed(m, w) -> int:
    """A move at feed needs a feed rate: on its line (G93), or in force, per turn with a spindle speed."""
    if m.feed_mode == INVERSE_TIME:
        return NO_FEED_ON_LINE if math.isnan(w[F]) else 0
    if m.feed == 0.0:
        return NO_FEED
    return NO_SPEED if m.feed_mode == PER_TURN and m.speed == 0.0 else 0


def inverse_time(m, w, length: float) -> None:
    """In G93 the F word is the inverse of the minutes that a move of ``length`` takes."""
    if m.feed_mode == INVERSE_TIME:
        m.feed = max(0.1, length * w[F])


# --- points and frames
def dwell(m, seconds: float) -> None:
    """G4 and the dwells of cycles."""
    m.dwells += 1
    m.dwell_time += max(seconds, 0.0)
    m.waited += max(seconds, 0.0)


def end_point(m, w, end) -> int:
    """``end`` (6,): where the words lead from there, in the current coordinate system."""
    for axis in range(6):
        word = w[X + axis]
        if not math.isnan(word):
            end[axis] = word if m.absolute else end[axis] + word
    return _polar(m, w, end) if is_polar(w) else 0


def is_polar(w) -> bool:
    """True for a line whose end is given by its distance ``@`` from the origin or its angle ``^``."""
    return not (math.isnan(w[RADIUS]) and math.isnan(w[ANGLE]))


def _polar(m, w, end) -> int:
    """Polar words say where it ends, or what is added (G91); what is not given stays."""
    if end[0] == 0.0 and end[1] == 0.0 and (math.isnan(w[ANGLE]) or not m.absolute):
        return NO_ANGLE if m.absolute else NO_DIRECTION
    radius, angle = math.hypot(end[0], end[1]), math.atan2(end[1], end[0])
    if not math.isnan(w[RADIUS]):
        radius = w[RADIUS] if m.absolute else radius + w[RADIUS]
    if not math.isnan(w[ANGLE]):
        angle = math.radians(w[ANGLE]) if m.absolute else angle + math.radians(w[ANGLE])
    end[0], end[1] = polar(radius, angle)
    return 0


def rotate(x: float, y: float, degrees: float):
    """(x, y) turned about the origin."""
    return turned(x, y, math.radians(degrees))


def to_frame(m, x: float, y: float, z: float, out) -> None:
    """``out`` (3,): a point of the current coordinate system in the machine frame, m."""
    x, y, z = x + m.g92[0], y + m.g92[1], z + m.g92[2]
    if m.rotation != 0.0:
        x, y = rotate(x, y, m.rotation)
    out[0], out[1], out[2] = (x + m.g5x[0]) * m.factor, (y + m.g5x[1]) * m.factor, (z + m.g5x[2]) * m.factor


# --- straight moves
def straight_length(p, end) -> float:
    """The length that a feed counts along: of x, y, z, or of the turning axes where only they move."""
    if abs(end[0] - p[0]) > 1e-7 or abs(end[1] - p[1]) > 1e-7 or abs(end[2] - p[2]) > 1e-7:
        return math.hypot(math.hypot(end[0] - p[0], end[1] - p[1]), end[2] - p[2])
    return math.hypot(math.hypot(end[3] - p[3], end[4] - p[4]), end[5] - p[5])


def cuts_thread(motion: int) -> bool:
    """True for G33, G33.1, G74, G76 and G84: in step with the spindle."""
    return motion in (330, 331, 740, 760, 840)


def write_move(m, kind: int, end, v_f: float, row) -> None:
    """Write a move of the tip to ``end`` (6,) of the current coordinate system; the next one starts there."""
    row.kind = kind
    row.v_f = v_f
    row.n_s = turning(m)
    row.ccw = m.spindle < 0
    row.thread = kind != TRAVERSE and cuts_thread(m.motion)
    row.tool = m.in_spindle
    row.dwell, m.waited = m.waited, 0.0
    for axis in range(3):
        row.start[axis], row.rotary0[axis] = m.at[axis], m.turned[axis]
        row.rotary[axis] = math.radians(end[3 + axis] + m.g92[3 + axis] + m.g5x[3 + axis])
    to_frame(m, end[0], end[1], end[2], row.end)
    for axis in range(3):
        m.at[axis], m.turned[axis] = row.end[axis], row.rotary[axis]


def write_straight(m, kind: int, end, v_f: float, row) -> None:
    """Write a straight move; its end is what the machine was last sent to."""
    write_move(m, kind, end, v_f, row)
    row.plane, row.turns, row.clockwise, row.sweep = 0, 0, False, 0.0
    for axis in range(3):
        row.centre[axis] = 0.0
    for axis in range(6):
        m.sent[axis] = end[axis]


# --- arcs
def check_arc(m, w, has_end: bool) -> int:
    """What an arc needs on its line. ``has_end``: an end point in the plane is given."""
    first, second, third = axes(m.plane)
    has_centre = not (math.isnan(w[I]) and math.isnan(w[J]) and math.isnan(w[K]))
    has_radius = not math.isnan(w[R])
    if m.arc_not_allowed:
        return ARC_AFTER_G40
    if m.rotation != 0.0 and m.plane != 17:
        return ARC_IN_NO_PLANE
    if not has_centre and not has_radius:
        return ARC_WITHOUT_FORM
    if has_centre and has_radius:
        return ARC_WITH_TWO_FORMS
    refusal = check_feed(m, w)
    if refusal != 0:
        return refusal
    if not has_centre:
        return 0 if has_end else RADIUS_WITHOUT_END
    if not math.isnan(w[I + third]) and (m.arc_absolute or w[I + third] != 0.0):
        return ARC_ACROSS_PLANE
    if m.arc_absolute and (math.isnan(w[I + first]) or math.isnan(w[I + second])):
        return ARC_CENTRE_INCOMPLETE
    return 0


def turns_of(w, motion: int) -> int:
    """Started turns of an arc (P, else 1), negative for clockwise."""
    turns = 1 if math.isnan(w[P]) else round(w[P])
    return -turns if motion == CLOCKWISE else turns


def arc_centre(m, w, motion: int, start, end):
    """(refusal, u, v): the centre of an arc from ``start`` to ``end``, each (u, v) in the plane, by I J K or by R."""
    if not math.isnan(w[R]):
        return _by_radius(m, w[R], motion, start, end)
    first, second, _ = axes(m.plane)
    u = 0.0 if math.isnan(w[I + first]) else w[I + first]
    v = 0.0 if math.isnan(w[I + second]) else w[I + second]
    if not m.arc_absolute:
        u, v = start[0] + u, start[1] + v
    r_start, r_end = math.hypot(u - start[0], v - start[1]), math.hypot(u - end[0], v - end[1])
    if min(r_start, r_end) < (RADIUS_INCH if m.unit_code == INCH else RADIUS_MM):
        return ARC_ON_ITS_CENTRE, u, v
    tolerance = SPIRAL_INCH if m.unit_code == INCH else SPIRAL_MM
    allowed = min(max(tolerance, SPIRAL_SHARE * max(r_start, r_end)), 100.0 * tolerance)
    m.figures[0], m.figures[1], m.figures[2] = r_start, r_end, allowed
    return (ARC_OFF_ITS_CIRCLE if abs(r_start - r_end) > allowed else 0), u, v


def _by_radius(m, radius: float, motion: int, start, end):
    """(refusal, u, v) of an arc by R."""
    if end[0] == start[0] and end[1] == start[1]:
        return RADIUS_TO_START, 0.0, 0.0
    size, half = abs(radius), 0.5 * math.hypot(end[0] - start[0], end[1] - start[1])
    m.figures[0], m.figures[1] = size, half
    if half - size > (RADIUS_INCH if m.unit_code == INCH else RADIUS_MM) or size == 0.0:
        return RADIUS_TOO_SMALL, 0.0, 0.0
    u, v = centre_by_radius(start, end, radius, -1 if motion == CLOCKWISE else 1)
    return 0, u, v


def arc_length(m, end, start, centre, turn: int) -> float:
    """Length that an inverse time counts: with the radius at the start. ``start`` and ``centre`` are (u, v)."""
    first, second, third = axes(m.plane)
    angle = swept(start, (end[first], end[second]), centre, turn, 0.0)
    radius = math.hypot(start[0] - centre[0], start[1] - centre[1])
    return math.hypot(radius * angle, end[third] - m.p[third])


def write_arc(m, end, middle, turn: int, v_f: float, row) -> None:
    """Write an arc in ``row.plane`` to ``end`` (6,) about ``middle`` (3,), both in the current coordinate system."""
    write_move(m, ARC, end, v_f, row)
    to_frame(m, middle[0], middle[1], middle[2], row.centre)
    first, second, _ = axes(row.plane)
    row.turns = min(abs(turn), MOST)
    row.clockwise = turn < 0
    row.sweep = swept(
        (row.start[first], row.start[second]),
        (row.end[first], row.end[second]),
        (row.centre[first], row.centre[second]),
        turn,
    )


# --- a line
def check_move(m, w, motion: int) -> int:
    """Whether the words of a line allow G0, G1, G2 or G3."""
    if is_arc(motion):
        first, second, _ = axes(m.plane)
        return check_arc(m, w, is_polar(w) or not (math.isnan(w[X + first]) and math.isnan(w[X + second])))
    return check_feed(m, w) if motion == LINE else 0


def make_move(m, w, motion: int, end, row) -> int:
    """G0, G1, G2 or G3 to ``end`` (6,), written into ``row``. Where it is refused nothing has changed."""
    if is_arc(motion):
        first, second, third = axes(m.plane)
        start = (m.p[first], m.p[second])
        refusal, u, v = arc_centre(m, w, motion, start, (end[first], end[second]))
        if refusal != 0:
            return refusal
        keep_motion(m, motion)
        turn = turns_of(w, motion)
        if m.feed_mode == INVERSE_TIME:
            inverse_time(m, w, arc_length(m, end, start, (u, v), turn))
        row.plane = m.plane
        write_arc(m, end, from_plane(m.plane, u, v, m.p[third]), turn, feed_speed(m), row)
    elif motion == LINE:
        keep_motion(m, motion)
        if m.feed_mode == INVERSE_TIME:
            inverse_time(m, w, straight_length(m.p, end))
        write_straight(m, FEED, end, feed_speed(m), row)
    else:
        keep_motion(m, motion)
        write_straight(m, TRAVERSE, end, 0.0, row)
    m.arc_not_allowed = False
    m.initial_level = math.nan
    for axis in range(6):
        m.p[axis] = end[axis]
    return 0
