"""Rules of modes, feeds, speeds and dwells, and of plain lines; ``motion_rules`` says what rules are."""

# mypy: disable-error-code="no-untyped-def, no-untyped-call"

import math

from robomill.toolpath.gcode import codes
from robomill.toolpath.gcode.codes import G_GROUP, M_GROUP, A, B, C, F, I, J, K, L, P, Q, R, S, X
from robomill.toolpath.gcode.rules.cycle_rules import cycle, is_cycle, pecks
from robomill.toolpath.gcode.rules.motion_rules import (
    INVERSE_TIME,
    LINE,
    RAPID,
    check_move,
    end_point,
    implied_motion,
    is_arc,
    is_polar,
    make_move,
)

MOTION, PLANE, DISTANCE = G_GROUP + codes.MOTION, G_GROUP + codes.PLANE, G_GROUP + codes.DISTANCE
ARC_DISTANCE, FEED_MODE = G_GROUP + codes.ARC_DISTANCE, G_GROUP + codes.FEED_MODE
UNITS, COORDINATES = G_GROUP + codes.UNITS, G_GROUP + codes.COORDINATES
RETRACT, SPINDLE_MODE = G_GROUP + codes.RETRACT, G_GROUP + codes.SPINDLE_MODE
SPINDLE, COOLANT = M_GROUP + codes.SPINDLE, M_GROUP + codes.COOLANT
NO_MOTION = 800


def set_rates(m, w) -> None:
    """G93 to G97, F and S take effect before anything else. In inverse time F belongs to its line alone."""
    if not math.isnan(w[SPINDLE_MODE]):
        m.spindle_mode = int(w[SPINDLE_MODE])
    if not math.isnan(w[FEED_MODE]):
        m.feed_mode = int(w[FEED_MODE])
        if m.feed_mode != INVERSE_TIME:
            m.feed = 0.0
    if m.feed_mode != INVERSE_TIME and not math.isnan(w[F]):
        m.feed = w[F]
    if not math.isnan(w[S]):
        m.speed = w[S]


def switch(m, w) -> None:
    """M3, M4, M5, M19 and coolants M7, M8, M9."""
    spindle, coolant = w[SPINDLE], w[COOLANT]
    if spindle in (3.0, 4.0, 5.0, 19.0):
        m.spindle = 1 if spindle == 3.0 else (-1 if spindle == 4.0 else 0)
    if coolant == 9.0:
        m.mist, m.flood = False, False
    elif not math.isnan(coolant):
        m.mist, m.flood = m.mist or coolant == 7.0, m.flood or coolant == 8.0


def set_modes(m, w) -> None:
    """G90, G91, G90.1, G91.1, G98 and G99."""
    if not math.isnan(w[DISTANCE]):
        m.absolute = w[DISTANCE] == 900.0
    if not math.isnan(w[ARC_DISTANCE]):
        m.arc_absolute = w[ARC_DISTANCE] == 901.0
    if not math.isnan(w[RETRACT]):
        m.retract_r = w[RETRACT] == 990.0


def set_plane(m, w) -> None:
    """G17, G18 and G19."""
    if not math.isnan(w[PLANE]):
        m.plane = int(w[PLANE]) // 10


def system_code(system: int) -> int:
    """The G code of a coordinate system 1 to 9: G54 to G59.3."""
    return 530 + 10 * system if system < 7 else 584 + system


def _takes(w, motion: int, has_axes: bool, has_centre: bool) -> bool:
    """True if a line has only words that its motion (-1: none) uses; cycles of which more is to be said are not."""
    if is_cycle(motion):
        turns = not (math.isnan(w[A]) and math.isnan(w[B]) and math.isnan(w[C]))
        if turns or has_centre or motion in (740, 840, 870, 880) or w[L] == 0.0 or w[Q] >= 100.0:
            return False
        return has_axes and math.isnan(w[P]) and (pecks(motion) or math.isnan(w[Q]))  # controls count dwells otherwise
    if not (math.isnan(w[P]) and math.isnan(w[Q]) and math.isnan(w[L])):
        return False
    if is_arc(motion):
        return True
    if has_centre or not math.isnan(w[R]):
        return False
    return motion in (RAPID, LINE) or (motion in (-1, NO_MOTION) and not has_axes)


def plain_line(m, w, end, rows, line: int) -> bool:
    """Do a plain line, whose words are ``w``; False if it is left to the interpreter."""
    has_centre = not (math.isnan(w[I]) and math.isnan(w[J]) and math.isnan(w[K]))
    has_axes = False
    for axis in range(6):
        has_axes = has_axes or not math.isnan(w[X + axis])
    if is_polar(w):
        if m.plane != 17 or not (math.isnan(w[X]) and math.isnan(w[X + 1])):
            return False
        has_axes = True
    motion = implied_motion(m, has_axes, has_centre) if math.isnan(w[MOTION]) else int(w[MOTION])
    if not _takes(w, motion, has_axes, has_centre):
        return False
    if is_cycle(motion) and m.keeps_heights and not (m.absolute if math.isnan(w[DISTANCE]) else w[DISTANCE] == 900.0):
        return False  # what it is read as may have to be said
    if not (math.isnan(w[UNITS]) or w[UNITS] == m.unit_code):
        return False
    if not (math.isnan(w[COORDINATES]) or w[COORDINATES] == system_code(m.system)):
        return False
    if not math.isnan(w[UNITS]):
        m.units_said = m.unit_code
    set_rates(m, w)
    switch(m, w)
    set_plane(m, w)
    set_modes(m, w)
    if motion == NO_MOTION:
        m.motion, m.initial_level = NO_MOTION, math.nan
    if motion in (-1, NO_MOTION):
        return True
    if is_cycle(motion):
        return cycle(m, w, motion, line, end, rows) == 0
    for axis in range(6):
        end[axis] = m.p[axis]
    if check_move(m, w, motion) != 0 or end_point(m, w, end) != 0:
        return False
    row = rows[m.moves]
    if make_move(m, w, motion, end, row) != 0:
        return False
    row.line = line
    m.moves += 1
    return True
