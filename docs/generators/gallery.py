"""A picture of each sample, drawn from its run by Matplotlib, once for light pages and once for dark ones."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

import robomill as rm
from robomill.io.samples import samples_dir
from robomill.simulation.result import SimulationResult
from robomill.units import from_si
from robomill.viz.theme import DIVERGING, DIVERGING_DARK, JOINT_COLOURS, JOINT_COLOURS_DARK

SAMPLES = ("paper_flute", "heart", "spiral", "word", "pocket_arcs", "two_tools")


@dataclass(frozen=True)
class Look:
    """The colours of one theme."""

    name: str
    text: str
    muted: str
    panel: str
    joints: tuple[str, ...]
    signed: list[list[Any]]


LOOKS = (
    Look("light", "#1F2A30", "#6B7780", "#FFFFFF", JOINT_COLOURS, DIVERGING),
    Look("dark", "#E6EAED", "#9AA6AE", "#131416", JOINT_COLOURS_DARK, DIVERGING_DARK),
)


def pages(pictures: Path) -> dict[str, str]:
    """The generated piece by name; its pictures are written into ``pictures``."""
    said = []
    for name in SAMPLES:
        setup = rm.load_setup(samples_dir() / name)
        result = rm.simulate(setup)
        for look in LOOKS:
            _drawn(result, look).savefig(pictures / f"{name}_{look.name}.png", dpi=110, facecolor=look.panel)
        said.append(_section(name, result))
    return {"gallery.md": "\n\n".join(said)}


def _section(name: str, result: SimulationResult) -> str:
    setup = result.setup
    worst = f"{from_si(result.max_deviation, 'mm'):.3f} mm at line {result.worst_block}"
    alt = f"{setup.name}: the error of the surface seen from above, the middle section, the shares of the joints."
    pictures = "\n".join(f"![{alt}](pictures/{name}_{look.name}.png){{.only-{look.name}}}" for look in LOOKS)
    return (
        f"## {setup.name}\n\n{setup.description}\n\n{pictures}\n\n"
        f"{result.verdict.sentence} The tip is off its path by at most {worst}.\n\n"
        f"```sh\nrobomill simulate {name}\n```"
    )


def _drawn(result: SimulationResult, look: Look) -> Figure:
    """Surface error from above, the section in the middle, and the joints' shares along the path."""
    wide = np.ptp(result.error.x) > 1.6 * np.ptp(result.error.y)
    fig = Figure(figsize=(9.2, 6.0 if wide else 5.4), layout="constrained")
    if wide:
        first, second = fig.subfigures(2, 1, height_ratios=(1.0, 0.9))
        section, shares = second.subplots(1, 2)
    else:
        first, second = fig.subfigures(1, 2, width_ratios=(1.25, 1.0))
        section, shares = second.subplots(2, 1)
    _surface(first, result, look)
    _section_axes(section, result, look)
    _shares_axes(shares, result, look)
    return fig


def _surface(fig: Any, result: SimulationResult, look: Look) -> None:
    error, limit = result.error, float(from_si(result.setup.tolerance, "mm"))
    axes = fig.subplots()
    colours = LinearSegmentedColormap.from_list("signed", [(at, colour) for at, colour in look.signed])
    edges = [float(from_si(v, "mm")) for v in (error.x[0], error.x[-1], error.y[0], error.y[-1])]
    values = np.where(error.cut, from_si(error.error, "mm"), np.nan).T
    image = axes.imshow(
        values, origin="lower", extent=edges, cmap=colours, vmin=-limit, vmax=limit, interpolation="nearest"
    )
    bar = fig.colorbar(image, ax=axes, location="bottom", shrink=0.8, aspect=32)
    bar.set_label("error of the surface, mm: + material left, − cut too deep", color=look.text, fontsize=9)
    bar.ax.tick_params(colors=look.muted, labelsize=8)
    bar.outline.set_visible(False)
    _dress(axes, look, "X, mm", "Y, mm", "Surface against the ideal one")


def _section_axes(axes: Any, result: SimulationResult, look: Look) -> None:
    section = result.groove(0.5 * float(result.path.s[-1]))
    w = from_si(section.w, "mm")
    span = np.abs(w) <= 1.6 * from_si(max(cutter.radius for cutter in result.tooling.cutters), "mm")
    axes.plot(w[span], from_si(section.z_ideal, "mm")[span], "--", color=look.muted, lw=1.2, label="ideal")
    axes.plot(w[span], from_si(section.z_machined, "mm")[span], color=look.joints[4], lw=1.8, label="machined")
    _dress(axes, look, "left of the feed, mm", "Z, mm", f"Section at mid-path, line {section.block}")
    _legend(axes, look)


def _shares_axes(axes: Any, result: SimulationResult, look: Look) -> None:
    path = result.path
    feed = np.where(path.cutting & result.answered, 1.0, np.nan)
    s = from_si(path.s, "mm")
    way = result.delta / np.where(result.deviation > 0.0, result.deviation, np.nan)[:, None]
    share = np.einsum("mj,mij->mi", way, result.delta_joint)  # along the deviation, so that they add up to its size
    for i, number in enumerate(result.setup.robot.joint_numbers):
        if np.nanmax(np.abs(share[:, i] * feed)) > 0.01 * result.max_deviation:
            axes.plot(s, from_si(share[:, i], "mm") * feed, color=look.joints[i], lw=1.6, label=f"joint {number}")
    axes.plot(s, from_si(result.deviation, "mm") * feed, color=look.text, lw=1.8, label="all")
    axes.set_ylim(min(0.0, axes.get_ylim()[0]), None)
    _dress(axes, look, "length cut, mm", "mm", "Deviation and its shares")
    _legend(axes, look)


def _dress(axes: Any, look: Look, x: str, y: str, title: str) -> None:
    axes.set_facecolor(look.panel)
    axes.set_title(title, color=look.text, fontsize=10, loc="left")
    axes.set_xlabel(x, color=look.text, fontsize=9)
    axes.set_ylabel(y, color=look.text, fontsize=9)
    axes.tick_params(colors=look.muted, labelsize=8)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color(look.muted)


def _legend(axes: Any, look: Look) -> None:
    axes.legend(fontsize=8, frameon=False, labelcolor=look.text)
