"""Speed of kinematics, compliance and maps against peers in the same run, one thread each.

The peers are more general than our special case: Pinocchio does any tree of joints, EAIK any arm with a decomposition.
Run with ``pytest -m benchmark -s tests/benchmarks/test_kinematics.py``.
"""

import os
import subprocess
import sys
from importlib.metadata import version

import numpy as np
import pytest

import robomill as rm
from robomill.compliance.cartesian import pose_jacobian_compliance
from robomill.kinematics.choice import every
from robomill.kinematics.decoupled import decoupled
from robomill.kinematics.forward import joint_frames
from robomill.workspace.fields import compliance_map
from robomill.workspace.grid import PAPER_BOX, box_grid, plane_grid
from tests.benchmarks.clock import fastest

pytestmark = pytest.mark.benchmark

PINOCCHIO_RATIO, EAIK_RATIO = 8.0, 8.0
BOX_SECONDS, PLANE_SECONDS = 0.25, 0.030
GIB = 1 << 30


def report(title, rows):
    print(f"\n{title}")
    for name, value in rows:
        print(f"  {name:<64} {value}")


def thousand(rate):
    return f"{rate / 1e3:9.0f} k/s"


def configurations(robot, count):
    return np.random.default_rng(0).uniform(robot.limits[:, 0], robot.limits[:, 1], (count, robot.n))


def pinocchio_loop(robot, theta):
    """A Python loop over Pinocchio for pose and Jacobian, with C batched by NumPy."""
    pin = pytest.importorskip("pinocchio")
    chain = robot.chain
    model, parent, placement = pin.Model(), 0, pin.SE3(np.array(chain.T_0))
    for i in range(robot.n):
        parent = model.addJoint(parent, pin.JointModelRZ(), placement, str(i))
        placement = pin.SE3(np.array(chain.E[i]))
    tool = model.addFrame(pin.Frame("tool", parent, placement, pin.FrameType.OP_FRAME))
    data = model.createData()
    q = chain.sign * theta + chain.offset
    world = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED

    def run():
        J = np.empty((len(q), 6, robot.n))
        T = np.empty((len(q), 4, 4))
        for i, row in enumerate(q):
            J[i] = pin.computeFrameJacobian(model, data, row, tool, world)
            T[i] = pin.updateFramePlacement(model, data, tool).homogeneous
        J *= chain.sign
        J_v = J[:, :3]
        return T, J, (J_v * robot.C_theta) @ np.swapaxes(J_v, 1, 2)

    return run


def eaik_robot(robot):
    homogeneous = pytest.importorskip("eaik.IK_Homogeneous")
    return homogeneous.HomogeneousRobot(joint_frames(robot, np.zeros(robot.n)))


def test_forward_kinematics_jacobian_and_compliance():
    robot = rm.load_robot("slavkovic_5r")
    theta = configurations(robot, 100_000)
    loop = pinocchio_loop(robot, theta[:20_000])
    for ours, theirs in zip(pose_jacobian_compliance(robot, theta[:20_000]), loop(), strict=True):
        np.testing.assert_allclose(ours, theirs, atol=1e-12)
    ours = 100_000 / fastest(lambda: pose_jacobian_compliance(robot, theta), 9)
    theirs = 20_000 / fastest(loop, 3)
    report(
        "FK + Jacobian + 3 x 3 compliance of 100 000 configurations of the 5R",
        [
            ("robomill", thousand(ours)),
            (f"Pinocchio {version('pin')} in a Python loop, C batched by NumPy", thousand(theirs)),
            ("ratio", f"{ours / theirs:9.1f}"),
        ],
    )
    assert ours >= PINOCCHIO_RATIO * theirs


@pytest.mark.parametrize("name", ["slavkovic_5r", "kuka_kr500"])
def test_closed_form_inverse_kinematics(name):
    """The answer people ask for, within limits and checked; and all eight, each checked, as the peer gives them."""
    robot = rm.load_robot(name)
    T_MT = rm.tool_pose(robot, configurations(robot, 100_000))
    peer = eaik_robot(robot)
    few = [np.array(T) for T in T_MT[:10_000]]
    ours = 100_000 / fastest(lambda: rm.inverse_kinematics(robot, T_MT, spin="fixed"), 7)
    all_of_them = 100_000 / fastest(lambda: every(robot, decoupled(robot), T_MT), 7)
    theirs = 10_000 / fastest(lambda: peer.IK_batched(few, num_worker_threads=1), 3)
    solutions = [len(solution.Q) for solution in peer.IK_batched(few[:200], num_worker_threads=1)]
    rows = [
        ("robomill, nearest within limits, checked by forward kinematics", thousand(ours)),
        ("robomill, 8 branches, each checked by forward kinematics", thousand(all_of_them)),
        (f"EAIK {version('eaik')} batched, one worker, {np.mean(solutions):.1f} solutions a pose", thousand(theirs)),
        ("ratio", f"{ours / theirs:9.1f}"),
        ("ratio for 8 branches", f"{all_of_them / theirs:9.1f}"),
    ]
    report(f"Closed-form inverse kinematics of 100 000 poses, {name}", rows)
    assert ours >= EAIK_RATIO * theirs
    assert all_of_them >= EAIK_RATIO * theirs


def test_maps_of_the_paper_box_and_plane():
    robot = rm.load_robot("slavkovic_5r")
    box, plane = box_grid(*PAPER_BOX, 0.010), plane_grid("z", 0.0, *PAPER_BOX, 0.010)
    assert (box.cells, plane.cells) == (376_431, 121 * 61)
    of_box = fastest(lambda: compliance_map(robot, box), 5)
    of_plane = fastest(lambda: compliance_map(robot, plane), 9)
    peer = eaik_robot(robot)
    field = compliance_map(robot, plane)
    theta = field.theta.reshape(-1, 5)[:3000]
    poses = [np.array(T) for T in rm.tool_pose(robot, theta)]
    loop = pinocchio_loop(robot, theta)
    of_peers = fastest(lambda: (peer.IK_batched(poses, num_worker_threads=1), loop()), 3) / 3000
    report(
        "Reach + IK + J + joint shares + det(J)",
        [
            (f"paper's box, 10 mm, {box.cells} poses", f"{of_box:9.3f} s"),
            (f"plane 121 x 61, {plane.cells} poses", f"{of_plane * 1e3:9.2f} ms"),
            (
                f"EAIK {version('eaik')} + Pinocchio {version('pin')} loop, same poses, without shares",
                f"{of_peers * box.cells:9.3f} s",
            ),
            ("ratio on the box", f"{of_peers * box.cells / of_box:9.1f}"),
        ],
    )
    assert of_box < BOX_SECONDS
    assert of_plane < PLANE_SECONDS


def test_memory_of_the_paper_box():
    code = (
        "import resource, robomill as rm\n"
        "from robomill.workspace.fields import compliance_map\n"
        "from robomill.workspace.grid import PAPER_BOX, box_grid\n"
        "compliance_map(rm.load_robot('slavkovic_5r'), box_grid(*PAPER_BOX, 0.010))\n"
        "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024)\n"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment)
    peak = int(out.stdout)
    report("Peak memory of the process that maps the paper's box", [("resident", f"{peak / GIB:9.2f} GiB")])
    assert peak < GIB
