"""The identification page's inputs: measurements, robot, model, what was noticed, and the button that uses it."""

from collections.abc import Callable
from dataclasses import replace

import streamlit as st

from robomill.errors import LoadTestError, RobomillError
from robomill.files import TABLE
from robomill.identification.fit.models import Model
from robomill.identification.knowledge import Knowledge
from robomill.identification.load_test import JointTests, LoadTests
from robomill.identification.result import IdentificationResult
from robomill.io.measured.load_test_sheets import TEMPLATES, load_test_template
from robomill.io.measured.load_tests import read_findings
from robomill.io.robot.robots import robot_titles
from robomill.io.texts import read_text
from robomill.provenance import Finding
from robomill.robot.model import Robot
from robomill.simulation.setup import SimulationSetup
from robomill.ui import pieces, session
from robomill.ui.bench import MOST_KEPT, OWN, SAMPLES, THE_PROJECTS, Bench
from robomill.ui.entry import inputs
from robomill.ui.identification.bench import decide, decided, field, put_sample, put_tests
from robomill.ui.identification.words import summary
from robomill.units import format_count

SECTIONS = {"tests": "Load tests", "map": "Measured map", "laboratory": "Virtual laboratory"}
VIEWS = {
    "compliances": "Compliances",
    "residuals": "Residuals",
    "points": "Points",
    "models": "Models",
    "next": "Measure next",
    "cut": "In the cut",
}
MAX_MB = 50
EDITABLE = 60_000
USED = "identification.use"


def choose(key: str, options: dict[str, str]) -> str:
    """A row of views; the choice outlives a visit to another page."""
    return str(inputs.pick(key.capitalize(), f"identification.{key}", options, look=inputs.HIDDEN))


def source(bench: Bench, robot: Robot) -> None:
    """A sample, a file, or pasted rows; refused text stays with its sentence."""
    samples = {**SAMPLES, OWN: bench.name} if bench.sample == OWN else SAMPLES
    # A list of its own for each file: a browser shows a chosen entry by the name that it had.
    key = "identification.sample" + f":{bench.name}" * (bench.sample == OWN)
    inputs.choice("Load tests", key, samples, bench.sample, put_sample, inputs.LISTED)
    upload("Your load tests (CSV)", "identification.file", put_tests)
    _templates(robot)
    if len(bench.text) > EDITABLE:
        kept = "" if len(bench.text) <= MOST_KEPT else " and not kept with the project"
        lines = len(bench.text.splitlines())
        pieces.note(f"{bench.name}: {format_count(lines)} lines; files of this size are edited outside{kept}.")
        return
    with st.expander("Rows: paste or edit", icon=":material/edit_note:", expanded=bench.sample == OWN):
        inputs.text(
            "Header with units, then one row a test",
            "identification.rows",
            bench.text,
            lambda rows: put_tests(rows, "pasted rows"),
            lines=8,
            height=220,
        )
        pieces.note("Commas, semicolons or tabs, as copied from a spreadsheet. Lines with # are remarks.")


def upload(label: str, key: str, take: Callable[[str, str], None]) -> None:
    """A file that is put on the bench as text; what is not text is refused in a sentence."""

    def text_of(data: bytes, name: str) -> None:
        take(read_text(data, LoadTestError, TABLE, name)[0], name)

    inputs.upload(label, key, text_of, most_MB=MAX_MB, fresh=session.store().revision)


def _templates(robot: Robot) -> None:
    with st.popover("Templates", icon=":material/download:", width="stretch"):
        pieces.note("Empty measuring sheets with their units in the header.")
        for protocol, label in TEMPLATES.items():
            name = f"load-tests-{protocol.replace(' ', '-')}.csv"
            sheet = load_test_template(protocol, robot.n)
            pieces.download(label, sheet, name, f"identification.template.{protocol}")


def robot_choice(bench: Bench) -> None:
    """Which robot was measured: the project's, or a preset."""
    own = session.project().setup.robot.name
    titles = {THE_PROJECTS: "The robot of this project", **robot_titles()}
    now = bench.robot_name(own)
    inputs.choice("Robot measured", "identification.robot", titles, now, decided("robot"), inputs.LISTED)


def model_choice(bench: Bench, robot: Robot) -> None:
    """Which springs are fitted, where links bend, and whether tests that do not fit weigh less."""
    field(bench, "model", inputs.LISTED)
    if Model(bench.model).has("joint"):
        field(bench, "bending_auto")
    if Model(bench.model).has("bending") and not bench.bending_auto:
        inputs.several(
            "Links bend at joints",
            "identification.bending",
            {j: str(j) for j in robot.joint_numbers},
            [j for j in bench.bending if j in robot.joint_numbers],
            lambda joints: decide(bending=tuple(sorted(joints))),
        )
    field(bench, "robust")
    with st.expander("How the tests are treated", icon=":material/tune:", expanded=bench.fit_points != "none"):
        for name in ("fit_points", "weights", "leave_out"):
            field(bench, name, inputs.LISTED)


def said(tests: LoadTests | JointTests | None, refusal: RobomillError | None, found: tuple[Finding, ...]) -> None:
    """The refusal, or what was read and everything the reader and the fit noticed, worst first."""
    if refusal is not None:
        pieces.error(refusal)
    if tests is None:
        return
    made = tests.provenance.kind
    pieces.note(summary(tests), *([pieces.badge(made)] if made != "measured" else []))
    loud = [f for f in found if f.level in ("error", "suspicious", "warning")]
    for finding in loud[:4]:
        pieces.said("warning", finding.message, "visibility" if finding.level == "suspicious" else "")
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


def use(bench: Bench, robot: Robot, result: IdentificationResult) -> None:
    """The button that puts the compliances in force, with their uncertainty."""
    if not result.has_joints:
        pieces.note("One constant matrix has no joints to give to the project; choose a model with joint springs.")
        return
    if not result.gives:
        pieces.note("No joint gives way by these tests, so there is nothing to give to the project: look at the signs.")
        return
    setup = session.project().setup
    fitted = adopted(setup, robot, result, bench.name)
    known = session.known(setup)
    in_force = setup.measured_map is None and known is not None and known.holds_for(fitted.robot, fitted.springs)
    if in_force:
        session.know(knowledge(bench, robot, result))  # force and lengths may have been stated since
    label, icon = ("In use in the project", "check") if in_force else ("Use these compliances in the project", "input")
    put = (_use, bench, fitted, robot, result)
    inputs.button(label, "identification.use", icon, *put, type="primary", width="stretch", disabled=in_force)
    if in_force:
        pieces.note("Every page counts with them now, and shows its deviation with a band. Undo leads back.")
    else:
        springs = len(result.springs(robot))
        pieces.note(
            "Sets the joint compliances"
            + (f" and {springs} spring{'s' * (springs > 1)} beside the joints" if springs else "")
            + " of the project's robot; their uncertainty goes along as bands."
        )


def adopted(setup: SimulationSetup, robot: Robot, result: IdentificationResult, name: str) -> SimulationSetup:
    """The set-up with the compliances and springs found; a measured map gives way."""
    changed, springs = result.adopted(robot, name, setup.robot, setup.springs)
    return setup.replace(robot=changed, springs=springs, measured_map=None)


def knowledge(bench: Bench, robot: Robot, result: IdentificationResult) -> Knowledge:
    """How sure the compliances found are, with what was stated of force and lengths."""
    known = Knowledge.of(result, robot)
    known = known.noise_only() if bench.band == "noise" else known
    known = replace(known, source=f"from {len(result.row)} load tests: {known.made_of}")
    return known.widened(robot, bench.force_unsure, bench.length_unsure)


def _use(bench: Bench, fitted: SimulationSetup, robot: Robot, result: IdentificationResult) -> None:
    known = knowledge(bench, robot, result)
    project = session.project()
    if bench.robot_name(project.setup.robot.name) != THE_PROJECTS:
        session.experiment(bench.replace(robot=THE_PROJECTS), USED)
    session.change(label=USED, robot=fitted.robot, springs=fitted.springs, measured_map=None)
    session.know(known)
