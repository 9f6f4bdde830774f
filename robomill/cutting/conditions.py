"""How the tool cuts at every step of the path: feed, speed, depth and the arc of engagement. SI, rad.

The engagement angle phi is seen from the spindle, measured clockwise from the left of the feed:
phi = 0 is the left of the feed, pi/2 straight ahead, pi the right. It is geometry and does not depend on the
cutter's hand; a right-hand cutter's teeth run from 0 to pi.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import BoolArray, FloatArray, IntArray, as_floats, frozen
from robomill.cutting.tool import Cutter
from robomill.errors import CuttingError
from robomill.units import format_si


@dataclass(frozen=True, eq=False)
class CutConditions:
    """Arrays of shape (m,), one entry a step of the path; a scalar stands for all steps.

    v_f      m/s    feed rate along the path
    n_s      1/s    spindle revolutions per second, 0 where stopped
    a_p      m      axial depth of cut, 0 in air
    phi_st   rad    start of the arc of engagement, 0..pi clockwise from the left of the feed
    phi_ex   rad    end of the arc; equal to phi_st in air
    cutting  bool   False on rapids
    s        m      path length from the start
    t        s      time from the start
    across   1      share of the feed across the tool axis: 1 on the level, 0 in a plunge (only this makes chips aside)
    block    int    source line, 0 where not stated (refusals name it)

    Raises CuttingError for lengths that differ, values that are not finite, or an arc the wrong way round.
    """

    v_f: FloatArray
    n_s: FloatArray
    a_p: FloatArray
    phi_st: FloatArray
    phi_ex: FloatArray
    cutting: BoolArray
    s: FloatArray
    t: FloatArray
    across: FloatArray = 1.0  # type: ignore[assignment]
    block: IntArray = 0  # type: ignore[assignment]

    def __post_init__(self) -> None:
        m = max(np.size(getattr(self, field.name)) for field in fields(self))
        for field in fields(self):
            value = as_floats(getattr(self, field.name), f"cutting conditions, {field.name}", (), error=CuttingError)
            if value.shape not in ((), (1,), (m,)):
                raise CuttingError(f"Cutting conditions, {field.name}: expected {m} values, found shape {value.shape}.")
            dtype: Any = {"cutting": bool, "block": np.int64}.get(field.name, np.float64)
            object.__setattr__(self, field.name, frozen(np.broadcast_to(value, (m,)), dtype))
        self._check_signs()

    def _check_signs(self) -> None:
        for name in ("v_f", "n_s", "a_p"):
            bad = np.flatnonzero(self.cutting & (getattr(self, name) < 0.0))
            if bad.size:
                raise CuttingError(f"{self.place(bad[0])}: {name} is negative; it must be 0 or more.", where=name)
        small = 1e-9
        wrong = (self.phi_st < -small) | (self.phi_ex > np.pi + small) | (self.phi_ex < self.phi_st - small)
        bad = np.flatnonzero(self.cutting & wrong)
        if bad.size:
            i = bad[0]
            raise CuttingError(
                f"{self.place(i)}: arc of engagement from {format_si(self.phi_st[i], 'deg')} to "
                f"{format_si(self.phi_ex[i], 'deg')}; expected 0° <= start <= end <= 180°.",
                where="phi_st",
            )

    def place(self, i: int) -> str:
        """Where step ``i`` is for people: its source line, or its number where no line is stated."""
        return f"Line {self.block[i]}" if self.block[i] > 0 else f"Step {i}"

    def __len__(self) -> int:
        return len(self.v_f)

    @property
    def engaged(self) -> BoolArray:
        """(m,) True where the cutter is in the material."""
        return self.cutting & (self.a_p > 0.0) & (self.phi_ex > self.phi_st)

    def f_z(self, flutes: int) -> FloatArray:
        """Feed per tooth (m,) m: v_f / (n_s flutes); 0 outside the material.

        Raises CuttingError where the tool is in the material with its spindle stopped or without a feed.
        """
        engaged = self.engaged
        for name, text in (("n_s", "the spindle stands still"), ("v_f", "the feed rate is 0")):
            bad = np.flatnonzero(engaged & (getattr(self, name) <= 0.0))
            if bad.size:
                word = "S" if name == "n_s" else "F"
                raise CuttingError(
                    f"{self.place(bad[0])}: {text} while the tool is in the material; give {word} before the cut.",
                    where=name,
                )
        result = np.zeros(len(self))
        return np.divide(self.v_f, self.n_s * flutes, out=result, where=engaged)

    @classmethod
    def steady(
        cls,
        v_f: ArrayLike,
        n_s: ArrayLike,
        a_p: ArrayLike,
        *,
        arc: tuple[float, float] = (0.0, np.pi),
        **others: ArrayLike,
    ) -> CutConditions:
        """The same arc everywhere, a full slot unless ``arc`` (phi_st, phi_ex) says otherwise; cutting, s = t = 0."""
        given: dict[str, Any] = {"cutting": True, "s": 0.0, "t": 0.0, **others}
        return cls(v_f=v_f, n_s=n_s, a_p=a_p, phi_st=arc[0], phi_ex=arc[1], **given)  # type: ignore[arg-type]


def cut_warnings(cutter: Cutter, conditions: CutConditions) -> tuple[str, ...]:
    """What deserves a word though it can be computed: depth beyond the flutes, plunging in the material."""
    found = []
    engaged = conditions.engaged
    if cutter.flute_length is not None:
        deep = np.flatnonzero(engaged & (conditions.a_p > cutter.flute_length * (1.0 + 1e-9)))
        if deep.size:
            worst = deep[np.argmax(conditions.a_p[deep])]
            depth = format_si(conditions.a_p[worst], "mm")
            found.append(
                f"{conditions.place(worst)}: depth {depth} is beyond the flute length "
                f"{format_si(cutter.flute_length, 'mm')}; the shank would rub ({deep.size} steps)."
            )
    plunging = np.flatnonzero(engaged & (conditions.across < 1e-6))
    if plunging.size:
        found.append(
            f"{conditions.place(plunging[0])}: the tool plunges into the material; the thrust of a plunge "
            f"is not modelled and taken as 0 ({plunging.size} steps)."
        )
    return tuple(found)
