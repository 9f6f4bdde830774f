"""What speaks against a model, in sentences with codes, and whether it pays to let links bend."""

from dataclasses import replace

from robomill.identification.fit.crossvalidation import headline, relative_by_pose
from robomill.identification.fit.models import Model
from robomill.identification.fit.selection import Candidates, pays
from robomill.identification.fit.suspects import OF_GAUGES, BendingOffer, Cause, Inquest, Suspect
from robomill.identification.fit.treatment import AUTO
from robomill.provenance import Finding
from robomill.robot.model import Robot
from robomill.units import format_number, format_si, from_si
from robomill.wording import listed

RARE = 1e-3  # chance of noise alone below which it is said that something is missing
NAMED = 3  # causes that a sentence names
SCATTER = "A compliance can then be off by more than its interval says, which knows scatter only."


def bending_offer(candidates: Candidates, model: str, inquest: Inquest, before: float) -> BendingOffer | None:
    """What letting the tests say where links bend would bring, where bending may be what is missing; None where it does
    not pay, or the tests have been asked."""
    treatment, kinds = candidates.treatment, [each.cause.kind for each in inquest.likeliest]
    if treatment.bending == AUTO or "bending" not in kinds or kinds[0] not in ("bending", "zero", "points"):
        return None
    auto = replace(candidates, model=Model(model), treatment=replace(treatment, bending=AUTO), kept={}, chosen={})
    choice, fitted = auto.best()
    after = headline(relative_by_pose(fitted.system, auto.missed().error, fitted.weights))
    if not choice.has("bending") or not pays(after, before):
        return None
    return BendingOffer(choice.bending_joints, choice.turned, before, after)


def model_findings(robot: Robot, inquest: Inquest) -> tuple[Finding, ...]:
    """Said where the readings depart from the model by more than chance makes, with what would explain it."""
    found = _zero(robot, inquest)
    likeliest = inquest.likeliest
    if likeliest:
        was, now = (format_si(each, "%", 1) for each in (inquest.before, likeliest[0].error))
        text = (
            f"The readings depart from this model by more than noise does: {named(robot, likeliest[0])} explains poses "
            f"left out best, missed by {now} then instead of {was}{_alike(robot, likeliest)}. {SCATTER}"
        )
    elif inquest.lack < RARE:
        text = (
            "Readings at one pose agree with each other far better than with this model: something is missing from it "
            "that no single spring, point or zero explains, or the gauges err in proportion to what they read. "
            f"{SCATTER}"
        )
    elif inquest.growth < RARE:
        text = (
            "What the model misses grows with the displacement: the gauges err in proportion to it (then let tests "
            "count by their relative error), or something is missing from the model that no single spring, point or "
            f"zero explains. {SCATTER}"
        )
    else:
        return ()
    return (*found, Finding("warning", text, code="model-misses"))


def _alike(robot: Robot, likeliest: tuple[Suspect, ...]) -> str:
    """The causes that cannot be told from the first."""
    if len(likeliest) < 2:
        return ""
    others = [named(robot, each) for each in likeliest[1:NAMED]]
    more = len(likeliest) - NAMED
    also = listed([*others, f"{more} more"] if more > 0 else others, "or")
    return f"; these tests cannot tell it from {also}"


def _zero(robot: Robot, inquest: Inquest) -> tuple[Finding, ...]:
    """A joint's zero, where it explains the readings best."""
    likeliest = inquest.likeliest
    if not likeliest or likeliest[0].cause.kind != "zero":
        return ()
    first = likeliest[0]
    seems = "seems to" if len(likeliest) == 1 else "may"
    text = (
        f"Joint {first.cause.at} {seems} stand {_off(robot, first)} from its stated angles: check its zero before "
        "anything else is fitted"
    )
    points = [each for each in inquest.suspects if each.cause.kind == "points" and each not in likeliest]
    text += f"; {named(robot, points[0])} explains the readings less well." if points else "."
    return (Finding("warning", text, code="joint-zero"),)


def named(robot: Robot, suspect: Suspect) -> str:
    """A cause in a sentence: "another load point"."""
    cause: Cause = suspect.cause
    if cause.kind == "zero":
        return f"joint {cause.at} standing {_off(robot, suspect)} from its stated angles"
    if cause.kind == "bending":
        return f"a link that bends {'after' if cause.turned else 'at'} joint {cause.at}"
    if cause.kind in OF_GAUGES:
        return OF_GAUGES[cause.kind]
    points = {"force": "another load point", "gauge": "another gauge point", "both": "another load and gauge point"}
    return points.get(cause.points, "a spring of the tool")


def _off(robot: Robot, suspect: Suspect) -> str:
    unit = robot.joint_units[robot.joint_numbers.index(suspect.cause.at)]
    half = format_number(float(from_si(suspect.half, unit)), 1)
    return f"{'+' if suspect.off > 0 else ''}{format_si(suspect.off, unit, 1)} (± {half}, 95 %)"
