"""Equations (13) to (15) with the numbers of now, and the table of what of the paper is reproduced."""

import html

import streamlit as st

from robomill.compliance.at_pose import PoseReport
from robomill.learn.equations import component, product
from robomill.learn.evidence import evidence
from robomill.learn.push import AsidePush
from robomill.report.paper import WORDS, Statement
from robomill.report.reproduction import reproduction
from robomill.report.reproduction_row import Row, columns, summary
from robomill.report.tags import Html
from robomill.ui import pieces
from robomill.ui.work import cached
from robomill.units import unit_label

TONE = {"reproduced": "computed", "assumed": "assumed", "gap": "user", "not computed": "computed"}
SHORT = {**WORDS, "assumed": "reproduced, assumed lengths"}


def equations(pose: PoseReport, push: AsidePush, far: str) -> None:
    """Eqs. (13), (14) and (15) with this robot's numbers at this pose, ``far`` from the base, for the push of the
    question."""
    st.header(f"The mathematics, {far} from the base")
    left, right = pieces.split([1, 1], "mathematics", gap="large")
    with left:
        st.latex(r"\large C_X = \sum_{i=1}^{n} C_{\theta i}\,\mathbf{J}_i\,\mathbf{J}_i^{T} \qquad (13),\,(14)")
        pieces.note(
            pieces.subscripts(
                "Every joint gives in its own direction J_i; the tip gives by the sum. Along "
                f"{push.name}, in the paper's units, C_θ in 10⁻⁶ rad/(N m) and J in m/rad:"
            )
        )
        st.latex(r"\large " + component(pose, push.along, push.along))
        pieces.note(f"and from {push.name} into {'XYZ'[push.aside]}, the reason why it goes aside:")
        st.latex(r"\large " + component(pose, push.aside, push.along))
    with right:
        st.latex(r"\large \delta\mathbf{x} = C_{X\delta}\,\mathbf{F} \qquad (15)")
        st.latex(r"\large " + product(pose.C, push.force))
        pieces.note(
            f"In the paper's units: C in {unit_label('um/N')}, F in N, the displacement in µm; all in the robot frame."
        )


@cached.shared(lambda: "paper", "Computing the paper's tables and figures")
def rows() -> list[Row]:
    """The reproduction table, computed once for the server."""
    return reproduction(evidence(cached.result))


def reproduced() -> None:
    """The table, with what did not come out and why."""
    st.header("The paper, reproduced")
    found = pieces.attempt(rows)
    if found is None:
        return
    pieces.note(f"{summary(found)} Numbers are in the paper's units.")
    shown = [
        (
            Html(f"<b>{html.escape(r.statement.where)}</b>"),
            _given(r.statement),
            pieces.subscripts(r.found),
            pieces.badge(TONE[r.statement.status], SHORT[r.statement.status]),
            pieces.subscripts(r.reason),
        )
        for r in found
    ]
    with (
        st.expander("Table by table, figure by figure", key="learn.open.reproduced"),
        st.container(key="learn-reproduced"),
    ):
        pieces.table(shown, "wwwww", ("Of the paper", "What it gives", "What robomill finds", "How far", "Reason"))
    pieces.download("CSV", lambda: _csv(found), "robomill-reproduction.csv", "csv:reproduction")


def _given(statement: Statement) -> Html:
    """What the paper gives, and its own words."""
    quoted = " ".join(f"“{html.escape(q)}”" for q in statement.quotations)
    return pieces.subscripts(statement.gives) + Html(f"<details><summary>in its words</summary>{quoted}</details>")


def _csv(found: list[Row]) -> str:
    import pandas as pd

    return pd.DataFrame(columns(found)).to_csv(index=False)
