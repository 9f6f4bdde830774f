"""The identification page's inputs: measurements, robot, model, what was noticed, and the button that uses it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import streamlit as st

from robomill.errors import LoadTestError, RobomillError
from robomill.identification.knowledge import Knowledge
from robomill.identification.load_test import JointTests, LoadTests
from robomill.identification.models import MODELS, Model
from robomill.identification.result import IdentificationResult
from robomill.io.load_test_sheets import load_test_template
from robomill.io.load_tests import read_findings
from robomill.io.robots import robot_names
from robomill.provenance import Finding, Provenance
from robomill.robot.model import Robot
from robomill.simulation.setup import SimulationSetup
from robomill.ui import inputs, pieces, session
from robomill.ui.identification.bench import SAMPLES, Bench, decoded, take_sample
from robomill.ui.identification.words import MODEL_TITLES, summary
from robomill.units import from_si, to_si, unit_label

SECTIONS = {"tests": "Load tests", "map": "Measured map", "laboratory": "Virtual laboratory"}
VIEWS = {
    "compliances": "Compliances",
    "residuals": "Residuals",
    "models": "Models",
    "next": "Measure next",
    "cut": "In the cut",
}
MAX_MB = 50
EDITABLE = 60_000
OWN = "own"
IDENTIFIED = "identified from"
TEMPLATES = {
    "joints": "Poses as joint angles",
    "world": "Poses as X, Y, Z, A, B",
    "joint by joint": "One joint at a time",
    "compliances": "Measured compliances",
}


def choose(key: str, options: dict[str, str]) -> str:
    """A row of views; the choice outlives a visit to another page."""
    kept = f"identification:{key}"
    current = st.session_state.get(kept, next(iter(options)))

    def take(picked: str) -> None:
        st.session_state[kept] = picked

    inputs.choice(key.capitalize(), f"ident:{key}", options, current, take, inputs.HIDDEN)
    return str(st.session_state.get(kept, current))


def source(kept: Bench, robot: Robot) -> None:
    """A sample, a file, or pasted rows; refused text stays with its sentence."""
    samples = {**SAMPLES, OWN: kept.name} if not kept.sample else SAMPLES
    inputs.choice(
        "Load tests",
        "ident:sample",
        samples,
        kept.sample or OWN,
        lambda name: None if name == OWN else take_sample(kept, name),
        inputs.LISTED,
    )
    upload("Your load tests (CSV)", "ident:file", kept.take, kept.revision)
    _templates(robot)
    if len(kept.text) > EDITABLE:
        pieces.note(f"{kept.name}: {len(kept.text.splitlines()):,} lines; files of this size are edited outside.")
        return
    with st.expander("Rows: paste or edit", icon=":material/edit_note:", expanded=not kept.sample):
        box = "ident:text"
        inputs.seed(box, kept.text)
        st.text_area(
            "Header with units, then one row a test",
            key=box,
            height=220,
            on_change=lambda: kept.take(st.session_state[box], "pasted rows"),
        )
        pieces.note("Commas, semicolons or tabs, as copied from a spreadsheet. Lines with # are remarks.")


def upload(label: str, key: str, take: Callable[[str, str], None], revision: int) -> None:
    """A file that is put on the bench as text; what is not text is refused in a sentence.

    ``revision`` changes when the file was taken: the box is empty again then.
    """
    box = f"{key}:{revision}"

    def taken() -> None:
        file: Any = st.session_state.get(box)
        if file is not None:
            inputs.submit(key, None, lambda: take(decoded(file.getvalue(), file.name), file.name))

    st.file_uploader(label, key=box, max_upload_size=MAX_MB, on_change=taken)
    inputs.sentence(key)


def _templates(robot: Robot) -> None:
    with st.popover("Templates", icon=":material/download:", width="stretch"):
        pieces.note("Empty measuring sheets with their units in the header.")
        for protocol, label in TEMPLATES.items():
            name = f"load-tests-{protocol.replace(' ', '-')}.csv"
            sheet = load_test_template(protocol, robot.n)
            pieces.download(label, sheet, name, "text/csv", key=f"ident:template:{protocol}")


def robot_choice(kept: Bench) -> None:
    """Which robot was measured: the project's, or a preset."""
    titles = {"": f"The project's: {session.project().setup.robot.name}", **{n: n for n in robot_names()}}

    def take(name: str) -> None:
        kept.robot_name = name

    inputs.choice("Robot measured", "ident:robot", titles, kept.robot_name, take, inputs.LISTED)


def model_choice(kept: Bench, robot: Robot) -> None:
    """Which springs are fitted, where links bend, and whether tests that do not fit weigh less."""

    def take_model(name: str) -> None:
        kept.model = name

    inputs.choice(
        "What gives", "ident:model", {m: MODEL_TITLES[m] for m in MODELS}, kept.model, take_model, inputs.LISTED
    )
    if Model(kept.model).has("bending"):
        key = "ident:bending"
        inputs.seed(key, [j for j in kept.bending if j in robot.joint_numbers])
        st.multiselect(
            "Links bend at joints",
            list(robot.joint_numbers),
            key=key,
            on_change=lambda: setattr(kept, "bending", tuple(sorted(st.session_state[key]))),
        )
    key = "ident:robust"
    inputs.seed(key, kept.robust)
    st.toggle(
        "Weigh down tests that do not fit",
        key=key,
        on_change=lambda: setattr(kept, "robust", bool(st.session_state[key])),
    )


def said(tests: LoadTests | JointTests | None, refusal: RobomillError | None, found: tuple[Finding, ...]) -> None:
    """The refusal, or what was read and everything the reader and the fit noticed, worst first."""
    if refusal is not None:
        pieces.error(refusal)
    if tests is None:
        return
    pieces.note(summary(tests) + (" " + pieces.badge("computed", "synthetic") if tests.synthetic else ""))
    loud = [f for f in found if f.level in ("error", "suspicious", "warning")]
    for finding in loud[:4]:
        st.warning(finding.message, icon=":material/visibility:" if finding.level == "suspicious" else None)
    for finding in [f for f in found if f not in loud][:4] + loud[4:]:
        pieces.note(finding.message)


def findings(
    tests: LoadTests | JointTests | None, result: IdentificationResult | None, robot: Robot
) -> tuple[Finding, ...]:
    """Findings on the tests and, where there is one, on the fit, each once."""
    if tests is None:
        return ()
    found = result.findings if result is not None else read_findings(tests, robot)
    return tuple(dict.fromkeys(found))


def use(kept: Bench, robot: Robot, result: IdentificationResult) -> None:
    """The button that puts the compliances in force, with their uncertainty."""
    if not result.has_joints:
        pieces.note("One constant matrix has no joints to give to the project; choose a model with joint springs.")
        return
    setup = session.project().setup
    fitted = adopted(setup, robot, result, kept.name)
    known = session.known(setup)
    in_force = known is not None and known.holds_for(fitted.robot, fitted.springs)
    if in_force:
        session.know(knowledge(kept, robot, result))  # force and lengths may have been stated since
    st.button(
        "In force in the project" if in_force else "Use these compliances in the project",
        type="primary",
        icon=":material/check:" if in_force else ":material/input:",
        key="ident:use",
        width="stretch",
        disabled=in_force,
        on_click=_use,
        args=(kept, fitted, robot, result),
    )
    if in_force:
        pieces.note("Every page counts with them now, and shows its deviation with a band. Undo leads back.")
    else:
        springs = len(result.springs(robot))
        pieces.note(
            "Sets the joint compliances"
            + (f" and {springs} springs beside the joints" if springs else "")
            + " of the project's robot; their uncertainty goes along as bands."
        )
    inputs.sentence("ident:use")


def adopted(setup: SimulationSetup, robot: Robot, result: IdentificationResult, name: str) -> SimulationSetup:
    """The set-up with the compliances and springs found; springs of an earlier identification give way."""
    words = f"{IDENTIFIED} {len(result.row)} load tests ({name}), {MODEL_TITLES[result.model].lower()}"
    marked = {**result.applied_to(robot).provenance, "compliance.identified": Provenance("computed", words)}
    found = result.springs(robot)
    names = {spring.name for spring in found}
    old = tuple(s for s in setup.springs if s.name not in names and not s.provenance.source.startswith(IDENTIFIED))
    return setup.replace(robot=result.applied_to(robot).replace(provenance=marked), springs=old + found)


def knowledge(kept: Bench, robot: Robot, result: IdentificationResult) -> Knowledge:
    """How sure the compliances found are, with what was stated of force and lengths."""
    known = Knowledge.of(result, robot, f"from {len(result.row)} load tests")
    return known.widened(robot, kept.force_unsure, kept.length_unsure)


def _use(kept: Bench, fitted: SimulationSetup, robot: Robot, result: IdentificationResult) -> None:
    def put() -> None:
        known = knowledge(kept, robot, result)
        session.change(robot=fitted.robot, springs=fitted.springs)
        session.know(known)
        kept.robot_name = ""

    inputs.submit("ident:use", None, put)


def field(label: str, kept: Bench, name: str, unit: str, low: float, high: float, step: float, digits: int) -> None:
    """A number of the bench in display units, between two bounds that its refusal names."""
    key = f"ident:{name}"
    inputs.seed(key, round(float(from_si(float(getattr(kept, name)), unit)), 9))

    def put() -> None:
        typed = st.session_state[key]
        if typed is None or not low <= typed <= high:
            found = "nothing" if typed is None else f"{typed:g}"
            raise LoadTestError(f"{label}: found {found}, expected {low:g} to {high:g} {unit_label(unit)}.")
        setattr(kept, name, to_si(float(typed), unit))

    named = f"{label}, {unit_label(unit)}" if unit_label(unit) else label
    st.number_input(
        named,
        key=key,
        step=float(step),
        format=f"%.{digits}f",
        on_change=lambda: inputs.submit(key, st.session_state[key], put),
    )
    inputs.sentence(key)
