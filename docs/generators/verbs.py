"""The command line from its own parser: every verb with its words, its example and what it takes."""

from __future__ import annotations

import argparse
import os

from robomill.cli.parser import make_parser


def pages() -> dict[str, str]:
    """The generated piece by name."""
    os.environ["COLUMNS"] = "96"
    top = make_parser()
    verbs = next(each for each in top._actions if isinstance(each, argparse._SubParsersAction))
    short = {each.dest: each.help or "" for each in verbs._choices_actions}
    listed = ["| verb | what it does |", "|---|---|"]
    listed += [f"| [`{name}`](#verb-{name}) | {_cell(short.get(name, ''))} |" for name in verbs.choices]
    return {"verbs.md": "\n\n".join(["\n".join(listed), *(_verb(name, sub) for name, sub in verbs.choices.items())])}


def _verb(name: str, sub: argparse.ArgumentParser) -> str:
    """A section on one verb."""
    said = [f"(verb-{name})=\n\n## `robomill {name}`", _cell(sub.description or "")]
    said.append(f"```text\n{sub.format_usage().strip()}\n```")
    rows = [_row(action) for action in sub._actions if not isinstance(action, argparse._HelpAction)]
    if rows:
        said.append("\n".join(["| what | meaning | where it is left out |", "|---|---|---|", *rows]))
    if sub.epilog:
        said.append(f"```text\n{sub.epilog.strip()}\n```")
    return "\n\n".join(said)


def _row(action: argparse.Action) -> str:
    if action.option_strings:
        value = "" if action.nargs == 0 else " " + str(action.metavar or action.dest.upper())
        what = ", ".join(f"`{option}{value}`" for option in action.option_strings)
    else:
        what = f"`{(action.metavar or action.dest).upper()}`"  # type: ignore[union-attr]
    choices = f" One of {', '.join(f'`{each}`' for each in action.choices)}." if action.choices else ""
    if action.required:
        default = "is needed"
    elif action.default in (None, False, argparse.SUPPRESS, []):
        default = ""
    else:
        default = f"`{action.default}`"
    return f"| {what} | {_cell((action.help or '') + choices)} | {default} |"


def _cell(text: str) -> str:
    return " ".join(text.replace("%%", "%").replace("|", "\\|").split())
