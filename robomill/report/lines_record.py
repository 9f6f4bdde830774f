"""The lines of a program as a JSON-ready record: what each leaves, those that use most of their tolerance first."""

from typing import Any

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.report.records import shown
from robomill.simulation.result import SimulationResult

MOST = 12  # lines that are listed


def lines_record(result: SimulationResult, most: int = MOST) -> dict[str, Any]:
    """How many lines cut, and the worst of them: errors (signed) of walls, floors, ends, along the feed; the share of a
    tolerance that those with one use; the largest deviation of the tip; null where nothing of it is left or known."""
    path, verdict = result.path, result.verdict
    blocks, of = np.unique(path.block, return_inverse=True)

    def largest(sample: IntArray, value: FloatArray) -> FloatArray:
        """(blocks,) of each line the value of the largest size; NaN where it has none."""
        known = np.isfinite(value)
        sample, value = sample[known], value[known]
        order = np.argsort(np.abs(value), kind="stable")
        found = np.full(len(blocks), np.nan)
        found[of[sample[order]]] = value[order]  # of equal places the last stays
        return found

    def counted(which: Any) -> IntArray:
        return np.bincount(of[np.asarray(which)], minlength=len(blocks))

    gauge, judged, along = result.gauge, np.flatnonzero(result.judged), np.flatnonzero(result.judged_along)
    errors = {
        "wall": (largest(gauge.walls.sample, gauge.walls.error), verdict.wall),
        "floor": (largest(gauge.floors.sample, gauge.floors.error), verdict.floor),
        "end": (largest(gauge.ends.sample, gauge.ends.error), verdict.end),
        "feed": (largest(along, result.delta_in_cut[along, 0]), verdict.feed),
    }
    shares = np.array([np.abs(value) / each.tolerance for value, each in errors.values() if each.stated])
    share = np.fmax.reduce(shares, axis=0)
    tip = largest(judged, result.deviation[judged])
    force = largest(judged, result.force_size[judged])
    length = np.bincount(of, np.where(path.cutting, path.step_length, 0.0), minlength=len(blocks))
    lost, missed = counted(result.not_judged), counted(result.missed & path.cutting)
    tool = np.zeros(len(blocks), dtype=int)
    tool[of[path.cutting]] = path.tool[path.cutting]
    cuts = np.flatnonzero(length > 0.0)
    order = cuts[np.lexsort((-np.nan_to_num(tip[cuts], nan=-1.0), -np.nan_to_num(share[cuts], nan=-1.0)))]
    return {
        "counted_in": path.block_name,
        "cutting": len(cuts),
        "unknown": int(((lost + missed)[cuts] > 0).sum()),
        "worst": [
            {
                "line": int(blocks[b]),
                "tool": int(tool[b]),
                "length_mm": shown(length[b], "mm"),
                **{f"{name}_mm": shown(values[b], "mm") for name, (values, _) in errors.items()},
                "share": float(share[b]),
                "max_deviation_mm": shown(tip[b], "mm"),
                "force_N": shown(force[b], "N"),
                "not_judged": int(lost[b]),
                "not_reached": int(missed[b]),
            }
            for b in order[:most]
        ],
    }
