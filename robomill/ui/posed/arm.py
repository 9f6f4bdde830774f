"""The arm as a figure on any page: built once for equal scenes, a classroom sees the same ones."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from robomill.arrays import digest
from robomill.simulation.result import SimulationResult
from robomill.ui import pieces, session, shell
from robomill.ui.work import cached
from robomill.units import format_times
from robomill.viz.arm import ArmScene, arm_figure, displacement_scale
from robomill.viz.views import arm_scene

if TYPE_CHECKING:
    from robomill.viz.chart import Chart


def arm(
    scene: ArmScene,
    key: str,
    words: tuple[str, str],
    height: int,
    zoom: float = 1.0,
    more: tuple[Any, Callable[[Chart, bool], Any]] | None = None,
) -> None:
    """The arm with its caption and what a screen reader says (``words``).

    ``more``: what else the figure depends on, and what adds it to the figure, light or dark.
    """
    dark, view = shell.dark(), session.project().view
    scene = replace(scene, unit=view.of("m"))

    def draw() -> Chart:
        fig = arm_figure(scene, dark=dark, height=height, revision=key, zoom=zoom)
        if more is not None:
            more[1](fig, dark)
        return fig

    kept = (digest((scene, None if more is None else more[0])), dark)
    pieces.figure(cached.kept_figure(key, kept, draw), key, caption=words[0], alt=words[1])


def arm_at(
    result: SimulationResult, i: int, key: str, height: int, zoom: float = 1.0, aspect: float | None = None
) -> None:
    """The arm as it stands at sample ``i`` of a run, with force and displacement; it fills a frame of an ``aspect``."""
    scene = replace(arm_scene(result, i, session.project().view.length), aspect=aspect)
    drawn = format_times(displacement_scale(result.delta[i], scene.frames))
    lost = "" if result.reached.all() else " Grey dots: out of reach."
    caption = f"Blue: force on the tool. Orange: displacement, shown {drawn}.{lost}"
    arm(scene, key, (caption, "The arm, the part and the path with force and displacement."), height, zoom)
