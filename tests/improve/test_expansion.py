"""Deviations as they go with uncertain numbers: how far out it is asked whether the arm reaches; sag that is added."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import robomill as rm
from robomill.improve import expansion
from robomill.improve.expansion import Expansion

STD = np.array([0.5e-3, 0.2e-3, 1.0])


@pytest.mark.parametrize(("judged", "reaches"), [([True, True], False), ([True, False], True)])
@pytest.mark.parametrize("way", [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.8, -0.6), (-0.6, -0.8)])
def test_a_single_draw_that_lies_farthest_out_and_is_not_reached_is_found(
    monkeypatch: pytest.MonkeyPatch, way: tuple[float, float], judged: list[bool], reaches: bool
) -> None:
    """In standard deviations of lengths and places, of all of them together: by itself none need be the largest. What
    is not judged need not be reached."""
    rng = np.random.default_rng(4)
    angle, size = rng.uniform(-np.pi, np.pi, 900), 2.0 * np.sqrt(rng.random(900))
    change = np.column_stack([size * np.cos(angle), size * np.sin(angle), rng.normal(size=900)]) * STD
    change[637, :2] = 2.1 * np.array(way) * STD[:2]

    def configurations(draw: np.ndarray) -> SimpleNamespace:
        far = float((draw / STD)[:2] @ way) > 2.05
        return SimpleNamespace(reached=np.array([[True, not far]]))

    monkeypatch.setattr(expansion, "changed", lambda unsure, draw: draw)
    own = SimpleNamespace(
        geometry=(0, 1),
        unsure=SimpleNamespace(std=STD),
        screen=SimpleNamespace(judged=np.array(judged)),
        at=SimpleNamespace(configurations=configurations),
    )
    assert Expansion.reaches(own, change) == reaches  # type: ignore[arg-type]
    assert Expansion.reaches(own, np.delete(change, 637, axis=0))  # type: ignore[arg-type]


def test_what_the_links_weight_does_goes_with_the_compliances_too() -> None:
    """Heavy links whose sag is added: draws of compliances and lengths, against runs with those numbers."""
    setup = rm.load_setup("paper_flute").replace(step=10e-3, cell=5e-4)
    links = rm.LinkMasses(mass=np.full(5, 60.0), centre=np.full((5, 3), -0.05))
    setup = setup.replace(links=links, add_sag=True)
    nothing = {"force": 0.0, "part": 0.0, "part_turn": 0.0, "tool_length": 0.0}
    found = rm.uncertainty(setup, rm.Spread(compliance=0.1, lengths=1e-3, **nothing), samples=24, seed=2)
    arm, at = setup.robot, {each.key: i for i, each in enumerate(found.inputs)}
    light = rm.simulate(setup.replace(add_sag=False)).max_deviation
    for k in range(0, 24, 4):
        changed = {key: found.change[k, i] for key, i in at.items()}
        C = [C + changed[f"C_theta_{n}"] for n, C in zip(arm.joint_numbers, arm.C_theta, strict=True)]
        a, d = ([v + changed.get(f"{s}_{i}", 0.0) for i, v in enumerate(getattr(arm, s), 1)] for s in "ad")
        run = rm.simulate(setup.replace(robot=arm.replace(C_theta=C, a=a, d=d)))
        assert found.tip[k] == pytest.approx(run.max_deviation, rel=1e-4)
        assert abs(run.max_deviation - light) > 0.2 * light
