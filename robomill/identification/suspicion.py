"""What looks wrong in the measurements before anything is fitted: signs, units, copies. Said aloud, never mended."""

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.gravity import GRAVITY
from robomill.errors import LoadTestError
from robomill.identification.fit.models import Model
from robomill.identification.fit.system import build_system
from robomill.identification.length_units import length_suspicions
from robomill.identification.load_test import JointTests, LoadTests
from robomill.identification.other_axes import axes_suspicions
from robomill.identification.other_senses import sense_suspicions
from robomill.provenance import Finding
from robomill.robot.model import Robot
from robomill.robot.sources import block_in_force
from robomill.units import to_si
from robomill.wording import listed

PLAUSIBLE = (5e-8, 1e-4)  # m/N at the tip: stiffer than any arm of joints, to one that can be pushed about by hand
PLAUSIBLE_JOINT = (1e-8, 1e-3)  # rad/(N m): stiffer than the joints that lift a tonne, to those of a table-top arm
SMALL = 1e-6  # of the largest motion of a component: none
FEW = 4  # tests in which a component may be zero by chance
FACTOR = 8.0  # against the robot's own compliances
MOST = 200  # tests that are looked at; more are thinned evenly
POUND = 4.4482216152605  # N a pound-force
ALIKE = 0.2  # of the displacements that the robot's own compliances leave over, when scaled by one number
SLIPS = {
    "pound-force as N": POUND,
    "kilogram-force as N": -GRAVITY[2],
    "inches as mm": to_si(1.0, "in") / to_si(1.0, "mm"),
    "a wrong prefix": 1e3,
}


def suspicions(tests: LoadTests | JointTests, robot: Robot | None = None) -> tuple[Finding, ...]:
    """Findings on sign, unit and repeated rows.

    A compliance is positive definite, so a displacement *along* its own force is positive; against the force at most
    tests means a flipped sign. ``FACTOR`` against the robot's own values, or where it has none a size that no arm has,
    means a wrong unit; so do points and pulleys that explain far more in another.
    """
    if tests.single:
        return _joint_suspicions(tests, robot)
    explained: tuple[Finding, ...] = ()
    if robot is not None and tests.theta is not None:
        explained = length_suspicions(robot, tests) or sense_suspicions(robot, tests) or axes_suspicions(robot, tests)
    return (*_signs(tests), *_unread(tests, robot), *_sizes(tests, robot), *explained, *_repeats(tests))


def _signs(tests: LoadTests) -> list[Finding]:
    F, read, moved = tests.wrench[:, :3], tests.displacement[:, :3], tests.vectors
    size = np.linalg.norm(F, axis=1)
    along = np.einsum("mgi,mi->mg", tests.directions, F)
    names = [(name, "the force", "it") for name in tests.components]
    if tests.gauges is None:
        names = [(f"d{axis}", f"F{axis}", axis) for axis in tests.components]
    loaded = np.isfinite(moved).all(axis=1) & (size > 0)
    against = loaded & (np.einsum("mi,mi->m", F, np.nan_to_num(moved)) < 0)  # negative work: no spring gives that
    found = []
    flipped = []
    for i, (name, force, main_axis) in enumerate(names):
        main = (np.abs(along[:, i]) > 0.9 * size) & np.isfinite(read[:, i]) & (size > 0)
        wrong = main & (along[:, i] * read[:, i] < 0)
        if main.sum() >= 2 and wrong.sum() > 0.5 * main.sum():
            flipped.append(name)
            found.append(
                f"{name} runs against {force} in {int(wrong.sum())} of the {int(main.sum())} tests loaded along "
                f"{main_axis}"
            )
    if against.sum() > (0.9 if flipped else 0.5) * loaded.sum():
        found.insert(0, f"The tool moves against its force in {int(against.sum())} of {int(loaded.sum())} tests")
        flipped = list(tests.components)
    if flipped:
        what = "the sign of the displacements" if len(flipped) == 3 else f"the sign of {flipped[0]}"
        return [Finding("suspicious", f"{'; '.join(found)}: is {what} or of the forces turned round?", code="sign")]
    return []


def _unread(tests: LoadTests, robot: Robot | None) -> list[Finding]:
    """A component that is zero to the last digit in every test, while others move, though joints would move it."""
    still = (tests.displacement[:, :3] == 0.0).all(axis=0)
    if robot is None or tests.theta is None or len(tests) < FEW or tests.gauges is not None or still.sum() in (0, 3):
        return []
    moves = np.abs(Model("joints").terms(robot, tests)[:, :3, 0]).max(axis=(0, 2))
    still &= moves > SMALL * moves.max()
    if not still.any():
        return []
    names = listed([f"d{axis}" for axis, nothing in zip(tests.components, still, strict=True) if nothing])
    text = (
        f"{names} is zero in every test: was it read? What was not measured is no zero; give what was by gauge1_x, _y, "
        "_z and reading1_mm instead."
    )
    return [Finding("suspicious", text, code="unread")]


def _sizes(tests: LoadTests, robot: Robot | None) -> list[Finding]:
    F, moved = tests.wrench[:, :3], tests.displacement[:, :3]
    size = np.linalg.norm(F, axis=1)
    loaded = size > 0
    if not loaded.any():
        return []
    given = float(np.median(np.sqrt(np.nansum(moved[loaded] ** 2, axis=1)) / size[loaded]))
    if given == 0.0:
        text = "Most displacements are zero: was the gauge read, and to enough digits?"
        return [Finding("suspicious", text, code="no-displacement")]
    found = _off(given, _expected(tests, robot), PLAUSIBLE) or _scaled(tests, robot)
    if found is None:
        return []
    text = f"The displacements are about {found}: is their unit, or the forces', right?"
    return [Finding("suspicious", text, code="unit")]


def _off(given: float, own: float | None, plausible: tuple[float, float]) -> str | None:
    """By how much a compliance is too large or small, and what slip does that; None for one that may be."""
    low, high = plausible if own is None else (own / FACTOR, own * FACTOR)
    if low < given < high:
        return None
    middle, word = float(np.sqrt(low * high)), "larger" if given >= high else "smaller"
    times = max(given / middle, middle / given)
    if own is None:
        return f"{times:.3g} times {word} than those of a usual arm"
    hint = "".join(f" ({slip} makes {factor:.3g})" for slip, factor in SLIPS.items() if 0.6 < times / factor < 1.6)
    return f"{times:.3g} times {word} than this robot's own compliances would give{hint}"


def _knows(robot: Robot | None) -> bool:
    """Whether the compliances of all its joints are known rather than assumed."""
    if robot is None or not np.all(robot.C_theta > 0):
        return False
    source = robot.provenance.get(block_in_force(robot))
    return source is None or source.kind != "assumed"


def _scaled(tests: LoadTests, robot: Robot | None) -> str | None:
    """By how much the readings are the robot's own, all times one number that a slip of the unit makes; None if not."""
    own = _own(tests, robot)
    if own is None:
        return None
    read, predicted = own
    times = float(read @ predicted / max(float(predicted @ predicted), 1e-300))
    if times <= 0.0 or np.linalg.norm(read - times * predicted) > ALIKE * np.linalg.norm(read):
        return None
    for slip, factor in SLIPS.items():
        for made, word in ((factor, "larger"), (1.0 / factor, "smaller")):
            if abs(times / made - 1.0) < 0.1:
                return (
                    f"{max(times, 1.0 / times):.3g} times {word} than this robot's own compliances would give ({slip}?)"
                )
    return None


def _own(tests: LoadTests, robot: Robot | None) -> tuple[FloatArray, FloatArray] | None:
    """Displacements (e,) read, and by the robot's own joint compliances, where these are known."""
    if robot is None or tests.theta is None or not _knows(robot):
        return None
    try:
        system = build_system(robot, tests.thinned(MOST), Model("joints"))
    except LoadTestError:
        return None
    return system.b[system.linear], (system.A @ robot.C_theta)[system.linear]


def _expected(tests: LoadTests, robot: Robot | None) -> float | None:
    """Typical m/N of the readings by the robot's own joint compliances, where these are known."""
    if robot is None or tests.theta is None or not _knows(robot):
        return None
    tests = tests.thinned(MOST)
    try:
        system = build_system(robot, tests, Model("joints"))
    except LoadTestError:
        return None
    size = np.linalg.norm(tests.wrench[:, :3], axis=1)
    moved = np.bincount(system.test[system.linear], (system.A @ robot.C_theta)[system.linear] ** 2, len(tests))
    ratio = np.sqrt(moved[size > 0]) / size[size > 0]
    return float(np.median(ratio)) if np.median(ratio) > 0 else None


def _repeats(tests: LoadTests) -> list[Finding]:
    poses = tests.theta if tests.theta is not None else tests.x_M
    assert poses is not None
    table = np.concatenate([poses, tests.wrench, np.nan_to_num(tests.displacement)], axis=1)
    _, first, back = np.unique(table + 0.0, axis=0, return_index=True, return_inverse=True)
    original = first[back.ravel()]
    copies = np.flatnonzero(original != np.arange(len(table)))
    if len(copies) == 0:
        return []
    again = int(tests.row[copies[0]])
    others = f" (and {len(copies) - 1} more)" if len(copies) > 1 else ""
    text = (
        f"Row {again} repeats row {tests.row[original[copies[0]]]} to the last digit{others}; both are used: "
        "delete the copy unless it was measured twice."
    )
    return [Finding("warning", text, again, count=len(copies), code="repeat", place="")]


def _joint_suspicions(tests: JointTests, robot: Robot | None) -> tuple[Finding, ...]:
    found = []
    against = tests.angle * tests.torque < 0
    if against.mean() > 0.5:
        text = (
            f"The angle runs against the torque in {int(against.sum())} of {len(tests)} tests: is a sign turned round?"
        )
        found.append(Finding("suspicious", text, code="sign"))
    given, own = np.abs(tests.angle / tests.torque), None
    if robot is not None and _knows(robot) and np.isin(tests.joint, robot.joint_numbers).all():
        same = tests.joint[:, None] == np.array(robot.joint_numbers)
        own = float(np.exp(np.median(np.log(robot.C_theta[same.argmax(axis=1)]))))
    off = _off(float(np.median(given)), own, PLAUSIBLE_JOINT)
    if off is not None:
        text = f"The angles a newton metre makes are about {off}: is their unit, or the torques', right?"
        found.append(Finding("suspicious", text, code="unit"))
    return tuple(found)
