"""The way in to the corrected program of a set-up."""

import math
from collections.abc import Iterable
from numbers import Real

from robomill.arguments import asked
from robomill.errors import CompensationError
from robomill.identification.knowledge import Knowledge
from robomill.improve.compensation import BOUND, Compensation, compensation
from robomill.io.gcode_out import toolpath_to_gcode
from robomill.simulation.setup import SimulationSetup, check_setup
from robomill.units import to_si


@asked
def compensate(
    setup: SimulationSetup,
    components: Iterable[str] = ("normal", "axial"),
    bound: float = BOUND,
    *,
    bound_um: float | None = None,
    known: Knowledge | None = None,
) -> Compensation:
    """The program that sends the tool elsewhere, so that, pushed off, it goes where it was meant to go.

    Parameters
    ----------
    setup : SimulationSetup
        What is to be cut, and with what.
    components : str or sequence of str
        What of the deviation is taken back: "normal" to the path, "axial", "feed".
    bound, bound_um : float
        m, or micrometres: how near the program keeps to the corrected path. A line is split, an arc becomes chords,
        only where it would not.
    known : Knowledge, optional
        How sure the compliances are; gives the band of what remains. Left out: ``setup.known``.

    Returns
    -------
    Compensation
        The program's text with what it leaves, before and after, and where compliances or force are wrong by 20 %.

    Raises
    ------
    CompensationError
        Where the prediction is not to be trusted (not reached, not judged, not coupled), where no correction is found,
        where the arm cannot follow it, and for words that cannot be written back.

    Notes
    -----
    A fixed point on path and force: c with p + c + delta(p + c) = p in the chosen components, force and engagement of
    the corrected path. A plunge is led beside its hole, but no deeper than the cut that goes on from there.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.compensate(rm.load_setup("paper_flute"))
    <Compensation Reference groove (Slavkovic 2013): 0.2295 mm before, 0.0002 mm after 2 iterations>
    """
    check_setup(setup)
    asked_for = bound if bound_um is None else bound_um
    if not (isinstance(asked_for, Real) and math.isfinite(asked_for)):
        raise CompensationError(f"Bound: found {asked_for!r:.40}; expected a number.", where="bound")
    within = bound if bound_um is None else to_si(bound_um, "um")
    return compensation(setup, components, within, toolpath_to_gcode, known or setup.known)
