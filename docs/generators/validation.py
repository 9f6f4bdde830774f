"""The validation table: each number computed now, by robomill and by a calculation that shares nothing with it.

A row whose two numbers lie further apart than it allows stops the build.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module

import numpy as np
from scipy.optimize import nnls
from scipy.spatial.transform import Rotation

import robomill as rm
from robomill.compliance.deflection import deflection
from robomill.compliance.gravity import LinkMasses, gravity_sag
from robomill.compliance.springs.tool_bending import ToolBending
from robomill.cutting.conditions import CutConditions
from robomill.cutting.forces import model_of
from robomill.cutting.tool import Cutter
from robomill.io.materials import load_material, sample_materials
from robomill.io.samples import samples_dir
from robomill.report.reproduction import reproduction
from robomill.report.reproduction_row import WORDS, Evidence, Row, summary
from robomill.robot.model import Robot
from robomill.surface.stock import Stock
from robomill.surface.zmap import cut
from robomill.toolpath.gcode import read_gcode
from robomill.units import from_si, unit_label

PAPER_ARM = "slavkovic_5r"
TINY = 1e-12


class ValidationError(Exception):
    """Two numbers that should agree do not."""


@dataclass(frozen=True)
class Check:
    """One row: what is compared, by which independent way, both numbers in ``unit``, and how far apart they may lie
    as a share of the first (of ``scale`` where that is given, in SI)."""

    what: str
    way: str
    independent: float
    robomill: float
    unit: str
    within: float
    digits: int = 4
    scale: float | None = None

    @property
    def apart(self) -> float:
        return abs(self.robomill - self.independent) / (self.scale or abs(self.independent))

    def row(self) -> str:
        if not self.apart <= self.within:
            raise ValidationError(f"{self.what}: {self.independent!r} by {self.way}, {self.robomill!r} by robomill.")
        label = unit_label(self.unit)
        if self.independent == 0.0:  # the largest difference of many: neither number says anything by itself
            return f"| {self.what} | {self.way} | | | {_size(self.apart)}{'' if self.apart < TINY else ' ' + label} |"
        values = (f"{from_si(value, self.unit):.{self.digits}f}" for value in (self.independent, self.robomill))
        shown = (f"{value} {label}".replace("-", "−") for value in values)
        return f"| {self.what} | {self.way} | {' | '.join(shown)} | {_size(self.apart)} |"


def pages() -> dict[str, str]:
    """The generated pieces by name."""
    return {
        "validation_paper.md": _paper(),
        "validation_closed.md": _table(CLOSED_FORMS),
        "validation_brute.md": _table(BRUTE_FORCE),
        "validation_peers.md": _table(PEERS),
    }


HEAD = "| what | the other way | by it | by robomill | apart |\n|---|---|---:|---:|---:|"


def _table(checks: dict[str, Callable[[], list[Check]]]) -> str:
    rows, missing = [], []
    for needed, compute in checks.items():
        package = needed.partition(":")[0]
        try:
            if package:
                import_module(package)
        except ModuleNotFoundError:
            missing.append(package)
            continue
        rows += [check.row() for check in compute()]
    left_out = f"\n\nNot computed in this build, since it is not installed here: {', '.join(missing)}." if missing else ""
    return "\n".join([HEAD, *rows]) + left_out


def _size(apart: float) -> str:
    if apart < TINY:
        return "rounding"
    exponent = math.floor(math.log10(apart))
    return f"{apart / 10.0**exponent:.0f}·10{str(exponent).translate(str.maketrans('-0123456789', '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'))}"


# ---- the paper -----------------------------------------------------------------------------------------------------
def _paper() -> str:
    setup = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml")
    robot = rm.load_robot(PAPER_ARM)
    files = samples_dir() / "load_tests"
    nine, single = (rm.identify(robot, rm.read_load_tests(files / name)) for name in ("nine_points.csv", "one_joint_at_a_time.csv"))
    other = setup.replace(robot=setup.robot.with_compliance_set("table_3"))
    evidence = Evidence(robot, rm.simulate(setup), rm.simulate(other), nine, single, tuple(sample_materials()))
    rows = reproduction(evidence)
    lost = [row.statement.where for row in rows if not row.holds]
    if lost:
        raise ValidationError(f"Statements of the paper that do not hold: {lost}.")
    head = "| where | the paper | robomill | that is | why |\n|---|---|---|---|---|"
    return "\n".join([summary(rows), "", head, *map(_paper_row, rows)])


def _paper_row(row: Row) -> str:
    cells = (row.statement.where, row.statement.gives, row.found, WORDS[row.statement.status], row.reason)
    return "| " + " | ".join(cell.replace("|", "\\|").replace("$", "\\$") for cell in cells) + " |"


# ---- closed forms --------------------------------------------------------------------------------------------------
def _plane_geometry() -> list[Check]:
    """The paper's arm with the tool vertical at X = 0, Z = 0: two links and a wrist in a plane."""
    robot = rm.load_robot(PAPER_ARM)
    upper, fore, wrist = float(robot.a[1]), float(robot.d[3]), float(robot.a[4])
    reach, height = 1.3, wrist  # of the wrist's centre, from the shoulder
    far = math.hypot(reach, height)
    elbow = math.atan2(height, reach) + math.acos((upper**2 + far**2 - fore**2) / (2 * upper * far))
    h = upper * math.sin(elbow)  # of the elbow above the tip
    along = reach - upper * math.cos(elbow)  # of the tip beyond the elbow
    C_theta = robot.compliance_sets["table_2"]
    by_hand = {
        "yy": C_theta[2] * h**2 + C_theta[4] * wrist**2,
        "yz": -C_theta[2] * h * along,
        "zz": C_theta[1] * reach**2 + C_theta[2] * along**2,
    }
    theta = rm.inverse_kinematics(robot, rm.pose_from_world([0.0, -reach, 0.0, 0.0, 0.0])).theta
    C = rm.cartesian_compliance(robot, theta)
    found = {"yy": C[1, 1], "yz": C[1, 2], "zz": C[2, 2]}
    words = {
        "yy": "C₃ h² + C₅ a₅², with the elbow h above the tip",
        "yz": "−C₃ h l, with the tip l beyond the elbow",
        "zz": "C₂ Y² + C₃ l²",
    }
    return [
        Check(f"C_{name} at (0, −1300, 0) mm, Table 2", words[name], by_hand[name], float(found[name]), "um/N", 1e-9)
        for name in by_hand
    ]


def _planar_arm() -> list[Check]:
    """Two links in a plane: the textbook's Jacobian."""
    robot = rm.load_robot("planar_2r")
    one, two = robot.a
    theta = np.array([0.4, 0.9])
    s1, s12 = math.sin(theta[0]), math.sin(theta.sum())
    C_xx = robot.C_theta[0] * (one * s1 + two * s12) ** 2 + robot.C_theta[1] * (two * s12) ** 2
    words = "C₁ (l₁ s₁ + l₂ s₁₂)² + C₂ (l₂ s₁₂)²"
    det = rm.geometric_jacobian(robot, theta)[:2]
    return [
        Check("C_xx of a planar arm", words, C_xx, float(rm.cartesian_compliance(robot, theta)[0, 0]), "um/N", 1e-9),
        Check("det(J) of a planar arm", "l₁ l₂ sin θ₂", one * two * math.sin(theta[1]), float(np.linalg.det(det)), "m2", 1e-9),
    ]


def _slot_forces() -> list[Check]:
    """Altintas' mean force of a full slot, for each aluminium row and the paper's cut."""
    N, a, c = 3, 2e-3, 0.05e-3
    cutter = Cutter("flat", 8e-3, flutes=N)
    conditions = CutConditions.steady(0.03, 200.0, a, cutting=[False, True])
    checks = []
    for row in sample_materials():
        if row.kind != "mechanistic":
            continue
        force = model_of(row)(cutter, row).components(conditions)[1]  # type: ignore[call-arg]
        by_hand = N * a * (row.Ktc * c / 4 + row.Kte / math.pi)  # type: ignore[attr-defined]
        checks.append(Check(f"F_y of the paper's slot, {row.title}", "N a (K_tc c/4 + K_te/π)", by_hand, float(force[1]), "N", 1e-9, 1))
    return checks


def _volumes() -> list[Check]:
    """What a straight cut takes away: a strip and two half bodies of revolution."""
    R, depth, length = 4e-3, 2e-3, 40e-3
    stock = Stock([-10e-3, -10e-3, -10e-3], [50e-3, 10e-3, 0.0])
    p = np.array([[0.0, 0.0, -depth], [length, 0.0, -depth]])
    flat = 2 * R * depth * length + math.pi * R**2 * depth
    half = math.acos((R - depth) / R)
    segment = R**2 * (half - math.sin(half) * math.cos(half))
    cap = math.pi * depth**2 * (R - depth / 3)
    ball = segment * length + cap
    words = ("2 R a l + π R² a", "segment of the circle · l + cap of the ball")
    return [
        Check(f"volume of a slot, {kind} end", way, exact, float(cut(stock, 1e-4, Cutter(kind, 2 * R), p).removed_volume), "mm3", 2e-3, 2)
        for kind, way, exact in (("flat", words[0], flat), ("ball", words[1], ball))
    ]


def _cantilever() -> list[Check]:
    d, L, E = 0.8 * 8e-3, 32e-3, 600e9
    by_hand = L**3 / (3 * E * math.pi * d**4 / 64)
    return [Check("bending of an 8 mm carbide cutter", "L³ / (3 E I)", by_hand, ToolBending(8e-3, L).lateral, "um/N", 1e-9)]


CLOSED_FORMS: dict[str, Callable[[], list[Check]]] = {
    ":plane": _plane_geometry,
    ":planar": _planar_arm,
    ":force": _slot_forces,
    ":volume": _volumes,
    ":cantilever": _cantilever,
}


# ---- brute force ---------------------------------------------------------------------------------------------------
def _screw(robot: Robot, row: int, q: float) -> np.ndarray:
    """A row of a D-H table, eq. (4), written out."""
    t, al = robot.sign[row] * q + robot.theta_offset[row], robot.alpha[row]
    turn = np.array([[math.cos(t), -math.sin(t), 0, 0], [math.sin(t), math.cos(t), 0, 0], [0, 0, 1, robot.d[row]], [0, 0, 0, 1]])
    link = np.array([[1, 0, 0, robot.a[row]], [0, math.cos(al), -math.sin(al), 0], [0, math.sin(al), math.cos(al), 0], [0, 0, 0, 1]])
    return turn @ link


def _frames(robot: Robot, theta: np.ndarray) -> list[np.ndarray]:
    """The frame after each row, by multiplying the table's rows."""
    frames = [np.array(robot.T_base)]
    for row in range(robot.rows):
        frames.append(frames[-1] @ _screw(robot, row, float(theta[row])))
    return frames[1:]


def _tip(robot: Robot, theta: np.ndarray) -> np.ndarray:
    """The tip by multiplying the table's rows."""
    return (_frames(robot, theta)[-1] @ robot.T_tool)[:3, 3]


def _configurations(robot: Robot, count: int) -> np.ndarray:
    low, high = 0.8 * robot.limits.T
    return np.random.default_rng(2013).uniform(low, high, (count, robot.n))


def _rows_multiplied() -> list[Check]:
    robot = rm.load_robot(PAPER_ARM)
    theta = _configurations(robot, 200)
    apart = np.linalg.norm(rm.tool_pose(robot, theta)[:, :3, 3] - [_tip(robot, each) for each in theta], axis=1).max()
    return [Check("tip, farthest of 200 configurations", "the rows of Table 1 multiplied out", 0.0, float(apart), "m", 1e-12, 4, 1.0)]


def _numeric_jacobian() -> list[Check]:
    robot = rm.load_robot(PAPER_ARM)
    theta, h = _configurations(robot, 200), 1e-6
    numeric = [[(_tip(robot, t + e) - _tip(robot, t - e)) / (2 * h) for e in h * np.eye(5)] for t in theta]
    apart = float(np.abs(np.swapaxes(numeric, 1, 2) - rm.geometric_jacobian(robot, theta)[:, :3]).max())
    return [Check("J_v, largest difference of 200 configurations", "differences of the pose, h = 10⁻⁶ rad", 0.0, apart, "m", 1e-8, 4, 1.0)]


def _twisted_joints() -> list[Check]:
    """Each joint turned by C_i times the torque that the force has about it; the tip then stands off by C F."""
    robot, F = rm.load_robot(PAPER_ARM), np.array([30.0, 100.0, -23.0])
    theta = rm.inverse_kinematics(robot, rm.pose_from_world([0.2, -1.3, -0.1, 0.0, 0.0])).theta
    h = 1e-6
    J = np.array([(_tip(robot, theta + e) - _tip(robot, theta - e)) / (2 * h) for e in h * np.eye(5)]).T
    moved = _tip(robot, theta + robot.C_theta * (J.T @ F)) - _tip(robot, theta)
    delta = rm.cartesian_compliance(robot, theta) @ F
    return [
        Check(f"δ_{axis} under (30, 100, −23) N", "joints twisted by C_i τ_i, the pose computed again", float(moved[i]), float(delta[i]), "mm", 1e-3)
        for i, axis in enumerate("xyz")
    ]


def _energy() -> list[Check]:
    robot, F = rm.load_robot("kuka_kr270"), np.array([-40.0, 60.0, 80.0])
    theta = np.array([0.2, -1.2, 1.3, 0.3, 0.9, -0.4])
    J = rm.geometric_jacobian(robot, theta)[:3]
    tau = J.T @ F
    stored = 0.5 * float((robot.C_theta * tau**2).sum())
    done = 0.5 * float(F @ deflection(rm.joint_contributions(J, robot.C_theta), F).sum(axis=0))
    return [Check("energy of a KUKA KR270 under (−40, 60, 80) N", "½ Σ C_i τ_i², stored in its joints", stored, done, "N m", 1e-9, 6)]


def _revolution() -> list[Check]:
    """The mean over a revolution by adding up 36 000 instants, of a side cut."""
    row = load_material("al7075_t6_carbide_ref190")
    N, a, radius, c, width = 3, 2e-3, 4e-3, 0.05e-3, 2e-3
    start = math.pi - math.acos(1 - width / radius)  # down milling: the arc ends where the tooth runs along the feed
    phi = (np.arange(36_000) + 0.5) * 2 * math.pi / 36_000
    inside = phi >= start
    inside &= phi <= math.pi
    h = c * np.sin(phi)
    Ft, Fr = ((getattr(row, f"K{x}c") * h + getattr(row, f"K{x}e")) * a * inside for x in "tr")
    along = N * float(np.mean(-Ft * np.cos(phi) - Fr * np.sin(phi)))
    left = N * float(np.mean(Ft * np.sin(phi) - Fr * np.cos(phi)))
    conditions = CutConditions.steady(0.03, 200.0, a, arc=(start, math.pi), cutting=[False, True])
    force = model_of(row)(Cutter("flat", 2 * radius, flutes=N), row).components(conditions)[1]  # type: ignore[call-arg]
    way = "36 000 instants of a revolution added up"
    return [
        Check("feed force of a side cut, 2 mm wide", way, along, float(force[0]), "N", 1e-3, 2),
        Check("feed-normal force of the same", way, left, float(force[1]), "N", 1e-3, 2),
    ]


def _sag() -> list[Check]:
    """The derivative of the potential energy by differences, then the joints twisted by it."""
    robot = rm.load_robot(PAPER_ARM)
    mass, centre = np.array([120.0, 90.0, 60.0, 25.0, 30.0]), np.array([-0.2, 0.01, 0.03])
    theta = rm.inverse_kinematics(robot, rm.pose_from_world([0.2, -1.3, -0.1, 0.0, 0.0])).theta
    g, h = 9.80665, 1e-6

    def energy(t: np.ndarray) -> float:
        frames = _frames(robot, t)
        frames[-1] = frames[-1] @ robot.T_tool  # the last mass is told in {T}
        return g * sum(m * float((T @ [*centre, 1.0])[2]) for m, T in zip(mass, frames))

    tau = np.array([-(energy(theta + e) - energy(theta - e)) / (2 * h) for e in h * np.eye(5)])
    moved = _tip(robot, theta + robot.C_theta * tau) - _tip(robot, theta)
    sag = gravity_sag(robot, theta, LinkMasses(mass, np.tile(centre, (5, 1)))).sum(axis=0)
    way = "derivative of the potential energy, joints twisted by it"
    return [Check("sag under 325 kg of links, in Z", way, float(moved[2]), float(sag[2]), "mm", 5e-3)]


def _strewn_points() -> list[Check]:
    """The volume of the sample heart's ideal cut by asking for points whether the cutter passes over them."""
    setup = rm.load_setup(samples_dir() / "heart")
    path, R, stock = setup.toolpath, setup.cutter.radius, setup.stock_block
    sides = [np.arange(low + 1e-4, high, 2e-4) for low, high in zip(stock.lower[:2], stock.upper[:2])]
    points = np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1).reshape(-1, 2)
    points += np.random.default_rng(7).uniform(-1e-4, 1e-4, points.shape)  # one point somewhere in each cell
    deepest = np.full(len(points), float(stock.upper[2]))
    for i in range(1, len(path)):
        a, b = path.p[i - 1], path.p[i]
        low, high = np.minimum(a, b)[:2] - R, np.maximum(a, b)[:2] + R
        some = np.flatnonzero(((points >= low) & (points <= high)).all(axis=1)) if path.cutting[i] else []
        way, from_a = b[:2] - a[:2], points[some] - a[:2]
        length = float(way @ way)
        t = np.clip(from_a @ way / length, 0, 1) if length > 0 else np.ones(len(from_a))
        over = np.linalg.norm(from_a - t[:, None] * way, axis=1) <= R
        z = np.where(over, a[2] + t * (b[2] - a[2]), np.inf)
        deepest[some] = np.minimum(deepest[some], z)
    volume = 4e-8 * float(np.sum(stock.upper[2] - deepest))
    way_of = f"{len(points):,} points asked whether the cutter passes over them".replace(",", " ")
    return [Check("volume of the sample heart", way_of, volume, rm.simulate(setup).ideal.removed_volume, "mm3", 2e-3, 1)]


BRUTE_FORCE: dict[str, Callable[[], list[Check]]] = {
    ":rows": _rows_multiplied,
    ":jacobian": _numeric_jacobian,
    ":twist": _twisted_joints,
    ":energy": _energy,
    ":revolution": _revolution,
    ":sag": _sag,
    ":points": _strewn_points,
}


# ---- peers ---------------------------------------------------------------------------------------------------------
def _pinocchio() -> list[Check]:
    """The arm as Pinocchio's own model, joint by joint."""
    import pinocchio as pin

    robot = rm.load_robot("kuka_kr500")
    model, chain = pin.Model(), robot.chain
    parent, before = 0, np.array(chain.T_0)
    for i in range(robot.n):
        placement = pin.SE3(before[:3, :3] @ Rotation.from_euler("z", chain.offset[i]).as_matrix(), before[:3, 3])
        axis = np.array([0.0, 0.0, float(chain.sign[i])])
        parent = model.addJoint(parent, pin.JointModelRevoluteUnaligned(axis), placement, f"j{i}")
        before = np.array(chain.E[i])
    model.addFrame(pin.Frame("tip", parent, pin.SE3(before[:3, :3], before[:3, 3]), pin.FrameType.OP_FRAME))
    data, tip, worst = model.createData(), model.getFrameId("tip"), np.zeros(2)
    for theta in _configurations(robot, 200):
        J = pin.computeFrameJacobian(model, data, theta, tip, pin.LOCAL_WORLD_ALIGNED)
        pin.framesForwardKinematics(model, data, theta)
        off = np.linalg.norm(data.oMf[tip].translation - rm.tool_pose(robot, theta)[:3, 3])
        worst = np.maximum(worst, [off, np.abs(J - rm.geometric_jacobian(robot, theta)).max()])
    version = f"Pinocchio {pin.__version__}"
    return [
        Check("tip of a KUKA KR500, farthest of 200", version, 0.0, float(worst[0]), "m", 1e-12, 4, 1.0),
        Check("J of the same, largest difference", version, 0.0, float(worst[1]), "1", 1e-12, 4, 1.0),
    ]


def _scipy() -> list[Check]:
    """SciPy's non-negative least squares on equations (16), with a numeric Jacobian."""
    robot = rm.load_robot(PAPER_ARM)
    tests = rm.read_load_tests(samples_dir() / "load_tests" / "nine_points.csv", robot)
    found, rows, read = rm.identify(robot, tests).C_theta, [], []
    for T, wrench, moved in zip(tests.tool_poses(robot), tests.wrench, tests.displacement):
        theta, h = rm.inverse_kinematics(robot, T).theta, 1e-6
        J = np.array([(_tip(robot, theta + e) - _tip(robot, theta - e)) / (2 * h) for e in h * np.eye(5)]).T
        rows.append(J * (J.T @ wrench[:3]))
        read.append(moved[:3])
    solved = nnls(np.concatenate(rows) * 1e-6, np.concatenate(read))[0] * 1e-6
    return [
        Check(f"C_θ{j} identified from the nine points", "SciPy's nnls, numeric Jacobian", float(solved[j - 1]), float(found[j - 1]), "1e-7 rad/(N m)", 1e-4, 2)
        for j in range(1, 6)
    ]


def _shapely() -> list[Check]:
    """What the cutter passes over, as a union of capsules."""
    import shapely

    setup = rm.load_setup(samples_dir() / "word")
    path = setup.toolpath
    level = [
        shapely.LineString([path.p[i - 1, :2], path.p[i, :2]])
        for i in np.flatnonzero(path.cutting)
        if i and np.ptp(path.p[i - 1 : i + 1, 2]) < 1e-9 and np.ptp(path.p[i - 1 : i + 1, :2], axis=0).max() > 1e-9
    ]
    area = shapely.union_all(level).buffer(setup.cutter.radius, quad_segs=200).area
    surface = rm.simulate(setup).ideal
    depth = float(setup.stock_block.upper[2] - surface.z.min())
    return [Check("volume of the sample word", f"Shapely {shapely.__version__}: union of its strokes, times the depth", area * depth, surface.removed_volume, "mm3", 2e-3, 1)]


def _manifold() -> list[Check]:
    """A drawn body taken from a block by a solid modeller."""
    import manifold3d

    R, depth = 4.0, 2.0
    tool = manifold3d.Manifold.cylinder(2 * depth, R, R, 512)
    points = [(10.0, 10.0), (30.0, 18.0), (24.0, 6.0)]
    passes = [manifold3d.Manifold.batch_hull([tool.translate([*p, -depth]) for p in pair]) for pair in zip(points, points[1:])]
    block = manifold3d.Manifold.cube([40.0, 28.0, 10.0]).translate([0.0, 0.0, -10.0])
    taken = block.volume() - (block - manifold3d.Manifold.batch_boolean(passes, manifold3d.OpType.Add)).volume()
    p = np.array([[x, y, -depth] for x, y in points]) * 1e-3
    surface = cut(Stock([0.0, 0.0, -10e-3], [40e-3, 28e-3, 0.0]), 1e-4, Cutter("flat", 2e-3 * R), p)
    return [Check("volume of two slots that meet", "Manifold: solids of 512 sides", taken * 1e-9, surface.removed_volume, "mm3", 2e-3, 2)]


def _rotations() -> list[Check]:
    A, B = 0.3, -0.5
    by_scipy = Rotation.from_euler("XYZ", [A, B, 0.0]).as_matrix()
    apart = np.abs(rm.pose_from_world([0.0, 0.0, 0.0, A, B])[:3, :3] - by_scipy).max()
    return [Check("rotation of a tilted tool, A and B", "SciPy's Rotation, intrinsic XYZ", 0.0, float(apart), "1", 1e-14, 4, 1.0)]


def _arcs() -> list[Check]:
    """The length of a full circle in the chords that stand for it."""
    path = read_gcode("G21 G17 G90\nG0 X20 Y0 Z5\nG1 Z-1 F300\nG2 X20 Y0 I-20 J0\nM30\n")
    flat = path.p[path.p[:, 2] < -0.5e-3]
    length = float(np.linalg.norm(np.diff(flat, axis=0), axis=1).sum())
    return [Check("length of a circle of 20 mm from G2", "2 π r", 2 * math.pi * 20e-3, length, "mm", 1e-4, 3)]


CLOSED_FORMS[":arcs"] = _arcs
PEERS: dict[str, Callable[[], list[Check]]] = {
    "pinocchio": _pinocchio,
    "scipy:nnls": _scipy,
    "scipy:rotation": _rotations,
    "shapely": _shapely,
    "manifold3d": _manifold,
}
