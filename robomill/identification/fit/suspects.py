"""What may be missing from a model, and what letting links bend would bring: values, asked for in ``causes``."""

from dataclasses import dataclass
from typing import Literal

from robomill.provenance import Finding
from robomill.units import format_si

Kind = Literal["bending", "tool", "points", "zero", "offset", "drift", "play"]
OF_GAUGES: dict[Kind, str] = {
    "offset": "a constant in every reading (a gauge that was not zeroed)",
    "drift": "a drift of the gauges from the first row to the last",
    "play": "a constant with the sign of the reading (play or friction)",
}
ALIKE = 0.95  # share of an error on poses left out above which two causes explain them alike


@dataclass(frozen=True)
class Cause:
    """One thing that may be missing: bending at joint ``at`` in the link before it or (``turned``) after it, the tool,
    what gauges do, ``points`` by the name of what is fitted ("force", "gauge", "both"), or the zero of joint ``at``."""

    kind: Kind
    at: int = 0
    turned: bool = False
    points: str = ""


@dataclass(frozen=True)
class Suspect:
    """A cause that the readings call for: its ``numbers`` (how many it adds), the chance that noise alone calls for it,
    the error on poses left out with it, and by how much the zero of a joint is off with half its 95 % interval (rad or
    m; NaN for other causes)."""

    cause: Cause
    numbers: int
    chance: float
    error: float
    off: float = float("nan")
    half: float = float("nan")


@dataclass(frozen=True)
class Inquest:
    """What an inquiry found: the error on poses left out ``before`` any cause, the suspects, the likeliest first, and
    the chance with which noise alone would leave over so much between the poses (``lack``, NaN where no pose is loaded
    often enough) or so much more where the displacement is large (``growth``)."""

    before: float = float("nan")
    suspects: tuple[Suspect, ...] = ()
    lack: float = float("nan")
    growth: float = float("nan")

    @property
    def likeliest(self) -> tuple[Suspect, ...]:
        """The simplest of those that explain poses left out best, and what cannot be told from it."""
        if not self.suspects:
            return ()
        limit = self.suspects[0].error / ALIKE
        alike = sorted((s for s in self.suspects if s.error <= limit), key=lambda s: (s.numbers, s.error))
        first = alike[0]
        return (first, *(s for s in alike[1:] if not (s.cause.kind == first.cause.kind == "points")))


UNASKED = Inquest()


@dataclass(frozen=True)
class BendingOffer:
    """Links that are worth letting bend: at these joints (``turned``: after them), and the error on poses left out as
    the tests choose them in every fold, before and after."""

    joints: tuple[int, ...]
    turned: bool
    before: float
    after: float

    def finding(self) -> Finding:
        """The offer as it is said."""
        where = " and ".join(map(str, self.joints))
        was, now = format_si(self.before, "%", 1), format_si(self.after, "%", 1)
        text = (
            f"Links seem to bend {'after' if self.turned else 'at'} joint {where}: let the tests say where links bend "
            f"(bending auto), and the error on poses left out goes from {was} to {now}."
        )
        return Finding("warning", text, count=len(self.joints), code="bending-pays")
