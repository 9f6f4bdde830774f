"""Results, figures and pictures kept by fingerprint: made once for everyone on the server, bounded in bytes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial, wraps
from typing import TYPE_CHECKING, Any, TypeVar, cast

from robomill.arrays import digest
from robomill.errors import RobomillError
from robomill.identification.knowledge import Knowledge
from robomill.kinematics.spin import OverSpin
from robomill.simulation.enlarged import Enlarged, enlarged
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import deviation_over_spin, simulate
from robomill.simulation.samples import sampled
from robomill.simulation.setup import SimulationSetup
from robomill.surface.sections.groove import GrooveSection
from robomill.ui import session
from robomill.ui.entry import inputs
from robomill.ui.work import beside, job
from robomill.ui.work.commons import NOTHING, Commons
from robomill.ui.work.job import Underway

if TYPE_CHECKING:
    from robomill.viz.chart import Chart

SPIN_SAMPLES = 400
FILE = "file"  # the place of the one file that a session has made for it
Function = TypeVar("Function", bound=Callable[..., Any])
commons = Commons()


def shared(
    key: Callable[..., Any], doing: str = "", seconds: Callable[..., float] | None = None
) -> Callable[[Function], Function]:
    """Keeps the answers of a function for everyone on the server, by the fingerprint of ``key(*arguments)``.

    A refusal is not kept. What is ``doing`` may take long: a page has it made beside itself, and ``Underway`` is raised
    while it is not there. Where it takes more than a minute, which ``seconds(*arguments)`` tells, it is asked for.
    """

    def keep(function: Function) -> Function:
        @wraps(function)
        def asked(*arguments: Any) -> Any:
            name = name_of(function, key(*arguments))
            make = partial(commons.get, name, partial(function, *arguments))
            if not doing or not beside.on_a_page():
                return make()
            place = ".".join(name)
            if commons.find(name, NOTHING) is not NOTHING:
                job.give_up(place)  # it ended between two runs of the page, or somebody else had it made
                return make()
            takes = 0.0 if seconds is None else seconds(*arguments)
            return beside.made(place, name, make, doing, takes, group=name[0])

        return cast("Function", asked)

    return keep


def name_of(function: Callable[..., Any], said: Any) -> tuple[str, str]:
    """Under what the answer of a shared function is kept; ``said`` is what its key says."""
    return f"{function.__module__}.{function.__qualname__}", digest(said)


def by_setup(setup: SimulationSetup) -> tuple[Any, ...]:
    """A set-up's numbers, and its words: a result carries them, and nobody is shown those of another."""
    return setup.digest(), setup.provenance, setup.description, setup.source.name


def by_result(result: SimulationResult) -> tuple[Any, ...]:
    """The set-up that was run."""
    return by_setup(result.setup)


def by_knowledge(known: Knowledge | None) -> tuple[Any, ...] | None:
    """What is known of the compliances."""
    return None if known is None else (known.covariance, known.source)


@shared(by_setup)
def result(setup: SimulationSetup) -> SimulationResult:
    """``simulate(setup)``, from the cache where it was computed before. Raises the refusal of ``simulate``."""
    found = simulate(setup)
    _ = found.verdict  # so that what cannot be judged is refused here, where a page expects it
    return found


def held(setup: SimulationSetup) -> SimulationResult | None:
    """The run of ``setup`` where it is kept; None where it would have to be computed."""
    found: SimulationResult | None = commons.find(name_of(result, by_setup(setup)))
    return found


@shared(by_setup, "Spin about the tool")
def over_spin(setup: SimulationSetup) -> OverSpin:
    """What the free spin about the tool does to the largest deviation, at ``SPIN_SAMPLES`` points of the path."""
    path = setup.toolpath
    return deviation_over_spin(setup, sampled(path, max(setup.step, float(path.s[-1]) / SPIN_SAMPLES)))


@shared(lambda setup, station: (by_setup(setup), station), "Section")
def groove(setup: SimulationSetup, station: float) -> GrooveSection:
    """The groove's section at ``station`` (m of length cut)."""
    return result(setup).groove(station)


@shared(lambda setup, times: (by_setup(setup), times), "Surface with its displacement enlarged")
def pictured(setup: SimulationSetup, times: float) -> Enlarged:
    """The surfaces for pictures with the displacement ``times`` times enlarged, from the cache."""
    return enlarged(result(setup), times)


def asked_for(
    label: str, key: str, about: Any, make: Callable[[], Any], place: str = FILE, icon: str = "download"
) -> Any:
    """What ``make`` answers, which ``about`` tells apart: made beside the page, once the button ``label`` begins it.

    ``key`` is the button's; at one ``place`` one thing is made. Raises the refusal, and ``Underway`` while it is not
    there.
    """
    name = f"{place}.{key}", digest(about)
    found = commons.find(name, NOTHING)
    if found is not NOTHING:
        return found
    if session.kept(f"{place}.asked") != name:
        raise Underway(partial(inputs.button, label, f"{key}.ask", icon, beside.begin, place, name))
    try:
        return beside.made(place, name, partial(commons.get, name, make), label)
    except RobomillError:
        session.drop(f"{place}.asked")
        raise


def kept_figure(name: str, key: Sequence[Any], make: Callable[[], Chart]) -> Chart:
    """The figure of ``make``, built once for equal ``key`` (digests, view, theme); do not change it afterwards.

    Building a figure costs more than computing what it shows; a classroom sees the same ones.
    """
    found: Chart = commons.get(("figure", name, *key), make)
    return found
