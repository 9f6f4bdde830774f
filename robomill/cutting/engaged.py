"""The engaged part of the cutter as sums over its surface, and the mean force that follows from them.

At a point of the cutter's surface at angle phi (clockwise from the left of the feed), whose normal leans kappa from the
axis, with the unit feed v: the chip is h = c (v . n), c being the feed per tooth, and a piece of edge ds carries, for
every term of the law, a load h^e ds (``edge``). With w = (v . n)^e dphi ds the ``moments`` are summed over all that is
engaged, so that any coefficients of the same exponents can be applied afterwards. The chip is that of the full feed,
across and along the axis, so that chips add up to the volume removed. The flat end of a mill, ground hollow, takes part
where the feed goes down: all of it from its ``DISH`` on, on gentler slopes its ``heel``. Source: Engin and Altintas
2001; the feed along the axis as in Ozturk and Budak 2007 (5-axis ball-end milling).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import BoolArray, FloatArray, IntArray, frozen
from robomill.cutting.edge import MOMENTS, EdgeTerm, moments, push
from robomill.cutting.profile_kernels import heel, nose_pieces
from robomill.cutting.tool import DISH, PRESSED, Cutter
from robomill.errors import CuttingError
from robomill.lazy import cached_property

PANELS = 12  # of a half turn that an engaged part is summed over
ANGLES, PIECES = 720, 64  # of the turn and of a rounded nose, for a full slot
FACING = 1e-6  # share of the feed: a surface that faces it by less does not cut


@dataclass(frozen=True, eq=False)
class EngagedPart:
    """What is engaged at every step.

    exponents  (n_e,)       of the chip thickness, as the force law needs them
    moments    (m, n_e, 8)  m (rad m): the sums above; zero in air
    sectors    (m, s, 4)    m, float16, means over each of the ``sector_edges``: the height engaged along the axis
                            (gaps count as zero), where it begins and where it ends, and how much of the end face is; 0
                            in air
    known    (m,) bool      False where what stands before the step is not known (None: it is, everywhere)
    """

    exponents: tuple[float, ...]
    moments: FloatArray
    sectors: np.ndarray
    known: BoolArray | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "moments", frozen(self.moments))
        object.__setattr__(self, "sectors", frozen(self.sectors, np.float16))

    def __len__(self) -> int:
        return len(self.moments)

    @cached_property
    def touches(self) -> BoolArray:
        """(m,) bool: where anything is engaged."""
        return np.asarray((self.moments != 0.0).any(axis=(1, 2)))

    def of(self, exponent: float) -> FloatArray:
        """(m, 8) the sums for one exponent. Raises CuttingError for one that was not asked for."""
        for n, known in enumerate(self.exponents):
            if known == exponent:
                return np.asarray(self.moments[:, n])
        raise CuttingError(
            f"Engaged part: it was summed for the exponents {self.exponents}; the force law has {exponent:g}."
        )

    def force(
        self, terms: tuple[EdgeTerm, ...], cutter: Cutter, c: ArrayLike, index: IntArray | None = None
    ) -> FloatArray:
        """Mean force ON the tool over a revolution at the steps ``index`` (k,) (None: all), (k, 3) N: feed,
        feed-normal, axial; ``c`` (k,) m feed per tooth."""
        c, some = np.asarray(c, dtype=np.float64), slice(None) if index is None else index
        force = np.zeros((len(self) if index is None else len(index), 3))
        for term in terms:
            sums = self.of(term.exponent)[some].T * c**term.exponent
            for axis, each in enumerate(push(term, cutter, sums)):
                force[:, axis] += each
        return np.asarray(force * (cutter.flutes / (2.0 * np.pi)))


def sector_edges(count: int) -> FloatArray:
    """Angles (count + 1,) rad from the left of the feed, clockwise, that part so many sectors: one or two half turns,
    or the quarters of their panels, which are finer towards the sides of the tool."""
    halves = 2 if count in (2, 8 * PANELS) else 1
    if count <= 2:
        return np.asarray(np.pi * np.arange(count + 1), dtype=np.float64)
    panels = 0.5 - 0.5 * np.cos(np.pi * np.arange(PANELS + 1) / PANELS)
    within = (panels[:-1, None] + np.diff(panels)[:, None] * np.arange(4) / 4).ravel()
    one = np.append(within, 1.0)
    return np.asarray(np.pi * np.concatenate([[0.0], *(half + one[1:] for half in range(halves))]), dtype=np.float64)


def sinks(along: ArrayLike) -> FloatArray:
    """How steeply (...) a feed goes down for the end of a mill; ``along`` (...) is the part of the unit feed along the
    axis. 1 where all of it cuts, as from its ``DISH`` on, 0 where it clears, up to the slope at which it is
    ``PRESSED``; between them as the slope."""
    down = np.clip(-np.asarray(along, dtype=np.float64), 0.0, 0.5)
    slope = down / np.sqrt(1.0 - down**2)
    flat, whole = (s / np.sqrt(1.0 - s**2) for s in (PRESSED, DISH))
    return np.asarray(np.clip((slope - flat) / (whole - flat), 0.0, 1.0))


def end_of(cutter: Cutter, steep: ArrayLike, sine: ArrayLike) -> FloatArray:
    """How much of the radius of its end a cutter cuts with, m, at angles of this ``sine``, where it ``sinks`` as
    ``steep`` as this."""
    radius = cutter.flat_radius
    cuts = radius - np.minimum(heel(radius, np.asarray(steep), np.asarray(sine)), radius)
    return np.asarray(np.where(np.asarray(steep) > 0.0, cuts, 0.0))


def full_slot(
    cutter: Cutter,
    exponents: tuple[float, ...],
    a_p: FloatArray,
    along: FloatArray,
    steep: FloatArray | None = None,
) -> EngagedPart:
    """The part engaged in a full slot of depth ``a_p`` (m,) m, by quadrature; ``along`` (m,) is the part of the unit
    feed along the axis, negative on the way down, and ``steep`` (m,) how it ``sinks`` (None: so steeply)."""
    cuts = np.stack([a_p, along, sinks(along) if steep is None else steep], axis=1)
    kinds, inverse = np.unique(cuts, axis=0, return_inverse=True)
    moments = np.array([[_slot_moments(cutter, e, kind) for e in exponents] for kind in kinds])
    none = np.zeros((len(a_p), 0, 4))
    return EngagedPart(exponents, moments.reshape(len(kinds), len(exponents), MOMENTS)[inverse.ravel()], none)


def _slot_moments(cutter: Cutter, e: float, kind: FloatArray) -> FloatArray:
    a_p, along, steep = kind
    phi = (np.arange(ANGLES) + 0.5) * (2.0 * np.pi / ANGLES)
    sine, cosine = np.sin(phi)[:, None], np.cos(phi)[:, None]
    _, _, leans, lengths = nose_of(cutter, a_p)
    kappa = np.concatenate([[0.0], leans, [0.5 * np.pi]])
    rest = np.broadcast_to(np.append(lengths, max(a_p - cutter.nose_height, 0.0)), (ANGLES, len(kappa) - 1))
    ds = np.hstack([end_of(cutter, steep, sine), rest])
    facing = np.sqrt(max(1.0 - along * along, 0.0)) * sine * np.sin(kappa) - along * np.cos(kappa)
    w = np.where(facing > FACING, np.maximum(facing, FACING) ** e, 0.0) * ds * (2.0 * np.pi / ANGLES)
    return np.array([each.sum() for each in moments(w, w * np.sin(kappa), w * np.cos(kappa), sine, cosine)])


def nose_of(cutter: Cutter, top: ArrayLike) -> FloatArray:
    """The nose up to heights ``top`` (...) m, its own at most, in equal pieces (4, q, ...): where each begins and ends
    above the tip, its normal's angle from the axis and its length; none of a flat mill."""
    high = np.asarray(top, dtype=np.float64)
    pieces = np.empty((4, PIECES if cutter.nose_height > 0.0 else 0, high.size))
    nose_pieces(np.ascontiguousarray(high).ravel(), cutter.solid, pieces)
    return pieces.reshape(4, pieces.shape[1], *high.shape)
