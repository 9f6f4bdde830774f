"""The machined surface as a turnable figure, coloured by its signed error."""

import numpy as np

from robomill.arrays import FloatArray
from robomill.simulation.enlarged import Enlarged
from robomill.units import decimals, from_si, unit_label
from robomill.viz.chart import Chart
from robomill.viz.theme import DIVERGING, axis3d, colour_bar, figure, palette

MAX_CELLS = 60_000
EYE = {"x": -0.8, "y": -1.15, "z": 0.95}  # from where it is seen until it is turned


def thinned(x: FloatArray, y: FloatArray, *fields: FloatArray) -> tuple[FloatArray, ...]:
    """Every k-th cell, so that at most ``MAX_CELLS`` are sent to the screen; the result itself stays whole."""
    step = max(1, int(np.ceil(np.sqrt(len(x) * len(y) / MAX_CELLS))))
    return (x[::step], y[::step], *[f[::step, ::step] for f in fields])


def surface_figure(shown: Enlarged, limit: float, unit: str, *, dark: bool, height: int = 460) -> Chart:
    """The drawn heights in ``unit``, coloured by the error up to +-``limit`` m; to be turned with the mouse."""
    drawn = [from_si(v, unit) for v in (shown.drawn.x, shown.drawn.y, shown.drawn.z)]
    x, y, z, error = thinned(*drawn, from_si(shown.error, unit))
    shown_limit = float(from_si(limit, unit))
    p = palette(dark)
    revision = "surface-iso"
    fig = figure(dark=dark, height=height, revision=revision, margin={"l": 0, "r": 0, "t": 0, "b": 0})
    colour = np.nan_to_num(error.T).astype(np.float32)
    fig.add(
        "surface",
        x=x.astype(np.float32),
        y=y.astype(np.float32),
        z=z.T.astype(np.float32),
        surfacecolor=colour,
        cmin=-shown_limit,
        cmax=shown_limit,
        colorscale=DIVERGING,
        lighting={"ambient": 0.62, "diffuse": 0.5, "specular": 0.08, "roughness": 0.8, "fresnel": 0.05},
        lightposition={"x": -400, "y": -800, "z": 1500},
        contours={a: {"highlight": False} for a in "xyz"},
        colorbar=colour_bar(f"Error, {unit_label(unit)} (+ material left, − too deep)", dark=dark, len=0.8, x=0.97),
        customdata=colour,
        name="machined",
        hovertemplate=f"x %{{x:.2f}}, y %{{y:.2f}}, z %{{z:.3f}} {unit}<br>"
        f"error %{{customdata:+.{decimals(unit, 3)}f}} {unit_label(unit)}<extra></extra>",
    )
    height_span = max(float(np.nanmax(z) - np.nanmin(z)), 1e-9)
    span = max(float(np.ptp(x)), float(np.ptp(y)))
    stretch = min(max(0.10 * span / height_span, 1.0), 4.0)
    fig.lay_out(
        scene={
            "xaxis": axis3d(f"x<sub>W</sub>, {unit}", dark=dark),
            "yaxis": axis3d(f"y<sub>W</sub>, {unit}", dark=dark),
            "zaxis": axis3d(f"z<sub>W</sub>, {unit}", dark=dark, nticks=3),
            "uirevision": revision,
            "dragmode": "turntable",
            "aspectmode": "manual",
            "aspectratio": {
                "x": 2.4 * np.ptp(x) / span,
                "y": 2.4 * np.ptp(y) / span,
                "z": 2.4 * stretch * height_span / span,
            },
            "camera": {
                "eye": EYE,
                "up": {"x": 0.0, "y": 0.0, "z": 1.0},
                "projection": {"type": "orthographic"},
            },
        },
        font={"color": p.text},
    )
    return fig
