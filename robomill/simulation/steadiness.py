"""What a run says of the joints that follow its path: haste and singular configurations, each with its line."""

from robomill.kinematics.inverse import IKResult
from robomill.kinematics.steadiness import hasty_turns, passages
from robomill.provenance import Finding
from robomill.toolpath.path import Toolpath

HASTE, SINGULAR = "joint-in-haste", "singular-configuration"


def steadiness(path: Toolpath, ik: IKResult) -> tuple[Finding, ...]:
    """Findings on the configurations ``ik`` (m,) of the sampled path: a line is named once for each joint.

    ``joint-in-haste``: a joint turns much more than the tool's own motion asks for. ``singular-configuration``: det(J)
    changes its sign, so that there is a direction in which the arm can neither be moved nor hold by its joints alone.
    """
    found: dict[tuple[str, int, int], Finding] = {}
    for haste in hasty_turns(ik):
        v_f = float(path.v_f[haste.worst]) if path.cutting[haste.worst] else 0.0
        _add(found, HASTE, int(path.block[haste.worst]), haste.joint, haste.sentence(v_f))
    for passage in passages(ik):
        _add(found, SINGULAR, int(path.block[passage.at]), 0, passage.sentence())
    return tuple(sorted(found.values(), key=lambda finding: finding.line))


def _add(found: dict[tuple[str, int, int], Finding], code: str, line: int, joint: int, words: str) -> None:
    """A finding, or one more of those found: the first one's words stay."""
    known = found.get((code, line, joint))
    count = 1 if known is None else known.count + 1
    found[code, line, joint] = Finding(
        "warning", words if known is None else known.message, line, count=count, code=code
    )
