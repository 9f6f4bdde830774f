"""G and M codes by modal group: words of one group exclude one another on a line.

G codes are ten times their number (G41.1 -> 411).
"""

LETTERS = "xyzabcijkrfspql@^"
"""The words of a line as the rules take them: values of these letters (``@ ^``: polar), NaN where not given,"""
X, _, Z, A, B, C, I, J, K, R, F, S, P, Q, L, RADIUS, ANGLE = range(len(LETTERS))  # noqa: E741
G_GROUP, M_GROUP, WIDTH = len(LETTERS), len(LETTERS) + 16, len(LETTERS) + 27
"""then the G codes by modal group from ``G_GROUP`` on and the M codes by modal group from ``M_GROUP`` on."""

NON_MODAL, MOTION, PLANE, DISTANCE, ARC_DISTANCE, FEED_MODE, UNITS, COMPENSATION = 0, 1, 2, 3, 4, 5, 6, 7
LENGTH, RETRACT, COORDINATES, CONTROL, SPINDLE_MODE, DIAMETER = 8, 10, 12, 13, 14, 15

G_GROUPS: dict[int, int] = {
    code: group
    for group, codes in (
        (NON_MODAL, (40, 53, 100, 280, 281, 300, 301, 520, 530, 920, 921, 922, 923)),
        (MOTION, (0, 10, 20, 30, 50, 51, 52, 330, 331, 382, 383, 384, 385, 730, 740, 760, *range(800, 900, 10))),
        (PLANE, (170, 180, 190, 171, 181, 191)),
        (DISTANCE, (900, 910)),
        (ARC_DISTANCE, (901, 911)),
        (FEED_MODE, (930, 940, 950)),
        (UNITS, (200, 210)),
        (COMPENSATION, (400, 410, 411, 420, 421)),
        (LENGTH, (430, 431, 432, 490)),
        (RETRACT, (980, 990)),
        (COORDINATES, (540, 550, 560, 570, 580, 590, 591, 592, 593)),
        (CONTROL, (610, 611, 640)),
        (SPINDLE_MODE, (960, 970)),
        (DIAMETER, (70, 80)),
    )
    for code in codes
}

STOP, IO, TOOL, SPINDLE, COOLANT, OVERRIDE, USER = 4, 5, 6, 7, 8, 9, 10

M_GROUPS: dict[int, int] = {
    code: group
    for group, codes in (
        (STOP, (0, 1, 2, 30, 60)),
        (IO, range(62, 69)),
        (TOOL, (6, 61)),
        (SPINDLE, (3, 4, 5, 19, 70, 71, 72, 73)),
        (COOLANT, (7, 8, 9)),
        (OVERRIDE, range(48, 54)),
        (USER, range(100, 200)),
    )
    for code in codes
}

PROBES = frozenset({382, 383, 384, 385})
NEEDS_AXES = frozenset({100, 280, 300, 520, 920})
"""Non-modal words that use the axis words of their line."""


def g_name(code: int) -> str:
    """``411`` -> ``"G41.1"``."""
    return f"G{code // 10}.{code % 10}" if code % 10 else f"G{code // 10}"
