"""The public names, each with the module that it loads from on first use; type checkers read them here."""

from .compliance.at_pose import PoseReport as PoseReport, at_pose as at_pose
from .compliance.cartesian import (
    cartesian_compliance as cartesian_compliance,
    joint_contributions as joint_contributions,
)
from .compliance.deflection import deflection as deflection
from .compliance.gravity import LinkMasses as LinkMasses
from .compliance.springs.joint_bending import JointBending as JointBending
from .compliance.springs.spindle import SpindleSpring as SpindleSpring
from .compliance.springs.tool_bending import ToolBending as ToolBending
from .cutting.force import ForceModel as ForceModel
from .cutting.forces.along_path import PathForce as PathForce
from .cutting.forces.constant import ConstantForce as ConstantForce
from .cutting.forces.kienzle import KienzleForce as KienzleForce, KienzleRow as KienzleRow
from .cutting.forces.measured import ForceRecord as ForceRecord, MeasuredForce as MeasuredForce
from .cutting.forces.mechanistic import MechanisticForce as MechanisticForce, MechanisticRow as MechanisticRow
from .cutting.materials import Material as Material
from .cutting.tool import Cutter as Cutter
from .cutting.tool_table import TableTool as TableTool, ToolTable as ToolTable
from .errors import RobomillError as RobomillError
from .identification.knowledge import Knowledge as Knowledge
from .identification.load_test import JointTests as JointTests, LoadTests as LoadTests
from .identification.result import IdentificationResult as IdentificationResult
from .improve.advice import Advice as Advice, advise as advise
from .improve.box_design import BoxDesign as BoxDesign, design_box as design_box
from .improve.compensation import Compensation as Compensation
from .improve.design import Design as Design, design as design
from .improve.draws import Tornado as Tornado, Uncertainty as Uncertainty
from .improve.path_sensitivity import PathSensitivity as PathSensitivity, sensitivity as sensitivity
from .improve.placed import Place as Place, Placement as Placement
from .improve.placement import place as place
from .improve.turning import Turning as Turning, turn as turn
from .improve.uncertainty import uncertainty as uncertainty
from .improve.unsure import Spread as Spread
from .io.compensated import compensate as compensate
from .io.drawing.drawings import read_drawing as read_drawing
from .io.maps import write_map as write_map
from .io.materials import load_material as load_material, material_names as material_names
from .io.measured.forces import read_forces as read_forces
from .io.measured.identified import identify as identify
from .io.measured.load_tests import read_load_tests as read_load_tests
from .io.meshes import read_stock as read_stock
from .io.point_tables import read_points as read_points
from .io.programs import read_program as read_program
from .io.robot.robots import load_robot as load_robot, robot_names as robot_names
from .io.samples import copy_samples as copy_samples, samples as samples
from .io.setups.force_models import process_force as process_force
from .io.setups.projects import load_setup as load_setup
from .io.setups.tool_tables import read_tool_table as read_tool_table
from .io.writers import (
    write_gcode as write_gcode,
    write_material as write_material,
    write_robot as write_robot,
    write_setup as write_setup,
    write_stl as write_stl,
)
from .kinematics.asked import inverse_kinematics as inverse_kinematics
from .kinematics.forward import joint_frames as joint_frames, tool_pose as tool_pose
from .kinematics.jacobian import geometric_jacobian as geometric_jacobian, task_jacobian as task_jacobian
from .kinematics.result import IKResult as IKResult
from .kinematics.transforms import pose_from_world as pose_from_world, world_from_pose as world_from_pose
from .provenance import Finding as Finding, Provenance as Provenance
from .report.html import report_html as report_html, write_report as write_report
from .robot.model import Robot as Robot
from .simulation.judging.verdict_words import Verdict as Verdict
from .simulation.result import SimulationResult as SimulationResult
from .simulation.run import simulate as simulate
from .simulation.setup import SimulationSetup as SimulationSetup
from .study.described import Study as Study, load_study as load_study
from .study.running import StudyResult as StudyResult, run_study as run_study
from .surface.sections.groove import GrooveSection as GrooveSection
from .surface.stock import Stock as Stock
from .surface.zmap import ZMap as ZMap
from .toolpath.drawing import Drawing as Drawing, LayerCut as LayerCut
from .toolpath.gcode import read_gcode as read_gcode
from .toolpath.part_zero import frame_from_points as frame_from_points
from .toolpath.path import Toolpath as Toolpath
from .toolpath.sketch import Element as Element, Sketch as Sketch
from .toolpath.source import (
    GCodeSource as GCodeSource,
    LinesSource as LinesSource,
    PointsSource as PointsSource,
    SketchSource as SketchSource,
)
from .workspace.fields import ComplianceMap as ComplianceMap, Field as Field, compliance_map as compliance_map
from .workspace.grid import Grid as Grid, box_grid as box_grid, plane_grid as plane_grid
from .workspace.quantities import map_quantities as map_quantities
from .workspace.reach import reach as reach

__version__: str
