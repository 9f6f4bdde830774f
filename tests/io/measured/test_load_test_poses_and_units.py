"""Load tests with a slip in them, and as a UR, a KUKA or a FANUC shows poses; simulated on five arms from scratch."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robomill.errors import LoadTestError
from robomill.io.measured.load_tests import read_findings, read_load_tests
from tests.identification.cables import Arm, Rig, as_robot, make, postures, random_six, ur_like

RIG = Rig(noise=1e-6)
INCH = 1 / 25.4  # what a length in inches reads as under mm
FIVE = {
    "kuka": Arm.of("kuka_kr270"),
    "fanuc": Arm.of("fanuc_r2000ic"),
    "ur": ur_like(),
    "random 1": random_six(1),
    "random 3": random_six(3),
}
UR, ROTVEC = ("rx", "ry", "rz"), ("rotvec_x", "rotvec_y", "rotvec_z")


def configurations(arm, name):
    if name in ("kuka", "fanuc"):
        return postures(arm, 24, np.random.default_rng(7))
    return np.random.default_rng(7).uniform(-1.2, 1.2, (24, 6))


@pytest.fixture(scope="module", params=FIVE)
def five(request):
    arm = FIVE[request.param]
    return arm, as_robot(arm, request.param), make(arm, RIG, 24, seed=5, q=configurations(arm, request.param))


def joints(made):
    return {f"theta{i + 1}_deg": np.degrees(made.q[:, i]) for i in range(6)}


def world(arm, made, turned, length=1.0):
    T = np.array([arm.frames(q)[-1] @ arm.T_FT for q in made.q])
    vectors = np.array([Rotation.from_matrix(R).as_rotvec() for R in T[:, :3, :3]])
    places = {f"{a}_mm": T[:, i, 3] * 1e3 * length for i, a in enumerate("XYZ")}
    return T, places | {f"{name}_rad": vectors[:, i] for i, name in enumerate(turned)}


def csv(made, where, *head, points=1.0, moved=1.0, pulley=None, force=1.0, also=()):
    """The file, with points, displacements and forces times what they should be."""
    columns = dict(where)
    if pulley is None:
        columns |= {f"F{a}_N": made.F[:, i] * force for i, a in enumerate("xyz")}
    else:
        columns |= {"load_N": np.linalg.norm(made.F, axis=1)}
        columns |= {f"pulley_{a}_mm": np.full(24, RIG.pulleys[0][i] * 1e3 * pulley) for i, a in enumerate("xyz")}
    for name, point in (("load_point_", RIG.load_point), ("gauge_point_", RIG.gauge_point)):
        columns |= {f"{name}{a}_mm": np.full(24, point[i] * 1e3 * points) for i, a in enumerate("xyz")}
    columns |= {f"d{a}_mm": made.moved[:, i] * 1e3 * moved for i, a in enumerate("xyz")}
    columns |= {name: np.full(24, 2.0) for name in also}
    lines = [",".join(f"{v:.9g}" for v in row) for row in zip(*columns.values(), strict=True)]
    return "\n".join([*(f"# {line}" for line in head), ",".join(columns), *lines]) + "\n"


def suspected(text, robot):
    tests = read_load_tests(text, robot)
    return {finding.code for finding in read_findings(tests, robot) if finding.level == "suspicious"}


@pytest.mark.parametrize("turned", [UR, ROTVEC])
def test_rotation_vectors_are_the_poses_of_the_simulator(five, turned):
    arm, _, made = five
    T, where = world(arm, made, turned)
    head = ("frame: tool", "angles: ur") if turned == UR else ("frame: tool",)
    F = {f"F{a}_N": made.F[:, i] for i, a in enumerate("xyz")}
    d = {f"d{a}_mm": made.moved[:, i] * 1e3 for i, a in enumerate("xyz")}
    columns = where | F | d
    lines = [",".join(f"{v:.12g}" for v in row) for row in zip(*columns.values(), strict=True)]
    tests = read_load_tests("\n".join([*(f"# {line}" for line in head), ",".join(columns), *lines]))
    A, B, C = tests.x_M[:, 3:].T
    again = Rotation.from_euler("XYZ", np.stack([A, B, C], axis=-1)).as_matrix()
    np.testing.assert_allclose(again, T[:, :3, :3], atol=1e-9)
    np.testing.assert_allclose(tests.x_M[:, :3], T[:, :3, 3], atol=1e-9)
    assert np.isnan(tests.displacement[:, 3:]).all(), "rx, ry, rz are not a rotation that was measured"


def test_rotations_beside_x_y_z_alone_are_asked_about(five):
    arm, robot, made = five
    with pytest.raises(LoadTestError, match="angles: ur"):
        read_load_tests(csv(made, world(arm, made, UR)[1], "frame: tool"), robot)


def test_degrees_under_radians_are_suspected():
    name = "kuka"
    arm, made = FIVE[name], make(FIVE[name], RIG, 24, seed=5, q=configurations(FIVE[name], name))
    where = world(arm, made, ROTVEC)[1]
    for factor, head, told in ((180 / np.pi, "rad", True), (1.0, "deg", True), (1.0, "rad", False)):
        turned = {f"{key.removesuffix('_rad')}_{head}": v * factor for key, v in where.items() if "rotvec" in key}
        places = {key: v for key, v in where.items() if "rotvec" not in key}
        F = {f"F{a}_N": made.F[:, i] for i, a in enumerate("xyz")}
        d = {f"d{a}_mm": made.moved[:, i] * 1e3 for i, a in enumerate("xyz")}
        columns = places | turned | F | d
        lines = [",".join(f"{v:.9g}" for v in row) for row in zip(*columns.values(), strict=True)]
        tests = read_load_tests("\n".join(["# frame: tool", ",".join(columns), *lines]))
        assert ("pose-unit" in [finding.code for finding in tests.findings]) == told


@pytest.mark.parametrize("also", [("S", "T"), ("CONFIG",)])
def test_what_a_controller_says_of_the_posture_is_named_as_not_read(also):
    arm, robot = FIVE["kuka"], as_robot(FIVE["kuka"], "kuka")
    made = make(arm, RIG, 24, seed=5, q=configurations(arm, "kuka"))
    tests = read_load_tests(csv(made, world(arm, made, ROTVEC)[1], "frame: tool", also=also), robot)
    (said,) = [finding for finding in tests.findings if finding.code == "posture-not-read"]
    assert (said.level, said.count) == ("warning", len(also))
    assert all(name in said.message for name in also)
    assert not [finding for finding in tests.findings if finding.code == "passed-over"]


def test_sound_tests_rouse_no_suspicion(five):
    _, robot, made = five
    assert suspected(csv(made, joints(made)), robot) == set()
    assert suspected(csv(made, joints(made), pulley=1.0), robot) == set()


@pytest.mark.parametrize("moved", [1e3, 25.4, INCH, 1e-3])
def test_displacements_in_another_unit_are_suspected(five, moved):
    _, robot, made = five
    for other in (robot, robot.replace(C_theta=robot.C_theta * 2.0), robot.replace(C_theta=robot.C_theta / 2.0)):
        assert suspected(csv(made, joints(made), moved=moved), other) == {"unit"}


@pytest.mark.parametrize(("points", "pulley"), [(INCH, None), (INCH, INCH), (1.0, INCH)])
def test_points_and_pulleys_in_inches_are_suspected(five, points, pulley):
    _, robot, made = five
    assert "length-unit" in suspected(csv(made, joints(made), points=points, pulley=pulley), robot)


@pytest.mark.parametrize("length", [INCH, 1e-3, 25.4])
def test_poses_in_another_unit_are_refused_with_what_they_may_be(length):
    arm, robot = FIVE["kuka"], as_robot(FIVE["kuka"], "kuka")
    made = make(arm, RIG, 24, seed=5, q=configurations(arm, "kuka"))
    read_load_tests(csv(made, world(arm, made, ROTVEC)[1], "frame: tool"), robot)
    slip = {INCH: "in under a header in mm", 1e-3: "m under a header in mm", 25.4: "mm under a header in in"}[length]
    with pytest.raises(LoadTestError, match=f"read as {slip}"):
        read_load_tests(csv(made, world(arm, made, ROTVEC, length)[1], "frame: tool"), robot)
