"""A study as one TOML file, its set-up within: the command line runs it to the same numbers."""

from __future__ import annotations

from typing import Any

import tomli_w

from robomill.io.setups.projects import setup_to_toml
from robomill.io.tables import parse_toml
from robomill.study.described import FORMAT, VERSION, Study
from robomill.study.design import DISTRIBUTIONS, Parameter


def study_to_toml(study: Study) -> str:
    """The study as a file that needs no other; ``load_study`` reads it back to the same digest."""
    design: dict[str, Any] = {"kind": study.kind}
    if study.kind != "grid":
        design |= {"points": study.count, "seed": study.seed}
    elif study.seed:
        design["seed"] = study.seed
    data = {
        "format": FORMAT,
        "version": VERSION,
        "name": study.name,
        "responses": list(study.responses),
        "design": design,
        "parameters": {each.key: _table(each, study.kind == "grid") for each in study.parameters},
        "setup": parse_toml(setup_to_toml(study.setup), "set-up", exact=True),
    }
    return tomli_w.dumps(data, multiline_strings="\r" not in getattr(study.setup.source, "text", ""))


def _table(each: Parameter, grid: bool) -> dict[str, Any]:
    if each.values:
        return {"values": list(each.values)}
    steps = {"steps": each.steps} if grid else {}
    if each.distribution:
        stated = zip(DISTRIBUTIONS[each.distribution], each.stated, strict=True)
        return {"distribution": each.distribution, **dict(stated), **steps}
    return {"low": each.low, "high": each.high, **({"log": True} if each.log else {}), **steps}
