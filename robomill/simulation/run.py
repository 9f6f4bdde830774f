"""One run, end to end: path -> poses -> joints -> compliance -> force -> deflection -> surfaces."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from robomill import budgets
from robomill.arguments import asked
from robomill.arrays import FloatArray
from robomill.compliance.cartesian import joint_contributions
from robomill.compliance.deflection import deflection
from robomill.compliance.gravity import LinkMasses, gravity_sag
from robomill.compliance.spring import extra_contributions
from robomill.cutting.conditions import CutConditions
from robomill.cutting.force import feed_frame
from robomill.cutting.unjudged import Unjudged
from robomill.errors import ToolpathError
from robomill.kinematics.forward import joint_frames
from robomill.kinematics.inverse import LEAST_MOTION, IKResult, Spin, inverse_kinematics
from robomill.kinematics.jacobian import geometric_jacobian
from robomill.kinematics.spin import LEAST_DEVIATION, OverSpin, over_spins, spin_matters
from robomill.kinematics.transforms import pose_from_world, rotation_z, tilt_from_axis, transform
from robomill.progress import checkpoint, gathered, slices
from robomill.simulation.coupling import COUPLING, Coupling
from robomill.simulation.cut import (
    Led,
    cut_conditions,
    met_conditions,
    rotary_asked,
    steps_in_stock,
    through_stock,
    told_conditions,
    unknown_material,
)
from robomill.simulation.judging.leaning import leaning, lying
from robomill.simulation.judging.sinking import clear, fallen, pressing, sinking, told_to_sink
from robomill.simulation.led import against, led_beside, led_conditions, plunges
from robomill.simulation.mapped import beyond_map, total_compliance
from robomill.simulation.marching import Bent, march_coupled
from robomill.simulation.meant import linked, meant, straight_on
from robomill.simulation.result import SimulationResult
from robomill.simulation.samples import sampled, ways
from robomill.simulation.setup import SimulationSetup, check_setup
from robomill.simulation.threads import threads_in_cut
from robomill.simulation.tools import farther, held
from robomill.simulation.turning import turns_in_cut
from robomill.surface.contact.engagement import engage
from robomill.toolpath.path import Toolpath
from robomill.toolpath.sampling import check_samples
from robomill.toolpath.source import GCodeSource

Simulate = Callable[[SimulationSetup], SimulationResult]
"""What runs a set-up: ``simulate``, or something that keeps its results."""


@asked
def simulate(setup: SimulationSetup) -> SimulationResult:
    """How far the tip is pushed off its path by the cutting force, and what that leaves of the part.

    Parameters
    ----------
    setup : SimulationSetup
        Robot, path, part zero, cutter, force, stock, tolerance and numerics.

    Returns
    -------
    SimulationResult
        Arrays over the samples of the path, SI, in {M}; surfaces, sections and the verdict are made when asked for.
        Points that cannot be reached are NaN and counted in ``reached``. Of a program that was corrected, and is told
        for which path (``wanted``), the deviation is that from this path.

    Raises
    ------
    RobomillError
        One of its children, naming what cannot be run: a path without a cut, a stock that does not fit the memory.

    Notes
    -----
    Eqs. (11) to (16): C of every configuration from its Jacobian, delta = C F.

    Examples
    --------
    >>> import robomill as rm
    >>> robot = rm.load_robot("slavkovic_5r")
    >>> path = rm.Toolpath.from_points(p_mm=[[0, 0, -2], [40, 0, -2]], feed_mm_min=1800)
    >>> setup = rm.SimulationSetup(
    ...     robot=robot,
    ...     source=path,
    ...     cutter=rm.Cutter("flat", diameter_mm=8, flutes=3),
    ...     force=rm.ConstantForce((0.0, 100.0, 0.0)),
    ...     part_zero_mm=(0, -1300, 0),
    ... )
    >>> result = rm.simulate(setup)
    >>> float((result.deviation[-1] * 1e3).round(3))
    0.252
    """
    check_setup(setup)
    return ran(setup)


def ran(setup: SimulationSetup, *, softer: float = 1.0, stronger: float = 1.0) -> SimulationResult:
    """The run of ``setup``; of a corrected program, of which it is told what is wanted, against that path. ``softer``
    and ``stronger`` as in ``along``."""
    path = stepped(setup, setup.toolpath)
    if setup.wanted_path is None:
        return along(setup, path, softer=softer, stronger=stronger)
    checkpoint(0.0, "Where the program was meant to go")
    asked_for = stepped(setup, setup.wanted_path)
    mark = setup.source.mark if isinstance(setup.source, GCodeSource) else None
    wanted, untold = meant(path, asked_for, setup.step, mark.components if mark else ())
    told = told_conditions(setup, wanted, np.ones(len(wanted), dtype=bool))
    links = linked(path, wanted)
    led = led_beside(wanted, path.p, plunges(wanted, told), links)
    run = along(setup, path, led=led, spin=spin_along(setup, asked_for), softer=softer, stronger=stronger)
    return against(run, wanted, feed_directions(setup, wanted), links | straight_on(path, wanted), untold)


def stepped(setup: SimulationSetup, whole: Toolpath) -> Toolpath:
    """``whole`` as a run of ``setup`` evaluates it, in short steps. Raises ToolpathError where they are too many, and
    where nothing is cut."""
    path = sampled(whole, setup.step, partial(steps_in_stock, setup) if setup.engagement else None)
    if setup.engagement:
        check_samples(whole, setup.step, len(path), budgets.samples(marched=True))
    if not path.cutting.any():
        raise ToolpathError("The path has no feed move, so nothing is cut: add a G1 move, or a point with a feed.")
    return path


def along(
    setup: SimulationSetup,
    path: Toolpath,
    *,
    led: Led | None = None,
    spin: Spin | FloatArray | None = None,
    softer: float = 1.0,
    stronger: float = 1.0,
) -> SimulationResult:
    """The run of ``setup`` along a path in {W} as it is sampled.

    ``led`` says where the tool goes if not as the path tells it to, ``spin`` (rad; or (m,), a course of it) how the arm
    holds it if not as the set-up says; ``softer`` is what all that gives is multiplied by, ``stronger`` what the force
    is: how a result changes where they are wrong.
    """
    checkpoint(0.0, "Trying arm positions")
    ik = configurations(setup, path, spin)
    checkpoint(0.0, "Compliance")
    C_joint, C_spring = compliances(setup, path, ik.theta)
    C = softer * total_compliance(setup, path, C_joint, C_spring)
    C_joint, C_spring = (each if softer == 1.0 else softer * each for each in (C_joint, C_spring))
    checkpoint(stage="Force and deflection")
    sag = None if setup.links is None else softer * sags(setup, path, ik.theta, setup.links)
    offset = _offset(setup, path, sag)
    told, frames = told_conditions(setup, path, ik.reached, led), feed_directions(setup, path, led)
    bent = Bent(setup, path, told, C, frames, offset, stronger, led)
    conditions, F, unjudged, coupling = forces(bent)
    unjudged += leaning(path, ik)
    checkpoint(0.0, "Deflection")
    return SimulationResult(
        setup=setup,
        path=path,
        ik=ik,
        C_joint=C_joint,
        C_spring=C_spring,
        C=C,
        conditions=conditions,
        R_MF=bent.R_MF,
        F=F,
        delta_joint=gathered(len(path), "Deflection", lambda some: deflection(C_joint[some], F[some])),
        delta_spring=gathered(len(path), "Deflection", lambda some: deflection(C_spring[some], F[some])),
        delta=known(bent.delta(F), unjudged),
        sag=sag,
        coupling=coupling,
        unjudged=unjudged + beyond_map(setup, path, ik.reached) + lying(path),
    )


def configurations(setup: SimulationSetup, path: Toolpath, held: Spin | FloatArray | None = None) -> IKResult:
    """How the arm stands along the sampled path: branches joined, the spin about the tool as the set-up has it, or as
    it is ``held``, one for all or (m,) rad."""
    if isinstance(held, np.ndarray):
        turned = tool_poses(setup, path) @ transform(rotation_z(held), np.zeros(3))
        return inverse_kinematics(setup.robot, turned, near="path", spin="fixed")
    spin: Spin = setup.spin if isinstance(setup.spin, float) else LEAST_MOTION
    if held is not None:
        spin = held
    elif setup.spin == LEAST_DEVIATION and setup.robot.n >= 6:
        over = deviation_over_spin(setup, path)
        spin = float(over.angle[over.best])
    return inverse_kinematics(setup.robot, tool_poses(setup, path), near="path", spin=spin)


def spin_along(setup: SimulationSetup, path: Toolpath) -> Spin | None:
    """The spin (rad) that the arm chooses along a path, which a program that was corrected for it keeps, wherever it
    comes from; None where there is none to choose."""
    return spin_of(configurations(setup, path)) if chooses_spin(setup) else None


def chooses_spin(setup: SimulationSetup) -> bool:
    """Whether the arm is free to choose how it turns about its tool, and it matters."""
    return not isinstance(setup.spin, float) and spin_matters(setup.robot)


def spin_of(ik: IKResult) -> Spin:
    """The one spin (rad) of configurations along a path; that of least motion where there is none, or more than one."""
    one = ik.spin is not None and len(ik.spin) > 0 and np.ptp(ik.spin) == 0.0
    return float(ik.spin[0]) if ik.spin is not None and one else LEAST_MOTION


def deviation_over_spin(setup: SimulationSetup, path: Toolpath) -> OverSpin:
    """The largest deviation, m, at feed along the sampled path for each spin about the tool, one spin a path.

    The force is that of the uncoupled run at the spin of least motion: it does not know the arm.
    """
    T_MT = tool_poses(setup, path)
    ik = inverse_kinematics(setup.robot, T_MT, near="path")
    C = total_compliance(setup, path, *compliances(setup, path, ik.theta))
    told = told_conditions(setup, path, ik.reached)
    bent = Bent(setup.replace(coupling=False), path, told, C, feed_directions(setup, path), np.zeros((len(path), 3)))
    F = forces(bent)[1]

    def largest(theta: FloatArray) -> float:
        checkpoint()
        C = total_compliance(setup, path, *compliances(setup, path, theta))
        size = np.linalg.norm(replace(bent, C=C).delta(F), axis=1)[path.cutting]
        return float(np.nanmax(size)) if np.isfinite(size).any() else float("nan")

    return over_spins(setup.robot, T_MT, largest)


def compliances(setup: SimulationSetup, path: Toolpath, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Shares of the joints (..., m, n, 3, 3) and of the springs beside them (..., m, k, 3, 3), m/N, eqs. (13), (14), of
    configurations theta (..., m, n) along the path."""
    m = theta.shape[:-1]
    C_joint, C_spring = np.empty((*m, setup.robot.n, 3, 3)), np.empty((*m, len(setup.springs), 3, 3))
    for tool in held(setup, path):
        steps = np.flatnonzero(tool.steps)
        for some in slices(len(steps), "Compliance"):
            i = steps[some]
            J = geometric_jacobian(tool.robot, theta[..., i, :])
            C_joint[..., i, :, :, :] = joint_contributions(J[..., :3, :], setup.robot.C_theta)
            if tool.springs:
                C_spring[..., i, :, :, :] = extra_contributions(
                    tool.springs, joint_frames(tool.robot, theta[..., i, :])
                )
    return C_joint, C_spring


def sags(setup: SimulationSetup, path: Toolpath, theta: FloatArray, links: LinkMasses) -> FloatArray:
    """(..., m, n, 3) m: shares of the joints in the sag of the tip, of configurations theta (..., m, n)."""
    sag = np.empty((*theta.shape, 3))
    for tool in held(setup, path):
        carried = links.behind(tool.longer)
        steps = np.flatnonzero(tool.steps)
        for some in slices(len(steps), "Sag"):
            sag[..., steps[some], :, :] = gravity_sag(tool.robot, theta[..., steps[some], :], carried)
    return sag


def forces(bent: Bent) -> tuple[CutConditions, FloatArray, tuple[Unjudged, ...], Coupling | None]:
    """Conditions, force F (m, 3) N in {M}, what it has no model for, and how a coupled run was solved."""
    setup, path = bent.setup, bent.path
    if setup.force.follows_cut and told_to_sink(bent.told).any():
        bent = replace(bent, told=sinking(bent.told, path, *_tips(bent), partial(_lift, bent)))
    conditions, F = _once(bent)
    if not setup.coupling:
        return conditions, F, _reasons(bent, conditions), None
    coupled = march_coupled(bent, bent.delta(F))
    reasons = _reasons(bent, coupled.conditions) + coupled.unjudged
    cut = coupled.conditions.engaged
    known = cut & ~np.any([np.zeros_like(cut), *(each.where for each in reasons)], axis=0)
    judged = float(known.sum() / cut.sum()) if cut.any() else 1.0
    return coupled.conditions, coupled.F, reasons, replace(coupled.coupling, judged=judged)


def _offset(setup: SimulationSetup, path: Toolpath, sag: FloatArray | None) -> FloatArray:
    """(m, 3) m in {M}: what the tip is off without a force, the ``sag`` (m, n, 3) m of the joints where it is added."""
    return sag.sum(axis=-2) if sag is not None and setup.add_sag else np.zeros((len(path), 3))


def kept_to_path(run: SimulationResult) -> SimulationResult:
    """A ``run`` as if every tip went where it is told to, and the end of its tool sank as steeply: what force and
    place could not agree on is known there."""
    setup, path = run.setup, run.path
    told = told_conditions(setup, path, run.ik.reached)
    bent = Bent(setup, path, told, run.C, run.R_MF, _offset(setup, path, run.sag))
    conditions, F = _once(bent)
    unjudged = tuple(each for each in run.unjudged if each.code != COUPLING)
    return replace(run, conditions=conditions, F=F, delta=known(bent.delta(F), unjudged), unjudged=unjudged)


def _once(bent: Bent) -> tuple[CutConditions, FloatArray]:
    """Conditions and force along the path as it is told, or led."""
    setup, path, told, led = bent.setup, bent.path, bent.told, bent.led
    if not setup.engagement:
        conditions = told
    elif led is None:
        conditions = cut_conditions(setup, path, told)
    else:
        conditions = led_conditions(setup, path, told, led)
    return conditions, bent.force(conditions, bent.R_MF)


def _tips(bent: Bent) -> tuple[FloatArray, Callable[[], FloatArray] | None]:
    """(m, 3) m in {W}: where the tips go if no end of a tool met anything; where they were meant to, if led. And what
    says of each step how far (m,) m its own fall lifts the tip; None where nothing does."""
    if bent.led is not None:
        return bent.led.meant, None
    free = replace(bent, told=clear(bent.told))
    tips = np.asarray(bent.path.p + bent.setup.to_part(np.nan_to_num(free.delta(_once(free)[1]))))
    return tips, partial(_own_lift, free, tips) if bent.setup.engagement else None


def _own_lift(free: Bent, tips: FloatArray) -> FloatArray:
    """(m,) m: how much less the ``tips`` (m, 3) m of a run would be lifted at the end of each step that goes down, were
    it not deeper there than where it began."""
    path = free.path
    raised = np.maximum(fallen(path, path.p), 0.0)[:, None] * path.k
    found = engage(through_stock(free.setup, path, free.told, looked=raised))
    delta = free.delta(free.force(met_conditions(free.told, found), free.R_MF))
    return np.einsum("mi,mi->m", tips - path.p - free.setup.to_part(np.nan_to_num(delta)), path.k)


def _lift(bent: Bent) -> FloatArray:
    """(m, 3) m in {W}: how far whole ends of tools that press on their floors hold the tips off where they go if no end
    met anything."""
    told = pressing(bent.told)
    F, free = (bent.force(each, bent.R_MF) for each in (told, clear(told)))
    return np.asarray(bent.setup.to_part(np.nan_to_num(bent.delta(F) - bent.delta(free))))


def _reasons(bent: Bent, conditions: CutConditions) -> tuple[Unjudged, ...]:
    """Where the force has no model, and why."""
    force, path = bent.setup.force, bent.path
    turning = turns_in_cut(path, conditions) if force.follows_cut else ()
    threads = threads_in_cut(path, conditions) if force.of_milling else ()
    return (
        force.unjudged(conditions) + turning + threads + unknown_material(conditions) + rotary_asked(path, conditions)
    )


def known(delta: FloatArray, unjudged: tuple[Unjudged, ...]) -> FloatArray:
    """``delta`` (m, 3), NaN where it is not judged."""
    for each in unjudged:
        delta = np.where(each.where[:, None], np.nan, delta)
    return delta


def tool_poses(setup: SimulationSetup, path: Toolpath) -> FloatArray:
    """(m, 4, 4) T_MT along the path, for the first tool's length."""
    back = farther(setup, path)
    return gathered(
        len(path), "Poses", lambda some: np.asarray(setup.T_MW @ tool_frames(path.p[some], path.k[some], back[some]))
    )


def tool_frames(p: FloatArray, k: FloatArray, back: FloatArray) -> FloatArray:
    """(m, 4, 4) T_WT: the point ``back`` (m,) m behind the tip p (m, 3) m, z_T = k (m, 3), spin about z_T as
    R_x(A) R_y(B) gives it."""
    return pose_from_world(np.column_stack([p + back[:, None] * k, tilt_from_axis(k)]))


def feed_directions(setup: SimulationSetup, path: Toolpath, led: Led | None = None) -> FloatArray:
    """(m, 3, 3) R_MF, columns feed, feed-normal, axial in {M}."""
    frames = feed_frame(ways(path) if led is None else led.way, path.k)
    return gathered(len(path), "Ways of the feed", lambda some: np.asarray(setup.T_MW[:3, :3] @ frames[some]))
