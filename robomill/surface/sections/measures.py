"""What a section tells of what is cut there: each measure declared once, for files, screens and reports."""

from dataclasses import dataclass

from robomill.units import format_si, in_lengths

LEFT = "positive to the left of the feed"
MATERIAL = "positive: material left"


@dataclass(frozen=True)
class Measure:
    """A number of a section.

    label   what people call it; ``short``: in a line beside others, "" where it is left out there
    unit    of files; a length is shown in the unit of the page. ``digits`` are its decimals (None: those of the unit)
    signed  whether it has two sides; ``hint``: which is positive, or what it is of
    form    the measure that is told beside it: how straight the wall is whose lean it is
    """

    label: str
    unit: str = "mm"
    short: str = ""
    signed: bool = False
    hint: str = ""
    digits: int | None = None
    form: str = ""

    def shown(self, value: float, length: str) -> str:
        """A value (SI) with its unit, a length in ``length`` (mm or in)."""
        return format_si(value, in_lengths(self.unit, length), self.digits, self.signed)


_SIDES = ("left", "right")
#: By their names, in the order of files; they are told of every section, whatever its kind.
MEASURED = {
    "station": Measure("Station"),
    "width": Measure("Width", short="width"),
    "depth": Measure("Depth", short="depth"),
    "centre_offset": Measure("Centre offset", short="centre", signed=True, hint=LEFT),
    "floor_error": Measure("Floor error", short="floor", signed=True, hint=MATERIAL),
    **{
        f"wall_{side}_error": Measure(f"{side.capitalize()} wall error", short=f"{side} wall", signed=True, hint=LEFT)
        for side in _SIDES
    },
    **{
        f"wall_{side}_angle": Measure(f"{side.capitalize()} wall", "deg", form=f"wall_{side}_straightness")
        for side in _SIDES
    },
    **{f"wall_{side}_straightness": Measure(f"{side.capitalize()} wall straightness") for side in _SIDES},
    "flatness": Measure("Floor flatness"),
    "floor_tilt": Measure(
        "Floor tilt", "deg", signed=True, hint="across, rising to the left of the feed positive", digits=3
    ),
    "error_mean": Measure("Mean error", short="surface", signed=True, hint=MATERIAL),
    "error_max": Measure("Largest error", signed=True, hint=MATERIAL),
    "error_rms": Measure("RMS error"),
    "slope": Measure("Slope", "deg", hint="of the ideal surface"),
}
