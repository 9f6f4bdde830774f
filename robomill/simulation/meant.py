"""Where the samples of a corrected program were meant to be: their places on the path that it was corrected for.

A corrected program goes beside that path, cut by cut and in its order, with short links at sharp corners. Each of its
samples belongs to the place that is nearest among those with its own direction, and no sample belongs before the one
ahead of it (dynamic time warping in a window that goes along). Where the program was corrected along its feed, too,
that is not enough: on its way from one corner to the next no text says how far along it a sample was meant to be, since
the same line is written whatever the correction does between its ends. There only what leads across the path is told.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray, stretches
from robomill.cutting.conditions import STEEP
from robomill.errors import ToolpathError
from robomill.progress import checkpoint
from robomill.provenance import Finding, named
from robomill.simulation.corners import FARTHEST, SAME, Ways, at_corners
from robomill.simulation.samples import ways
from robomill.simulation.setup import SimulationSetup
from robomill.toolpath.path import Toolpath
from robomill.toolpath.sampling import CORNER
from robomill.toolpath.source import GCodeSource
from robomill.units import format_count, format_si
from robomill.vectors import angle_between, nearest_on

WANTED = "wanted-path"  # the findings that say from which path a corrected program's deviation is told
LINK = 20e-6  # m: corrections at one place that differ by more are joined by a link
TURNED = 2e-3  # m: a place where the path goes the other way counts as so much further off, twice
LEFT_OUT = 2e-3  # m: what is left out of the path counts as its length times this
STILL = 1e-9  # m: less is none
DIRECTED = 0.5e-3  # m: shorter steps may be links, which go any way
ITS_WAY = 0.5  # cosine of the angle within which a sample goes the way of a step
PLUNGING = math.sqrt(1.0 - STEEP**2)  # cosine of the angle to the tool's axis within which a step is a plunge's
WINDOW = 96  # samples of the path among which one looks
SAID = 20_000  # samples between two words of progress


def corrected_notes(setup: SimulationSetup) -> tuple[Finding, ...]:
    """From which path the deviation of a corrected program is told."""
    source = setup.source
    if not isinstance(source, GCodeSource):
        return ()
    if source.wanted is not None:
        text = f"the deviation is told from the path of {source.wanted.name}, for which this program was corrected."
        return (Finding("info", text, code=WANTED),)
    if source.mark is None:
        return ()
    text = (
        f"this program was corrected for {source.mark.name}, and its deviation is told from its own lines, not from "
        f"the path that was meant: open {source.mark.name} before it, or give that with --wanted."
    )
    return (Finding("warning", text, code=WANTED),)


def jump_notes(path: Toolpath, ahead: FloatArray | None) -> tuple[Finding, ...]:
    """Where a corrected program, which sends the tool ``ahead`` (m, 3) m of the ``path`` that was meant, jumps: between
    two samples at one place."""
    if ahead is None:
        return ()
    jump = np.linalg.norm(np.diff(ahead, axis=0, prepend=ahead[:1]), axis=1)
    there = path.cutting & np.append(False, path.cutting[:-1]) & (path.step_length < SAME) & (jump > LINK)
    if not there.any():
        return ()
    where, far = named(path.block[there].tolist()), format_si(float(jump[there].max()), "mm")
    text = (
        f"at {format_count(int(there.sum()), 'corner')} ({path.block_name} {where}) the correction jumps, by up to "
        f"{far}, as the force does; a link as long leads across, and what the tool does on it is not predicted."
    )
    return (Finding("info", text, code="jumps"),)


def untold_notes(setup: SimulationSetup, judged: BoolArray, along: BoolArray) -> tuple[Finding, ...]:
    """How many of the ``judged`` (m,) samples of a program that was corrected along its feed are not judged ``along``
    it (m,), too."""
    lost, every = int((judged & ~along).sum()), int(judged.sum())
    if not lost:
        return ()
    text = (
        f"the program was corrected along its feed, too: how far along it the tip should be is known where cuts begin, "
        f"end and turn, not on the way between; at {lost} of {format_count(every, 'sample')} the deviation along the "
        "feed is not judged."
    )
    return (Finding("info" if setup.feed_tolerance is None else "warning", text, code="untold-feed"),)


def meant(path: Toolpath, wanted: Toolpath, step: float, corrected: tuple[str, ...] = ()) -> tuple[Toolpath, BoolArray]:
    """``path``, the samples of a corrected program, where they were meant to be on the samples of the ``wanted`` path,
    which are no further apart than ``step`` (m); and (m,) those of which nobody knows how far along it that is.
    ``corrected`` are the components in which it says that it was; () where it does not say. Raises ToolpathError where
    they belong to two paths."""
    p, untold = np.array(path.p), np.zeros(len(path), dtype=bool)
    cuts, told = _cuts(path), _cuts(wanted)
    if len(cuts) != len(told):
        raise ToolpathError(
            f"Wanted path: it has {format_count(len(told), 'cut')} between rapids, and the program "
            f"{format_count(len(cuts), 'cut')}: the program was not corrected for it; give the one that was meant."
        )
    directed = path.step_length >= min(DIRECTED, 0.5 * step)
    here, there = (np.where(each.cutting[:, None], ways(each), 0.0) for each in (path, wanted))  # a rapid's is no cut's
    for every, all_ in zip(cuts, told, strict=True):
        moves = path.step_length[every] > 0.0
        moves[0] = True
        some = every[moves]
        near = _aligned(path.p[some], here[some] * directed[some, None], wanted.p[all_], there[all_])
        q, k = path.p[some], path.k[some]
        s = _nearest(q, here[some], wanted.p[all_], near)
        s, meets = at_corners(q, k, path.block[some], s, Ways.of(wanted.p[all_], wanted.k[all_]))
        s[0], s[-1] = 0.0, np.linalg.norm(np.diff(wanted.p[all_], axis=0), axis=1).sum()  # a cut is meant whole
        p[some], worst, at = _places(q, wanted.p[all_], s)
        if not corrected or "feed" in corrected:
            untold[some] = _untold(q - p[some], here[some], k, meets, bool(corrected))
        _bottoms(p, path, wanted, some, all_)
        for i in every[~moves].tolist():  # what turns on the spot stays at its place
            p[i] = p[i - 1]
        if worst > FARTHEST:
            raise ToolpathError(
                f"Wanted path: at {path.block_name} {path.block[some[at]]} the program is {format_si(worst, 'mm')} off "
                f"it, and a corrected one at most {format_si(FARTHEST, 'mm', 0)}: give the path that it was corrected "
                "for."
            )
    return replace(path, p=p), untold


def _untold(off: FloatArray, way: FloatArray, k: FloatArray, meets: BoolArray, said: bool) -> BoolArray:
    """(n,) samples of a cut, ``off`` (n, 3) m their places, of which nobody knows how far along the path these are: all
    on the ``way`` (n, 3) from one place that ``meets`` (n,) the next cut to another where it is ``said`` that the feed
    was corrected; where nobody has said anything, if both ends are sent the same way along it. In a plunge all are
    known: its bottom is told."""
    at = np.flatnonzero(meets | np.isin(np.arange(len(off)), (0, len(off) - 1)))
    begin, end = at[:-1], at[1:]
    sent = np.einsum("eqi,eqi->eq", off[[begin, end]], way[[begin + 1, end]])
    moved = np.full(len(begin), said) | (np.abs(sent) > LINK).all(axis=0) & (sent[0] * sent[1] > 0.0)
    found = np.repeat(np.append(moved, False), np.diff(np.append(at, len(off))))
    found[at] = False
    return np.asarray(found & (np.abs(np.einsum("ni,ni->n", way, k)) < PLUNGING))


def _cuts(path: Toolpath) -> list[IntArray]:
    """The samples of each cut: where a rapid has brought the tool, and all up to the next rapid that goes anywhere."""
    rapid = ~path.cutting & (path.step_length > 0.0)
    cut = np.cumsum(rapid)
    of = [np.flatnonzero(cut == number) for number in np.unique(cut[path.cutting])]
    return [some for some in of if path.step_length[some[1:]].any()]


def _bottoms(p: FloatArray, path: Toolpath, wanted: Toolpath, some: IntArray, all_: IntArray) -> None:
    """Plunges in ``p`` (m, 3) m, of the samples ``some`` of a corrected path, so that their ends are where those of the
    wanted path's samples ``all_`` end: along its way a plunge is corrected by what the cut asks that goes on there."""
    here, there = _plunges(path, some), _plunges(wanted, all_)
    if not there:
        return
    ends = np.array([wanted.p[end] for _, end in there])
    for begin, end in here:
        n = int(np.argmin(np.linalg.norm(ends - p[end], axis=1)))
        first, last = there[n]
        top, bottom = wanted.p[first - 1], wanted.p[last]
        depth = float(np.linalg.norm(bottom - top))
        if np.linalg.norm(bottom - p[end]) > FARTHEST or depth == 0.0:
            continue
        between = wanted.p[first:last]
        line = (np.broadcast_to(each, between.shape) for each in (top, bottom))
        if nearest_on(between, *line)[1].max(initial=0.0) > LINK:
            continue  # the steep end of an arc or a helix: its samples stand where they belong along it
        back = np.linalg.norm(path.p[begin : end + 1] - path.p[end], axis=1)
        p[begin : end + 1] = bottom + np.minimum(back / depth, 1.0)[:, None] * (top - bottom)


def _plunges(path: Toolpath, some: IntArray) -> list[tuple[int, int]]:
    """The first and the last sample of each plunge among samples of a path."""
    some = some[(path.step_length[some] > 0.0) & (some > 0)]
    move = path.p[some] - path.p[some - 1]
    down = np.einsum("mi,mi->m", move, path.k[some]) < -PLUNGING * path.step_length[some]
    return [(int(some[begin]), int(some[past - 1])) for begin, past in stretches(down & path.cutting[some])]


def linked(path: Toolpath, wanted: Toolpath) -> BoolArray:
    """(m,) samples of a corrected path, meant to be at ``wanted``, on links between two cuts that meet at a place: all
    that stand there but for the first and the last, where the tool goes anywhere between these."""
    place = np.cumsum(wanted.step_length >= SAME)
    first = np.append(True, place[1:] != place[:-1])
    last = np.append(first[1:], True)
    inside = path.cutting & ~first & ~last & np.append(False, path.cutting[:-1])
    return np.asarray(inside & (np.bincount(place, np.where(first, 0.0, path.step_length))[place] > LINK))


def straight_on(path: Toolpath, wanted: Toolpath) -> BoolArray:
    """(m,) samples of a corrected path that begin a move which turns against the one before, though the ``wanted`` path
    goes straight on there: only two pieces of the correction meet."""
    i = np.flatnonzero(path.cutting & (path.step_length == 0.0))
    i = i[(i >= 2) & (i + 1 < len(path))]
    back, on = wanted.p[i - 1] - wanted.p[i - 2], wanted.p[i + 1] - wanted.p[i]
    found = np.zeros(len(path), dtype=bool)
    moving = (wanted.step_length[i - 1] >= SAME) & (wanted.step_length[i + 1] >= SAME) & path.cutting[i - 1]
    found[i[moving & (angle_between(back, on) < CORNER)]] = True
    return found


def _places(q: FloatArray, p: FloatArray, s_q: FloatArray) -> tuple[FloatArray, float, int]:
    """(n, 3) m: where on one cut of the wanted path, p (m, 3) m, the samples q (n, 3) m of one cut belong, about s_q
    (n,) m along it; how far (m) they are off it, or leave some of it out, and which sample is or does so most."""
    s = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(p, axis=0), axis=1)))
    s_q = np.maximum.accumulate(s_q)
    found = np.column_stack([np.interp(s_q, s, p[:, i]) for i in range(3)])
    left_out = np.diff(s_q, prepend=0.0, append=s[-1])
    left_out[1:-1] -= np.linalg.norm(np.diff(q, axis=0), axis=1)
    worst = np.maximum(np.linalg.norm(q - found, axis=1), left_out[:-1])
    worst[-1] = max(worst[-1], left_out[-1])
    at = int(np.argmax(worst))
    return found, float(worst[at]), at


def _aligned(q: FloatArray, t: FloatArray, p: FloatArray, u: FloatArray) -> IntArray:
    """(n,) samples of p (m, 3) m, in order, to which samples q (n, 3) m belong; t (n, 3) and u (m, 3) are their
    directions, 0 where one has none. The first belongs to the first, the last to the last, and what the samples leave
    out of p costs, so that where a path comes back to itself nothing is left out between."""
    n, m = len(q), len(p)
    s, gone = (np.append(0.0, np.cumsum(np.linalg.norm(np.diff(each, axis=0), axis=1))) for each in (p, q))
    steps = s - np.append(0.0, s)[np.searchsorted(s, s - STILL, "left")]
    width = min(m, WINDOW)
    every = np.arange(width)
    total = np.full(width, np.inf)
    total[0] = 0.0
    first = 0
    came, begun = np.zeros((n, width), dtype=np.int32), np.zeros(n, dtype=np.int64)
    for i in range(1, n):
        if i % SAID == 0:
            checkpoint(i / n, "Where the program was meant to go")
        window = slice(first, first + width)
        least, source = _stepped(total, s[window], np.maximum(gone[i] - gone[i - 1], steps[window]))
        moved = min(max(first + int(np.argmin(total)) - width // 2, first), m - width) - first
        first += moved
        shift = np.minimum(every + moved, width - 1)
        came[i], begun[i] = source[shift] + first - moved, first
        off = q[i] - p[first : first + width]
        along = np.einsum("wi,i->w", u[first : first + width], t[i])
        cost = np.einsum("wi,wi->w", off, off) + TURNED**2 * (float(t[i] @ t[i]) - along)
        total = least[shift] + cost
    at = np.empty(n, dtype=np.int64)
    at[-1] = first + (width - 1 if first + width == m else int(np.argmin(total)))
    for i in range(n - 1, 0, -1):
        at[i - 1] = came[i, at[i] - begun[i]]
    return at


def _stepped(total: FloatArray, s: FloatArray, far: FloatArray) -> tuple[FloatArray, IntArray]:
    """Least cost (w,) of coming to each of samples at s (w,) m from those before it, which cost ``total`` (w,), and
    from which: ``LEFT_OUT`` of what is further than ``far`` (w,) m."""
    every = np.arange(len(s))
    ahead = total - LEFT_OUT * s
    least = np.minimum.accumulate(ahead)
    source = np.maximum.accumulate(np.where(ahead <= least, every, 0))
    near = np.searchsorted(s, s - far - STILL, "left")  # the first from which nothing is left out
    best, of = total.copy(), every.copy()
    for back in range(1, int((every - near).max(initial=0)) + 1):
        begin = np.maximum(every - back, near)
        better = total[begin] < best
        best, of = np.where(better, total[begin], best), np.where(better, begin, of)
    beyond = np.maximum(near - 1, 0)
    cost = least[beyond] + LEFT_OUT * (s - far)
    skips = (near > 0) & (cost < best)
    return np.where(skips, cost, best), np.where(skips, source[beyond], of)


def _nearest(q: FloatArray, t: FloatArray, p: FloatArray, at: IntArray) -> FloatArray:
    """(n,) m along p (m, 3) m: the nearest place to each of q (n, 3) m at the samples ``at`` (n,), or on those of the
    two steps about them that go its way, t (n, 3): a link belongs to the corner that it leads around. Where there is
    none, it ends where the next sample goes on."""
    s = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(p, axis=0), axis=1)))
    found, least = s[at], np.linalg.norm(q - p[at], axis=1)
    about = [(a, np.minimum(a + 1, len(p) - 1)) for a in (np.maximum(at - 1, 0), at)]
    way = np.stack([p[b] - p[a] for a, b in about])
    size = np.linalg.norm(way, axis=2)
    way = np.divide(way, size[..., None], out=np.zeros_like(way), where=size[..., None] > 0.0)
    own, behind = (np.einsum("ni,eni->en", each, way) for each in (t, np.vstack([t[1:], t[-1:]])))
    link = ~(own > ITS_WAY).any(axis=0) & t.any(axis=1)
    on = np.einsum("ni,ni->n", *way) > np.cos(CORNER)  # where it turns, or its slope does, a link is that corner's
    goes = np.where(link, on & (behind > ITS_WAY), own > ITS_WAY)
    for (a, b), its in zip(about, goes, strict=True):
        share, off = nearest_on(q, p[a], p[b])
        better = its & (off < least)
        found = np.where(better, s[a] + share * (s[b] - s[a]), found)
        least = np.where(better, off, least)
    return np.asarray(found)
