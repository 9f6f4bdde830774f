"""Cable tests as people write them down: poses by three angles, cables, pulleys, hooks and dial gauges.

The truth is the simulator of ``tests/identification/cables.py``; rotations are scipy's own.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import robomill as rm
from robomill.errors import LoadTestError
from robomill.io.measured.load_test_sheets import TEMPLATES, load_test_template, load_tests_to_csv
from robomill.io.measured.load_tests import read_load_tests, read_measured_map
from tests.identification.cables import Arm, Rig, in_tool, make

ARMS = {name: (Arm.of(name), rm.load_robot(name)) for name in ("kuka_kr270", "fanuc_r2000ic")}
RIG = Rig(noise=0.0)
MADE = {name: make(arm, RIG, 24, seed=5) for name, (arm, _) in ARMS.items()}
LETTERS = {"kuka": ("A", "B", "C"), "robomill": ("A", "B", "C"), "fanuc": ("W", "P", "R")}


def flanges(name):
    return np.array([ARMS[name][0].frames(q)[-1] for q in MADE[name].q])


def loads(T, point):
    return T[:, :3, :3] @ point + T[:, :3, 3]


def angles(R, how):
    """Degrees, in the order of ``LETTERS``."""
    turned = Rotation.from_matrix(R)
    if how == "kuka":
        return turned.as_euler("ZYX", degrees=True)  # about Z, then the new Y, then the new X
    return turned.as_euler("xyz" if how == "fanuc" else "XYZ", degrees=True)  # lower case: about fixed axes


def csv(columns, *head):
    names = ",".join(columns)
    lines = [",".join(f"{v:.9f}" if np.isfinite(v) else "" for v in row) for row in zip(*columns.values(), strict=True)]
    return "\n".join([*(f"# {line}" for line in head), names, *lines]) + "\n"


def vector(name, values, unit=""):
    values = np.broadcast_to(values, (24, 3))
    return {f"{name}{a}{unit}": values[:, i] for i, a in enumerate("xyz")}


def pose(name, how="kuka", frame="flange"):
    arm = ARMS[name][0]
    T = flanges(name) @ (np.eye(4) if frame == "flange" else arm.T_FT)
    turns = angles(T[:, :3, :3], how)
    return {
        **{f"{a}_mm": T[:, i, 3] * 1e3 for i, a in enumerate("XYZ")},
        **{f"{letter}_deg": turns[:, i] for i, letter in enumerate(LETTERS[how])},
    }


def pull(name):
    return {"load_N": np.linalg.norm(MADE[name].F, axis=1)}


def cable(name):
    return vector("cable_", MADE[name].F / np.linalg.norm(MADE[name].F, axis=1, keepdims=True))


POINTS = {
    **vector("load_point_", RIG.load_point * 1e3, "_mm"),
    **vector("gauge_point_", RIG.gauge_point * 1e3, "_mm"),
}


def moved(name):
    return vector("d", MADE[name].moved * 1e3, "_mm")


@pytest.mark.parametrize("name", ARMS)
@pytest.mark.parametrize("frame", ["flange", "tool"])
@pytest.mark.parametrize("how", LETTERS)
def test_poses_by_three_angles_are_those_of_the_simulator(name, frame, how):
    arm, robot = ARMS[name]
    head = [f"frame: {frame}"] + ([f"angles: {how}"] if how != "fanuc" else [])
    text = csv({**pose(name, how, frame), **pull(name), **cable(name), **POINTS, **moved(name)}, *head)
    tests = read_load_tests(text, robot)
    np.testing.assert_allclose(tests.tool_poses(robot), flanges(name) @ arm.T_FT, atol=1e-8)
    np.testing.assert_allclose(tests.wrench[:, :3], MADE[name].F, atol=1e-5)
    np.testing.assert_allclose(tests.force_point, np.tile(in_tool(arm, RIG.load_point), (24, 1)), atol=1e-9)
    np.testing.assert_allclose(tests.measuring_point, np.tile(in_tool(arm, RIG.gauge_point), (24, 1)), atol=1e-9)
    assert "pose-frame" in [f.code for f in tests.findings]
    stood_otherwise = (np.abs(tests.theta - MADE[name].q)[:, :3] > 1e-3).any(axis=1).sum()
    assert sum(f.count for f in tests.findings if f.code == "postures-open") > stood_otherwise


@pytest.mark.parametrize(("how", "lost"), [*(("fanuc", n) for n in "WPRXY"), *(("kuka", n) for n in "ABZ")])
def test_an_angle_or_a_place_that_is_missing_is_asked_for_by_its_column(how, lost):
    name = "fanuc_r2000ic"
    columns = {**pose(name, how), **pull(name), **cable(name), **POINTS, **moved(name)}
    del columns[next(key for key in columns if key.startswith(f"{lost}_"))]
    head = ["frame: flange"] + ([f"angles: {how}"] if how != "fanuc" else [])
    with pytest.raises(LoadTestError, match=rf"\b{lost.lower()}_(mm|deg)|\b{lost}_(mm|deg)"):
        read_load_tests(csv(columns, *head), ARMS[name][1])


def test_the_pulley_or_the_hook_and_the_pulley_give_the_cable_too():
    name = "kuka_kr270"
    arm, robot = ARMS[name]
    pulley = vector("pulley_", np.array(RIG.pulleys[0]) * 1e3, "_mm")
    hook = loads(flanges(name), RIG.load_point)
    base = {**pose(name), **pull(name), **moved(name), **pulley}
    beside = RIG.load_point + 0.03 * np.eye(3)[1]
    stated = vector("load_point_", beside * 1e3, "_mm")
    head = ("frame: flange", "angles: kuka")
    for columns, aimed in (
        ({**base, **POINTS}, True),
        ({**base, **vector("hook_", hook * 1e3, "_mm")}, True),
        ({**base, **stated, **vector("hook_", hook * 1e3, "_mm")}, False),
    ):
        tests = read_load_tests(csv(columns, *head), robot)
        np.testing.assert_allclose(tests.wrench[:, :3], MADE[name].F, atol=1e-3)
        assert tests.aimed.all() == aimed
    np.testing.assert_allclose(tests.force_point[0], in_tool(arm, beside), atol=1e-9)
    off = read_load_tests(csv({**base, **stated}, *head), robot)  # aimed from the stated point, wrong as it is
    u = np.array(RIG.pulleys[0]) - loads(flanges(name), beside)
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    np.testing.assert_allclose(off.wrench[:, :3], u * pull(name)["load_N"][:, None], atol=1e-4)


def test_hooks_that_are_not_one_point_of_the_tool_are_said():
    name = "kuka_kr270"
    hook = loads(flanges(name), RIG.load_point)
    hook[7, 2] += 0.04
    pulley = vector("pulley_", np.array(RIG.pulleys[0]) * 1e3, "_mm")
    columns = {**pose(name), **pull(name), **moved(name), **pulley, **vector("hook_", hook * 1e3, "_mm")}
    tests = read_load_tests(csv(columns, "frame: flange", "angles: kuka"), ARMS[name][1])
    (said,) = [f for f in tests.findings if f.code == "hook-scatter"]
    assert (said.level, said.line) == ("suspicious", 4 + 7)


def test_gauges_along_any_direction_give_the_same_compliances():
    name = "fanuc_r2000ic"
    arm, robot = ARMS[name]
    rng = np.random.default_rng(2)
    along = rng.standard_normal((2, 24, 3))
    along /= np.linalg.norm(along, axis=-1, keepdims=True)
    small = make(arm, Rig(noise=0.0, pull=(2.0, 6.0)), 24, seed=5)
    read = np.einsum("kmi,mi->km", along, small.moved) * 1e3
    read[1, ::3] = np.nan  # the second gauge was not there in every test
    F = small.F
    columns = {
        **pose(name, "fanuc"),
        "force_N": np.linalg.norm(F, axis=1),
        **vector("cable_", F / np.linalg.norm(F, axis=1, keepdims=True)),
        **POINTS,
        **vector("gauge1_", along[0]),
        **vector("gauge2_", along[1]),
        "reading1_um": read[0] * 1e3,
        "reading2_um": read[1] * 1e3,
    }
    tests = read_load_tests(csv(columns, "frame: flange"), robot)
    assert np.isnan(tests.displacement[::3, 1]).all()
    result = rm.identify(robot, tests)
    np.testing.assert_allclose(result.C_theta, arm.C_theta, rtol=1e-3)
    assert result.equations == 24 + 16
    one = csv({**columns, "gauge_x": along[0, :, 0]}, "frame: flange")
    with pytest.raises(LoadTestError, match="the same quantity twice"):
        read_load_tests(one, robot)


def test_a_wrong_load_point_is_found_though_the_cable_was_aimed_from_it():
    """Pulley and pull alone: the stated point turns the forces too, by 3 degrees, and the fit turns them back."""
    name = "kuka_kr270"
    arm, robot = ARMS[name]
    made = make(arm, Rig(noise=2e-6), 24, seed=5)
    off = RIG.load_point + 0.150 * np.array([0.6, 0.64, -0.48])
    columns = {
        **{f"theta{i + 1}_deg": np.degrees(made.q[:, i]) for i in range(6)},
        "pull_N": np.linalg.norm(made.F, axis=1),
        **vector("pulley_", np.array(RIG.pulleys[0]) * 1e3, "_mm"),
        **vector("load_point_", off * 1e3, "_mm"),
        **vector("gauge_point_", RIG.gauge_point * 1e3, "_mm"),
        **vector("d", made.moved * 1e3, "_mm"),
    }
    tests = read_load_tests(csv(columns), robot)
    assert np.degrees(np.arccos(((tests.wrench[:, :3] * made.F).sum(1) / (made.F**2).sum(1)).clip(-1, 1))).max() > 2.0
    plain, fitted = rm.identify(robot, tests), rm.identify(robot, tests, fit_points="force")
    assert fitted.cv_relative_error < plain.cv_relative_error / 5
    (point,) = fitted.points
    assert point.off == pytest.approx(0.150, abs=0.01)
    assert ((point.ci95[:, 0] <= RIG.load_point) & (RIG.load_point <= point.ci95[:, 1])).all()
    inside = (fitted.ci95[:, 0] <= arm.C_theta) & (arm.C_theta <= fitted.ci95[:, 1])
    assert inside.all()


def test_gauges_and_pulleys_are_written_as_they_are_read():
    name = "kuka_kr270"
    robot = ARMS[name][1]
    columns = {
        **pose(name),
        **pull(name),
        **vector("pulley_", np.array(RIG.pulleys[0]) * 1e3, "_mm"),
        **vector("gauge_", [0.0, 0.6, 0.8]),
        "reading_mm": MADE[name].moved @ [0.0, 0.6, 0.8] * 1e3,
    }
    tests = read_load_tests(csv(columns, "frame: flange", "angles: kuka", "provenance: synthetic"), robot)
    again = read_load_tests(load_tests_to_csv(tests, digits=9), robot)
    for key in ("theta", "wrench", "displacement", "gauges", "pulley"):
        np.testing.assert_allclose(getattr(again, key)[:, :1], getattr(tests, key)[:, :1], rtol=1e-5, atol=1e-6)
    assert again.aimed.all()
    assert again.provenance.kind == tests.provenance.kind == "synthetic"


@pytest.mark.parametrize("n", [5, 6])
def test_every_template_is_read_back(n):
    arms = {5: rm.load_robot("slavkovic_5r"), 6: ARMS["kuka_kr270"][1]}
    for protocol in TEMPLATES:
        text = load_test_template(protocol, n)
        assert len(read_load_tests(text, arms[n] if protocol == "cable" else None))


LINE = {
    **{f"{a}_mm": v for a, v in zip("XYZ", (1600.0, 0.0, 1300.0), strict=True)},
    **{f"{a}_deg": v for a, v in zip("ABC", (0.0, 90.0, 0.0), strict=True)},
    "load_N": 400.0,
    **{f"cable_{a}": v for a, v in zip("xyz", (0.8, 0.0, 0.6), strict=True)},
    **{f"d{a}_mm": 0.1 for a in "xyz"},
}
HEAD = ("frame: flange", "angles: kuka")
PULLEY = {f"pulley_{a}_mm": 2000.0 for a in "xyz"}
NO_CABLE = {f"cable_{a}": None for a in "xyz"}
NO_READING = {f"d{a}_mm": None for a in "xyz"}
GAUGE = {"gauge_x": 1.0, "gauge_y": 0.0, "gauge_z": 0.0}


@pytest.mark.parametrize(
    ("change", "head", "where", "words"),
    [
        ({}, HEAD[:1], "row 2", "angles: kuka"),
        ({}, HEAD[1:], "row 2", "frame: flange"),
        ({}, ("frame: wrist", HEAD[1]), "row 3", "tool, flange"),
        ({}, (*HEAD, "provenance: hearsay"), "row 4", "expected one of paper, measured"),
        ({"B_deg": None}, HEAD, "row 3", "B_deg is missing"),
        ({"cable_x": 0.7}, HEAD, "row 4, column cable_x", "length 0.922"),
        ({"load_N": -1.0}, HEAD, "row 4, column load_N", "above zero"),
        ({"load_N": None}, HEAD, "row 3", "load_N"),
        (PULLEY, HEAD, "row 3", "twice"),
        ({**NO_CABLE, "hook_x_mm": 1.0, "hook_y_mm": 1.0, "hook_z_mm": 1.0}, HEAD, "row 3", "no direction"),
        ({"Fx_N": 1.0, "Fy_N": 1.0, "Fz_N": 1.0}, HEAD, "row 3", "given twice"),
        (GAUGE, HEAD, "row 3", "needs reading1_mm"),
        ({**GAUGE, "reading_mm": 0.1}, HEAD, "row 3", "given twice"),
        ({**NO_READING, "reading_mm": 0.1}, HEAD, "row 3", "needs gauge1_x"),
        ({**NO_READING, **GAUGE, "gauge_y": 1.0, "reading_mm": 0.1}, HEAD, "row 4, column gauge_x", "length 1.41"),
        ({f"{name}{a}_mm": 1.0 for name in ("FP", "load_point_") for a in "xyz"}, HEAD, "row 3", "twice"),
        ({"theta1_deg": 1.0}, HEAD, "row 3", "poses are given twice"),
        ({"X_mm": 9000.0}, HEAD, "row 4", "not reached"),
    ],
)
def test_refusals_name_row_and_column(change, head, where, words):
    columns = {k: np.array([v]) for k, v in {**LINE, **change}.items() if v is not None}
    with pytest.raises(LoadTestError) as refused:
        read_load_tests(csv(columns, *head), ARMS["kuka_kr270"][1])
    assert refused.value.where == where
    assert words in str(refused.value)


def test_what_needs_the_robot_says_so_and_five_joints_have_no_c():
    text = csv({k: np.array([v]) for k, v in LINE.items()}, *HEAD)
    with pytest.raises(LoadTestError, match="need the robot"):
        read_load_tests(text)
    tool = text.replace("frame: flange", "frame: tool")
    assert read_load_tests(tool).x_M.shape == (1, 6)
    with pytest.raises(LoadTestError, match="slavkovic_5r has 5 joints"):
        read_load_tests(tool, rm.load_robot("slavkovic_5r"))


def test_a_map_by_cables_is_made_at_poses_of_the_flange():
    name = "kuka_kr270"
    arm, robot = ARMS[name]
    q = MADE[name].q[:2]
    T = flanges(name)[:2]
    rows = {
        key: []
        for key in [*pose(name), "load_N", *(f"{w}{a}{u}" for w, u in (("cable_", ""), ("d", "_mm")) for a in "xyz")]
    }
    tip = arm.T_FT[:3, 3]
    for k in range(2):
        for axis in np.eye(3):
            here = [*T[k, :3, 3] * 1e3, *angles(T[k : k + 1, :3, :3], "kuka")[0], 1.0, *axis]
            here += list(arm.yields(q[k], tip, tip, axis, {}) * 1e3)
            for key, value in zip(rows, here, strict=True):
                rows[key].append(value)
    field = read_measured_map(csv({k: np.array(v) for k, v in rows.items()}, *HEAD), robot)
    J = rm.geometric_jacobian(robot, q)[:, :3]
    order = np.argsort(np.linalg.norm(field.p - loads(T, tip)[0], axis=1))
    np.testing.assert_allclose(field.C[order], np.einsum("mik,k,mjk->mij", J, arm.C_theta, J), rtol=1e-4, atol=1e-12)


@pytest.mark.parametrize(
    ("columns", "bad", "column"),
    [
        ({}, {"cable_x": 0.7}, "cable_x"),
        ({}, {"cable_x": 0.8 * 1.03, "cable_z": 0.6 * 1.03}, "cable_x"),
        ({}, {"load_N": 0.0}, "load_N"),
        ({**NO_READING, **GAUGE, "reading_mm": 0.1}, {"gauge_y": 1.0}, "gauge_x"),
        ({}, {"X_mm": 9000.0}, ""),
        (
            {**NO_CABLE, **PULLEY, **{f"{at}{a}_mm": 1000.0 for a in "xyz" for at in ("hook_", "FP")}},
            {f"hook_{a}_mm": 2000.0 for a in "xyz"},
            "pulley_x_mm",
        ),
    ],
)
@pytest.mark.parametrize("at", [0, 1, 2])
def test_one_bad_row_among_good_ones_is_the_one_that_is_named(columns, bad, column, at):
    good = {k: np.full(3, v) for k, v in {**LINE, **columns}.items() if v is not None}
    robot = ARMS["kuka_kr270"][1]
    assert len(read_load_tests(csv(good, *HEAD), robot)) == 3
    for key, value in bad.items():
        good[key][at] = value
    with pytest.raises(LoadTestError) as refused:
        read_load_tests(csv(good, *HEAD), robot)
    assert refused.value.where == f"row {4 + at}" + (f", column {column}" if column else "")


def test_a_direction_is_used_at_length_one_if_it_was_written_a_little_off():
    robot = ARMS["kuka_kr270"][1]
    for stretch in (0.985, 1.0, 1.015):
        line = {k: np.array([v * stretch if k.startswith("cable") else v]) for k, v in LINE.items() if v is not None}
        tests = read_load_tests(csv(line, *HEAD), robot)
        np.testing.assert_allclose(tests.wrench[0, :3], [320.0, 0.0, 240.0], atol=1e-9)


def test_a_pulley_a_millimetre_from_its_hook_still_says_where_to():
    apart = {**NO_CABLE, **{f"{at}{a}_mm": 0.0 for a in "xyz" for at in ("hook_", "FP", "pulley_")}}
    line = {k: np.array([v]) for k, v in {**LINE, **apart}.items() if v is not None}
    for gap, reads in ((0.99, False), (1.0, True), (1.01, True)):
        line["pulley_y_mm"][0] = gap
        if reads:
            wrench = read_load_tests(csv(line, *HEAD), ARMS["kuka_kr270"][1]).wrench
            np.testing.assert_allclose(wrench[0, :3], [0.0, 400.0, 0.0], atol=1e-9)
        else:
            with pytest.raises(LoadTestError, match="the pulley is where the hook is"):
                read_load_tests(csv(line, *HEAD), ARMS["kuka_kr270"][1])


@pytest.mark.parametrize(("stated", "said"), [(True, True), (False, False)])
def test_where_the_base_stands_is_said_of_poses_only_where_the_robots_file_says_it(stated, said):
    """It ended in "; not stated", which reads as if the angles were not, though the head declares them."""
    robot = ARMS["kuka_kr270"][1]
    if not stated:
        robot = robot.replace(provenance={**robot.provenance, "base": rm.Provenance("user", "not stated")})
    columns = {**pose("kuka_kr270"), **vector("F", [30.0, 40.0, -20.0], "_N"), **vector("d", [0.1, 0.2, 0.1], "_mm")}
    tests = read_load_tests(csv(columns, "frame: flange", "angles: kuka"), robot)
    text = next(each.message for each in tests.findings if each.code == "pose-frame")
    assert (";" in text) is said
    assert "not stated" not in text
