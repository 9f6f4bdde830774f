"""What is known of the compliances in force, as the table [uncertainty] of a set-up's file."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from robomill.compliance.spring import Spring
from robomill.errors import LoadTestError
from robomill.identification.knowledge import Knowledge
from robomill.identification.model_error import ModelError
from robomill.identification.models import MODELS, Model
from robomill.io.tables import Table
from robomill.robot.model import Robot

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
    error = table.numbers("model_error", 3, "1", None)
    known = Knowledge(
        model,
        table.numbers("parameters", p, "1"),
        table.rows("covariance", p, "1", p),
        table.whole("dof") if table.has("dof") else None,
        table.rows("force_covariance", 3, "1", 3) if table.has("force_covariance") else None,
        table.numbers("lengths", 2 * robot.rows, "1", None),
        table.text("words", "from load tests"),
        error=None if error is None else ModelError(*error),
    )
    table.finish()
    of_these = not model.has("joint") or np.allclose(known.parameters[: robot.n], robot.C_theta, rtol=SAME, atol=0.0)
    return known.held_by(robot, springs) if of_these else known
