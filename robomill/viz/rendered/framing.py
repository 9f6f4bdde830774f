"""A scene that fills its frame: seen in parallel from one side, its points on so much of the picture, without axes."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray
from robomill.viz.solids import Said

FILL = 0.8  # of the frame, in the direction that is tighter
STEP = 1.06  # the scale goes in steps of this factor, so that it stands still while the arm moves a little
PAD = 0.08  # of what is drawn, beyond it: the box in which plotly draws


def framed(points: FloatArray, eye: ArrayLike, aspect: float) -> dict[str, Any]:
    """Layout of a plotly scene of points (m, 3), looked at from ``eye`` (3,), in a frame ``aspect`` as wide as high.

    Plotly shows a parallel scene one unit up and down from its middle; ``aspectratio`` says how long its box is.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    pad = PAD * float((high - low).max())
    low, high = low - pad, high + pad
    right, up = screen(np.asarray(eye, dtype=float))
    seen = np.stack([points @ right, points @ up], axis=1)
    span = np.maximum(np.ptp(seen, axis=0), 1e-6)
    scale = FILL * float(np.min(2.0 * np.array([aspect, 1.0]) / span))
    scale = STEP ** np.floor(np.log(scale) / np.log(STEP))
    middle = 0.5 * (seen.min(axis=0) + seen.max(axis=0)) - np.array([right, up]) @ (0.5 * (low + high))
    centre = scale * (middle[0] * right + middle[1] * up)
    axes = {f"{name}axis": {"visible": False, "range": [low[i], high[i]]} for i, name in enumerate("xyz")}
    return {
        **axes,
        "aspectmode": "manual",
        "aspectratio": dict(zip("xyz", (scale * (high - low)).tolist(), strict=True)),
        "camera": {
            "eye": dict(zip("xyz", (np.asarray(eye, dtype=float) + centre).tolist(), strict=True)),
            "center": dict(zip("xyz", centre.tolist(), strict=True)),
            "projection": {"type": "orthographic"},
        },
    }


def signs(said: list[Said], background: str) -> list[dict[str, Any]]:
    """Words at points of a scene, each on a ground of its own, so that they can be read before whatever they meet."""
    return [
        {
            **dict(zip("xyz", np.asarray(at, dtype=float).tolist(), strict=True)),
            "text": word,
            "showarrow": False,
            "font": {"color": colour, "size": 16},  # some are shown smaller, in a narrow column
            "bgcolor": background,
            "borderpad": 2,
        }
        for at, word, colour in said
        if word
    ]


def screen(eye: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Unit vectors to the right and up on the screen, seen from ``eye`` with z upwards."""
    back = eye / np.linalg.norm(eye)
    right = np.cross([0.0, 0.0, 1.0], back)
    right /= np.linalg.norm(right)
    return right, np.cross(back, right)
