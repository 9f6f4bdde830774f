"""Exercises about a robot whose compliances are hidden: read off load tests made for one student.

Hidden compliances and noise are drawn from the student number and rounded as a table and a dial gauge round them.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.cartesian import cartesian_compliance
from robomill.compliance.deflection import displacement
from robomill.identification.fit.estimate import identify
from robomill.identification.load_test import LoadTests
from robomill.identification.synthesis import SYNTHETIC
from robomill.kinematics.jacobian import geometric_jacobian
from robomill.learn.draws import Draws
from robomill.learn.exercise import Slip
from robomill.learn.made import Made
from robomill.learn.poses import until
from robomill.robot.model import Robot
from robomill.units import format_number, format_si, from_si, rounded, to_si

POSES, LOAD, NOISE, GAUGE = 8, 250.0, 2e-6, 1e-6
SOFT_POSES, SOFT_GAUGE = 3, 1e-7
SEEN = 0.1  # share of some reading that a joint asked for has at least


def hidden(robot: Robot, draws: Draws) -> Robot:
    """The robot with every joint 0.6 to 1.6 times as soft as its file says, in whole hundredths."""
    times = np.array([draws.whole(60, 160) for _ in range(robot.n)]) / 100.0
    return robot.replace(C_theta=robot.C_theta * times)


def readings(robot: Robot, draws: Draws) -> tuple[Robot, LoadTests]:
    """(the hidden robot, its tests): eight poses, each pushed along X, Y and Z with 250 N; a gauge of 1 µm."""
    truth = hidden(robot, draws)
    theta = np.array([until(robot, draws, lambda pose: True).theta for _ in range(POSES)])
    theta = np.repeat(theta, 3, axis=0)
    F = np.tile(LOAD * np.eye(3), (POSES, 1))
    moved = displacement(cartesian_compliance(truth, theta), F)
    noise = np.array([[draws.normal() for _ in range(3)] for _ in range(len(F))])
    read = np.round((moved + NOISE * noise) / GAUGE) * GAUGE
    return truth, LoadTests(F, read, theta=theta, provenance=SYNTHETIC)


def columns(tests: LoadTests) -> dict[str, tuple[float, ...]]:
    """The tests as a table in the units of the shop floor; each number as short as it is."""
    assert tests.theta is not None
    many = {f"theta{i + 1}_deg": from_si(column, "deg") for i, column in enumerate(tests.theta.T)}
    many |= {f"F{axis}_N": tests.wrench[:, i] for i, axis in enumerate("xyz")}
    many |= {f"d{axis}_um": from_si(tests.displacement[:, i], "um") for i, axis in enumerate("xyz")}
    return {name: tuple(rounded(value, 9) + 0.0 for value in column) for name, column in many.items()}


def laboratory(robot: Robot, draws: Draws) -> Made:
    """A joint's compliance from noisy load tests."""
    _, tests = readings(robot, draws)
    found = identify(robot, tests)
    sure = [k for k in range(robot.n) if found.stderr[k] < 0.03 * found.C_theta[k]]
    k = draws.one_of(sure or [int(np.argmin(found.stderr / found.C_theta))])
    answer = float(found.C_theta[k])
    tolerance = float(min(0.15, max(0.03, 3.0 * found.stderr[k] / answer)))
    number = robot.joint_numbers[k]
    text = (
        f"A robot of this kind was pushed at {POSES} poses along X, Y and Z with {format_si(LOAD, 'N', 0)} each; the "
        "table holds what the gauge read. Its joints are not as soft as the robot's file says. What is the compliance "
        f"of joint {number}? Use every reading."
    )
    return Made(
        text, answer, tuple(_laboratory_slips(robot, tests, found.C_theta, k)), tolerance=tolerance, data=columns(tests)
    )


def _laboratory_slips(robot: Robot, tests: LoadTests, C_theta: FloatArray, k: int) -> Iterator[Slip]:
    numbers = robot.joint_numbers
    yield Slip("This is what the robot's file says: the readings of this robot say otherwise.", float(robot.C_theta[k]))
    for i in range(robot.n):
        if i != k:
            yield Slip(f"This is the compliance of joint {numbers[i]}: asked is joint {numbers[k]}.", float(C_theta[i]))
    unit = float(to_si(1.0, "1e-7 rad/(N m)"))
    text = "This is the stiffness, the inverse of what is asked: a compliance is in rad/(N m)."
    yield Slip(text, unit / float(C_theta[k]))
    yield Slip(text, unit * float(from_si(1.0 / C_theta[k], "kN m/rad")))
    assert tests.theta is not None
    J = geometric_jacobian(robot, tests.theta)
    every = range(robot.n)
    for i in every:
        if i != k:
            kept = [each for each in every if each != i]
            estimate = _least_squares(J[:, :3][:, :, kept], tests)[kept.index(k)]
            yield Slip(f"Joint {numbers[i]} is missing in the fit: all joints give at once.", float(estimate))
    alone = float(_least_squares(J[:, :3][:, :, [k]], tests)[0])
    yield Slip("Only this joint was fitted: the others give, too.", alone)
    yield Slip(
        "The lever arms are missing: the rows of ω were fitted in place of the rows of v.",
        float(_least_squares(J[:, 3:], tests)[k]),
    )


def _least_squares(J_v: FloatArray, tests: LoadTests) -> FloatArray:
    """(n,) compliances that fit the readings with these rows (m, 3, n) of the Jacobian."""
    turned = np.einsum("min,mi->mn", J_v, tests.wrench[:, :3])
    A = (J_v * turned[:, None, :]).reshape(-1, J_v.shape[-1])
    return np.asarray(np.linalg.lstsq(A, tests.displacement[:, :3].ravel(), rcond=None)[0])


def soft_joint(robot: Robot, draws: Draws) -> Made:
    """Which joint is softer than its file says, from three readings without noise."""
    times = draws.whole(16, 26) / 10.0
    poses = [until(robot, draws, lambda pose: True) for _ in range(SOFT_POSES)]
    theta = np.array([pose.theta for pose in poses])
    axes = [draws.whole(0, 2 if robot.n > 3 else 1) for _ in poses]
    F = LOAD * np.eye(3)[axes]
    shares = np.array(
        [np.linalg.norm(pose.C_joint @ f, axis=1) / np.linalg.norm(pose.C @ f) for pose, f in zip(poses, F)]
    )
    k = draws.one_of([i for i in range(robot.n) if shares[:, i].max() > SEEN])
    read = [_softened(robot, i, times, theta, F) for i in range(robot.n)]
    slips = []
    for i, number in enumerate(robot.joint_numbers):
        at = int(np.argmax(np.linalg.norm(read[i] - read[k], axis=1)))
        axis = int(np.argmax(np.abs(read[i][at] - read[k][at])))
        would, does = (format_si(each[at, axis], "um") for each in (read[i], read[k]))
        text = (
            f"Not joint {number}: were it the soft one, the tip would go {would} along {'XYZ'[axis]} in test {at + 1}, "
            f"and it goes {does}."
        )
        slips += [Slip(text, float(number))] if i != k else []
    tests = LoadTests(F, np.round(read[k] / SOFT_GAUGE) * SOFT_GAUGE, theta=theta, provenance=SYNTHETIC)
    text = (
        f"One joint of this robot is {format_number(times, 1)} times as soft as its file says, the others are as they "
        f"are there. The table holds three load tests. Which joint is it? Give its number."
    )
    return Made(text, float(robot.joint_numbers[k]), tuple(slips), data=columns(tests))


def _softened(robot: Robot, i: int, times: float, theta: FloatArray, F: FloatArray) -> FloatArray:
    """(m, 3) how far the tip goes where joint ``i`` is so many times as soft."""
    C_theta = robot.C_theta.copy()
    C_theta[i] *= times
    return displacement(cartesian_compliance(robot.replace(C_theta=C_theta), theta), F)
