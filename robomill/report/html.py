"""A run as one HTML page to hand over: nothing is fetched, no script runs, and it prints on A4 or Letter.

Every number is one of ``simulation_record``, which ``robomill simulate --json`` prints; pictures are of the same run.
"""

import platform
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np

from robomill.arguments import asked
from robomill.errors import ProjectError
from robomill.files import check_folder_there, check_no_folder, shown_place, write_whole
from robomill.report import sections_told
from robomill.report.pictures import joints_picture, path_picture, section_picture
from robomill.report.remedies_told import Made, Told, told_of
from robomill.report.simulation_record import simulation_record
from robomill.report.tags import Html, escaped, joined, tag
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import simulate
from robomill.simulation.setup import SimulationSetup
from robomill.simulation.stations import section_at
from robomill.units import MINUS, format_si
from robomill.version import __version__

MARK = '<!doctype html>\n<html lang="en" data-made-by="robomill report">'  # how a report begins
ENDS = (".html", ".htm")
STYLE = Path(__file__).with_name("report.css")
ALONE = "default-src 'none'; style-src 'unsafe-inline'"  # nothing is fetched, whatever words a file brings
KEY = (
    '<span class="key"><i class="left"></i>left on the part <i class="ideal"></i>as programmed '
    '<i class="allowed"></i>allowed</span>'
)
KEY_OF_PATH = (
    '<span class="key"><i></i>across the feed, left + <i class="floor"></i>along the tool, up + '
    '<i class="limit"></i>allowed <i class="lost"></i>not judged or not reached</span>'
)


@asked
def report_html(run: SimulationSetup | SimulationResult, remedies: Made | Sequence[Made] = ()) -> str:
    """A report of a run as the text of one HTML page, to hand over, print or keep.

    Parameters
    ----------
    run : SimulationSetup or SimulationResult
        A set-up is run first.
    remedies : one or a sequence
        What ``rm.advise``, ``rm.compensate``, ``rm.design``, ``rm.place`` or ``rm.turn`` returned for the same set-up;
        ``rm.design`` may have been asked about another tolerance.

    Returns
    -------
    str
        The page. Its numbers are those of ``robomill simulate --json``, in mm and N.

    Raises
    ------
    RobomillError
        Where the set-up is refused, or a remedy is none or is that of another set-up.

    Examples
    --------
    >>> import robomill as rm
    >>> page = rm.report_html(rm.load_setup("paper_flute"))
    >>> "within tolerance (77 % of it used)" in page
    True
    """
    result = run if isinstance(run, SimulationResult) else simulate(run)
    return page(result, simulation_record(result), told_of(result.setup, remedies))


@asked
def write_report(
    path: str | Path, run: SimulationSetup | SimulationResult, remedies: Made | Sequence[Made] = ()
) -> Path:
    """A report of a run as an HTML file; see ``report_html``.

    Parameters
    ----------
    path : str or Path
        Where it shall stand.
    run : SimulationSetup or SimulationResult
        A set-up is run first.
    remedies : one or a sequence
        What was computed to mend the cut.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    RobomillError
        Where the set-up is refused; ProjectError for a place that cannot be written, or where another file stands that
        is no report.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> import robomill as rm
    >>> rm.write_report(pathlib.Path(tempfile.mkdtemp()) / "report.html", rm.load_setup("paper_flute")).name
    'report.html'
    """
    check_replaceable(Path(path))
    return write_whole(path, report_html(run, remedies), ProjectError)


def check_replaceable(place: Path) -> None:
    """Refuse a place where something stands that is no report. Raises ProjectError."""
    if place.suffix.lower() not in ENDS:
        raise ProjectError(f"{shown_place(place)}: a page is written there; give a name that ends in .html.")
    check_no_folder(place, shown_place(place), ProjectError)
    check_folder_there(place, shown_place(place), ProjectError)
    if not place.is_file():
        return
    try:
        with place.open("rb") as stream:
            begins = stream.read(len(MARK))
    except OSError as exc:
        raise ProjectError(f"{shown_place(place)}: cannot be opened ({exc.strerror}); give another place.") from None
    if begins != MARK.encode():
        raise ProjectError(f"{shown_place(place)}: another file stands there that is no report; give another name.")


def page(
    result: SimulationResult, record: dict[str, Any], remedies: Sequence[Told] = (), when: datetime | None = None
) -> str:
    """The page of a run and its record."""
    made = moment(when or datetime.now().astimezone())
    robot = result.setup.robot
    parts = [
        sections_told.header(record, made, robot.title or robot.name),
        sections_told.verdict(record),
        sections_told.tiles(record),
        _pictures(result, record),
        sections_told.measures(record),
        sections_told.lines(record),
        sections_told.remedies(remedies),
        sections_told.rests_on(record),
        sections_told.left_out(record),
        sections_told.findings(record),
        _made_with(record, made),
    ]
    return _whole(record["name"], parts)


def moment(when: datetime) -> str:
    """Day and time of a report, and how far that clock is from UTC: ``7 March 2026, 09:05 UTC+5:30``."""
    east = when.utcoffset()
    minutes = 0 if east is None else round(east.total_seconds() / 60.0)
    hours, rest = divmod(abs(minutes), 60)
    zone = f"{'+' if minutes > 0 else MINUS}{hours}{f':{rest:02d}' if rest else ''}" if minutes else ""
    return f"{when.day} {when:%B %Y, %H:%M} UTC{zone}"


def _whole(name: str, parts: Sequence[object]) -> str:
    head = tag(
        "head",
        tag("meta", charset="utf-8"),
        tag("meta", http_equiv="Content-Security-Policy", content=ALONE),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("title", f"{name} · milling report · robomill"),
        tag("style", Html(STYLE.read_text(encoding="utf-8"))),
    )
    return f"{MARK}{head}\n<body>\n{Html(chr(10)).join(map(escaped, parts))}\n</body></html>\n"


def _pictures(result: SimulationResult, record: dict[str, Any]) -> Html:
    """The section beside the joints, and the way along the path."""
    if result.worst < 0:
        return tag("p", "Nothing of the cut is judged, so there are no pictures of it.", class_="quiet")
    section, joints = section_at(result, result.decided.sample), joints_picture(record)
    pair = []
    if section is not None:
        said = f"Section {format_si(section.station, 'mm', 1)} along the cut, line {section.block}, to scale. "
        pair.append(tag("figure", section_picture(section, result), tag("figcaption", said, Html(KEY))))
    if joints is not None:
        said = f"Which joint gives: parts of the largest deviation, {_mm(record)} at line {record['worst_block']}."
        pair.append(tag("figure", joints, tag("figcaption", said)))
    elif not record["joint_shares_add_up"]:
        pair.append(
            tag("p", "The compliances were measured as a map, which says nothing of single joints.", class_="quiet")
        )
    along = tag("figure", path_picture(result), tag("figcaption", Html(KEY_OF_PATH)))
    return joined([tag("h2", "The cut"), along, tag("div", *pair, class_="pair") if pair else ""])


def _mm(record: dict[str, Any]) -> str:
    return sections_told.mm(record["max_deviation_mm"])


def _made_with(record: dict[str, Any], made: str) -> Html:
    """Versions and the fingerprint by which the run is found again."""
    versions = f"robomill {__version__}, Python {platform.python_version()}, NumPy {np.__version__}; {made}."
    print_ = tag("span", record["digest"], class_="mono")
    return joined(
        [
            tag("h2", "Made with"),
            tag("p", versions, class_="quiet"),
            tag("p", "Fingerprint of the set-up: ", print_, ". The same set-up gives it again.", class_="quiet"),
        ]
    )
