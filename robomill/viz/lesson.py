"""The lesson's small figure: determinant and largest compliance on the way to the edge of the workspace."""

from robomill.arrays import FloatArray
from robomill.viz.chart import Chart
from robomill.viz.theme import axis, figure, palette


def ray_figure(
    radius: FloatArray,
    here: int,
    titles: tuple[str, str, str],
    curves: tuple[FloatArray, FloatArray],
    *,
    dark: bool,
) -> Chart:
    """Two curves (m,), one above the other, against radius (m,), marked at ``here``; titles of radius and curves."""
    p = palette(dark)
    fig = figure(dark=dark, height=250, revision="ray", showlegend=False, margin={"l": 8, "r": 8, "t": 8, "b": 8})
    for values, colour, suffix, title in zip(curves, (p.accent, p.caution), ("", "2"), titles[1:], strict=True):
        axes = {"xaxis": f"x{suffix}", "yaxis": f"y{suffix}"}
        hover = f"{title}: %{{y:.3f}}<extra></extra>"
        fig.lines(radius, values, {"color": colour, "width": 3}, hovertemplate=hover, **axes)
        fig.dots([radius[here]], [values[here]], {"color": p.text, "size": 12}, hoverinfo="skip", **axes)
        top = suffix == ""
        domain = [0.56, 1.0] if top else [0.0, 0.44]
        below = "" if top else titles[0]
        fig.layout[f"xaxis{suffix}"] = axis(below, dark=dark, anchor=f"y{suffix}", nticks=5, showticklabels=not top)
        fig.layout[f"yaxis{suffix}"] = axis(title, dark=dark, anchor=f"x{suffix}", domain=domain, nticks=4)
    return fig
