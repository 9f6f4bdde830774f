"""Numbers that other programs give."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.optimize import nnls
from scipy.spatial.transform import Rotation

import robomill as rm
from generators.validation.check import Check, Compute
from generators.validation.naive import configurations, tip
from robomill.cutting.tool import Cutter
from robomill.io.samples import samples_dir
from robomill.surface.stock import Stock
from robomill.surface.zmap import cut

PAPER_ARM = "slavkovic_5r"


def _pinocchio() -> list[Check]:
    """The arm as Pinocchio's own model, joint by joint."""
    import pinocchio as pin

    robot = rm.load_robot("kuka_kr500")
    model, chain = pin.Model(), robot.chain
    parent, before = 0, np.array(chain.T_0)
    for i in range(robot.n):
        placement = pin.SE3(before[:3, :3] @ Rotation.from_euler("z", chain.offset[i]).as_matrix(), before[:3, 3])
        axis = np.array([0.0, 0.0, float(chain.sign[i])])
        parent = model.addJoint(parent, pin.JointModelRevoluteUnaligned(axis), placement, f"j{i}")
        before = np.array(chain.E[i])
    model.addFrame(pin.Frame("tip", parent, pin.SE3(before[:3, :3], before[:3, 3]), pin.FrameType.OP_FRAME))
    data, tip, worst = model.createData(), model.getFrameId("tip"), np.zeros(2)
    for theta in configurations(robot, 200):
        J = pin.computeFrameJacobian(model, data, theta, tip, pin.LOCAL_WORLD_ALIGNED)
        pin.framesForwardKinematics(model, data, theta)
        off = np.linalg.norm(data.oMf[tip].translation - rm.tool_pose(robot, theta)[:3, 3])
        worst = np.maximum(worst, [off, np.abs(J - rm.geometric_jacobian(robot, theta)).max()])
    version = f"Pinocchio {pin.__version__}"
    return [
        Check("tip of a KUKA KR500, farthest of 200", version, 0.0, float(worst[0]), "m", 1e-12, 4, 1.0),
        Check("J of the same, largest difference", version, 0.0, float(worst[1]), "1", 1e-12, 4, 1.0),
    ]


def _scipy() -> list[Check]:
    """SciPy's non-negative least squares on equations (16), with a numeric Jacobian."""
    robot = rm.load_robot(PAPER_ARM)
    tests = rm.read_load_tests(samples_dir() / "load_tests" / "nine_points.csv", robot)
    found, rows, read = rm.identify(robot, tests).C_theta, [], []
    for T, wrench, moved in zip(tests.tool_poses(robot), tests.wrench, tests.displacement):
        theta, h = rm.inverse_kinematics(robot, T).theta, 1e-6
        J = np.array([(tip(robot, theta + e) - tip(robot, theta - e)) / (2 * h) for e in h * np.eye(5)]).T
        rows.append(J * (J.T @ wrench[:3]))
        read.append(moved[:3])
    solved = nnls(np.concatenate(rows) * 1e-6, np.concatenate(read))[0] * 1e-6
    return [
        Check(
            f"C_θ{j} identified from the nine points",
            "SciPy's nnls, numeric Jacobian",
            float(solved[j - 1]),
            float(found[j - 1]),
            "1e-7 rad/(N m)",
            1e-4,
            2,
        )
        for j in range(1, 6)
    ]


def _shapely() -> list[Check]:
    """What the cutter passes over, as a union of capsules."""
    import shapely

    setup = rm.load_setup(samples_dir() / "word")
    path = setup.toolpath
    level = [
        shapely.LineString([path.p[i - 1, :2], path.p[i, :2]])
        for i in np.flatnonzero(path.cutting)
        if i and np.ptp(path.p[i - 1 : i + 1, 2]) < 1e-9 and np.ptp(path.p[i - 1 : i + 1, :2], axis=0).max() > 1e-9
    ]
    area = shapely.union_all(level).buffer(setup.cutter.radius, quad_segs=200).area
    surface = rm.simulate(setup).ideal
    depth = float(setup.stock_block.upper[2] - surface.z.min())
    return [
        Check(
            "volume of the sample word",
            f"Shapely {shapely.__version__}: union of its strokes, times the depth",
            area * depth,
            surface.removed_volume,
            "mm3",
            2e-3,
            1,
        )
    ]


def _manifold() -> list[Check]:
    """A drawn body taken from a block by a solid modeller."""
    import manifold3d

    R, depth = 4.0, 2.0
    tool = manifold3d.Manifold.cylinder(2 * depth, R, R, 512)
    points = [(10.0, 10.0), (30.0, 18.0), (24.0, 6.0)]
    passes = [manifold3d.Manifold.batch_hull([tool.translate([*p, -depth]) for p in pair]) for pair in pairwise(points)]
    block = manifold3d.Manifold.cube([40.0, 28.0, 10.0]).translate([0.0, 0.0, -10.0])
    taken = block.volume() - (block - manifold3d.Manifold.batch_boolean(passes, manifold3d.OpType.Add)).volume()
    p = np.array([[x, y, -depth] for x, y in points]) * 1e-3
    surface = cut(Stock([0.0, 0.0, -10e-3], [40e-3, 28e-3, 0.0]), 1e-4, Cutter("flat", 2e-3 * R), p)
    return [
        Check(
            "volume of two slots that meet",
            "Manifold: solids of 512 sides",
            taken * 1e-9,
            surface.removed_volume,
            "mm3",
            2e-3,
            2,
        )
    ]


def _rotations() -> list[Check]:
    A, B = 0.3, -0.5
    by_scipy = Rotation.from_euler("XYZ", [A, B, 0.0]).as_matrix()
    apart = np.abs(rm.pose_from_world([0.0, 0.0, 0.0, A, B])[:3, :3] - by_scipy).max()
    return [
        Check(
            "rotation of a tilted tool, A and B",
            "SciPy's Rotation, intrinsic XYZ",
            0.0,
            float(apart),
            "1",
            1e-14,
            4,
            1.0,
        )
    ]


PEERS: tuple[tuple[str, Compute], ...] = (
    ("pinocchio", _pinocchio),
    ("scipy", _scipy),
    ("scipy", _rotations),
    ("shapely", _shapely),
    ("manifold3d", _manifold),
)
