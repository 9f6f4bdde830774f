"""The paper's arm with the compliances of its Table 3, and poses of it, for tests of the fit."""

import numpy as np

import robomill as rm

ROBOT = rm.load_robot("slavkovic_5r").with_compliance_set("table_3")


def poses(robot, count, seed=0):
    rng = np.random.default_rng(seed)
    return rng.uniform(robot.limits[:, 0], robot.limits[:, 1], (count, robot.n))


def nine_points():
    X, Y = np.meshgrid([-0.6, 0.0, 0.6], [-1.6, -1.3, -1.0])
    x_M = np.stack([X.ravel(), Y.ravel(), 0 * X.ravel(), 0 * X.ravel(), 0 * X.ravel()], axis=-1)
    return rm.inverse_kinematics(ROBOT, rm.pose_from_world(x_M)).theta
