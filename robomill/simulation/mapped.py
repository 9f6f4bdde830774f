"""Compliance in force along a path: the shares of joints and springs, or what was measured, where a map holds."""

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.cutting.unjudged import Unjudged
from robomill.kinematics.spin import spin_matters
from robomill.progress import gathered
from robomill.provenance import Finding
from robomill.simulation.setup import SimulationSetup
from robomill.simulation.tools import farther
from robomill.toolpath.path import Toolpath
from robomill.units import format_si, to_si

MOST_TURNED = to_si(2.0, "deg")
"""A map holds for the tool axis it was measured with. Stated, not derived: on the paper's arm 2 degrees change the
compliance by a few per cent; 30 degrees can change it by times."""
MAP_SPIN = "map-spin"
NOTICED = to_si(0.1, "deg")
MOST_LONGER = to_si(10.0, "mm")
"""A map holds for the tool it was measured with, taken to be the first that cuts. Stated, not derived: on the paper's
arm a tool longer by 10 mm changes the compliance by 3 per cent, one longer by 100 mm by 30."""
NOTICED_APART = to_si(0.5, "mm")
FAR_BESIDE = to_si(10.0, "mm")
"""From the plane of a map. Stated: on the paper's arm 10 mm change the compliance by a hundredth."""


def total_compliance(setup: SimulationSetup, path: Toolpath, C_joint: FloatArray, C_spring: FloatArray) -> FloatArray:
    """C (m, 3, 3) m/N that the deflection is computed with: all shares, or at feed what was measured, if it was.

    NaN outside the map and where the tool stands more than ``MOST_TURNED`` off the one it was measured with, or is
    longer or shorter by more than ``MOST_LONGER``.
    """
    C = gathered(len(path), "Compliance", lambda some: C_joint[some].sum(axis=-3) + C_spring[some].sum(axis=-3))
    field = setup.measured_map
    if field is None:
        return C
    measured = gathered(len(path), "Measured map", lambda some: field.compliance(setup.in_base(path.p[some])))
    measured[(turned(setup, path) > MOST_TURNED) | (longer(setup, path) > MOST_LONGER)] = np.nan
    return np.where(path.cutting[:, None, None], measured, C)


def turned(setup: SimulationSetup, path: Toolpath) -> FloatArray:
    """(m,) rad at feed: how far the tool stands off the one the map was measured with; 0 elsewhere, or without one."""
    if setup.measured_map is None:
        return np.zeros(len(path))
    field = setup.measured_map

    def angle(some: slice) -> FloatArray:
        return field.turned(setup.in_base(path.p[some]), setup.to_base(path.k[some]))

    return np.where(path.cutting, gathered(len(path), "Measured map", angle), 0.0)


def longer(setup: SimulationSetup, path: Toolpath) -> FloatArray:
    """(m,) m at feed: by how much the tool is longer or shorter than the one the map was measured with; 0 elsewhere, or
    without one."""
    if setup.measured_map is None:
        return np.zeros(len(path))
    return np.where(path.cutting, np.abs(farther(setup, path)), 0.0)


def beyond_map(setup: SimulationSetup, path: Toolpath, reached: BoolArray) -> tuple[Unjudged, ...]:
    """Steps at which the map in force says nothing because the tool leans otherwise than when it was measured, or is
    another one."""
    angle, length = turned(setup, path), longer(setup, path)
    leans = (
        f"the tool stands up to {format_si(angle.max(), 'deg', 1)} off the axis the measured map was taken with, and "
        f"beyond {format_si(MOST_TURNED, 'deg', 0)} it does not hold: measure at this axis, or use the joints' model."
    )
    differs = (
        f"the tool's length differs by up to {format_si(length.max(), 'mm', 1)} from that of the first that cuts, with "
        f"which the measured map is taken to have been measured, and beyond {format_si(MOST_LONGER, 'mm', 0)} it does "
        "not hold: measure with this tool, or use the joints' model."
    )
    return (
        *Unjudged.at("map-axis", (angle > MOST_TURNED) & reached, leans),
        *Unjudged.at("map-tool", (length > MOST_LONGER) & reached, differs),
    )


def map_notes(setup: SimulationSetup, path: Toolpath) -> tuple[Finding, ...]:
    """What a reader must know of the map in force."""
    if setup.measured_map is None:
        return ()
    notes = list(setup.measured_map.findings)
    if setup.springs:
        text = "The measured map holds whatever gives; the springs beside the joints are shown, not added."
        notes.append(Finding("info", text, code="springs-in-map"))
    if setup.add_sag:
        text = (
            "The sag is that of the joints' compliances: the measured map holds for a force on the tool, and what the "
            "links' weight does farther back is not in it."
        )
        notes.append(Finding("warning", text, code="sag-by-joints"))
    if spin_matters(setup.robot):
        text = (
            "The measured map holds for the turn about the tool axis it was taken with, which is not in it; on this "
            "arm that turn changes the compliance: measure and mill with the same one."
        )
        notes.append(Finding("warning", text, code=MAP_SPIN))
    largest = float(turned(setup, path).max())
    if NOTICED < largest <= MOST_TURNED:
        off = format_si(largest, "deg", 1)
        text = f"The tool stands up to {off} off the axis the measured map was taken with; it is used as it is."
        notes.append(Finding("warning", text, code="map-axis"))
    return (*notes, *_apart(setup, path))


def _apart(setup: SimulationSetup, path: Toolpath) -> tuple[Finding, ...]:
    """Tools a little longer than that of the map, and cuts beside the plane that it was measured in."""
    assert setup.measured_map is not None
    length, found = float(longer(setup, path).max()), []
    if NOTICED_APART < length <= MOST_LONGER:
        text = (
            f"The tools' lengths differ by up to {format_si(length, 'mm', 1)}; the measured map is taken to have been "
            "measured with the first that cuts, and is used as it is."
        )
        found.append(Finding("warning", text, code="map-tool"))
    beside = setup.measured_map.beside(setup.in_base(path.p[path.cutting]))
    off = float(beside.max(initial=0.0))
    if off > FAR_BESIDE:
        text = (
            f"The cut lies up to {format_si(off, 'mm', 0)} beside the points of the measured map, which all lie in one "
            "plane, line or point: what changes across it was not measured, and the map is used as it is."
        )
        found.append(Finding("warning", text, code="map-plane"))
    return tuple(found)
