"""From load tests however they are given (read, a file, a DataFrame) to the compliances of the joints."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from robomill.arguments import asked, refuse_unknown
from robomill.errors import LoadTestError
from robomill.frames import is_frame
from robomill.identification.fit import estimate
from robomill.identification.fit.treatment import STANDARD, Choices, Treatment
from robomill.identification.load_test import JointTests, LoadTests
from robomill.identification.result import IdentificationResult
from robomill.io.measured.load_tests import read_load_tests
from robomill.robot.model import Robot, check_robot

if TYPE_CHECKING:
    from robomill.frames import DataFrame


@asked
def identify(
    robot: Robot,
    tests: LoadTests | JointTests | DataFrame | str | Path,
    model: str = "joints",
    treatment: Treatment = STANDARD,
    **choices: Unpack[Choices],
) -> IdentificationResult:
    """Joint compliances, and those of springs beside the joints, from load tests, with how sure they are.

    Parameters
    ----------
    robot : Robot
        The arm that was loaded; its own compliances do not enter.
    tests : LoadTests, JointTests, pandas.DataFrame, str or Path
        Load tests, or what ``read_load_tests`` makes of a table, a file or the name of a sample.
    model : str
        What gives: "joints", "joints+bending" (links, too), "joints+tool", "joints+bending+tool", or "constant" (one
        compliance matrix at all poses).
    treatment : Treatment
        How the tests are treated, as a result has it in ``found.treatment``; or by name, each of these ``choices``:
    bending : sequence of int, or "auto"
        Joints, counted from 1, at which links bend in a model with bending; left out (2, 3). "auto": where the tests
        say, in every model.
    fit_points : {"none", "force", "gauge", "both"}
        Which points of the tool are found beside the compliances: where the force acts, where the gauge reads.
    robust : bool
        Whether tests that do not fit the others count less.
    exclude : sequence of int
        Rows that are left out, by their numbers in ``found.row``.
    weights : {"equal", "size"}
        Every reading alike, or every test by its relative error.
    leave_out : {"pose", "neighbours"}
        What is left out together to see how well the model predicts: any poses, or neighbouring ones.

    Returns
    -------
    IdentificationResult
        ``C_theta`` (n,) rad/(N m), m/N where a joint slides, with ``stderr`` (n,) and ``ci95`` (n, 2); NaN for a joint
        that the tests do not see.

    Raises
    ------
    LoadTestError
        Where the table cannot be read (row and column are named), or the tests cannot answer: too few equations, one
        pose only, poses outside the limits.

    Notes
    -----
    Eqs. (16) and (17) are linear in the compliances, which are not negative: non-negative least squares, no starting
    guess (paper, Sec. 5.1).

    Examples
    --------
    >>> import robomill as rm
    >>> robot = rm.load_robot("slavkovic_5r")
    >>> found = rm.identify(robot, "one_joint_at_a_time")
    >>> (found.C_theta * 1e7).round(2).tolist()
    [7.2, 10.13, 12.26, 17.34, 91.24]
    """
    check_robot(robot)
    refuse_unknown(choices, {each.name for each in fields(Treatment)}, "identify")
    if not isinstance(tests, LoadTests | JointTests | str | Path | bytes) and not is_frame(tests):
        found = type(tests).__name__
        raise LoadTestError(
            f"identify: expected load tests, a file or a DataFrame with their columns, found {found}; of an array or a "
            "mapping make a DataFrame first."
        )
    given = tests if isinstance(tests, LoadTests | JointTests) else read_load_tests(tests, robot)
    return estimate.identify(robot, given, model, treatment, **choices)
