"""What the tests of the documents share: where these stand, and their own modules, which are no part of the package."""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
sys.path[:0] = [path for path in (str(DOCS),) if path not in sys.path]
