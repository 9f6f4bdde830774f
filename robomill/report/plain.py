"""Records as lines of text, for a person at a terminal."""

import math
from collections.abc import Sequence
from typing import Any

from robomill.provenance import Finding, named
from robomill.report.paper import WORDS as WORDS_OF_STATUS
from robomill.simulation.judging.strays import WORDS
from robomill.surface.sections.measures import MEASURED
from robomill.surface.sections.section_law import MEASURES
from robomill.units import (
    SI_NAMES,
    format_beside,
    format_limit,
    format_number,
    format_percent,
    format_share,
    format_significant,
    format_value,
    from_si,
    to_si,
)

AXES = "XYZ"
TURNS, SLIDES = "1e-7 rad/(N m)", "1e-9 m/N"  # what compliances are told in, of joints that turn and that slide
SHORT = [name for name, of in MEASURED.items() if of.short]
SECTIONS = {kind: kind if kind != "unknown" else "-" for kind in MEASURES}


def matrix_lines(rows: Sequence[Sequence[float]]) -> list[str]:
    """A matrix with aligned columns."""
    return ["  " + " ".join(f"{format_number(v, 4):>10}" for v in row) for row in rows]


def robot_lines(record: dict[str, Any]) -> list[str]:
    lines = []
    for robot in record["robots"]:
        lines.append(f"{robot['name']:18} {robot['joints']} joints  {robot['title']}")
        lines += [f"{'':18} {line}" for line in assumed_lines(robot["assumed"])]
    return lines


def assumed_lines(assumed: Sequence[dict[str, str]]) -> list[str]:
    """One line for what a record lists as assumed; none where nothing is."""
    return [f"assumed   {'; '.join(each['what'] for each in assumed)}"] if assumed else []


HEADINGS = {"study": "studies", "load tests": "load tests", "answers": "answers of a class"}  # others take an s


def sample_lines(record: dict[str, Any]) -> list[str]:
    """The samples by kind, each with the name that commands take."""
    lines: list[str] = []
    kinds = dict.fromkeys(each["kind"] for each in record["samples"])
    for kind in kinds:
        lines.append(HEADINGS.get(kind, f"{kind}s"))
        lines += [f"  {each['name']:32} {each['title']}" for each in record["samples"] if each["kind"] == kind]
    return lines


def reproduction_lines(record: dict[str, Any]) -> list[str]:
    """Of each statement of the paper: what it gives, what is found here, and how the two stand."""
    lines = []
    for row in record["rows"]:
        words = WORDS_OF_STATUS[row["status"]]
        end = f"gap       {row['reason']}" if row["status"] == "gap" else f"holds     {words}: {row['reason']}"
        if not row["holds"]:
            end = f"DOES NOT HOLD ({words}): {row['reason']}"
        lines += [row["of_the_paper"], f"  paper     {row['paper']}", f"  robomill  {row['robomill']}", f"  {end}"]
    broken = [row["of_the_paper"] for row in record["rows"] if not row["holds"]]
    return [*lines, record["summary"], *([f"does not hold: {', '.join(broken)}"] if broken else [])]


def pose_lines(record: dict[str, Any]) -> list[str]:
    det = record["det_J"]
    lines = [f"{record['robot']}, compliance {record['compliance_set']}", "T_MT (m)", *matrix_lines(record["T_MT"])]
    lines += ["J (m, rad)", *matrix_lines(record["J"])]
    if det is not None:
        lines.append("det(J)  " + format_value(det, record["det_J_unit"], 4))
    lines += ["C (um/N)", *matrix_lines(record["C_um_per_N"])]
    for joint, share in zip(record["joints"], record["joint_share_um_per_N"], strict=True):
        lines += [f"of joint {joint}", *matrix_lines(share)]
    return lines if record["reached"] else [*lines, f"not reached: {record['reason']}"]


def ik_lines(record: dict[str, Any]) -> list[str]:
    if not record["reached"]:
        return [f"not reached: {record['reason']}"]
    angles = ", ".join(format_number(v, 4) for v in record["theta_deg"])
    return [f"theta (deg)  {angles}", f"residual     {format_significant(record['residual_m'], 2)} m"]


def gcode_lines(record: dict[str, Any]) -> list[str]:
    moves, length, extents = record["moves"], record["length_mm"], record["extents_mm"]
    lines = [f"units    {record['units']}"]
    lines += [f"{kind:8} {moves[kind]:8d} moves  {format_value(length.get(kind, 0.0), 'mm')}" for kind in moves]
    if extents:
        lines.append("extents of the cuts (rapids may reach further)")
        for axis, low, high in zip(AXES, *extents, strict=True):
            lines.append(f"{axis}        {format_value(low, 'mm')} to {format_value(high, 'mm')}")
    return lines + finding_lines(record["findings"])


def finding_lines(findings: Sequence[dict[str, Any]]) -> list[str]:
    """What was noticed, with its line and how often."""
    lines = []
    for f in findings:
        times = f" ({f['count']} times)" if f["count"] > 1 else ""
        lines.append(f"{f['level']:9} {Finding(f['level'], f['message'], f['line']).sentence}{times}")
    return lines


def simulation_lines(record: dict[str, Any]) -> list[str]:
    def vector(values: Sequence[float | None], unit: str) -> str:
        numbers = [float("nan") if v is None else v for v in values]
        return "  ".join(f"{axis} {format_value(v, unit, sign=True)}" for axis, v in zip(AXES, numbers))

    worst, rms = (format_value(record[f"{key}_deviation_mm"], "mm") for key in ("max", "rms"))

    lines = [record["name"], record["verdict_sentence"]]
    if record["worst_block"]:
        lines += [
            f"max       {worst}   rms {rms}",
            f"there     {vector(record['deviation_mm'], 'mm')}",
            f"force     {vector(record['force_N'], 'N')}",
        ]
    if record["worst_block"] and record["joint_shares_add_up"]:
        shares = zip(record["joints"], record["joint_share_mm"], strict=True)
        lines += [f"joint {joint}   {vector(share, 'mm')}" for joint, share in shares]
        lines += [f"{name:9} {vector(share, 'mm')}" for name, share in record["spring_share_mm"].items()]
    if record["worst_block"] and record["ahead_mm"] is not None:
        lines.append(f"program   {vector(record['ahead_mm'], 'mm')}   sent there beside {record['wanted']}")
    if record["worst_block"] and record["sag_mm"] is not None:
        what = (
            "added to what the force does"
            if record["sag_added"]
            else "not added: the part is zeroed with the arm sagged"
        )
        lines.append(f"sag       {vector(record['sag_mm'], 'mm')}   {what}")
    lines += [f"{name:9} {_reading(record[name], record['verdict'])}" for name in ("wall", "floor", "feed")]
    if tip := record["tip"]:
        lines.append(
            f"tip       {format_value(tip['value_mm'], 'mm')} off its path at line {tip['line']}; {WORDS[tip['fate']]}"
        )
    for name, turn in (record["tooth"] or {}).items():
        mean, low, high = (format_value(turn[end], "mm", sign=True) for end in ("mean", "low", "high"))
        lines.append(f"tooth     {name} {mean} by the mean force, {low} to {high} as teeth come by")
    lines += [_band_line(each) for each in record["ranges"] if each["kind"] == "measured"]
    lines.append(f"left out  {', '.join(record['left_out'])}")
    reached, why = record["reached"], record["reached"]["reason"]
    lines.append(f"reached   {reached['count']} of {reached['of']} points{f'; first: {why}' if why else ''}")
    lost = record["not_judged"]
    if lost["count"]:
        lines.append(f"not judged {lost['count']} of {lost['of']} points of the cut, line {named(lost['blocks'])}")
        lines += [
            f"          {reason['why']} ({reason['count']} points)"
            + (f"; in a file: {', '.join(reason['names'])}" if reason["names"] else "")
            for reason in lost["reasons"]
        ]
    lines.append("sections  station  kind     what is measured there (mm)")
    lines += [_section_line(section) for section in record["groove"]]
    return lines + finding_lines([f for f in record["findings"] if f["level"] != "ignored"])


def _band_line(found: dict[str, Any]) -> str:
    """Between which ends wall, floor and tip lie by how sure the compliances are."""
    said = []
    for name in ("wall", "floor", "tip"):
        ends = [v for v in found[f"{name}_mm"] if v is not None and math.isfinite(v)]
        told = " to ".join(format_value(v, "mm", sign=name != "tip") for v in ends)
        said += [f"{name} {told}"] if len(ends) == 2 else []
    return f"sure      {', '.join(said)} ({found['over']})"


def _section_line(section: dict[str, Any]) -> str:
    """What a section is and its dimensions, or why there are none."""
    start = f"          {section['station_mm']:7.2f}  {SECTIONS[section['kind']]:7s}  "
    names = [each for each in SHORT if section["kind"] != "groove" or each in MEASURES["groove"]]
    known = [(MEASURED[name], section[f"{name}_mm"]) for name in names if not math.isnan(section[f"{name}_mm"])]
    found = [f"{of.short} {format_value(v, '1', 4, True) if of.signed else f'{v:.3f}'}" for of, v in known]
    return start + (", ".join(found) or str(section["note"]) or "nothing can be measured")


def _reading(found: dict[str, Any], level: str) -> str:
    """One quantity of the verdict: its largest value, where, and how much of its tolerance it uses."""
    if found["line"] is None:
        return no_reading(level)
    return f"{reading_value(found)} at line {found['line']}, {reading_share(found)}"


def no_reading(level: str) -> str:
    """Why a quantity of a verdict of that ``level`` has no value."""
    return "not judged" if level == "unjudged" else "none is left to measure"


def reading_value(found: dict[str, Any]) -> str:
    """The largest value of a quantity of the verdict, with the digits that tell it from what is allowed."""
    return format_beside(to_si(found["value_mm"], "mm"), to_si(found["tolerance_mm"], "mm"), "mm", sign=True)


def reading_share(found: dict[str, Any]) -> str:
    """How much of its tolerance a quantity of the verdict uses."""
    if not found["judged"]:
        return "not judged by itself"
    return f"{format_share(found['share'])} of {format_limit(to_si(found['tolerance_mm'], 'mm'), 'mm')}"


def map_lines(record: dict[str, Any]) -> list[str]:
    sizes = " x ".join(str(len(record[f"{axis.lower()}_mm"])) for axis in AXES)
    reached, of = record["reached"]["count"], record["reached"]["of"]
    lines = [f"{record['robot']}, {sizes} points, {reached} of {of} reached"]
    for axis in AXES:
        places = record[f"{axis.lower()}_mm"]
        ends = [format_value(place, "mm", 1) for place in (places[0], places[-1])[: len(places)]]
        lines.append(f"{axis:18} {' to '.join(ends)}")
    if not reached:
        return [*lines, "The arm reaches none of these points; look at --x, --y, --z and the tilts."]
    for quantity in record["quantities"]:
        low, high = (format_value(quantity[end], quantity["unit"]) for end in ("min", "max"))
        lines.append(f"{quantity['name']:18} {low} to {high}   {quantity['title']}")
    return lines + finding_lines(record["findings"])


def _held(point: dict[str, Any]) -> list[tuple[float, tuple[float, float]]]:
    """Coordinates of a point with their intervals; infinite where these tests do not hold one."""
    ends = [tuple(math.inf * side if v is None else v for side, v in zip((-1, 1), e)) for e in point["ci95_mm"]]
    return list(zip(point["flange_mm"], ends))  # type: ignore[arg-type]


def identification_lines(record: dict[str, Any]) -> list[str]:
    lines = [f"model {record['model']}", f"joint   C_theta ({TURNS})   95 % interval"]
    columns = (record[name] for name in ("joints", "C_theta", "C_theta_units", "ci95"))
    for joint, value, unit, interval in zip(*columns, strict=True):
        shows = SLIDES if unit == SI_NAMES[SLIDES] else TURNS
        if value is None:
            lines.append(f"{joint:5d}     not seen")
            continue
        each = [from_si(float("nan") if v is None else v, shows) for v in (value, *interval)]
        shown, low, high = (format_number(v, 3, missing="nan") for v in each)
        slides = "" if shows == TURNS else f"   {shows}: it slides"
        lines.append(f"{joint:5d}   {shown:>10}                 {low:>10} to {high}{slides}")
    if record["cv_relative_error"] is not None:
        lines.append(
            f"cross-validated error  {format_percent(record['cv_relative_error'], 1)} of the measured displacement"
        )
    if record["bending_joints"]:
        lines.append(f"links bend at joint {', '.join(map(str, record['bending_joints']))}")
    for name, point in record["points"].items():
        place = ", ".join(
            f"{format_number(v, 1)} ± {format_number((high - low) / 2, 1)}" for v, (low, high) in _held(point)
        )
        off = format_value(point["off_mm"], "mm", 0)
        lines.append(f"{name.replace('_', ' ')} in the flange  {place} mm (95 %), {off} off the stated one")
    if record["band"] is not None:
        band = record["band"]
        held = "too little was left out to check them"
        if band["held"] is not None:
            held = f"they hold {format_percent(band['held'])} of what was left out"
        lines.append(f"95 % bands: {band['made_of']}; {held}")
    if record["unseen_joints"]:
        lines.append(f"not seen by these tests: joint {', '.join(map(str, record['unseen_joints']))}")
    return lines + finding_lines(record["findings"])
