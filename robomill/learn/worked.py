"""What stands on a tile or in a cell of a map, worked out: its law, the same with the numbers of now, where the paper
has it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.at_pose import PoseReport
from robomill.compliance.components import COMPONENTS
from robomill.compliance.deflection import deflection, displacement, shares_along
from robomill.cutting.forces.mechanistic import MechanisticForce, MechanisticRow
from robomill.kinematics.dexterity import task_matrix
from robomill.learn.equations import column, component, matrix, product, settled, texts
from robomill.simulation.judging.gauge import Readings
from robomill.simulation.judging.verdict_words import FLOOR, TIP, WALL, Reading, ReadingKind
from robomill.simulation.result import SimulationResult
from robomill.units import from_si, unit_label

SAME = 1e-9  # m, N: what a law gives otherwise is not what was simulated
ALL = r"\mathbf{C}_X = \mathbf{J}\,\mathbf{C}_\theta\,\mathbf{J}^T"


@dataclass(frozen=True)
class Worked:
    """What is worked out (``name``), its ``law`` and the same with ``numbers`` as TeX, where it stands in the paper,
    and in which units the numbers are."""

    name: str
    law: str
    numbers: str
    paper: str
    units: str

    @property
    def tex(self) -> str:
        """Both, to be taken along."""
        return f"{self.law}\n\n{self.numbers}"


def at_the_pose(pose: PoseReport, F: FloatArray | None = None, delta: FloatArray | None = None) -> list[Worked]:
    """Compliance, determinant and, where the joints alone let a force F (3,) N move the tip by delta (3,) m, that and
    their shares."""
    if not pose.reached:
        return []
    found = [_component(pose, name) for name in COMPONENTS]
    found += [_whole(pose), _largest(pose)]
    if pose.has_det_J:
        found.append(_determinant(pose))
    if F is not None and delta is not None and np.any(F) and _is(displacement(pose.C, F), delta):
        found = [*_displaced(pose.C, F), *_shares(pose, F), *found]
    return found


def of_the_run(result: SimulationResult, i: int) -> list[Worked]:
    """Readings of the verdict, and where it is decided (sample ``i``) the force and what it does."""
    verdict, gauge = result.verdict, result.gauge
    found = _read(result, WALL, verdict.wall, gauge.walls) + _read(result, FLOOR, verdict.floor, gauge.floors)
    rests = verdict.deciding
    if rests is not None and np.isfinite(rests[1].share):
        found.append(_share_of_tolerance(rests[1]))
    if i >= 0 and np.isfinite(result.delta[i]).all() and np.isfinite(result.F[i]).all():
        if _is(displacement(result.C[i], result.F[i]), result.delta[i]):
            found += _displaced(result.C[i], result.F[i])
        found += _force(result, i)
    return found


def _is(one: FloatArray, other: FloatArray) -> bool:
    return bool(np.allclose(one, other, rtol=0.0, atol=SAME))


def _component(pose: PoseReport, name: str) -> Worked:
    a, b = ("xyz".index(axis) for axis in name)
    J = rf"J_{{{name[0]}i}}^{{\,2}}" if a == b else rf"J_{{{name[0]}i}}\,J_{{{name[1]}i}}"
    return Worked(
        f"C_{name}",
        rf"C_{{{name}}} = \sum_{{i}} C_{{\theta i}}\,{J}",
        component(pose, a, b),
        "eqs. (13), (14)",
        f"Cθ in 10⁻⁶ rad/(N m), J in m/rad, C in {unit_label('um/N')}.",
    )


def _whole(pose: PoseReport) -> Worked:
    n = pose.robot.n

    def law(J: FloatArray, C: FloatArray) -> FloatArray:
        return (J * C) @ J.T

    J, C, found = settled(law, 3, (pose.J[:3], 3), (from_si(pose.robot.C_theta, "urad/(N m)"), 3))
    return Worked(
        "C, all of it",
        ALL,
        rf"\mathbf{{J}} = {matrix(J, n)},\quad \mathbf{{C}}_\theta = \operatorname{{diag}}({', '.join(C)}),\quad "
        rf"\mathbf{{J}}\,\mathbf{{C}}_\theta\,\mathbf{{J}}^T = {matrix(found, 3)}",
        "eqs. (9), (11), (12)",
        f"The rows of J for X, Y, Z, m/rad; Cθ in 10⁻⁶ rad/(N m); C in {unit_label('um/N')}.",
    )


def _largest(pose: PoseReport) -> Worked:
    values, axes = pose.principal

    def law(u: FloatArray, C: FloatArray) -> FloatArray:
        return np.asarray(u @ C @ u)

    u, C, (found,) = settled(law, 3, (axes[:, -1], 3), (from_si(pose.C, "um/N"), 3))
    return Worked(
        "Largest compliance",
        r"C_{max} = \max_{|\mathbf{u}| = 1} \mathbf{u}^T \mathbf{C}\,\mathbf{u}",
        rf"{column(u)}^T {matrix(C, 3)} {column(u)} = {found}",
        "of C by eq. (12)",
        f"u is the direction that gives most, C in {unit_label('um/N')}.",
    )


def _determinant(pose: PoseReport) -> Worked:
    J = task_matrix(pose.robot, pose.theta)
    cells, (found,) = settled(np.linalg.det, 3, (J, 4))
    return Worked(
        "det(J)",
        r"\det(\mathbf{J})",
        rf"\det {matrix(cells, J.shape[1])} = {found}",
        "Fig. 4, J by eq. (9)",
        f"The rows of J are those of the arm's task, m/rad and rad/rad; the result in {unit_label(pose.det_J_unit)}.",
    )


def _displaced(C: FloatArray, F: FloatArray) -> list[Worked]:
    delta = displacement(C, F)
    parts, (size,) = settled(np.linalg.norm, 1, (from_si(delta, "um"), 1))
    root = " + ".join(f"({part})^2" for part in parts)
    return [
        Worked(
            "Displacement of the tip",
            r"\boldsymbol{\delta} = \mathbf{C}\,\mathbf{F}",
            product(C, F),
            "eqs. (15), (16)",
            f"C in {unit_label('um/N')}, F in N, δ in µm, all in the robot frame.",
        ),
        Worked(
            TIP.label,
            r"|\boldsymbol{\delta}| = \sqrt{\delta_x^2 + \delta_y^2 + \delta_z^2}",
            rf"\sqrt{{{root}}} = {size}",
            "Sec. 4.2",
            "All in µm.",
        ),
    ]


def _shares(pose: PoseReport, F: FloatArray) -> list[Worked]:
    parts = deflection(pose.C_joint, F)
    delta = parts.sum(axis=0)
    found = []
    for k in np.argsort(-shares_along(parts, delta), kind="stable")[:3]:
        joint, own, whole = pose.robot.joint_numbers[k], from_si(parts[k], "um"), from_si(delta, "um")

        def law(own: FloatArray, whole: FloatArray) -> FloatArray:
            return 100.0 * shares_along(own[None], whole)

        one, all_, (share,) = settled(law, 0, (own, 1), (whole, 1))
        above = " + ".join(f"({a})({b})" for a, b in zip(one, all_, strict=True))
        below = " + ".join(f"({b})^2" for b in all_)
        found.append(
            Worked(
                f"Share of joint {joint}",
                rf"s_{{{joint}}} = \frac{{\boldsymbol{{\delta}}_{{{joint}}} \cdot \boldsymbol{{\delta}}}}"
                r"{\boldsymbol{\delta} \cdot \boldsymbol{\delta}}",
                rf"100\,\% \cdot \frac{{{above}}}{{{below}}} = {share}\,\%",
                "eq. (16)",
                "Displacements in µm.",
            )
        )
    return found


def _read(result: SimulationResult, kind: ReadingKind, reading: Reading, kept: Readings) -> list[Worked]:
    """What a gauge reads, where it is what the tip does there: several passes may have made the surface."""
    at = np.flatnonzero((kept.sample == reading.worst) & (kept.error == reading.value))
    if reading.worst < 0 or not len(at):
        return []
    way, moved = kept.way[at[0]], from_si(result.delta_in_cut[reading.worst], "um")
    if abs(float(way @ moved) - float(from_si(reading.value, "um"))) > from_si(SAME, "um"):
        return []
    n, d, (error,) = settled(lambda n, d: n @ d, 1, (way, 3), (moved, 1))
    terms = " + ".join(f"({a})({b})" for a, b in zip(n, d, strict=True))
    return [
        Worked(
            kind.label,
            r"e = n_f\,\delta_f + n_n\,\delta_n + n_a\,\delta_a",
            rf"{terms} = {error}",
            "Sec. 4.2",
            f"δ at line {int(result.path.block[reading.worst])} along the feed, to its left and along the tool, in µm; "
            "n is how the surface follows it.",
        )
    ]


def _share_of_tolerance(reading: Reading) -> Worked:
    given = from_si(np.array([abs(reading.value), reading.tolerance]), "um")
    (value, allowed), (share,) = settled(lambda v: 100.0 * v[0] / v[1], 0, (given, 1))
    return Worked(
        "Share of the tolerance",
        r"s = |e|\,/\,t",
        rf"100\,\% \cdot \frac{{{value}}}{{{allowed}}} = {share}\,\%",
        "not in the paper",
        "Error and tolerance in µm.",
    )


def _force(result: SimulationResult, i: int) -> list[Worked]:
    """The mean force across the feed, where the closed form of a straight edge is what was simulated."""
    model = result.setup.force
    if not isinstance(model, MechanisticForce) or not isinstance(model.row, MechanisticRow):
        return []
    c, cutter, row = result.conditions, result.tooling.at(i), model.row
    if not (c.n_s[i] > 0.0 and c.a_p[i] > 0.0 and cutter.flutes > 0):
        return []
    f_z = float(c.v_f[i] / (c.n_s[i] * cutter.flutes))
    lengths = from_si(np.array([c.a_p[i], f_z]), "mm")
    K = np.array([*from_si(np.array([row.Ktc, row.Krc]), "N/mm2"), *from_si(np.array([row.Kte, row.Kre]), "N/mm")])
    angles = np.array([c.phi_st[i], c.phi_ex[i]])

    def law(a: FloatArray, K: FloatArray, phi: FloatArray) -> float:
        return _across(cutter.flutes, a, K, phi)

    if texts(law(lengths, K, angles), 1) != texts(result.force_components[i, 1], 1):
        return []  # a helix, a nose, an arc that changes over the depth: no closed form
    (a, fz), (Ktc, Krc, Kte, Kre), (st, ex), (force,) = settled(law, 1, (lengths, 4), (K, 2), (angles, 4))
    N, sweep = cutter.flutes, rf"\Big]_{{{st}}}^{{{ex}}}"
    return [
        Worked(
            "Force across the feed",
            r"F_n = \frac{N a c}{8\pi}\Big[K_{tc}(2\varphi - \sin 2\varphi) + K_{rc}\cos 2\varphi\Big]_{\varphi_{st}}"
            r"^{\varphi_{ex}} - \frac{N a}{2\pi}\Big[K_{te}\cos\varphi + K_{re}\sin\varphi\Big]_{\varphi_{st}}"
            r"^{\varphi_{ex}}",
            rf"\frac{{{N} \cdot {a} \cdot {fz}}}{{8\pi}}"
            rf"\Big[{Ktc}(2\varphi - \sin 2\varphi) + {Krc}\cos 2\varphi{sweep}"
            rf" - \frac{{{N} \cdot {a}}}{{2\pi}}\Big[{Kte}\cos\varphi + {Kre}\sin\varphi{sweep} = {force}",
            "not in the paper: Altintas, Manufacturing Automation",
            "N teeth; a, c in mm; Ktc, Krc in N/mm²; Kte, Kre in N/mm; φ in rad; the force in N, left of the feed.",
        )
    ]


def _across(teeth: int, lengths: FloatArray, K: FloatArray, phi: FloatArray) -> float:
    """N: the feed-normal mean force of straight edges over the arc ``phi`` (2,) rad; lengths a, c in mm."""
    (a, c), (Ktc, Krc, Kte, Kre) = lengths, K
    chip = np.diff(Ktc * (2.0 * phi - np.sin(2.0 * phi)) + Krc * np.cos(2.0 * phi)).item()
    edge = np.diff(Kte * np.cos(phi) + Kre * np.sin(phi)).item()
    return float(teeth * a * c / (8.0 * np.pi) * chip - teeth * a / (2.0 * np.pi) * edge)
