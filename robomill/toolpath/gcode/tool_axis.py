"""Tool axes that a line gives as a direction, as the angles A and B of ``rigid.axis_from_tilt`` that stand for them."""

import math

UNIT = 1e-2
"""I, J and K of a straight move are a tool axis where their length is 1 within this."""


def angles_of(axis: tuple[float, float, float], before: tuple[float, float]) -> tuple[float, float]:
    """A and B (degrees) with (sin B, -sin A cos B, cos A cos B) along ``axis``, the pair nearest to ``before``.

    Every axis has two pairs, (A, B) and (A + 180, 180 - B), and each may be turned on by whole turns; at A's own axis
    A may be any, and stays. So an axis that goes on steadily has angles that do. The axis must not be (0, 0, 0).
    """
    i, j, k = axis
    size = math.sqrt(i * i + j * j + k * k)
    i, j, k = i / size, j / size, k / size
    level = math.hypot(j, k)
    b = math.degrees(math.atan2(i, level))
    a = math.degrees(math.atan2(-j, k)) if level > 1e-12 else before[0]
    pairs = [(a, b), (a + 180.0, 180.0 - b)]
    near = [tuple(v + 360.0 * round((w - v) / 360.0) for v, w in zip(pair, before)) for pair in pairs]
    best = min(near, key=lambda pair: math.dist(pair, before))
    return best[0], best[1]
