"""robomill: how far a milling robot is pushed off its path by the cutting force, and which joint is to blame.

SI inside (m, rad, N, s). The public names below load on first use, so that ``import robomill`` stays quick.
"""

from importlib import import_module
from typing import Any

__version__ = "0.1.0"

_PUBLIC = {
    "load_robot": "robomill.io.robots",
    "tool_pose": "robomill.kinematics.forward",
    "pose_from_world": "robomill.kinematics.transforms",
    "world_from_pose": "robomill.kinematics.transforms",
    "geometric_jacobian": "robomill.kinematics.jacobian",
    "task_jacobian": "robomill.kinematics.jacobian",
    "inverse_kinematics": "robomill.kinematics.inverse",
    "joint_contributions": "robomill.compliance.cartesian",
    "cartesian_compliance": "robomill.compliance.cartesian",
    "deflection": "robomill.compliance.deflection",
    "read_gcode": "robomill.toolpath.gcode",
    "load_setup": "robomill.io.projects",
    "simulate": "robomill.simulation.run",
    "read_load_tests": "robomill.io.load_tests",
    "identify": "robomill.identification.estimate",
    "RobomillError": "robomill.errors",
    "Robot": "robomill.robot.model",
    "Toolpath": "robomill.toolpath.path",
    "SimulationSetup": "robomill.simulation.setup",
    "SimulationResult": "robomill.simulation.result",
}

__all__ = sorted(_PUBLIC)


def __getattr__(name: str) -> Any:
    if name not in _PUBLIC:
        raise AttributeError(f"module 'robomill' has no attribute {name!r}")
    value = getattr(import_module(_PUBLIC[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*globals(), *_PUBLIC])
