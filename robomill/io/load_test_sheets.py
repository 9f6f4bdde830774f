"""Load tests written as CSV: templates to fill in, measuring sheets, samples. Read back by ``io.load_tests``."""

from __future__ import annotations

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import LoadTestError
from robomill.identification.load_test import LoadTests
from robomill.identification.plan import Plan
from robomill.units import format_si, from_si

AXES = "xyz"
WORLD = ("X", "Y", "Z", "A", "B")
_PROTOCOLS = ("joints", "world", "joint by joint", "compliances")


def load_test_template(protocol: str = "joints", n: int = 5) -> str:
    """An empty measuring sheet with one example row; protocols: joints, world, joint by joint, compliances."""
    world, zeros = "X_mm,Y_mm,Z_mm,A_deg,B_deg", ",".join(["0"] * n)
    loads = "Fx_N,Fy_N,Fz_N,dx_mm,dy_mm,dz_mm"
    example = "0,250,0,0.012,0.574,-0.256"
    sheets = {
        "joints": (f"{','.join(f'theta{i + 1}_deg' for i in range(n))},{loads}", f"{zeros},{example}"),
        "world": (f"{world},{loads}", f"0,-1300,0,0,0,{example}"),
        "joint by joint": ("joint,torque_Nm,angle_mrad", "1,300,0.214"),
        "compliances": (
            f"{world},load_N," + ",".join(f"C{r}{c}_um_N" for r in AXES for c in AXES),
            "0,-1300,0,0,0,250,1.8,0,0,0,2.3,-1.0,0,-1.0,1.9",
        ),
    }
    if protocol not in sheets:
        raise LoadTestError(f"Template {protocol!r}: expected one of {', '.join(_PROTOCOLS)}.")
    header, row = sheets[protocol]
    return (
        "# One row a loaded pose. Forces and displacements are differences to the preloaded reading, in {M}.\n"
        "# The row below is an example: replace it.\n"
        f"{header}\n{row}\n"
    )


def measuring_sheet(plan: Plan) -> str:
    """A plan as CSV to take to the robot: poses, forces, empty dx, dy, dz; what it promises stands in the remarks."""
    lines = [f"Next tests for {plan.goal}: {plan.sentence()}"]
    lines.append("Fill in dx_mm, dy_mm, dz_mm: differences between loaded and unloaded readings, in {M}.")
    for k, pose in enumerate(plan.x_M, 1):
        place = ", ".join(format_si(float(v), "mm", 0) for v in pose[:3])
        lines.append(
            f"Test {k}: X, Y, Z = {place}; A, B = {', '.join(format_si(float(v), 'deg', 1) for v in pose[3:])}"
        )
    return load_tests_to_csv(plan.as_tests(), "\n".join(lines), blank=True)


def load_tests_to_csv(tests: LoadTests, remarks: str = "", digits: int = 4, blank: bool = False) -> str:
    """Tests as CSV (deg or world mm, N, mm), ``digits`` decimals of a millimetre; ``blank`` leaves dx, dy, dz empty.

    Moments, rotations and point offsets are written where there are any.
    """
    columns: list[tuple[str, FloatArray, int]] = []
    if tests.theta is not None:
        columns += [(f"theta{i + 1}_deg", from_si(tests.theta[:, i], "deg"), 6) for i in range(tests.theta.shape[1])]
    else:
        assert tests.x_M is not None
        units = ("mm", "mm", "mm", "deg", "deg")
        columns += [
            (f"{name}_{unit}", from_si(tests.x_M[:, i], unit), 4)
            for i, (name, unit) in enumerate(zip(WORLD, units, strict=True))
        ]
    columns += _block("F", tests.wrench[:, :3], "N", 3)
    if tests.wrench[:, 3:].any():
        columns += _block("M", tests.wrench[:, 3:], "N m", 4)
    columns += _block("d", tests.displacement[:, :3], "mm", digits)
    if np.isfinite(tests.displacement[:, 3:]).any():
        columns += _block("r", tests.displacement[:, 3:], "mrad", digits)
    for name, points in (("FP", tests.force_point), ("MP", tests.measuring_point)):
        if points is not None and points.any():
            columns += _block(name, points, "mm", 3)
    lines = [f"# {line}" for line in remarks.splitlines()]
    lines.append(",".join(name for name, _, _ in columns))
    empty = {f"d{axis}_mm" for axis in AXES} if blank else set()
    lines += [
        ",".join("" if name in empty else _cell(values[k], places) for name, values, places in columns)
        for k in range(len(tests))
    ]
    return "\n".join(lines) + "\n"


def _block(name: str, values: FloatArray, unit: str, digits: int) -> list[tuple[str, FloatArray, int]]:
    suffix = unit.replace(" ", "")
    return [(f"{name}{axis}_{suffix}", from_si(values[:, i], unit), digits) for i, axis in enumerate(AXES)]


def _cell(value: float, places: int) -> str:
    if np.isnan(value):
        return ""
    text = f"{value:.{places}f}".rstrip("0").rstrip(".") if places else f"{value:.0f}"
    return "0" if text in ("-0", "") else text
