"""Load tests as CSV: templates to fill in, measuring sheets, samples. Read back by ``io.measured.load_tests``."""

import numpy as np

from robomill.errors import LoadTestError
from robomill.identification.load_test import LoadTests
from robomill.identification.plan import Plan
from robomill.units import format_many, format_plain

AXES = "xyz"
READINGS = ("d", "reading")
WORLD = ("X_mm", "Y_mm", "Z_mm")
TEMPLATES = {
    "joints": "Poses as joint angles",
    "world": "Poses as X, Y, Z, A, B",
    "cable": "Cable and dial gauge, poses of the flange",
    "joint by joint": "One joint at a time",
    "compliances": "Measured compliances",
}
_DIFFERENCES = "# One row a loaded pose. Forces and displacements are differences to the preloaded reading, in {M}."
_CABLE = """# frame: flange
# angles: kuka
# One row a loaded pose: the flange in {M} (frame: flange or tool), A, B, C as on a KUKA (angles: kuka or robomill; W,
# P, R for FANUC; joint angles do as well). The cable pulls with load_N along the unit vector cable_x, _y, _z in {M};
# the pulley's place pulley_x_mm, _y, _z in {M} may stand for it. load_point and gauge_point are points of the tool in
# the flange; the dial gauge reads along the unit vector gauge_x, _y, _z in {M}."""


def load_test_template(protocol: str = "joints", n: int = 5) -> str:
    """An empty measuring sheet with one example row, for one of ``TEMPLATES``."""
    world, zeros = "X_mm,Y_mm,Z_mm,A_deg,B_deg", ",".join(["0"] * n)
    joints = ",".join(f"theta{i + 1}_deg" for i in range(n))
    loads = "Fx_N,Fy_N,Fz_N,dx_mm,dy_mm,dz_mm"
    example = "0,250,0,0.012,0.574,-0.256"
    points = ",".join(f"{name}_{a}{unit}" for name, unit in _POINTS for a in AXES)
    sheets = {
        "joints": (_DIFFERENCES, f"{joints},{loads}", f"{zeros},{example}"),
        "world": (_DIFFERENCES, f"{world},{loads}", f"0,-1300,0,0,0,{example}"),
        "cable": (
            _CABLE,
            f"{'X_mm,Y_mm,Z_mm,A_deg,B_deg,C_deg' if n >= 6 else joints},load_N,{points},reading_mm",
            f"{'1600,0,1300,0,90,0' if n >= 6 else zeros},400,0.8,0,0.6,60,100,420,-50,120,380,0,0,1,0.215",
        ),
        "joint by joint": (_DIFFERENCES, "joint,torque_Nm,angle_mrad", "1,300,0.214"),
        "compliances": (
            _DIFFERENCES,
            f"{world},load_N," + ",".join(f"C{r}{c}_um_N" for r in AXES for c in AXES),
            "0,-1300,0,0,0,250,1.8,0,0,0,2.3,-1.0,0,-1.0,1.9",
        ),
    }
    if protocol not in sheets:
        raise LoadTestError(f"Template {protocol!r}: expected one of {', '.join(TEMPLATES)}.")
    said, header, row = sheets[protocol]
    return f"{said}\n# The row below is an example: replace it.\n{header}\n{row}\n"


_POINTS = (("cable", ""), ("load_point", "_mm"), ("gauge_point", "_mm"), ("gauge", ""))


def measuring_sheet(plan: Plan, after: str = "") -> str:
    """A plan as CSV to take to the robot: poses, forces, empty dx, dy, dz; what it promises stands in the remarks."""
    lines = [f"Next tests for {plan.goal}{f', after {after}' if after else ''}: {plan.sentence()}"]
    lines.append("Fill in dx_mm, dy_mm, dz_mm: differences between loaded and unloaded readings, in {M}.")
    for k, pose in enumerate(plan.x_M, 1):
        place, tilt = format_many(pose[:3], "mm", 0), format_many(pose[3:], "deg", 1)
        lines.append(f"Test {k}: X, Y, Z = {place}; A, B = {tilt}")
    return load_tests_to_csv(plan.as_tests(), "\n".join(lines), blank=True)


def load_tests_to_csv(tests: LoadTests, remarks: str = "", digits: int = 4, blank: bool = False) -> str:
    """Tests as CSV (deg or world mm, N, mm), ``digits`` decimals of a millimetre; ``blank`` leaves dx, dy, dz empty.

    Moments, rotations, gauges, pulleys and point offsets are written where there are any; so is a provenance.
    """
    head = remarks.splitlines()
    if tests.provenance.kind != "measured" and not blank:
        head.insert(0, f"provenance: {tests.provenance.kind}")
    if tests.x_M is not None and tests.x_M.shape[1] == 6:
        head += ["frame: tool", "angles: robomill"]
    columns = tests.columns()
    empty = {name for name in columns if blank and name.startswith(READINGS)}
    lines = [f"# {line}" for line in head]
    lines.append(",".join(columns))
    lines += [
        ",".join(
            "" if name in empty or np.isnan(values[k]) else format_plain(values[k], _decimals(name, digits))
            for name, values in columns.items()
        )
        for k in range(len(tests))
    ]
    return "\n".join(lines) + "\n"


def _decimals(name: str, digits: int) -> int:
    """Of a column: ``digits`` of what was read, and enough of what was set."""
    if name.startswith((*READINGS, "r")):
        return digits
    if name.endswith("_deg") or name.startswith("gauge"):
        return 6
    return 4 if name in WORLD or name.endswith("_Nm") else 3
