"""The drawn tool as a solid."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.viz.rendered.posed import tool_solids


@pytest.mark.parametrize(
    "cutter",
    [
        Cutter("flat", 0.008),
        Cutter("ball", 0.008),
        Cutter("bull", 0.008, corner_radius=0.001),
        Cutter("chamfer", 0.008, tip_angle=np.pi / 2),
    ],
)
def test_the_drawn_tool_is_closed_and_stands_on_its_tip(cutter: Cutter) -> None:
    trimesh = pytest.importorskip("trimesh")
    tip, k = np.array([0.01, 0.02, -0.002]), np.array([0.0, np.sin(0.3), np.cos(0.3)])
    for solid in tool_solids(cutter, tip, k, 0.09):
        mesh = trimesh.Trimesh(solid.points, solid.faces.astype(int))
        mesh.merge_vertices()
        mesh.update_faces(mesh.nondegenerate_faces())
        height = (np.asarray(solid.points) * 1e-3 - tip) @ k
        assert height.min() >= -1e-9
        if solid.role == "cutter":
            assert height.min() == pytest.approx(0.0, abs=1e-9)
            across = np.linalg.norm((np.asarray(solid.points) * 1e-3 - tip) - height[:, None] * k, axis=1)
            assert across.max() == pytest.approx(cutter.radius)
            assert (across <= cutter.radius_at(np.maximum(height, 0.0)) + 1e-9).all()
        assert mesh.is_watertight
