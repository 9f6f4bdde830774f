"""The parts of a report, each told from the record of a run alone."""

from collections.abc import Sequence
from typing import Any

from robomill.cutting.force import COMPONENTS
from robomill.provenance import Finding, named
from robomill.report.plain import no_reading, reading_share, reading_value
from robomill.report.remedies_told import Told
from robomill.report.tags import Html, joined, table, tag
from robomill.simulation.judging.strays import WORDS
from robomill.simulation.judging.verdict_words import (
    END,
    FEED,
    FLOOR,
    TIP,
    TITLES,
    WALL,
    WORDS as WORDS_OF_GRADE,
    gauge_end,
)
from robomill.surface.sections.measures import MEASURED
from robomill.surface.sections.section_law import MEASURES, TITLES as TITLES_OF_KIND
from robomill.units import format_count, format_percent, format_share, format_value

READINGS = (WALL, FLOOR, END, FEED)
MODEL = (
    "Static deflection: the mean cutting force bends joints (and springs, where there are any) that are linear; links "
    "are stiff, deflections small."
)
MOST_FINDINGS, MOST_SOURCES = 20, 30
LEVELS = {"error": "Error", "warning": "Warning", "suspicious": "Doubt", "ignored": "Ignored", "info": "Note"}


def header(record: dict[str, Any], made: str, robot: str) -> Html:
    """What was cut, with what (the ``robot`` as people call it), when."""
    facts = {
        "Program": record["program"] or "–",
        "Robot": f"{robot}, compliances {record['compliance_set'].replace('_', ' ')}",
        "Made": made,
        "Fingerprint": record["digest"][:12],
    }
    listed = (tag("div", tag("dt", name), tag("dd", words)) for name, words in facts.items())
    kicker = tag("p", "Milling report · robomill", class_="kicker")
    return tag("header", kicker, tag("h1", record["name"]), tag("dl", *listed))


def verdict(record: dict[str, Any]) -> Html:
    """The one verdict, how much of the tolerance is used, and over what it could be another."""
    level, share = record["verdict"], record["share"]
    parts = [tag("b", TITLES[level]), tag("p", record["verdict_sentence"])]
    if level in WORDS_OF_GRADE and record["decided_by"] != TIP.code:
        ends = gauge_end(share)
        at, full = (f"{100 * min(each, ends) / ends:.1f}%" for each in (share, 1.0))
        inner = joined([tag("i", style=f"width:{at}"), tag("b", style=f"left:{full}")])
        parts.append(tag("div", inner, class_="gauge"))
        words = f"{format_share(share)} of the tolerance used by what decides; the mark is all of it."
        parts.append(tag("p", words, class_="quiet"))
    if record["could_be_out_over"]:
        over = ", ".join(record["could_be_out_over"])
        parts.append(tag("p", f"It could be out of tolerance over: {over} (ranges below)."))
    lost = record["not_judged"]
    if lost["count"]:
        words = f"{format_count(lost['count'])} of {format_count(lost['of'], 'point')} of the cut are not judged."
        parts.append(tag("p", words))
    return tag("section", *parts, class_=f"verdict {level}")


def tiles(record: dict[str, Any]) -> Html:
    """What a gauge would read, how far the tip is off, how hard it is pushed."""
    made = []
    for kind in READINGS:
        found = record[kind.code]
        if kind in (END, FEED) and not found["judged"]:
            continue
        if found["line"] is None:
            made.append(_tile(kind.label, "–", no_reading(record["verdict"])))
        else:
            made.append(_tile(kind.label, reading_value(found), f"{reading_share(found)}, line\u00a0{found['line']}"))
    if record["worst_block"]:
        fate = WORDS[record["tip"]["fate"]] if record["tip"] else ""
        made.append(
            _tile(
                TIP.label,
                mm(record["max_deviation_mm"]),
                f"line\u00a0{record['worst_block']}; {fate}".rstrip("; "),
            )
        )
        parts = ", ".join(
            f"{COMPONENTS[name]} {format_value(each, 'N', 0, sign=True, with_unit=False)}"
            for name, each in record["force_component_N"].items()
        )
        made.append(_tile("Force there", format_value(record["force_size_N"], "N"), parts))
    return tag("div", *made, class_="tiles")


def _tile(title: str, value: str, note: str) -> Html:
    return tag("div", tag("span", title), tag("b", value), tag("span", note), class_="tile")


def measures(record: dict[str, Any]) -> Html | str:
    """What a gauge has for the section that is drawn."""
    found = record["worst_section"]
    if found is None:
        return ""
    names = [name for name in MEASURES[found["kind"]] if found["near_wall"] or "_near_" not in name]
    rows = []
    for name in (each.replace("_near_", f"_{found['near_wall']}_") for each in names):
        of = MEASURED[name]
        value, why = found[f"{name}_{of.unit}"], found["not_measured"].get(name, "")
        known = value is not None and value == value
        shown = format_value(value, of.unit, of.digits, of.signed) if known else "–"
        rows.append((of.label, shown, "" if known else why or "nothing to measure"))
    words = f"{TITLES_OF_KIND[found['kind']]}, {mm(found['station_mm'], 1)} along the cut, line {found['block']}"
    said = tag("p", found["note"], class_="quiet") if found["note"] else ""
    body = table(("Measure", "Value", ""), rows, "knw") if rows else tag("p", "Nothing can be measured there.")
    return joined([tag("h2", f"Section: {words}"), body, said])


def lines(record: dict[str, Any]) -> Html:
    """The worst lines of the program, and how many more there are."""
    found = record["lines"]
    what, rows = found["counted_in"], found["worst"]
    title = tag("h2", f"By {'program ' * (what == 'line')}{what}, the worst first")
    if not rows:
        return joined([title, tag("p", "Nothing is cut.")])
    tools = len({row["tool"] for row in rows}) > 1
    beside = any(row["not_judged"] or row["not_reached"] for row in rows)
    head = [what.capitalize(), *["Tool"] * tools, "Cut, mm", "Wall, mm", "Floor, mm", "Tip, mm", "Force, N", "Used"]
    kinds = "n" * len(head) + "w" * beside
    body = [
        [
            row["line"],
            *[f"T{row['tool']}"] * tools,
            number(row["length_mm"], "mm", 1),
            *(number(row[key], "mm", sign=True) for key in ("wall_mm", "floor_mm")),
            number(row["max_deviation_mm"], "mm"),
            number(row["force_N"], "N", 0),
            "–" if row["share"] != row["share"] else format_share(row["share"]),
            *[_unknown(row)] * beside,
        ]
        for row in rows
    ]
    more = found["cutting"] - len(rows)
    words = f"{format_count(len(rows))} of {format_count(found['cutting'], what)} that cut"
    words += ", those that use most of their tolerance" if more else ""
    if found["unknown"]:
        words += f"; {format_count(found['unknown'], what)} with points that have no number"
    note = tag(
        "p", f"{words}. Wall: left of the feed +; floor: up +. – : nothing is left there to measure.", class_="quiet"
    )
    return joined([title, tag("div", table([*head, *[""] * beside], body, kinds), class_="wide"), note])


def _unknown(row: dict[str, Any]) -> str:
    told = [
        f"{row[key]} {words}"
        for key, words in (("not_judged", "not judged"), ("not_reached", "out of reach"))
        if row[key]
    ]
    return ", ".join(told)


def remedies(rows: Sequence[Told]) -> Html | str:
    """What was tried and what it leaves."""
    if not rows:
        return ""
    body = [(row.title, row.what, row.leaves, row.verdict) for row in rows]
    return joined(
        [
            tag("h2", "Remedies that were computed"),
            table(("Remedy", "What", "What it leaves", "Verdict"), body, "wwww", "fixed tried"),
        ]
    )


def rests_on(record: dict[str, Any]) -> Html:
    """Every block of numbers with who says so, and between which ends the answer lies over what is assumed."""

    def mark(kind: str) -> Html:
        return tag("span", kind, class_=f"badge {kind}")

    rested = record["rests_on"][:MOST_SOURCES]
    rows = [(each["what"], each["value"], mark(each["kind"]), each["source"]) for each in rested]
    listed = {each["what"].lower() for each in record["rests_on"]}
    more = [each for each in record["assumed"] if each["what"].lower() not in listed and not _named_above(each, record)]
    rows += [(each["what"].capitalize(), each["value"], mark("assumed"), each["why"]) for each in more[:MOST_SOURCES]]
    parts = [tag("h2", "What it rests on"), table(("What", "Value", "Said by", "Source"), rows, "wwkw", "fixed rests")]
    ranges = [
        (
            f"Over {each['over']}" if each["kind"] != "computed" else each["over"].capitalize(),
            *(_ends(each[f"{name}_mm"], name != "tip") for name in ("wall", "floor", "tip")),
            "–" if None in each["share"] else " to ".join(map(format_share, each["share"])),
        )
        for each in record["ranges"]
    ]
    if ranges:
        head = ("Ranges", "Wall, mm", "Floor, mm", "Tip, mm", "Tolerance used")
        parts.append(table(head, ranges, "wnnnn"))
    return joined(parts)


def _named_above(each: dict[str, str], record: dict[str, Any]) -> bool:
    """Whether what is assumed stands among the sources by its value and reason already."""
    return any((row["value"], row["source"]) == (each["value"], each["why"]) for row in record["rests_on"])


def _ends(ends: Sequence[float | None], sign: bool) -> str:
    if any(each is None or each != each for each in ends):
        return "–"
    return " to ".join(number(each, "mm", sign=sign) for each in ends)


def left_out(record: dict[str, Any]) -> Html:
    """What no number here holds, and what is not judged."""
    lost, reached = record["not_judged"], record["reached"]
    said = [MODEL, f"Left out: {', '.join(record['left_out'])}."]
    if lost["count"]:
        words = f"Not judged: {format_count(lost['count'])} of {format_count(lost['of'], 'point')} of the cut"
        said.append(f"{words}, {record['lines']['counted_in']} {named(lost['blocks'])}.")
        said += [f"{each['why']} ({format_count(each['count'], 'point')})" for each in lost["reasons"]]
    else:
        said.append(f"Not judged: none of {format_count(lost['of'], 'point')} of the cut.")
    if lost["rapids"]:
        said.append(
            f"Rapids through material that no cut removes: line {named(lost['rapids'])}; what they leave is not judged."
        )
    words = f"Reached: {format_count(reached['count'])} of {format_count(reached['of'], 'point')}"
    said.append(f"{words}; first that is not: {reached['reason']}" if reached["reason"] else f"{words}.")
    surface = record["surface"]
    if surface["area_out_of_tolerance_share"]:
        said.append(
            f"Of walls and floors {format_percent(surface['area_out_of_tolerance_share'], 1)} are out of tolerance."
        )
    return joined(
        [tag("h2", "What is left out, and what is not judged"), tag("ul", *(tag("li", each) for each in said))]
    )


def findings(record: dict[str, Any]) -> Html:
    """What was noticed in the program and on the way, the grave ones first."""
    found = record["findings"]
    order = sorted(found, key=lambda each: Finding(each["level"], each["message"], each["line"]).order)
    rows = [
        (
            LEVELS[each["level"]],
            each["line"] or "",
            each["message"] + (f" ({each['count']} times)" if each["count"] > 1 else ""),
        )
        for each in order[:MOST_FINDINGS]
    ]
    title = tag("h2", "Findings")
    if not rows:
        return joined([title, tag("p", "None in the program, none in the run.")])
    more = len(found) - len(rows)
    note = tag("p", f"{format_count(more, 'more finding')}, all less grave.", class_="quiet") if more else ""
    return joined([title, table(("", record["lines"]["counted_in"].capitalize(), "What"), rows, "knw"), note])


def mm(value: float, digits: int | None = None) -> str:
    """A length with its unit."""
    return format_value(value, "mm", digits)


def number(value: float | None, unit: str, digits: int | None = None, sign: bool = False) -> str:
    """A bare number; a dash where there is none."""
    return format_value(float("nan") if value is None else value, unit, digits, sign, with_unit=False, missing="–")
