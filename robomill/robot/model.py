"""The robot as a value: D-H table, frames, limits, joint compliances, and where each number comes from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from types import MappingProxyType
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from robomill.arguments import asked, asking, refuse_unknown
from robomill.arrays import (
    Arrays,
    FloatArray,
    Numbers,
    Rows,
    as_floats,
    frozen,
    no_number,
    of_kind,
)
from robomill.errors import RobotError
from robomill.frames import Columns
from robomill.kinds import kinds_told
from robomill.provenance import UNSTATED, stated_blocks
from robomill.quantities import Quantity, quantities
from robomill.robot import checks
from robomill.robot.arm import COMPLIANCE, USER_SET, Arm
from robomill.robot.plausible import checked
from robomill.robot.sources import changed_sources, of_set, stated_of_robot
from robomill.robot.table import COLUMN_UNITS, OTHERS, changed_fields, refuse_printed, robot_fields
from robomill.spelled import in_si
from robomill.units import format_count, from_si

Limits = Arrays | Sequence[float | Sequence[float] | Arrays | None]
# Of the last axis's frame, where the tip stands in it: what of T_tool is typed as numbers.
TOOL_TIP = Quantity("Tip", "mm", "array", shape=(3,), axes=tuple("xyz"), digits=2)


@asking
@dataclass(frozen=True, eq=False, repr=False)
class Robot(Arm):
    """A serial arm of 1 to 7 joints. Immutable; ``replace`` gives a changed, checked copy.

    The table has one row a joint (``rows``): alpha, theta_offset in rad, a, d in m, sign +-1, prismatic. A joint turns
    by theta_DH = sign * theta + theta_offset; a prismatic one slides by d_DH = sign * theta + d at the fixed angle
    theta_offset. ``blocked`` (rows,) is NaN, or the coordinate (rad or m) at which an axis is held: a held axis
    neither moves nor gives, and is no longer counted in ``n``. What is per *free* joint (``limits``, ``C_theta``, every
    theta and Jacobian) has n entries; ``limits_all`` and ``C_theta_all`` have all rows.

    T_base = T_M0 and T_tool = T_nT are (4, 4). C_theta_all is rad/(N m), m/N where prismatic.
    Raises RobotError with one sentence for anything that cannot be a robot.

    Examples
    --------
    >>> import robomill as rm
    >>> robot = rm.load_robot("slavkovic_5r")
    >>> robot.n, (robot.C_theta * 1e7).round(2).tolist()
    (5, [7.14, 10.12, 12.3, 17.32, 91.35])
    >>> robot.replace(C_theta=2 * robot.C_theta).compliance_set
    'user'
    """

    door: ClassVar[tuple[type[RobotError], str]] = (RobotError, "Robot")

    def __post_init__(self) -> None:
        put = lambda key, value: object.__setattr__(self, key, value)  # noqa: E731
        where = f"Robot {(self.title or self.name)!r}"
        for said in (self.name, self.title):
            of_kind(said, str, "Robot, name", "a short text", RobotError)
        if not self.name.strip() or not self.name.isprintable():
            found = "does not stand on a line" if self.name.strip() else "is empty"
            raise RobotError(f"Robot: the name {found}; give it a short name.")
        if self.convention not in ("standard", "modified"):
            raise RobotError(f"{where}: convention is {self.convention!r}; expected 'standard' or 'modified'.")
        declared = quantities(Robot)
        rows = len(checks.column(self.alpha, declared["alpha"], None, where))
        checks.joint_count(rows, where)
        put("sign", np.ones(rows) if self.sign is None else self.sign)
        for key in ("alpha", "a", "d", "theta_offset", "sign"):
            put(key, frozen(checks.column(getattr(self, key), declared[key], rows, where)))
        checks.signs(self.sign, where)
        put("prismatic", frozen(checks.flags(False if self.prismatic is None else self.prismatic, rows, where), bool))
        put("T_base", frozen(np.eye(4) if self.T_base is None else checks.frame(self.T_base, "the base frame", where)))
        put("T_tool", frozen(np.eye(4) if self.T_tool is None else checks.frame(self.T_tool, "the tool frame", where)))
        self._check_limits(rows, where)
        self._check_blocked(rows, where)
        self._check_compliance(rows, where)
        blocks = ["geometry", "limits", "base", "tool", *map(of_set, self.compliance_sets)]
        put(
            "provenance", MappingProxyType(dict.fromkeys(blocks, UNSTATED) | stated_blocks(self.provenance, RobotError))
        )

    def _check_limits(self, rows: int, where: str) -> None:
        value = as_floats(self.limits_all, f"{where}: limits", (), error=RobotError, finite=False)
        if value.shape != (rows, 2):
            raise RobotError(f"{where}: limits: expected [lower, upper] for {rows} joints, found shape {value.shape}.")
        declared = quantities(Robot)["limits_all"]
        for side, name in enumerate(declared.axes):
            checks.column(value[:, side], replace(declared, label=f"{name} {declared.label}"), rows, where)
        checks.limits(value, declared, self.prismatic, where)
        object.__setattr__(self, "limits_all", frozen(value))

    def _check_blocked(self, rows: int, where: str) -> None:
        value = np.full(rows, np.nan) if self.blocked is None else np.asarray(self.blocked, dtype=np.float64)
        if value.shape != (rows,) or np.isinf(value).any():
            raise RobotError(
                f"{where}: blocked: expected {rows} values, NaN for a free joint, found shape {value.shape}."
            )
        if not np.isnan(value).any():
            raise RobotError(f"{where}: every axis is blocked; leave at least one free.")
        object.__setattr__(self, "blocked", frozen(value))

    def _check_compliance(self, rows: int, where: str) -> None:
        declared = quantities(Robot)["C_theta_all"]
        C_theta = checks.column(self.C_theta_all, declared, rows, where, self.prismatic)
        object.__setattr__(self, "C_theta_all", frozen(C_theta))
        sets = {}
        for key, value in self.compliance_sets.items():
            named = replace(declared, label=f"{declared.label} set {key!r}")
            sets[key] = frozen(checks.column(value, named, rows, where, self.prismatic))
        object.__setattr__(self, "compliance_sets", MappingProxyType(sets))
        if self.compliance_set != USER_SET and self.compliance_set not in sets:
            known = ", ".join(sets) or "none"
            raise RobotError(f"{where}: compliance set {self.compliance_set!r} is not among its sets ({known}).")
        if not np.array_equal(C_theta, sets.get(self.compliance_set, C_theta)):
            raise RobotError(
                f"{where}: compliance set {self.compliance_set!r} has other numbers than are given; leave "
                "compliance_set out, or give these numbers in compliance_sets by a name of their own."
            )

    @classmethod
    @asked
    def from_dh(
        cls,
        *,
        a: ArrayLike | None = None,
        a_mm: ArrayLike | None = None,
        alpha: ArrayLike | None = None,
        alpha_deg: ArrayLike | None = None,
        d: ArrayLike | None = None,
        d_mm: ArrayLike | None = None,
        theta_offset: ArrayLike | None = None,
        theta_offset_deg: ArrayLike | None = None,
        limits: Limits | None = None,
        limits_deg: Limits | None = None,
        limits_mm: Limits | None = None,
        C_theta: ArrayLike | None = None,
        C_theta_1e_7_rad_per_Nm: ArrayLike | None = None,
        k_theta_Nm_per_rad: ArrayLike | None = None,
        k_theta_kNm_per_rad: ArrayLike | None = None,
        convention: Literal["standard", "modified"] = "standard",
        sign: ArrayLike | None = None,
        prismatic: ArrayLike | None = None,
        T_base: Rows | None = None,
        base_xyz: Numbers | None = None,
        base_xyz_mm: Numbers | None = None,
        T_tool: Rows | None = None,
        tool_xyz: Numbers | None = None,
        tool_xyz_mm: Numbers | None = None,
        name: str = "robot",
        title: str = "",
    ) -> Robot:
        """A robot from its Denavit-Hartenberg table, one entry a joint from the base to the tool.

        Parameters
        ----------
        a, alpha, d, theta_offset : array_like, (rows,) or one number for all
            Link length and twist, offset along the axis and angle at theta = 0; m and rad, or ``_mm`` and ``_deg``.
            What is left out is 0.
        limits : array_like, (rows, 2), or one pair for all
            [lower, upper] in rad (m where a joint slides); or ``limits_deg`` of the joints that turn and ``limits_mm``
            of those that slide, None for the others. A turning joint without is taken to turn by 180 degrees either
            way, which is marked as assumed; one that slides must have them.
        C_theta, C_theta_1e_7_rad_per_Nm, k_theta_Nm_per_rad, k_theta_kNm_per_rad : array_like, (rows,) or one for all
            Compliances in rad/(N m) (m/N where a joint slides), as papers print them, or stiffnesses in N m/rad or
            kN m/rad; one of the four. A rigid joint has compliance 0, stiffness inf. Without any, 1e-6 rad/(N m) is
            assumed, and nothing is judged with it.
        convention : "standard" or "modified"
            Which table it is: Denavit and Hartenberg's, or Craig's.
        sign, prismatic : array_like, (rows,)
            -1 for joints that count backwards; True for joints that slide.
        T_base, T_tool : array_like, (4, 4)
            The base in {M}, and {T} in the last frame of the table, its z_T out of the part towards the spindle.
        base_xyz, tool_xyz : array_like, (3,)
            Instead of a frame only where it stands, m (or ``_mm``); its axes are then those of {M}, or of the flange.
        name, title : str
            A short name, and one for people.

        Returns
        -------
        Robot
            With ``n`` free joints.

        Raises
        ------
        RobotError
            For a table that cannot be, and for numbers that were meant in another unit; joint and number are named.

        Examples
        --------
        >>> import robomill as rm
        >>> arm = rm.Robot.from_dh(a_mm=[500, 400], limits_deg=(-170, 170), k_theta_kNm_per_rad=[800, 500])
        >>> rm.tool_pose(arm, [0.0, 0.0])[:3, 3].round(6).tolist()
        [0.9, 0.0, 0.0]
        """
        given = {key: value for key, value in locals().items() if key != "cls"}
        return checked(cls(**robot_fields(given, quantities(cls))), given)

    # ---- for people ---------------------------------------------------------------------------------------------
    def columns(self) -> Columns:
        """The table, a row a joint; what depends on whether it turns or slides has its unit in a column beside it."""
        declared = quantities(Robot)
        limit, compliance = (
            [declared[name].of_joint(bool(slides)).unit for slides in self.prismatic]
            for name in ("limits_all", "C_theta_all")
        )
        per_row = zip(self.limits_all, self.C_theta_all, limit, compliance, strict=True)
        found = [(*from_si(ends, a), from_si(float(C), c)) for ends, C, a, c in per_row]
        lower, upper, C = np.array(found).T
        return {
            "joint": np.arange(1, self.rows + 1),
            "alpha_deg": from_si(self.alpha, "deg"),
            "a_mm": from_si(self.a, "mm"),
            "d_mm": from_si(self.d, "mm"),
            "theta_offset_deg": from_si(self.theta_offset, "deg"),
            "sign": self.sign,
            "free": self.free,
            "lower": lower,
            "upper": upper,
            "limit_unit": np.array(limit),
            "compliance": C,
            "compliance_unit": np.array(compliance),
        }

    def _said(self) -> str:
        held = f", {format_count(self.rows - self.n)} of them held" if self.n < self.rows else ""
        slide = f", {int(self.prismatic.sum())} sliding" if self.prismatic.any() else ""
        return f"{self.name}: {format_count(self.rows, 'joint')}{slide}{held}, {self.convention} D-H, " + (
            "compliances assumed" if self.assumes_compliances else f"compliance set {self.compliance_set!r}"
        )

    # ---- change is replacement ------------------------------------------------------------------------------------
    @asked
    def replace(self, **changes: Any) -> Robot:
        """A checked copy with fields changed, by their own names or by those of ``from_dh`` with a unit.

        Compliances (``C_theta``, ``k_theta_kNm_per_rad`` ...) and limits are accepted with n entries (free joints) or
        with all rows. New compliances that are not given with a ``compliance_set`` are the user's: the set in force
        becomes "user"; a ``compliance_set`` alone puts its numbers in force. ``tool_xyz_mm`` moves the tip and keeps
        the axes of the tool.

        Where changed numbers come from is that they were given in code, unless ``provenance`` says more of their block:
        geometry, lengths, limits, base, tool, compliance, or compliance. and the name of a set.
        """
        known = [f.name for f in fields(self)]
        columns, who = [f"{name}{unit}" for name, unit in COLUMN_UNITS.items()], f"Robot {self.name!r}"
        refuse_unknown(changes, [*known, "C_theta", "limits", *columns, *OTHERS], who)
        said, asked_for = stated_of_robot(changes.get("provenance", {})), changes
        with kinds_told(Robot.__init__, who, changes), kinds_told(Robot.from_dh, who, changes):
            changes = in_si(Robot, changed_fields(self, changes))
            for short, full in (("C_theta", "C_theta_all"), ("limits", "limits_all")):
                if short == "C_theta" and short in changes:
                    refuse_printed(quantities(Robot)[full], changes[short], self.name)
                if short in changes:
                    changes[full] = self._filled(changes.pop(short), getattr(self, full))
            if "C_theta_all" not in changes:
                sets = changes.get("compliance_sets", self.compliance_sets)
                name = changes.get("compliance_set", self.compliance_set)
                changes |= {"C_theta_all": sets[name]} if name in sets else {}
            elif "compliance_set" not in changes:
                changes["compliance_set"] = USER_SET
            other = Robot(**{**{key: getattr(self, key) for key in known}, **changes, "provenance": self.provenance})
        found = {**other.provenance, **changed_sources(self, other), **said}
        if other.compliance_set != USER_SET:
            found.pop(COMPLIANCE, None)  # of numbers that are in force no more
        object.__setattr__(other, "provenance", MappingProxyType(found))
        return checked(other, asked_for)

    def _filled(self, value: Any, current: FloatArray) -> Any:
        if no_number(value):
            return value  # which is refused with the rest
        if np.ndim(value) == 0:
            return np.where(self.free, value, current) if current.ndim == 1 else value  # one for all
        if np.shape(value) != (self.n, *current.shape[1:]):
            return value  # of all rows, or refused
        full = np.array(current)
        full[self.free] = value
        return full

    @asked
    def with_compliance_set(self, name: str) -> Robot:
        """The same arm with one of its compliance sets in force."""
        if name not in self.compliance_sets:
            known = ", ".join(self.compliance_sets) or "none"
            raise RobotError(f"Robot {self.name!r}: has no compliance set {name!r}; it has: {known}.")
        return self.replace(C_theta_all=self.compliance_sets[name], compliance_set=name)

    def __reduce__(self) -> Any:
        # MappingProxyType does not pickle; a plain rebuild does, and checks again.
        state = {f.name: getattr(self, f.name) for f in fields(self)}
        for key in ("compliance_sets", "provenance"):
            state[key] = dict(state[key])
        return _rebuild, (state,)


def check_robot(robot: Any) -> None:
    """Refuse what is no robot, as its name is none: raises RobotError."""
    give = 'rm.load_robot("slavkovic_5r"), of a name or a file, or rm.Robot.from_dh(...)'
    of_kind(robot, Robot, "robot", give, RobotError)


def _rebuild(state: dict[str, Any]) -> Robot:
    return Robot(**state)
