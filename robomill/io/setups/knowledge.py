"""What is known of the compliances in force, as the table [uncertainty] of a set-up's file."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.spring import Spring
from robomill.errors import LoadTestError
from robomill.identification.fit.model_error import ModelError
from robomill.identification.fit.models import MODELS, Model
from robomill.identification.knowledge import Knowledge
from robomill.io.tables import Table
from robomill.robot.model import Robot

ROUNDING, LARGEST = 1e-6, 1e4  # of correlations; in SI, beyond anything that is measured here
NOTHING = 1e-30  # what is known exactly varies with nothing
SAME = 0.01  # as a share: compliances that differ by more are others


def knowledge_to_table(known: Knowledge) -> dict[str, Any]:
    """Plain numbers in SI; ``knowledge_from_table`` reads them back."""
    table: dict[str, Any] = {
        "model": known.model.name,
        "bending_joints": list(known.model.bending_joints),
        "bending_turned": known.model.turned,
        "parameters": known.parameters.tolist(),
        "covariance": known.covariance.tolist(),
        "words": known.source,
    }
    if known.dof is not None:
        table["dof"] = int(known.dof)
    if known.error is not None:
        table["model_error"] = [known.error.share, known.error.per_newton, known.error.floor]
    if known.F is not None:
        table["force_covariance"] = known.F.tolist()
    if known.lengths is not None:
        table["lengths"] = known.lengths.tolist()
    return table


def knowledge_from_table(table: Table, robot: Robot, springs: Sequence[Spring]) -> Knowledge:
    """What a file knows of the compliances in it; where they were changed since, it belongs to none of these.

    Raises ProjectError naming the key.
    """
    joints = tuple(table.wholes("bending_joints", (2, 3)))
    model = Model(table.choice("model", tuple(MODELS)), joints, table.flag("bending_turned", False))
    try:
        p = len(model.parameters(robot))
    except LoadTestError as refused:
        raise table.refuse("bending_joints", str(refused)) from None
    error = _sizes(table, "model_error", 3)
    known = Knowledge(
        model,
        table.numbers("parameters", p, "1"),
        _covariance(table, "covariance", p),
        table.whole("dof") if table.has("dof") else None,
        _covariance(table, "force_covariance", 3) if table.has("force_covariance") else None,
        _sizes(table, "lengths", 2 * robot.rows),
        table.text("words", "from load tests"),
        error=None if error is None else ModelError(*error),
    )
    if known.dof is not None and known.dof < 1:
        raise table.refuse("dof", f"found {known.dof}, expected 1 or more.")
    table.finish()
    of_these = not model.has("joint") or np.allclose(known.parameters[: robot.n], robot.C_theta, rtol=SAME, atol=0.0)
    return known.held_by(robot, springs) if of_these else known


def _covariance(table: Table, key: str, p: int) -> FloatArray:
    """(p, p) numbers that are a covariance: symmetric, and no combination of what they are of has one below zero."""
    found = table.rows(key, p, "1", p)
    size = np.sqrt(np.maximum(np.diag(found), 0.0))
    scale = np.where(size > 0.0, size, NOTHING)
    alike = found / np.outer(scale, scale)
    whole = np.diag(found).min() >= 0.0 and size.max() <= LARGEST and np.abs(alike).max() <= 1.0 + ROUNDING
    if not whole or np.abs(alike - alike.T).max() > ROUNDING or np.linalg.eigvalsh(alike).min() < -ROUNDING:
        raise table.refuse(key, "these numbers are no covariance; expected a symmetric matrix with nothing below zero.")
    return found


def _sizes(table: Table, key: str, count: int) -> FloatArray | None:
    """Standard deviations, or what a model misses: none below zero."""
    found = table.numbers(key, count, "1", None)
    if found is not None and not ((np.asarray(found) >= 0.0) & (np.asarray(found) <= LARGEST)).all():
        raise table.refuse(key, f"found {np.asarray(found).tolist()!r:.60}, expected numbers from 0 to {LARGEST:g}.")
    return found
