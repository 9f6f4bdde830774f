"""The cutter: its shape, its teeth and how far it sticks out. Lengths in m, angles in rad."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray
from robomill.errors import CuttingError
from robomill.units import format_si, to_si

CutterKind = Literal["flat", "ball", "bull", "chamfer"]
Hand = Literal["right", "left"]

KIND_TITLES: dict[str, str] = {
    "flat": "flat end mill",
    "ball": "ball-nose mill",
    "bull": "bull-nose mill",
    "chamfer": "chamfer mill",
}


@dataclass(frozen=True)
class Cutter:
    """A rotating cutter; its tip is the origin of {T} and its axis is z_T.

    ``hand`` is the direction of cut: a right-hand cutter turns clockwise seen from the spindle (M3).
    ``helix`` is the hand of the flutes. ``corner_radius`` belongs to bull-nose mills (a ball nose has R).
    ``tip_angle`` is the full angle of a chamfer mill's cone, ``tip_diameter`` the flat at its end.
    ``flute_length`` and ``stick_out`` may be None (not given): depth is then not checked, bending not computed.
    ``helix_angle`` enters the peak force (lag along the edge); 0 means straight flutes, which pull nowhere.
    Raises CuttingError for a cutter that cannot be.
    """

    kind: CutterKind
    diameter: float
    corner_radius: float = 0.0
    flutes: int = 2
    helix: Hand = "right"
    helix_angle: float = to_si(30.0, "deg")
    flute_length: float | None = None
    stick_out: float | None = None
    tip_angle: float | None = None
    tip_diameter: float = 0.0
    hand: Hand = "right"

    def __post_init__(self) -> None:
        if self.kind not in get_args(CutterKind):
            raise CuttingError(
                f"Cutter kind {self.kind!r} is not known: use flat, ball, bull or chamfer.", where="kind"
            )
        for name in ("helix", "hand"):
            if getattr(self, name) not in get_args(Hand):
                raise CuttingError(f"Cutter {name} {getattr(self, name)!r}: expected 'right' or 'left'.", where=name)
        self._settle_numbers()
        self._check_size()
        if self.kind == "ball":
            self._check_ball()
        elif self.kind == "bull":
            self._check_bull()
        elif self.corner_radius != 0.0:
            raise CuttingError(
                f"A {KIND_TITLES[self.kind]} has no corner radius, found {format_si(self.corner_radius, 'mm')}: "
                "set it to 0 or choose a bull-nose mill.",
                where="corner_radius",
            )
        self._check_cone()

    def _settle_numbers(self) -> None:
        """Every number a finite float (or None where it may be absent), flutes a whole number."""
        for name in (
            "diameter",
            "corner_radius",
            "helix_angle",
            "flute_length",
            "stick_out",
            "tip_angle",
            "tip_diameter",
        ):
            value = getattr(self, name)
            if value is None and name in ("flute_length", "stick_out", "tip_angle"):
                continue
            label = name.replace("_", " ")
            try:
                number = float(value)
            except (TypeError, ValueError) as exc:
                raise CuttingError(f"Cutter {label}: expected a number, found {value!r:.40}.", where=name) from exc
            if not math.isfinite(number):
                raise CuttingError(f"Cutter {label}: expected a finite number, found {number}.", where=name)
            object.__setattr__(self, name, number)
        try:
            whole = float(self.flutes) == int(self.flutes)
        except (TypeError, ValueError, OverflowError):
            whole = False
        if not whole or isinstance(self.flutes, str | bool):
            raise CuttingError(f"Cutter flutes: expected a whole number, found {self.flutes!r:.40}.", where="flutes")
        object.__setattr__(self, "flutes", int(self.flutes))

    def _check_size(self) -> None:
        if self.diameter <= 0.0:
            raise CuttingError(
                f"Cutter diameter {format_si(self.diameter, 'mm')}: it must be greater than 0.", where="diameter"
            )
        if self.flutes < 1:
            raise CuttingError(f"Cutter with {self.flutes} flutes: it needs at least one.", where="flutes")
        if not 0.0 <= self.helix_angle < to_si(85.0, "deg"):
            raise CuttingError(
                f"Helix angle {format_si(self.helix_angle, 'deg')}: expected 0° to 85°; "
                "the hand of the helix is set apart from its angle.",
                where="helix_angle",
            )
        for name in ("flute_length", "stick_out"):
            length = getattr(self, name)
            if length is not None and length <= 0.0:
                raise CuttingError(
                    f"Cutter {name.replace('_', ' ')} {format_si(length, 'mm')}: "
                    "it must be greater than 0, or left out if unknown.",
                    where=name,
                )
        if self.flute_length is not None and self.stick_out is not None and self.flute_length > self.stick_out:
            raise CuttingError(
                f"Flute length {format_si(self.flute_length, 'mm')} is longer than the stick-out "
                f"{format_si(self.stick_out, 'mm')}: the flutes cannot reach into the holder.",
                where="flute_length",
            )
        if self.corner_radius < 0.0:
            raise CuttingError(
                f"Corner radius {format_si(self.corner_radius, 'mm')}: it cannot be negative.", where="corner_radius"
            )

    def _check_ball(self) -> None:
        if self.corner_radius not in (0.0, self.radius) and not math.isclose(self.corner_radius, self.radius):
            raise CuttingError(
                f"A ball-nose mill of {format_si(self.diameter, 'mm')} has corner radius "
                f"{format_si(self.radius, 'mm')}, found {format_si(self.corner_radius, 'mm')}: "
                "leave it out or choose a bull-nose mill.",
                where="corner_radius",
            )
        object.__setattr__(self, "corner_radius", self.radius)

    def _check_bull(self) -> None:
        if self.corner_radius == 0.0:
            raise CuttingError(
                "A bull-nose mill needs a corner radius greater than 0: give one or choose a flat end mill.",
                where="corner_radius",
            )
        if self.corner_radius > self.radius:
            raise CuttingError(
                f"Corner radius {format_si(self.corner_radius, 'mm')} is larger than the cutter's radius "
                f"{format_si(self.radius, 'mm')}: it can be at most that (a ball nose).",
                where="corner_radius",
            )

    def _check_cone(self) -> None:
        if self.kind != "chamfer":
            if self.tip_angle is not None or self.tip_diameter != 0.0:
                raise CuttingError(
                    f"A {KIND_TITLES[self.kind]} has no tip angle or tip diameter: leave them out.", where="tip_angle"
                )
            return
        if self.tip_angle is None or not 0.0 < self.tip_angle < math.pi:
            found = "none" if self.tip_angle is None else format_si(self.tip_angle, "deg")
            raise CuttingError(
                f"A chamfer mill needs a tip angle between 0° and 180° (the full cone), found {found}.",
                where="tip_angle",
            )
        if not 0.0 <= self.tip_diameter < self.diameter:
            raise CuttingError(
                f"Tip diameter {format_si(self.tip_diameter, 'mm')}: expected 0 to less than the cutter's diameter "
                f"{format_si(self.diameter, 'mm')}.",
                where="tip_diameter",
            )

    @property
    def radius(self) -> float:
        """Largest radius R, m."""
        return 0.5 * self.diameter

    @property
    def flat_radius(self) -> float:
        """Radius of the flat end face, m: R (flat), 0 (ball), R - corner radius (bull), tip radius (chamfer)."""
        if self.kind == "chamfer":
            return 0.5 * self.tip_diameter
        return max(self.radius - self.corner_radius, 0.0)

    @property
    def nose_height(self) -> float:
        """Height above the tip at which the full radius is reached, m; from there on the side is a cylinder."""
        if self.kind == "chamfer":
            return (self.radius - self.flat_radius) / math.tan(0.5 * float(self.tip_angle or 0.0))
        return self.corner_radius

    @property
    def pull(self) -> int:
        """Which way the helix drives the cutter: +1 out of its holder (force on the tool along -z_T), -1 into it.

        A right-hand helix on a right-hand cutter pulls, and so does its mirror image; opposite hands push.
        Straight flutes give 0.
        """
        if self.helix_angle == 0.0:
            return 0
        return 1 if self.helix == self.hand else -1

    @property
    def title(self) -> str:
        """For people, e.g. ``"8.00 mm flat end mill, 3 flutes"``."""
        plural = "flute" if self.flutes == 1 else "flutes"
        return f"{format_si(self.diameter, 'mm', 2)} {KIND_TITLES[self.kind]}, {self.flutes} {plural}"

    def profile(self, r: ArrayLike) -> FloatArray:
        """Height (m) of the cutting surface above the tip at radius ``r`` (...) m; inf for r < 0 or r > R."""
        radius = np.asarray(r, dtype=np.float64)
        beyond = np.maximum(radius - self.flat_radius, 0.0)
        if self.kind == "flat":
            height = np.zeros_like(radius)
        elif self.kind == "chamfer":
            height = beyond / math.tan(0.5 * float(self.tip_angle or 0.0))
        else:
            rho = self.corner_radius
            height = rho - np.sqrt(np.maximum((rho - beyond) * (rho + beyond), 0.0))
        return np.where((radius >= 0.0) & (radius <= self.radius), height, np.inf)

    def radius_at(self, height: ArrayLike) -> FloatArray:
        """Radius (m) of the cutter ``height`` (...) m above the tip, the inverse of ``profile``; NaN below the tip."""
        z = np.asarray(height, dtype=np.float64)
        inside = np.clip(z, 0.0, self.nose_height)
        if self.kind == "flat":
            radius = np.full_like(z, self.radius)
        elif self.kind == "chamfer":
            radius = self.flat_radius + inside * math.tan(0.5 * float(self.tip_angle or 0.0))
        else:
            radius = self.flat_radius + np.sqrt(inside * (2.0 * self.corner_radius - inside))
        return np.where(z < 0.0, np.nan, radius)

    def replace(self, **changes: Any) -> Cutter:
        """A checked copy with fields changed."""
        if self.kind == "ball" and "corner_radius" not in changes:
            changes["corner_radius"] = 0.0
        return replace(self, **changes)
