"""``robomill design``: which joints to stiffen so that a set-up's cut keeps a tolerance, at the least cost."""

from typing import Any

import numpy as np

from robomill.cli import given, options
from robomill.cli.saying import say
from robomill.errors import RobomillError

EVERY = 100.0  # mm


def run_design(arguments: Any) -> int:
    """Solve; 1 where the tolerance cannot be met."""
    from robomill.improve.design import STIFFEST, design
    from robomill.report.design_record import design_lines, design_record

    if any(getattr(arguments, name) is not None for name in ("box", "force", "every")):
        return _box(arguments)
    most = STIFFEST if arguments.most is None else arguments.most
    found = design(
        given.setup(arguments.setup, arguments.allow_outside),
        tolerance_mm=arguments.tolerance_mm,
        measure=arguments.measure,
        bounds=(1.0, most),
    )
    record = design_record(found)
    return say(arguments, record, design_lines(record), 0 if found.feasible else 1)


def _box(arguments: Any) -> int:
    """Over a box of the workspace; 1 where the tolerance cannot be met there."""
    from robomill.improve.box_design import design_box
    from robomill.improve.design import STIFFEST
    from robomill.report.design_record import box_lines, box_record
    from robomill.units import to_si
    from robomill.workspace.grid import box_grid

    if not (arguments.box and arguments.force):
        raise RobomillError(
            "A box of the workspace takes --box X,Y,Z:X,Y,Z in mm and --force FX,FY,FZ in N; one of them is not given."
        )
    if arguments.measure not in ("verdict", "tip"):
        raise RobomillError(f"--measure {arguments.measure}: in a box there is no part; the tip's deviation is judged.")
    lower, upper = (to_si(np.array(corner), "mm") for corner in options.box(arguments.box, "--box"))
    for low, high, axis in zip(lower, upper, "xyz", strict=True):
        if low > high:
            raise RobomillError(f"--box: its {axis} ends before it begins; expected the lower corner first.")
    every = to_si(EVERY if arguments.every is None else arguments.every, "mm")
    found = design_box(
        given.setup(arguments.setup, arguments.allow_outside),
        box_grid(lower, upper, float(every)),
        options.numbers(arguments.force, "--force", 3, "FX,FY,FZ in N"),
        tolerance_mm=arguments.tolerance_mm,
        bounds=(1.0, STIFFEST if arguments.most is None else arguments.most),
    )
    record = box_record(found)
    return say(arguments, record, box_lines(record), 0 if found.feasible else 1)
