"""The cutter: its shape, its teeth and how far it sticks out. Lengths in m, angles in rad."""

from __future__ import annotations

import inspect
import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from robomill.arguments import asked, refuse_unknown
from robomill.arrays import FloatArray
from robomill.cutting.profile_kernels import Shape, conical, heights, profile, radii, round_nosed
from robomill.errors import CuttingError
from robomill.lazy import cached_property
from robomill.quantities import choice, quantity, settle, told, whole
from robomill.spelled import in_si, in_units, made, state
from robomill.units import format_count, format_si, to_si
from robomill.values import Value

#: Sine of how far the feed must go down along the axis before the whole flat end of a mill cuts: its teeth are ground
#: hollow (dish), so on gentler slopes only its heel does (``heel``). An assumption, the same for all mills.
DISH = math.sin(to_si(0.5, "deg"))
#: Sine of the slope below which nothing of it does: what its heel meets is less than the rounding of its edges.
PRESSED = math.sin(to_si(0.05, "deg"))
LARGEST = 2.0  # m: no cutter is as wide, whatever its unit
WIDEST, LONGEST = 0.6, 2.0  # m: hardly a cutter is wider, hardly one sticks out as far: was it meant in mm?
THINNEST, SHORTEST = 0.05e-3, 0.2e-3  # m: no robot mills with less, none sticks out less: was it meant in m?
SLIGHTEST, SHARPEST = to_si(1.5, "deg"), to_si(3.2, "deg")  # no helix is as slight, no tip as sharp: meant in rad?
MOST_FLUTES = 100  # a tooth a millimetre on a face mill of 32 mm; a mistyped number costs memory and time

Hand = Literal["right", "left"]
HANDS = {"right": "right", "left": "left"}


@dataclass(frozen=True)
class Family:
    """A family of cutters: what people call it, which numbers it needs beside those of every cutter, the angle of its
    point to start from, and whether it drills: pushed along its axis, it does not cut sideways."""

    short: str
    title: str
    needs: tuple[str, ...] = ()
    point: float = to_si(90.0, "deg")
    drills: bool = False

    def first(self, diameter: float) -> dict[str, float]:
        """A value to start from for each number in ``needs``, for a cutter of that diameter."""
        first = {"corner_radius": diameter / 8, "tip_angle": self.point, "tip_diameter": 0.0}
        return {name: first[name] for name in self.needs}


FAMILIES: dict[str, Family] = {
    "flat": Family("Flat", "flat end mill"),
    "ball": Family("Ball", "ball-nose mill"),
    "bull": Family("Bull", "bull-nose mill", ("corner_radius",)),
    "chamfer": Family("Chamfer", "chamfer mill", ("tip_angle", "tip_diameter")),
    "drill": Family("Drill", "drill", ("tip_angle",), point=to_si(118.0, "deg"), drills=True),
}


ASKED = ("flutes", "helix_angle")
"""The numbers of a cutter that the force grows with, and that may be left out."""


@in_units(CuttingError, "Cutter", asked=ASKED)
@dataclass(frozen=True, eq=False, repr=False)
class Cutter(Value):
    """A rotating cutter; its tip is the origin of {T} and its axis is z_T.

    ``Cutter("flat", diameter=0.008, flutes=3)`` in SI (m, rad), or ``Cutter("flat", diameter_mm=8, flutes=3)``.
    ``kind`` is "flat", "ball", "bull", "chamfer" or "drill".

    ``hand`` is the direction of cut: a right-hand cutter turns clockwise seen from the spindle (M3).
    ``helix`` is the hand of the flutes. ``corner_radius`` belongs to bull-nose mills (a ball nose has R).
    ``tip_angle`` is the full angle of a chamfer mill's cone or a drill's point, ``tip_diameter`` the flat at its end.
    ``flute_length`` and ``stick_out`` may be None (not given): depth is then not checked, bending not computed.
    ``unstated`` are the numbers the force grows with that were left out where it was made in code.
    ``helix_angle`` enters the peak force (lag along the edge); 0 means straight flutes, which pull nowhere.
    Raises CuttingError for a cutter that cannot be.

    Examples
    --------
    >>> import robomill as rm
    >>> cutter = rm.Cutter("bull", diameter_mm=10, corner_radius_mm=2, flutes=4)
    >>> cutter, cutter.flat_radius
    (<Cutter 10.00 mm bull-nose mill, 4 flutes>, 0.003)
    """

    kind: str = choice("Kind", {kind: family.short for kind, family in FAMILIES.items()})
    diameter: float = quantity("Diameter", "mm", least=1e-6, most=LARGEST, slip=WIDEST, tiny=THINNEST)
    corner_radius: float = quantity("Corner radius", "mm", default=0.0, least=0.0, slip=WIDEST, tiny=5e-6)
    flutes: int = whole("Flutes", default=2, least=1, most=MOST_FLUTES)
    helix: Hand = choice(
        "Helix",
        HANDS,
        default="right",
        hint="A right-hand helix on a right-hand cutter pulls the tool towards the part.",
    )
    helix_angle: float = quantity(
        "Helix angle",
        "deg",
        default=to_si(30.0, "deg"),
        least=0.0,
        below=to_si(85.0, "deg"),
        digits=1,
        slip=math.tau,
        tiny=SLIGHTEST,
    )
    flute_length: float | None = quantity(
        "Flute length",
        "mm",
        optional=True,
        above=0.0,
        slip=LONGEST,
        tiny=THINNEST,
        digits=1,
        hint="Deeper cuts are warned of: the shank would rub.",
    )
    stick_out: float | None = quantity(
        "Stick-out",
        "mm",
        optional=True,
        above=0.0,
        slip=LONGEST,
        tiny=SHORTEST,
        digits=1,
        hint="Free length from the holder; tool bending grows with its cube.",
    )
    tip_angle: float | None = quantity(
        "Full tip angle", "deg", optional=True, above=0.0, below=to_si(180.0, "deg"), slip=math.tau, tiny=SHARPEST
    )
    tip_diameter: float = quantity("Tip diameter", "mm", default=0.0, least=0.0, slip=WIDEST)
    hand: Hand = choice("Hand", HANDS, default="right")
    unstated: ClassVar[tuple[str, ...]] = ()
    carried: ClassVar[tuple[str, ...]] = ("unstated",)

    if TYPE_CHECKING:

        def __init__(
            self,
            kind: str,
            diameter: float = ...,
            corner_radius: float = ...,
            flutes: int = ...,
            helix: Hand = ...,
            helix_angle: float = ...,
            flute_length: float | None = ...,
            stick_out: float | None = ...,
            tip_angle: float | None = ...,
            tip_diameter: float = ...,
            hand: Hand = ...,
            *,
            diameter_mm: float = ...,
            corner_radius_mm: float = ...,
            helix_angle_deg: float = ...,
            flute_length_mm: float | None = ...,
            stick_out_mm: float | None = ...,
            tip_angle_deg: float | None = ...,
            tip_diameter_mm: float = ...,
        ) -> None: ...

    def __post_init__(self) -> None:
        settle(self, CuttingError, "Cutter")
        if self.flute_length is not None and self.stick_out is not None and self.flute_length > self.stick_out:
            raise CuttingError(
                f"Flute length {format_si(self.flute_length, 'mm')} is longer than the stick-out "
                f"{format_si(self.stick_out, 'mm')}: the flutes cannot reach into the holder.",
                where="flute_length",
            )
        self._check_corner()
        self._check_cone()

    def _check_corner(self) -> None:
        """A ball nose has the cutter's radius; without a need for one it is 0."""
        if self.kind == "ball":
            if self.corner_radius not in (0.0, self.radius) and not math.isclose(self.corner_radius, self.radius):
                raise CuttingError(
                    f"A ball-nose mill of {format_si(self.diameter, 'mm')} has corner radius "
                    f"{format_si(self.radius, 'mm')}, found {format_si(self.corner_radius, 'mm')}: "
                    "leave it out or choose a bull-nose mill.",
                    where="corner_radius",
                )
            object.__setattr__(self, "corner_radius", self.radius)
        elif "corner_radius" not in self.family.needs:
            if self.corner_radius != 0.0:
                raise CuttingError(
                    f"A {self.family.title} has no corner radius, found {format_si(self.corner_radius, 'mm')}: "
                    "set it to 0 or choose a bull-nose mill.",
                    where="corner_radius",
                )
        elif self.corner_radius == 0.0:
            raise CuttingError(
                f"A {self.family.title} needs a corner radius greater than 0: give one or choose a flat end mill.",
                where="corner_radius",
            )
        elif self.corner_radius > self.radius:
            raise CuttingError(
                f"Corner radius {format_si(self.corner_radius, 'mm')} is larger than the cutter's radius "
                f"{format_si(self.radius, 'mm')}: it can be at most that (a ball nose).",
                where="corner_radius",
            )

    def _check_cone(self) -> None:
        if not self.conical:
            if self.tip_angle is not None or self.tip_diameter != 0.0:
                raise CuttingError(
                    f"A {self.family.title} has no tip angle or tip diameter: leave them out.", where="tip_angle"
                )
        elif self.tip_angle is None:
            raise CuttingError(
                f"A {self.family.title} needs a tip angle between 0° and 180° (the full cone), found none.",
                where="tip_angle",
            )
        elif self.tip_diameter >= self.diameter:
            raise CuttingError(
                f"Tip diameter {format_si(self.tip_diameter, 'mm')}: expected 0 to less than the cutter's diameter "
                f"{format_si(self.diameter, 'mm')}.",
                where="tip_diameter",
            )

    @property
    def family(self) -> Family:
        """What cutters of its kind have in common: profile, name, whether they drill."""
        return FAMILIES[self.kind]

    @property
    def conical(self) -> bool:
        """Whether its nose is a cone; the others are round (a flat mill with radius 0)."""
        return "tip_angle" in self.family.needs

    @property
    def half_angle(self) -> float:
        """Between the axis and the flank of a cone, rad (0 on the others)."""
        return 0.5 * (self.tip_angle or 0.0)

    @property
    def radius(self) -> float:
        """Largest radius R, m."""
        return 0.5 * self.diameter

    @property
    def flat_radius(self) -> float:
        """Radius of the flat end face, m: R (flat), 0 (ball), R - corner radius (bull), tip radius (chamfer)."""
        return 0.5 * self.tip_diameter if self.conical else max(self.radius - self.corner_radius, 0.0)

    @cached_property
    def solid(self) -> Shape:
        """Its profile in numbers."""
        if self.conical:
            return conical(self.radius, self.flat_radius, self.half_angle)
        return round_nosed(self.radius, self.corner_radius)

    @property
    def nose_height(self) -> float:
        """Height above the tip at which the full radius is reached, m; from there on the side is a cylinder."""
        return profile(self.solid, self.radius)

    @property
    def edge_height(self) -> float:
        """How high above the tip its edges may reach, m: its flutes, at most to the holder; inf where neither is
        stated."""
        return min((each for each in (self.flute_length, self.stick_out) if each is not None), default=math.inf)

    @property
    def pull(self) -> int:
        """Which way the helix drives the cutter: +1 out of its holder (force on the tool along -z_T), -1 into it.

        A right-hand helix on a right-hand cutter pulls, and so does its mirror image; opposite hands push.
        Straight flutes give 0.
        """
        if self.helix_angle == 0.0:
            return 0
        return 1 if self.helix == self.hand else -1

    def _said(self) -> str:
        return self.title

    def _facts(self) -> list[tuple[str, str]]:
        return told(self)

    @property
    def title(self) -> str:
        """For people, e.g. ``"8.00 mm flat end mill, 3 flutes"``."""
        return self.called("mm")

    @asked
    def called(self, length: str) -> str:
        """``title`` with its diameter in ``length``, a key of ``UNITS``."""
        return f"{format_si(self.diameter, length, 2)} {self.family.title}, {format_count(self.flutes, 'flute')}"

    @asked
    def profile(self, r: ArrayLike) -> FloatArray:
        """Height (m) of the cutting surface above the tip at radius ``r`` (...) m; inf for r < 0 or r > R."""
        radius = np.asarray(r, dtype=np.float64)
        height = np.empty(radius.size)
        heights(np.ascontiguousarray(radius).ravel(), self.solid, height)
        return np.where((radius >= 0.0) & (radius <= self.radius), height.reshape(radius.shape), np.inf)

    @asked
    def radius_at(self, height: ArrayLike) -> FloatArray:
        """Radius (m) of the cutter ``height`` (...) m above the tip, the inverse of ``profile``; NaN below the tip."""
        z = np.asarray(height, dtype=np.float64)
        radius = np.empty(z.size)
        radii(np.ascontiguousarray(np.maximum(z, 0.0)).ravel(), self.solid, radius)
        return np.where(z >= 0.0, radius.reshape(z.shape), np.nan)

    def replace(self, **changes: Any) -> Cutter:
        """A checked copy with fields changed: ``diameter=0.01``, or ``diameter_mm=10``."""
        refuse_unknown(changes, inspect.signature(Cutter).parameters, "Cutter.replace")
        changes = in_si(Cutter, changes)
        if self.kind == "ball" and "corner_radius" not in changes:
            changes["corner_radius"] = 0.0
        other = made(Cutter, state(self) | changes)
        object.__setattr__(other, "unstated", tuple(name for name in self.unstated if name not in changes))
        return other

    @asked
    def reshaped(self, kind: str) -> Cutter:
        """The same cutter of another shape, with a first value for each number that one needs."""
        plain: dict[str, Any] = {"corner_radius": 0.0, "tip_angle": None, "tip_diameter": 0.0}
        return replace(self, kind=kind, **(plain | FAMILIES[kind].first(self.diameter)))
