"""The documents print what the code prints: their blocks are run, and what comes out is compared with what is shown.

Run are, page by page and in the page's order, in an empty folder:

- Python blocks, one after the other as in one session; what they print stands in the text block right behind them;
- console blocks: each line that begins with ``$ robomill``, in this process; its output stands below it.

``...`` in a shown output stands for anything. ``python docs/printed.py --write`` fills in what is printed now.
"""

from __future__ import annotations

import contextlib
import doctest
import io
import os
import re
import shlex
import sys
import tempfile
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

DOCS = Path(__file__).resolve().parent
ROOT = DOCS.parent
PAGES = (ROOT / "README.md", *sorted(DOCS.glob("*.md")), *sorted(DOCS.glob("how_to/*.md")))
_FENCE = re.compile(
    r"^(?P<mark>`{3,})(?P<language>[\w+-]*)[^\n]*\n(?P<text>.*?)^(?P=mark)[ \t]*$", re.MULTILINE | re.DOTALL
)
_BETWEEN = re.compile(r"`{3,}\s*`{3,}text[^\n]*\n")  # a block that ends, and right behind it one of text that begins
_PROMPT = "$ "


@dataclass(frozen=True)
class Block:
    """A fenced block: its language and text, where the text stands in the page, and the line it begins in."""

    language: str
    text: str
    start: int
    end: int
    line: int


@dataclass(frozen=True)
class Shown:
    """One output: what was run, what the page shows, what comes out, and where it stands (from, to) in the page.

    Where a page shows nothing, ``start`` is where a block of output would go and ``bare`` is true.
    """

    what: str
    shown: str
    printed: str
    start: int
    end: int
    line: int
    bare: bool = False

    @property
    def agrees(self) -> bool:
        want, got = (_plain(text) for text in (self.shown, self.printed))
        return want == got or doctest.OutputChecker().check_output(want, got, doctest.ELLIPSIS)


def blocks(text: str) -> list[Block]:
    """The fenced blocks of a page, in order."""
    return [
        Block(m["language"], m["text"], m.start("text"), m.end("text"), text.count("\n", 0, m.start()) + 1)
        for m in _FENCE.finditer(text)
    ]


def outputs(page: Path) -> Iterator[Shown]:
    """Run the page's blocks in the working folder and give each output with what the page shows of it."""
    text = page.read_text(encoding="utf-8")
    found = blocks(text)
    session: dict[str, object] = {"__name__": page.stem}
    for block, following in zip(found, [*found[1:], None]):
        if block.language == "python":
            printed = _captured(lambda block=block: _run(block, page, session))
            if following is not None and _BETWEEN.fullmatch(text[block.end : following.start]):
                yield Shown(block.text, following.text, printed, following.start, following.end, following.line)
            elif printed:
                end = block.end + len("```\n")
                yield Shown(block.text, "", printed, end, end, block.line, bare=True)
        elif block.language == "console":
            yield from _console(block)


def _run(block: Block, page: Path, session: dict[str, object]) -> None:
    source = "\n" * block.line + block.text  # so that a traceback names the page's own line
    try:
        exec(compile(source, str(page), "exec"), session)
    except Exception:
        print(traceback.format_exc())


def _console(block: Block) -> Iterator[Shown]:
    at = block.start
    pieces = re.split(rf"^(?={re.escape(_PROMPT)})", block.text, flags=re.MULTILINE)
    for piece in pieces:
        command, _, shown = piece.partition("\n")
        if command.startswith(f"{_PROMPT}robomill"):
            begin = at + len(command) + 1
            words = shlex.split(command.removeprefix(_PROMPT), comments=True)[1:]
            yield Shown(command, shown, _verb(words), begin, begin + len(shown), block.line)
        at += len(piece)


def _verb(words: list[str]) -> str:
    """What a verb prints: its output, and, where it refuses, the sentence that says why."""
    from robomill.cli import main

    said, refused, code = io.StringIO(), io.StringIO(), 0
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(refused):
        try:
            code = main(words)
        except SystemExit as ended:  # argparse
            code = int(ended.code or 0)
    return said.getvalue() + (refused.getvalue() if code == 2 else "")


def _captured(work: Callable[[], object]) -> str:
    """What goes to standard output; what goes to standard error (progress, a first preparation) is for the moment."""
    stream = io.StringIO()
    with contextlib.redirect_stdout(stream):
        work()
    return stream.getvalue()


def _plain(text: str) -> str:
    """Without blanks at the ends of lines and empty lines at the end of the text."""
    return "\n".join(line.rstrip() for line in text.rstrip().split("\n")) + "\n"


def refreshed(text: str, found: list[Shown]) -> str:
    """The page with what is printed now in place of what does not agree."""
    for each in sorted(found, key=lambda each: -each.start):
        if each.agrees:
            continue
        printed = _plain(each.printed) if each.printed.strip() else ""
        new = f"\n```text\n{printed}```\n" if each.bare else printed
        text = text[: each.start] + new + text[each.end :]
    return text


def in_empty_folder(page: Path) -> list[Shown]:
    """All outputs of a page, run where nothing else lies."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        return [replace(each) for each in outputs(page)]


def main(words: list[str]) -> int:
    wrong = 0
    chosen = [Path(word).resolve() for word in words if not word.startswith("-")] or [*PAGES]
    for page in chosen:
        found = in_empty_folder(page)
        bad = [each for each in found if not each.agrees]
        wrong += len(bad)
        for each in bad:
            print(f"{page.relative_to(ROOT)}:{each.line}: {each.what.strip().splitlines()[-1]}\n{each.printed}")
        if bad and "--write" in words:
            page.write_text(refreshed(page.read_text(encoding="utf-8"), found), encoding="utf-8")
    print(f"{wrong} outputs differ" + (", and are filled in" if wrong and "--write" in words else ""))
    return int(bool(wrong) and "--write" not in words)


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT))
    os.environ.setdefault("NO_COLOR", "1")
    sys.exit(main(sys.argv[1:]))
