"""The validation table: each number computed now, by robomill and by a calculation that shares nothing with it.

A row whose two numbers lie further apart than it allows stops the build.
"""

from __future__ import annotations

from generators.validation import paper
from generators.validation.brute_force import BRUTE_FORCE
from generators.validation.check import table
from generators.validation.closed_forms import CLOSED_FORMS
from generators.validation.peers import PEERS


def pages() -> dict[str, str]:
    """The generated pieces by name."""
    return {
        "validation_paper.md": paper.rows(),
        "validation_closed.md": table(CLOSED_FORMS),
        "validation_brute.md": table(BRUTE_FORCE),
        "validation_peers.md": table([compute for _, compute in PEERS], [package for package, _ in PEERS]),
    }
