"""A report: the numbers of ``simulate --json``, nothing that is fetched, words shown as they are, a few pages."""

from __future__ import annotations

import json
import re
import subprocess
from datetime import datetime, timedelta, timezone
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from screenshots import CHROMIUM

import robomill as rm
from robomill.cli import main
from robomill.errors import ProjectError
from robomill.report.html import MARK, moment
from robomill.simulation.judging.verdict_words import TITLES

SLOT = rm.load_setup("paper_flute")
AIR = "G21 G90\nG0 X0 Y0 Z50\nG0 X50\nG1 Z49 F100\nM2\n"
HOSTILE = (
    'G21 G90 (<script>alert\\1</script> <img src="http://evil.example/x.png">)\n'
    "G0 X0 Y0 Z5\nM8 ; <style>@import url(//evil.example)</style>\nG1 Z-2 F100\nG1 X60 F600\nM2\n"
)


class Page(HTMLParser):
    """The tags of a page, what each refers to, and its words."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.refers: list[tuple[str, str]] = []
        self.handlers: list[str] = []
        self.words: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        for name, value in attrs:
            if name in ("src", "href", "xlink:href", "srcset", "data", "action", "poster") or "url(" in (value or ""):
                self.refers.append((name, value or ""))
            if name.startswith("on"):
                self.handlers.append(name)

    def handle_data(self, data: str) -> None:
        if not self.tags or self.tags[-1] != "style":
            self.words.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())


def record_of(capsys: pytest.CaptureFixture[str], *words: str) -> dict:
    main(["simulate", *words, "--json"])
    return json.loads(capsys.readouterr().out)


def spelled(value: float, digits: int = 3, sign: bool = False) -> str:
    text = f"{value:+.{digits}f}" if sign else f"{value:.{digits}f}"
    return (text[1:] if float(text) == 0.0 and sign else text).replace("-", "−")


@pytest.mark.parametrize("name", ["paper_flute", "two_tools", "pocket_arcs", "paper_flute/setup_process"])
def test_its_numbers_are_those_of_simulate(name: str, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """Read from the page as words, written here from the JSON by other code."""
    out = tmp_path / "report.html"
    code = main(["report", name, "--out", str(out)])
    capsys.readouterr()
    record = record_of(capsys, name)
    page = Page(out.read_text(encoding="utf-8")).text
    assert code == (1 if record["verdict"] in ("out", "unjudged", "unreached", "missed") else 0)
    assert record["verdict_sentence"] in page
    assert TITLES[record["verdict"]] in page
    assert record["digest"] in page
    for quantity in ("wall", "floor"):
        assert f"{spelled(record[quantity]['value_mm'], sign=True)} mm" in page
    assert f"Tip off its path {spelled(record['max_deviation_mm'])} mm" in page
    for joint, share in zip(record["joints"], record["joint_share_mm"], strict=True):
        along = float(np.dot(share, record["deviation_mm"])) / record["max_deviation_mm"]
        assert f"joint {joint} {spelled(along, sign=True)} mm" in page
    for row in record["lines"]["worst"]:
        cells = [str(row["line"]), *([f"T{row['tool']}"] * (name == "two_tools")), spelled(row["length_mm"], 1)]
        cells += ["–" if row[key] is None else spelled(row[key], sign=True) for key in ("wall_mm", "floor_mm")]
        cells += [spelled(row["max_deviation_mm"]), spelled(row["force_N"], 0)]
        assert " ".join(cells) in page
    for each in record["rests_on"]:
        assert f"{each['kind']} {' '.join(each['source'].split())}" in page
    for each in record["left_out"]:
        assert each in page
    for name_of, unit in (("centre_offset", "mm"), ("floor_error", "mm")):
        value = record["worst_section"][f"{name_of}_{unit}"]
        if value is not None:
            assert f"{name_of.replace('_', ' ').capitalize()} {spelled(value, sign=True)} {unit}" in page


def test_the_worst_lines_are_found_by_looking_at_every_reading() -> None:
    result = rm.simulate(rm.load_setup("two_tools"))
    from robomill.report.lines_record import lines_record

    found = {row["line"]: row for row in lines_record(result, most=1000)["worst"]}
    path = result.path
    cutting = {int(b) for b, cut, step in zip(path.block, path.cutting, path.step_length) if cut and step > 0}
    assert set(found) == cutting
    for line, row in found.items():
        for key, readings in (("wall_mm", result.gauge.walls), ("floor_mm", result.gauge.floors)):
            here = [e for q, e in zip(readings.sample, readings.error) if path.block[q] == line]
            most = max(map(abs, here), default=None)
            assert (most is None and np.isnan(row[key])) or abs(row[key]) == pytest.approx(most * 1e3)
        length = sum(s for b, cut, s in zip(path.block, path.cutting, path.step_length) if cut and b == line)
        assert row["length_mm"] == pytest.approx(length * 1e3)
    shares = [row["share"] for row in found.values()]
    assert shares == sorted(shares, reverse=True)
    assert max(shares) == pytest.approx(result.verdict.share)


def test_nothing_is_fetched_and_nothing_runs() -> None:
    text = rm.report_html(SLOT)
    page = Page(text)
    assert page.refers == [("clip-path", "url(#along)"), ("clip-path", "url(#cut)")]
    assert not {"script", "link", "iframe", "img", "object", "embed", "base", "form"} & set(page.tags)
    assert "http://" not in text
    assert "https://" not in text
    assert "@import" not in text
    assert "default-src &#x27;none&#x27;" in text


def test_words_of_files_are_shown_as_they_are() -> None:
    source = rm.GCodeSource(HOSTILE, '"><script>x</script>.nc')
    setup = SLOT.replace(source=source, name='<img src=x onerror=alert(1)> & "groove" \u202e\x1b[31m', stock=None)
    text = rm.report_html(setup)
    page = Page(text)
    assert page.handlers == []
    assert not {"script", "img", "style", "b>"} & set(page.tags[page.tags.index("body") :])
    assert '<img src=x onerror=alert(1)> & "groove"' in page.text
    assert "\u202e" not in text
    assert "\x1b" not in text
    assert [value for _, value in page.refers] == ["url(#along)", "url(#cut)"]


def test_a_cut_that_is_not_judged_is_never_green(tmp_path: Path) -> None:
    """Force out of a model that nobody has stated for this cut, and a part out of reach."""
    far = SLOT.replace(part_zero_mm=(0, -2450, 0))
    result = rm.simulate(far)
    assert result.verdict.level in ("unreached", "unjudged")
    text = rm.report_html(result)
    assert f'class="verdict {result.verdict.level}"' in text
    assert not re.search(r'class="verdict (ok|tight)"', text)
    assert 'class="gauge"' not in text
    assert f"Reached: {int(result.reached.sum())} of {len(result.path)} points" in Page(text).text


def test_a_report_is_replaced_and_nothing_else_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    place = tmp_path / "report.html"
    assert main(["report", "paper_flute", "--out", str(place)]) == 0
    first = place.read_bytes()
    assert first.startswith(MARK.encode())
    assert main(["report", "paper_flute", "--tol", "0.1", "--out", str(place)]) == 1
    assert "replacing an older one" in capsys.readouterr().out
    assert place.read_bytes() != first
    mine = tmp_path / "mine.html"
    mine.write_text("<p>my work</p>")
    for out in (mine, tmp_path, tmp_path / "none" / "report.html"):
        assert main(["report", "paper_flute", "--out", str(out)]) == 2
        said = capsys.readouterr()
        assert said.out == ""
        assert len(said.err.strip().splitlines()) == 1
    assert mine.read_text() == "<p>my work</p>"
    with pytest.raises(ProjectError, match="no report"):
        rm.write_report(mine, SLOT)


def test_a_refused_set_up_leaves_no_report(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    air = tmp_path / "air.nc"
    air.write_text(AIR)
    out = tmp_path / "report.html"
    assert main(["report", "paper_flute", "--program", str(air), "--out", str(out)]) == 2
    assert capsys.readouterr().out == ""
    assert not out.exists()


def test_a_disk_that_is_full_leaves_no_half_report(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(*_: object, **__: object) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    out = tmp_path / "report.html"
    assert main(["report", "paper_flute", "--out", str(out)]) == 2
    assert "No space left" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_remedies_are_told_with_their_verdicts() -> None:
    design = rm.design(SLOT, tolerance_mm=0.2)
    text = Page(rm.report_html(SLOT, [design])).text
    ratio = max(design.stiffness_ratio)
    assert f"× {ratio:.2f}" in text
    assert rm.simulate(SLOT.replace(robot=design.setup.robot)).verdict.sentence in text, "one page, one tolerance"
    assert design.after.verdict.sentence not in text
    assert "to keep 0.2 mm" in text
    with pytest.raises(rm.RobomillError, match=r"rm\.advise"):
        rm.report_html(SLOT, [SLOT])


def test_a_remedy_of_another_cut_is_refused_and_one_alone_is_taken() -> None:
    corrected = rm.compensate(SLOT)
    assert rm.report_html(SLOT, corrected).count("Correct the program") == 1
    for other in (SLOT.replace(tolerance_mm=0.2), SLOT.replace(robot=rm.load_robot("kuka_kr270"))):
        with pytest.raises(rm.RobomillError, match="another set-up"):
            rm.report_html(other, [corrected])
    stiffer = rm.design(SLOT.replace(force=rm.PathForce(feed_normal=150.0)), tolerance_mm=0.2)
    with pytest.raises(rm.RobomillError, match="another set-up"):
        rm.report_html(SLOT, [stiffer])


@pytest.mark.browser
@pytest.mark.parametrize("name", ["paper_flute", "two_tools"])
def test_it_prints_on_a_few_pages(name: str, tmp_path: Path) -> None:
    if not Path(CHROMIUM).exists():
        pytest.skip("no Chromium: apt-get install -y chromium")
    page = rm.write_report(tmp_path / "report.html", rm.load_setup(name))
    words = [CHROMIUM, "--headless=new", "--no-sandbox", "--disable-gpu", f"--user-data-dir={tmp_path / 'home'}"]
    words += [f"--print-to-pdf={tmp_path / 'report.pdf'}", page.as_uri()]
    subprocess.run(words, check=True, capture_output=True, timeout=60)
    pages = len(re.findall(rb"/Type\s*/Page\b", (tmp_path / "report.pdf").read_bytes()))
    assert 1 <= pages <= 6


def test_the_robot_is_called_as_people_call_it() -> None:
    text = Page(rm.report_html(SLOT.replace(robot=rm.load_robot("kuka_kr270")))).text
    assert "Robot KUKA KR270-2F, compliances published" in text
    assert "kuka_kr270" not in text


@pytest.mark.parametrize(
    ("hours", "zone"), [(0.0, "UTC"), (2.0, "UTC+2"), (-3.5, "UTC\u22123:30"), (5.75, "UTC+5:45"), (None, "UTC")]
)
def test_the_moment_of_a_report_says_how_far_its_clock_is_from_utc(hours: float | None, zone: str) -> None:
    there = None if hours is None else timezone(timedelta(hours=hours))
    assert moment(datetime(2026, 3, 7, 9, 5, tzinfo=there)) == f"7 March 2026, 09:05 {zone}"
