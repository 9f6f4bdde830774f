"""What a section shows, by the ideal surface around the tool: a groove, a step, a pocket, a free surface, nothing."""

from typing import Literal

from robomill.cutting.tool import Cutter
from robomill.surface.sections.trace import OWN, Side

Kind = Literal["groove", "step", "pocket", "free", "nothing", "unknown"]
TITLES: dict[Kind, str] = {
    "groove": "Groove",
    "step": "Step",
    "pocket": "Pocket",
    "free": "Free surface",
    "nothing": "Nothing",
    "unknown": "Unknown",
}
GROOVE = 1.2  # cutter diameters: walls further apart were made by several passes, a pocket's
FLAT = 0.1  # of the radius: a cutter with a smaller flat leaves no straight floor

FLOOR = ("depth", "floor_error", "floor_tilt", "flatness")
NEAR_WALL = ("wall_near_error", "wall_near_angle", "wall_near_straightness")
#: What a gauge has for each kind; ``near`` is the wall to the left or to the right.
MEASURES: dict[Kind, tuple[str, ...]] = {
    "groove": (
        *("width", "depth", "centre_offset", "floor_error", "floor_tilt"),
        *("wall_left_angle", "wall_right_angle", "wall_left_straightness", "wall_right_straightness"),
    ),
    "step": (*FLOOR, *NEAR_WALL),
    "pocket": (*FLOOR, *NEAR_WALL),
    "free": ("error_mean", "error_max", "error_rms", "slope"),
    "nothing": (),
    "unknown": (),
}


def kind_of(left: Side, right: Side, cutter: Cutter) -> Kind:
    """The kind of a section that is cut at the axis, by what ends its floor to the left and to the right.

    Groove: two walls, at most ``GROOVE`` diameters apart. Free surface: where passes leave crests between them, where
    it rises further than a flank reaches, where a cutter without a flat goes beside another pass, and where no wall
    stands on either side. Step: one wall. Pocket: two walls further apart.
    """
    both = left, right
    walls = [side for side in both if side.ends == "wall"]
    if len(walls) == 2 and left.w - right.w <= GROOVE * cutter.diameter:
        return "groove"
    if not walls or any(side.ends in ("crest", "slope") for side in both):
        return "free"
    alone = all(side.ends == "open" or (side.ends == "wall" and abs(side.w) <= OWN * cutter.radius) for side in both)
    if not has_floor(cutter) and not alone:
        return "free"
    return "pocket" if len(walls) == 2 else "step"


def has_floor(cutter: Cutter) -> bool:
    """Whether it leaves a straight floor."""
    return cutter.flat_radius >= FLAT * cutter.radius


def straight_part(cutter: Cutter, floor: float, top: float) -> tuple[float, float] | None:
    """Heights (foot, top) m between which a wall that the cutter left is straight, between its ``floor`` and ``top``:
    beside its cylinder, or its cone where that is the higher of the two; None on a round nose."""
    nose = min(floor + cutter.nose_height, top)
    if cutter.conical and nose - floor > top - nose:
        return floor, nose
    return (nose, top) if top > nose else None
