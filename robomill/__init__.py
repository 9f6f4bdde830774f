"""robomill: how far a milling robot is pushed off its path by the cutting force, and which joint is to blame.

SI inside (m, rad, N, s). The public names below load on first use, so that ``import robomill`` stays quick.
"""

import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any

from robomill.version import __version__ as __version__

if TYPE_CHECKING:
    from robomill.compliance.at_pose import PoseReport as PoseReport
    from robomill.compliance.at_pose import at_pose as at_pose
    from robomill.compliance.cartesian import cartesian_compliance as cartesian_compliance
    from robomill.compliance.cartesian import joint_contributions as joint_contributions
    from robomill.compliance.deflection import deflection as deflection
    from robomill.compliance.gravity import LinkMasses as LinkMasses
    from robomill.compliance.springs.joint_bending import JointBending as JointBending
    from robomill.compliance.springs.spindle import SpindleSpring as SpindleSpring
    from robomill.compliance.springs.tool_bending import ToolBending as ToolBending
    from robomill.cutting.force import ForceModel as ForceModel
    from robomill.cutting.forces.along_path import PathForce as PathForce
    from robomill.cutting.forces.constant import ConstantForce as ConstantForce
    from robomill.cutting.forces.kienzle import KienzleForce as KienzleForce
    from robomill.cutting.forces.kienzle import KienzleRow as KienzleRow
    from robomill.cutting.forces.measured import ForceRecord as ForceRecord
    from robomill.cutting.forces.measured import MeasuredForce as MeasuredForce
    from robomill.cutting.forces.mechanistic import MechanisticForce as MechanisticForce
    from robomill.cutting.forces.mechanistic import MechanisticRow as MechanisticRow
    from robomill.cutting.materials import Material as Material
    from robomill.cutting.tool import Cutter as Cutter
    from robomill.cutting.tool_table import TableTool as TableTool
    from robomill.cutting.tool_table import ToolTable as ToolTable
    from robomill.errors import RobomillError as RobomillError
    from robomill.identification.knowledge import Knowledge as Knowledge
    from robomill.identification.load_test import JointTests as JointTests
    from robomill.identification.load_test import LoadTests as LoadTests
    from robomill.identification.result import IdentificationResult as IdentificationResult
    from robomill.improve.advice import Advice as Advice
    from robomill.improve.advice import advise as advise
    from robomill.improve.box_design import BoxDesign as BoxDesign
    from robomill.improve.box_design import design_box as design_box
    from robomill.improve.compensation import Compensation as Compensation
    from robomill.improve.design import Design as Design
    from robomill.improve.design import design as design
    from robomill.improve.draws import Tornado as Tornado
    from robomill.improve.draws import Uncertainty as Uncertainty
    from robomill.improve.path_sensitivity import PathSensitivity as PathSensitivity
    from robomill.improve.path_sensitivity import sensitivity as sensitivity
    from robomill.improve.placed import Place as Place
    from robomill.improve.placed import Placement as Placement
    from robomill.improve.placement import place as place
    from robomill.improve.turning import Turning as Turning
    from robomill.improve.turning import turn as turn
    from robomill.improve.uncertainty import uncertainty as uncertainty
    from robomill.improve.unsure import Spread as Spread
    from robomill.io.compensated import compensate as compensate
    from robomill.io.drawing.drawings import read_drawing as read_drawing
    from robomill.io.maps import write_map as write_map
    from robomill.io.materials import load_material as load_material
    from robomill.io.materials import material_names as material_names
    from robomill.io.measured.forces import read_forces as read_forces
    from robomill.io.measured.identified import identify as identify
    from robomill.io.measured.load_tests import read_load_tests as read_load_tests
    from robomill.io.meshes import read_stock as read_stock
    from robomill.io.point_tables import read_points as read_points
    from robomill.io.programs import read_program as read_program
    from robomill.io.robot.robots import load_robot as load_robot
    from robomill.io.robot.robots import robot_names as robot_names
    from robomill.io.samples import copy_samples as copy_samples
    from robomill.io.samples import samples as samples
    from robomill.io.setups.force_models import process_force as process_force
    from robomill.io.setups.projects import load_setup as load_setup
    from robomill.io.setups.tool_tables import read_tool_table as read_tool_table
    from robomill.io.writers import write_gcode as write_gcode
    from robomill.io.writers import write_material as write_material
    from robomill.io.writers import write_robot as write_robot
    from robomill.io.writers import write_setup as write_setup
    from robomill.io.writers import write_stl as write_stl
    from robomill.kinematics.asked import inverse_kinematics as inverse_kinematics
    from robomill.kinematics.forward import joint_frames as joint_frames
    from robomill.kinematics.forward import tool_pose as tool_pose
    from robomill.kinematics.jacobian import geometric_jacobian as geometric_jacobian
    from robomill.kinematics.jacobian import task_jacobian as task_jacobian
    from robomill.kinematics.result import IKResult as IKResult
    from robomill.kinematics.transforms import pose_from_world as pose_from_world
    from robomill.kinematics.transforms import world_from_pose as world_from_pose
    from robomill.provenance import Finding as Finding
    from robomill.provenance import Provenance as Provenance
    from robomill.report.html import report_html as report_html
    from robomill.report.html import write_report as write_report
    from robomill.robot.model import Robot as Robot
    from robomill.simulation.judging.verdict_words import Verdict as Verdict
    from robomill.simulation.result import SimulationResult as SimulationResult
    from robomill.simulation.run import simulate as simulate
    from robomill.simulation.setup import SimulationSetup as SimulationSetup
    from robomill.study.described import Study as Study
    from robomill.study.described import load_study as load_study
    from robomill.study.running import StudyResult as StudyResult
    from robomill.study.running import run_study as run_study
    from robomill.surface.sections.groove import GrooveSection as GrooveSection
    from robomill.surface.stock import Stock as Stock
    from robomill.surface.zmap import ZMap as ZMap
    from robomill.toolpath.drawing import Drawing as Drawing
    from robomill.toolpath.drawing import LayerCut as LayerCut
    from robomill.toolpath.gcode import read_gcode as read_gcode
    from robomill.toolpath.part_zero import frame_from_points as frame_from_points
    from robomill.toolpath.path import Toolpath as Toolpath
    from robomill.toolpath.sketch import Element as Element
    from robomill.toolpath.sketch import Sketch as Sketch
    from robomill.toolpath.source import GCodeSource as GCodeSource
    from robomill.toolpath.source import LinesSource as LinesSource
    from robomill.toolpath.source import PointsSource as PointsSource
    from robomill.toolpath.source import SketchSource as SketchSource
    from robomill.workspace.fields import ComplianceMap as ComplianceMap
    from robomill.workspace.fields import Field as Field
    from robomill.workspace.fields import compliance_map as compliance_map
    from robomill.workspace.grid import Grid as Grid
    from robomill.workspace.grid import box_grid as box_grid
    from robomill.workspace.grid import plane_grid as plane_grid
    from robomill.workspace.quantities import map_quantities as map_quantities
    from robomill.workspace.reach import reach as reach

_PUBLIC = {
    "PoseReport": "robomill.compliance.at_pose",
    "at_pose": "robomill.compliance.at_pose",
    "cartesian_compliance": "robomill.compliance.cartesian",
    "joint_contributions": "robomill.compliance.cartesian",
    "deflection": "robomill.compliance.deflection",
    "LinkMasses": "robomill.compliance.gravity",
    "JointBending": "robomill.compliance.springs.joint_bending",
    "ToolBending": "robomill.compliance.springs.tool_bending",
    "SpindleSpring": "robomill.compliance.springs.spindle",
    "ForceModel": "robomill.cutting.force",
    "PathForce": "robomill.cutting.forces.along_path",
    "ConstantForce": "robomill.cutting.forces.constant",
    "KienzleForce": "robomill.cutting.forces.kienzle",
    "KienzleRow": "robomill.cutting.forces.kienzle",
    "ForceRecord": "robomill.cutting.forces.measured",
    "MeasuredForce": "robomill.cutting.forces.measured",
    "MechanisticForce": "robomill.cutting.forces.mechanistic",
    "MechanisticRow": "robomill.cutting.forces.mechanistic",
    "Material": "robomill.cutting.materials",
    "Cutter": "robomill.cutting.tool",
    "TableTool": "robomill.cutting.tool_table",
    "ToolTable": "robomill.cutting.tool_table",
    "RobomillError": "robomill.errors",
    "identify": "robomill.io.measured.identified",
    "Knowledge": "robomill.identification.knowledge",
    "JointTests": "robomill.identification.load_test",
    "LoadTests": "robomill.identification.load_test",
    "IdentificationResult": "robomill.identification.result",
    "Advice": "robomill.improve.advice",
    "advise": "robomill.improve.advice",
    "BoxDesign": "robomill.improve.box_design",
    "design_box": "robomill.improve.box_design",
    "Design": "robomill.improve.design",
    "design": "robomill.improve.design",
    "Place": "robomill.improve.placed",
    "Placement": "robomill.improve.placed",
    "place": "robomill.improve.placement",
    "Compensation": "robomill.improve.compensation",
    "compensate": "robomill.io.compensated",
    "Turning": "robomill.improve.turning",
    "turn": "robomill.improve.turning",
    "PathSensitivity": "robomill.improve.path_sensitivity",
    "sensitivity": "robomill.improve.path_sensitivity",
    "Spread": "robomill.improve.unsure",
    "Tornado": "robomill.improve.draws",
    "Uncertainty": "robomill.improve.draws",
    "uncertainty": "robomill.improve.uncertainty",
    "read_drawing": "robomill.io.drawing.drawings",
    "process_force": "robomill.io.setups.force_models",
    "read_forces": "robomill.io.measured.forces",
    "read_load_tests": "robomill.io.measured.load_tests",
    "write_map": "robomill.io.maps",
    "load_material": "robomill.io.materials",
    "material_names": "robomill.io.materials",
    "read_stock": "robomill.io.meshes",
    "read_points": "robomill.io.point_tables",
    "read_program": "robomill.io.programs",
    "load_setup": "robomill.io.setups.projects",
    "load_robot": "robomill.io.robot.robots",
    "robot_names": "robomill.io.robot.robots",
    "copy_samples": "robomill.io.samples",
    "samples": "robomill.io.samples",
    "read_tool_table": "robomill.io.setups.tool_tables",
    "write_gcode": "robomill.io.writers",
    "write_material": "robomill.io.writers",
    "write_robot": "robomill.io.writers",
    "write_setup": "robomill.io.writers",
    "write_stl": "robomill.io.writers",
    "joint_frames": "robomill.kinematics.forward",
    "tool_pose": "robomill.kinematics.forward",
    "inverse_kinematics": "robomill.kinematics.asked",
    "geometric_jacobian": "robomill.kinematics.jacobian",
    "task_jacobian": "robomill.kinematics.jacobian",
    "IKResult": "robomill.kinematics.result",
    "pose_from_world": "robomill.kinematics.transforms",
    "world_from_pose": "robomill.kinematics.transforms",
    "Finding": "robomill.provenance",
    "Provenance": "robomill.provenance",
    "report_html": "robomill.report.html",
    "write_report": "robomill.report.html",
    "Robot": "robomill.robot.model",
    "SimulationResult": "robomill.simulation.result",
    "simulate": "robomill.simulation.run",
    "SimulationSetup": "robomill.simulation.setup",
    "Verdict": "robomill.simulation.judging.verdict_words",
    "Study": "robomill.study.described",
    "load_study": "robomill.study.described",
    "StudyResult": "robomill.study.running",
    "run_study": "robomill.study.running",
    "GrooveSection": "robomill.surface.sections.groove",
    "Stock": "robomill.surface.stock",
    "ZMap": "robomill.surface.zmap",
    "Drawing": "robomill.toolpath.drawing",
    "LayerCut": "robomill.toolpath.drawing",
    "read_gcode": "robomill.toolpath.gcode",
    "frame_from_points": "robomill.toolpath.part_zero",
    "Toolpath": "robomill.toolpath.path",
    "Element": "robomill.toolpath.sketch",
    "Sketch": "robomill.toolpath.sketch",
    "GCodeSource": "robomill.toolpath.source",
    "LinesSource": "robomill.toolpath.source",
    "PointsSource": "robomill.toolpath.source",
    "SketchSource": "robomill.toolpath.source",
    "ComplianceMap": "robomill.workspace.fields",
    "Field": "robomill.workspace.fields",
    "compliance_map": "robomill.workspace.fields",
    "Grid": "robomill.workspace.grid",
    "box_grid": "robomill.workspace.grid",
    "plane_grid": "robomill.workspace.grid",
    "map_quantities": "robomill.workspace.quantities",
    "reach": "robomill.workspace.reach",
}

__all__ = sorted(_PUBLIC)


if not TYPE_CHECKING:  # with it in sight, a name that does not exist would have a type, too

    def __getattr__(name: str) -> Any:
        if name not in _PUBLIC:
            raise AttributeError(f"module 'robomill' has no attribute {name!r}", name=name, obj=sys.modules[__name__])
        value = getattr(import_module(_PUBLIC[name]), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted([*_PUBLIC, *(name for name in globals() if name[:2] == "__")])
