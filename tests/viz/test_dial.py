"""The dial: the feed up, its left on the left."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from robomill.viz.dial import Dial, dial_figure


def dial(**changes: Any) -> dict[str, Any]:
    """The dial of a full slot as JSON."""
    values: dict[str, Any] = {
        "phi_st": 0.0,
        "phi_ex": 180.0,
        "depth": 2.0,
        "unit": "mm",
        "force": np.array([-63.5, 110.4, -23.3]),
        "scale": 100.0,
        **changes,
    }
    return dict(json.loads(dial_figure(Dial(**values), dark=False).figure.to_json())["layout"])


def test_the_dial_has_the_feed_up_and_its_left_on_the_left() -> None:
    arrow = next(a for a in dial()["annotations"] if a.get("arrowwidth") == 3.4)
    assert arrow["x"] == pytest.approx(-1.104), "feed-normal is the left of the feed"
    assert arrow["y"] == pytest.approx(-0.635), "the feed force holds the tool back"
    texts = [a.get("text", "") for a in dial()["annotations"]]
    assert "180°" in texts
    assert "127 N across, 23 N into the part" in texts
    assert "in air" in [a.get("text") for a in dial(force=np.zeros(3), engaged=False)["annotations"]]
