"""The paper once: what it prints and claims, in its own words, with our reading beside it.

Slavkovic, Milutinovic, Kokotovic, Glavonjic, Zivanovic, Ehmann, *Cartesian Compliance Identification and Analysis of an
Articulated Machining Robot*, FME Transactions 41 (2013) 83-95. Quotations are exact; indices are written as X_M, C_xx.
Its tables stand as they are printed, in the unit that each names; its milling test and its box, in SI, stand in
``robomill.paper``.
"""

from dataclasses import dataclass
from typing import Literal

from robomill.paper import BOX_SIZE, SLOT
from robomill.units import format_number, format_short, format_si, from_si

Status = Literal["reproduced", "assumed", "gap", "not computed"]
WORDS: dict[Status, str] = {
    "reproduced": "reproduced",
    "assumed": "reproduced with the assumed lengths",
    "gap": "gap",
    "not computed": "nothing to compute",
}

# Table 1: alpha (deg), offset of theta (deg), sense of theta, link by link. Its three lengths are symbols.
TABLE_1 = ((90, 0, 90, -90, 0), (-90, 90, 0, 0, 180), (1, 1, 1, -1, 1))
# Tables 2 and 3: joint compliances in 1e-7 rad/(N m), by the names of the robot's compliance sets.
TABLES = {"table_2": (7.14, 10.12, 12.30, 17.32, 91.35), "table_3": (9.03, 11.17, 14.74, 27.65, 97.58)}
EQUATIONS = 81  # Sec. 5.1: nine points, three forces, three displacements


@dataclass(frozen=True)
class Statement:
    """A table, figure or claim: where it stands, the paper's words, what they give in short, and how we read them.

    reading: what is missing, assumed or chosen; ``{name}`` in it is filled in with what was computed.
    """

    code: str
    where: str
    quotations: tuple[str, ...]
    gives: str
    status: Status
    reading: str


def _joints(name: str) -> str:
    return ", ".join(format_number(value, 2) for value in TABLES[name]) + " × 10⁻⁷ rad/(N m)"


def _box() -> str:
    return " × ".join(format_number(from_si(side, "mm"), 0) for side in BOX_SIZE)


def _mm(length: float) -> str:
    return format_short(length, "mm")


STATEMENTS = (
    Statement(
        "table_1",
        "Table 1, eq. (4)",
        (
            "Considering the above-mentioned remarks and constraints, a list of D-H kinematic parameters for each link "
            "is given in Table 1.",
        ),
        "D-H angles, offsets and signs of five links",
        "reproduced",
        "Typed from the table.",
    ),
    Statement(
        "lengths",
        "Table 1, a₂, d₄, a₅; Figs. 1, 2",
        (
            "Figure 2 shows the D-H coordinate frames for the 5-axis robot from Figure 1 in the reference position, "
            "taking into account the ranges of joint motions.",
        ),
        "symbols without numbers",
        "gap",
        f"The lengths are not printed. These reach the whole box and give the paper's {_mm(SLOT.from_table_2)}; they "
        "are assumed and editable.",
    ),
    Statement(
        "jacobian",
        "Eqs. (5) to (9)",
        (
            "The mapping between the static forces applied at the end-effector and the resulting torques at the joints "
            "can also be described by the Jacobian matrix [15-18].",
        ),
        "tool pose and geometric Jacobian",
        "reproduced",
        "Closed form against differences.",
    ),
    Statement(
        "workspace",
        "Fig. 3, eq. (10)",
        (
            "For programmers and operators familiar with CNC machine tools, this workspace is reduced to the "
            "parallelepiped X_M × Y_M × Z_M = 1200 × 600 × 500 mm³, as indicated in Figure 3.",
        ),
        f"A = B = 0: the adopted part of the workspace is {_box()} mm",
        "assumed",
        "Joint limits and the place of the box in Y are not printed; plausible ones are assumed.",
    ),
    Statement(
        "determinant",
        "Fig. 4",
        (
            "The presented distributions of the values for det(J) exhibit good force and speed transmission ratios of "
            "the tool with driving forces and speeds throughout the selected portion of the workspace.",
        ),
        "det(J) at Z = −400 and 100 mm: good throughout, no singularity",
        "assumed",
        "Rows v_x, v_y, v_z, ω_x', ω_y'. The figure's own numbers cannot be read from its text.",
    ),
    Statement(
        "table_2",
        "Table 2",
        (
            "To assure the decoupling of the joints only one joint at a time was loaded [8]. Therefore, while "
            "measuring the compliance of joint (i) all joints from the base to joint (i-1) were blocked.",
        ),
        _joints("table_2"),
        "reproduced",
        "The values are the paper's; the load tests are synthetic, since its readings are not printed.",
    ),
    Statement(
        "figure_5",
        "Fig. 5 (claim 1)",
        (
            "As it is noticeable from Figures 5a and 5i, the direct-compliances C_xx and C_zz are decreasing in the "
            "positive Y_M direction. At constant Y_M positions the direct-compliances C_xx and C_zz are increasing in "
            "the negative and positive X_M directions.",
            "The direct-compliance C_yy, Figure 5e, is increasing in the positive Y_M direction and decreasing in the "
            "negative and positive X_M directions at a constant Y_M positions.",
        ),
        "C_xx, C_zz fall with Y and grow with |X|; C_yy grows with Y and falls with |X|",
        "assumed",
        "The paper says so of the whole plane. With these lengths C_yy grows with Y for |X| up to {reach:.0f} mm "
        "alone; none of the 14\u202f112 lengths tried has it grow everywhere and meets the other claims.",
    ),
    Statement(
        "figure_6",
        "Fig. 6 (claim 2)",
        (
            "The direct-compliances C_xx and C_yy, Figures 6a and 6b, are predominantly affected by joint compliances "
            "C_θ1, C_θ3, and C_θ5. The direct-compliance C_zz, Figure 6c, is predominantly affected only by joint "
            "compliances C_θ2 and C_θ3.",
        ),
        "C_xx, C_yy from joints 1, 3, 5; C_zz from joints 2 and 3 only",
        "assumed",
        "Mean over the plane Z = 0.",
    ),
    Statement(
        "figure_7",
        "Fig. 7 (claim 3)",
        (
            "The cross-compliance C_xy, Figure 7a, is predominantly affected by joint compliances C_θ1, C_θ3, and "
            "C_θ5, while cross-compliances C_xz, Figure 7b, and C_zy, Figure 7c, are predominantly affected only by "
            "the joint compliance C_θ3.",
        ),
        "C_xy from joints 1, 3, 5; C_xz and C_zy from joint 3 only",
        "assumed",
        "At Z = 0 joints 2 and 3 alone move the tip vertically.",
    ),
    Statement(
        "figure_8",
        "Fig. 8",
        (
            "The total tool path deviations as well as the tool path deviations originating from the dominant "
            "individual joints' compliances are calculated for the constant static forces in the feed normal "
            "directions, i.e., F_xstat = F_ystat = 100 N.",
        ),
        f"deviation along six lines, {format_si(SLOT.force, 'N', 0)} normal to the feed, total and by joint",
        "assumed",
        "The curves are printed without numbers; their shape follows from Figs. 5 and 6.",
    ),
    Statement(
        "photographs",
        "Figs. 9, 10, 14",
        (
            "The original and deformed positions of the sphere-tip tool are measured by a FARO Portable CMM 3D "
            "digitizer (6), from which translational displacements δx, δy, and δz are calculated.",
        ),
        "the test rig, the measuring arm, the milling test",
        "not computed",
        "Drawings and photographs.",
    ),
    Statement(
        "measured_maps",
        "Fig. 11, eq. (17)",
        (
            "The workspace was subdivided into smaller cubes and the displacements of the sphere-tip tool were "
            "measured at 45 points at 6 Z_M levels (Z_M = -400 to 100 mm).",
        ),
        "nine measured maps, 45 points at each of 6 levels",
        "gap",
        "The raw displacements are not printed, so the measured maps cannot be redrawn.",
    ),
    Statement(
        "nine_points",
        "Fig. 12",
        (
            "For example, at the selected nine points (T1-T9), shown in Figure 12, an over-determined system of 81 "
            "equations was derived from which the joint compliances C_θi, i=1,2,…,5 were identified using the Matlab "
            "function lsqcurvefit.",
        ),
        f"nine points T1 to T9 at Z = 0: {EQUATIONS} equations",
        "reproduced",
        "The points are set in a 3 × 3 pattern over the plane; their coordinates are not printed.",
    ),
    Statement(
        "table_3",
        "Table 3",
        (
            "Comparing the joint compliances identified based on experimental Cartesian compliances, Table 3, with "
            "experimentally identified joint compliances from Table 2 it can be inferred that their values are "
            "slightly higher.",
        ),
        _joints("table_3"),
        "gap",
        "The 81 measured compliances are not printed: these come from synthetic ones with Table 3 and 4 µm of noise in "
        "them. Joint 4 is known least.",
    ),
    Statement(
        "figure_13",
        "Fig. 13 (claim 6)",
        (
            "Comparing the experimental with the analytically determined compliances, Figure 5, it can be inferred "
            "that the character of their distributions is similar, but the experimentally obtained compliances are "
            "slightly higher.",
        ),
        "maps from Table 3: a little higher than from Table 2",
        "assumed",
        "The measured maps shown beside them are not printed as numbers.",
    ),
    Statement(
        "force",
        "Fig. 15",
        ("As it can be noticed a constant static force level is approximately F_ystat=100N.",),
        f"static feed-normal force about {format_si(SLOT.force, 'N', 0)} (dynamometer, 50 Hz low-pass)",
        "gap",
        "The alloy and the signal are not printed; the measured value lies inside the spread.",
    ),
    Statement(
        "predicted",
        "Sec. 5.2, Table 2 (claim 5)",
        (
            "For the static force of approximately F_ystat=100N, Figure 15, the calculated displacement from the "
            "analytically determined compliance from Figure 5 is 0.23 mm, while the calculated displacement from the "
            "experimentally determined compliance, Figure 13, is approximately 0.29 mm.",
        ),
        f"{format_si(SLOT.force, 'N', 0)} moves the tip {_mm(SLOT.from_table_2)} in Y",
        "assumed",
        "One of the three assumed lengths is set by this number.",
    ),
    Statement(
        "from_map",
        "Sec. 5.2, measured map",
        (
            "From this simple milling test it can be readily noticed that the calculated displacement from the "
            "experimentally determined compliance is approximately equal to the measured tool path deviation on the "
            "workpiece.",
        ),
        f"{_mm(SLOT.from_map)} from the measured compliance map",
        "gap",
        f"{_mm(SLOT.from_map)} is read off a map whose data are not printed. Table 3 cannot give it: only joints 3 and "
        "5 act in Y there, and they are {soft_3:.2f} and {soft_5:.2f} times as soft, so {low:.3f} to {high:.3f} mm.",
    ),
    Statement(
        "machined",
        "Fig. 16",
        (
            "The machined flute is displayed in Figure 16 from which it can be seen that in the Y_M direction the "
            "deviation from the correct path is about 0.3 mm.",
        ),
        f"the flute is about {_mm(SLOT.measured)} off in Y",
        "gap",
        "Joints alone make {low:.0f} % to {high:.0f} % of what was measured; structure, spindle and tool give as well. "
        "No force and no stiffness is tuned to it.",
    ),
)
