"""An arm as numbers: its table, frames, limits and compliances by joint, and what follows from them."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from robomill.arrays import BoolArray, FloatArray, frozen, made_array
from robomill.lazy import cached_property
from robomill.provenance import Provenance
from robomill.quantities import quantities, quantity
from robomill.robot.dh import Chain, Row, build_chain
from robomill.values import Tabled

UNIT_SLIP = 1e-2  # rad/(N m), m/N: no joint gives more: was it meant in 1e-7 of it?
LONGEST = 100.0  # m: no link is longer: was it meant in mm?
USER_SET = "user"
"""The compliance set of numbers that are of no named one."""
COMPLIANCE = "compliance"


@dataclass(frozen=True, eq=False, repr=False)
class Arm(Tabled):
    """The fields of a ``Robot``, as it explains and checks them."""

    name: str
    convention: Literal["standard", "modified"]
    alpha: FloatArray = quantity("α", "deg", shape=(None,), slip=math.tau)
    a: FloatArray = quantity("a", "mm", shape=(None,), slip=LONGEST)
    d: FloatArray = quantity("d", "mm", shape=(None,), slip=LONGEST)
    theta_offset: FloatArray = quantity("θ₀", "deg", shape=(None,), slip=2.0 * math.tau)
    limits_all: FloatArray = quantity("limit", "deg", shape=(None, 2), axes=("lower", "upper"), sliding="mm")
    C_theta_all: FloatArray = quantity(
        "compliance", "1e-7 rad/(N m)", shape=(None,), least=0.0, digits=2, sliding="1e-9 m/N", slip=UNIT_SLIP
    )
    title: str = ""
    sign: FloatArray = quantity("sign", shape=(None,), default=None)
    prismatic: BoolArray = made_array()
    T_base: FloatArray = made_array()
    T_tool: FloatArray = made_array()
    blocked: FloatArray = quantity("held at", "deg", shape=(None,), sliding="mm", default=None)
    compliance_sets: Mapping[str, FloatArray] = field(default_factory=dict)
    compliance_set: str = USER_SET
    provenance: Mapping[str, Provenance] = field(default_factory=dict)

    @property
    def rows(self) -> int:
        """Rows of the D-H table, blocked axes included."""
        return len(self.alpha)

    @cached_property
    def free(self) -> BoolArray:
        """(rows,) True where the axis may move."""
        return frozen(np.isnan(self.blocked), bool)

    @cached_property
    def n(self) -> int:
        """Number of free joints: the length of every theta."""
        return int(self.free.sum())

    @cached_property
    def limits(self) -> FloatArray:
        """(n, 2) limits of the free joints, rad (m where prismatic)."""
        return frozen(self.limits_all[self.free])

    @cached_property
    def C_theta(self) -> FloatArray:
        """(n,) compliances of the free joints, rad/(N m) (m/N where prismatic)."""
        return frozen(self.C_theta_all[self.free])

    @cached_property
    def joint_units(self) -> tuple[str, ...]:
        """The unit in which people give the coordinate of each free joint: deg, mm where it slides."""
        limit = quantities(Arm)["limits_all"]
        return tuple(limit.of_joint(bool(slides)).unit for slides in self.prismatic[self.free])

    @cached_property
    def compliance_units(self) -> tuple[str, ...]:
        """The unit in which people give the compliance of each free joint."""
        compliance = quantities(Arm)["C_theta_all"]
        return tuple(compliance.of_joint(bool(slides)).unit for slides in self.prismatic[self.free])

    @cached_property
    def joint_numbers(self) -> tuple[int, ...]:
        """The 1-based table row of each free joint, for labels."""
        return tuple(int(i) + 1 for i in np.flatnonzero(self.free))

    @cached_property
    def home(self) -> FloatArray:
        """(n,) reference configuration: zero, or the middle of the range where zero is outside the limits."""
        low, high = self.limits[:, 0], self.limits[:, 1]
        return frozen(np.where((low <= 0) & (high >= 0), 0.0, 0.5 * (low + high)))

    @cached_property
    def chain(self) -> Chain:
        """The arm as constants between its free joints."""
        columns = (self.alpha, self.a, self.d, self.theta_offset, self.sign, self.prismatic, self.blocked)
        return build_chain(self.convention, [Row(*row) for row in zip(*columns)], self.T_base, self.T_tool)

    @property
    def assumes_compliances(self) -> bool:
        """Whether nobody has given the compliances in force: those of a URDF, or of a table without any."""
        said = self.provenance.get(COMPLIANCE)
        return self.compliance_set == USER_SET and said is not None and said.kind == "assumed"
