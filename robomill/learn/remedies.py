"""Exercises about what the force is, and what is left once a program is corrected for it."""

from __future__ import annotations

from dataclasses import replace

from robomill.cutting.conditions import CutConditions
from robomill.cutting.forces.mechanistic import MechanisticForce, MechanisticRow
from robomill.cutting.tool import Cutter
from robomill.io.materials import load_material
from robomill.learn.draws import Draws
from robomill.learn.exercise import Slip
from robomill.learn.made import Made
from robomill.learn.poses import giving, place
from robomill.robot.model import Robot
from robomill.units import format_number, format_percent, format_si, to_si

ROWS = ("al7075_t6_carbide_ref190", "al7075_hss_ref156", "al7075_carbide_ref47", "al6082_t6_carbide_ref189")


def left_over(robot: Robot, draws: Draws) -> Made:
    """What stays of a corrected program where the robot is softer than its model."""
    force, wrong = 10.0 * draws.whole(8, 40), draws.whole(2, 8) / 20.0
    pose, a = giving(robot, draws)
    name = "XYZ"[a]
    model = float(pose.C[a, a] * force)
    actual = (1.0 + wrong) * model
    slips = (
        Slip(
            "This is the whole displacement of the softer robot: the correction takes off what the model says.", actual
        ),
        Slip("This is what the model says, which the correction takes off: asked is what is left.", model),
        Slip("The correction was added with the wrong sign: the program goes against the push.", actual + model),
        Slip("The share was taken of the softer robot's displacement: it is a share of the model's.", wrong * actual),
        Slip("The model was taken as the softer one of the two.", -wrong / (1.0 + wrong) * model),
    )
    text = (
        f"{place(pose)}. The cut pushes the tip with {format_si(force, 'N', 0)} along +{name}. The program was "
        f"corrected by what this model says along {name}; the real robot is {format_percent(wrong)} softer than the "
        f"model in every joint. How far along {name} does the tip still miss? Give the sign."
    )
    return Made(text, actual - model, slips)


def slot(robot: Robot, draws: Draws) -> Made:
    """The mean force across the feed in a full slot."""
    row = load_material(draws.one_of(ROWS))
    assert isinstance(row, MechanisticRow)
    flutes, depth, feed = draws.whole(2, 4), draws.whole(2, 8) / 2.0, draws.whole(3, 12) / 100.0
    spindle = 1000 * draws.whole(8, 18)
    cutter = Cutter("flat", diameter_mm=8, flutes=flutes)
    f_z, a_p = to_si(feed, "mm/tooth"), to_si(depth, "mm")
    n_s = to_si(float(spindle), "1/min")

    def forces(given: MechanisticRow, teeth: int = flutes) -> tuple[float, float, float]:
        made = replace(cutter, flutes=teeth)
        steady = CutConditions.steady([f_z * n_s * teeth], [n_s], [a_p])
        feed_way, normal, axial = MechanisticForce(made, given).components(steady)[0].tolist()
        return feed_way, normal, axial

    along, answer, axial = forces(row)
    chip = forces(replace(row, Kte=0.0))[1]
    slips = (
        Slip(
            "The edge term Kte is missing: an edge rubs also where the chip has no thickness.",
            chip,
        ),
        Slip("The chip term Ktc is missing.", answer - chip),
        Slip("This is the force along the feed: asked is the one across it.", along),
        Slip("This is the force along the axis: asked is the one across the feed.", axial),
        Slip("This is one tooth's share: the forces of all teeth add up.", forces(row, 1)[1]),
        Slip("The depth of cut is missing: the coefficients are by millimetre of edge.", answer / depth),
    )
    given = ", ".join(
        f"{name} = {format_si(getattr(row, name), unit, 3)}"
        for name, unit in (("Ktc", "N/mm2"), ("Kte", "N/mm"), ("Krc", "N/mm2"), ("Kre", "N/mm"))
    )
    text = (
        f"A cutter with {flutes} teeth mills a full slot {format_si(a_p, 'mm', 1)} deep with "
        f"{format_si(f_z, 'mm/tooth', 2)} at {format_number(spindle, 0)} min⁻¹. {given}. What is the mean force on the "
        "tool across the feed?"
    )
    return Made(text, answer, slips)
