"""The documents are built without a warning, fetch nothing from anywhere, and have every key, name and verb."""

from __future__ import annotations

import argparse
import ast
import html
import json
import re
import subprocess
import sys
from fnmatch import fnmatchcase

import pytest

import robomill as rm
from robomill import learn
from robomill.cli import main
from robomill.cli.parser import make_parser
from tests.docs.documents import DOCS, ROOT

# What a page would fetch when it is opened, as against what it links to.
FETCHED = re.compile(
    r"<(?:script|img|iframe|source|video|audio|embed)\b[^>]*\bsrc=\"([^\"]+)|<link\b([^>]*)>|url\(([^)]+)\)"
)
KEY = re.compile(r"[A-Za-z][\w-]*")


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """The pages by name, built with warnings as errors."""
    folder = tmp_path_factory.mktemp("docs")
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-E", "-b", "html", str(DOCS), str(folder)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr[-4000:]
    return folder


def text_of(built, page):
    return html.unescape(re.sub(r"<[^>]+>", "", (built / f"{page}.html").read_text(encoding="utf-8")))


def test_no_page_fetches_anything_from_another_host(built):
    for page in [*built.rglob("*.html"), *built.rglob("*.css")]:
        for src, link, url in FETCHED.findall(page.read_text(encoding="utf-8")):
            if link and not re.search(r"rel=\"(?:stylesheet|preload|icon|shortcut icon|preconnect)", link):
                continue
            target = src or url.strip("'\"") or "".join(re.findall(r"href=\"([^\"]+)", link))
            assert not re.match(r"(?:https?:)?//", target), f"{page.name} fetches {target}"


def test_mathematics_is_in_the_page(built):
    page = (built / "theory.html").read_text(encoding="utf-8")
    assert page.count("<math ") > 15
    assert "\\begin{" not in page


def test_every_public_name_stands_in_the_api(built):
    page = (built / "api.html").read_text(encoding="utf-8")
    for name in rm.__all__:
        assert re.search(rf'id="robomill\.{name}"', page), name
    for name in learn.__all__:
        assert re.search(rf'id="robomill\.learn\.{name}"', page), name


def test_every_verb_and_option_stands_in_the_command_line(built):
    page = text_of(built, "command_line")
    verbs = next(each for each in make_parser()._actions if isinstance(each, argparse._SubParsersAction))
    for name, verb in verbs.choices.items():
        assert f"robomill {name}" in page
        for action in verb._actions:
            for option in [] if isinstance(action, argparse._HelpAction) else action.option_strings:
                assert option in page, f"{name} {option}"


def test_the_readme_names_every_verb():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    verbs = next(each for each in make_parser()._actions if isinstance(each, argparse._SubParsersAction))
    for name in verbs.choices:
        assert re.search(rf"(`|robomill ){name}\b", text), name


def test_every_key_that_a_reader_names_in_the_source_stands_in_the_file_formats(built):
    """Another way to the keys than the documents' own: the calls in the readers' source."""
    page = text_of(built, "file_formats")
    readers = (
        "text",
        "words",
        "choice",
        "flag",
        "whole",
        "wholes",
        "number",
        "numbers",
        "rows",
        "table",
        "tables",
        "read",
    )
    setups = [f"setups/{name}" for name in ("projects", "force_models", "workpiece", "tool_tables")]
    for file in (*setups, "robot/reader", "materials", "measured/measured_maps"):
        tree = ast.parse((ROOT / "robomill" / "io" / f"{file}.py").read_text(encoding="utf-8"))
        for call in (node for node in ast.walk(tree) if isinstance(node, ast.Call)):
            if not (isinstance(call.func, ast.Attribute) and call.func.attr in readers):
                continue
            for key in (arg.value for arg in call.args[:2] if isinstance(arg, ast.Constant)):
                if (
                    isinstance(key, str)
                    and KEY.fullmatch(key)
                    and not (call.func.attr != "read" and key == call.args[-1])
                ):
                    assert re.search(rf"\b{re.escape(key)}\b", page), f"{file}: {key}"


def test_every_key_of_a_pose_and_every_column_of_a_result_is_told(built, capsys, tmp_path):
    assert main(["pose", "slavkovic_5r", "--theta-deg", "0,0,0,0,0", "--json"]) == 0
    page = text_of(built, "results")
    for key in json.loads(capsys.readouterr().out):
        assert re.search(rf"^{key}\b", page, re.M), key
    assert main(["simulate", "paper_flute", "--out", str(tmp_path)]) == 0
    for name in ("deviation.csv", "sections.csv"):
        told = [cell for row in re.findall(r"^[\w*]+(?=\n)", page.split(name)[1], re.M) for cell in [row.strip()]]
        for column in (tmp_path / name).read_text().splitlines()[0].split(","):
            assert any(fnmatchcase(column, each) for each in told), column
