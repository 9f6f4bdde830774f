"""The engaged part of the cutter as sums over its surface, and the mean force that follows from them.

At a point of the cutter's surface at angle phi (clockwise from the left of the feed), whose normal leans kappa from the
axis, with the unit feed v: the chip is h = c (v . n), c being the feed per tooth, and a piece of edge ds carries, for
every term (e, Kt, Kr, Ka) of the law, Kt h^e ds against the tooth's motion, Kr h^e ds along -n and Ka h^e ds along the
surface, towards the part where the helix pulls (``edge``). With w = (v . n)^e dphi ds the sums are, over all that is
engaged,

    w cos(phi), w sin(phi);  w sin(kappa) sin(phi), w sin(kappa) cos(phi), w cos(kappa);
    w cos(kappa) sin(phi), w cos(kappa) cos(phi), w sin(kappa)

so that any coefficients of the same exponents can be applied afterwards. The chip is that of the full
feed, across and along the axis, so that chips add up to the volume removed; the flat end of a mill takes part where the
feed goes down by more than its ``DISH``. Source: Engin and Altintas 2001; the feed along the axis as in Ozturk and
Budak 2007 (5-axis ball-end milling).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import BoolArray, FloatArray, IntArray, frozen
from robomill.cutting.edge import EdgeTerm
from robomill.cutting.tool import DISH, Cutter
from robomill.errors import CuttingError

MOMENTS = 8
ANGLES, PIECES = 720, 64  # of the turn and of a rounded nose, for a full slot
FACING = 1e-6  # share of the feed: a surface that faces it by less does not cut


@dataclass(frozen=True, eq=False)
class EngagedPart:
    """What is engaged at every step.

    exponents  (n_e,)       of the chip thickness, as the force law needs them
    moments    (m, n_e, 8)  m (rad m): the sums above; zero in air
    spans      (m, s, 2)    m, float32: where the part begins and ends along the axis, in s equal sectors of the half
                            turn from the left of the feed to its right; inf, -inf where a sector is in air
    """

    exponents: tuple[float, ...]
    moments: FloatArray
    spans: np.ndarray

    def __post_init__(self) -> None:
        object.__setattr__(self, "moments", frozen(self.moments))
        object.__setattr__(self, "spans", frozen(self.spans, np.float32))

    def at(self, index: IntArray) -> EngagedPart:
        """The part at some of the steps (k,)."""
        return EngagedPart(self.exponents, self.moments[index], self.spans[index])

    def __len__(self) -> int:
        return len(self.moments)

    @property
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

    def force(self, terms: tuple[EdgeTerm, ...], cutter: Cutter, c: ArrayLike) -> FloatArray:
        """Mean force ON the tool over a revolution, (m, 3) N: feed, feed-normal, axial; ``c`` (m,) m feed per tooth."""
        c = np.asarray(c, dtype=np.float64)
        turning = 1.0 if cutter.hand == "right" else -1.0
        force = np.zeros((len(self), 3))
        for term in terms:
            load = (c**term.exponent)[:, None]
            M = self.of(term.exponent) * load
            Kt, Kr, Ka = turning * term.Kt, term.Kr, cutter.pull * term.Ka
            force[:, 0] -= Kt * M[:, 0] + Kr * M[:, 2] + Ka * M[:, 5]
            force[:, 1] += Kt * M[:, 1] - Kr * M[:, 3] - Ka * M[:, 6]
            force[:, 2] += Kr * M[:, 4] - Ka * M[:, 7]
        return np.asarray(force * (cutter.flutes / (2.0 * np.pi)))


def full_slot(cutter: Cutter, exponents: tuple[float, ...], a_p: FloatArray, along: FloatArray) -> EngagedPart:
    """The part engaged in a full slot of depth ``a_p`` (m,) m, by quadrature; ``along`` (m,) is the part of the unit
    feed along the axis, negative on the way down."""
    pairs, inverse = np.unique(np.stack([a_p, along], axis=1), axis=0, return_inverse=True)
    moments = np.array([[_slot_moments(cutter, e, *pair) for e in exponents] for pair in pairs])
    spans = np.stack([0.0 * a_p, a_p], axis=-1)[:, None, :]
    return EngagedPart(exponents, moments.reshape(len(pairs), len(exponents), MOMENTS)[inverse.ravel()], spans)


def _slot_moments(cutter: Cutter, e: float, a_p: float, along: float) -> FloatArray:
    phi = (np.arange(ANGLES) + 0.5) * (2.0 * np.pi / ANGLES)
    sine, cosine = np.sin(phi)[:, None], np.cos(phi)[:, None]
    kappa, ds = _profile(cutter, a_p, along)
    facing = np.sqrt(max(1.0 - along * along, 0.0)) * sine * np.sin(kappa) - along * np.cos(kappa)
    w = np.where(facing > FACING, np.maximum(facing, FACING) ** e, 0.0) * ds * (2.0 * np.pi / ANGLES)
    up, lying = w * np.sin(kappa), w * np.cos(kappa)
    sums = (w * cosine, w * sine, up * sine, up * cosine, lying, lying * sine, lying * cosine, up)
    return np.array([each.sum() for each in sums])


def _profile(cutter: Cutter, a_p: float, along: float) -> tuple[FloatArray, FloatArray]:
    """Angles kappa (q,) of the profile up to a depth, and the lengths (q,) m that they stand for."""
    nose = min(a_p, cutter.nose_height)
    kappa, ds = [np.zeros(0)], [np.zeros(0)]
    if along < -DISH:
        kappa.append(np.zeros(1))
        ds.append(np.array([cutter.flat_radius]))
    if nose > 0.0 and cutter.conical:
        kappa.append(np.array([0.5 * np.pi - cutter.half_angle]))
        ds.append(np.hypot([nose], cutter.radius_at(nose) - cutter.flat_radius))
    elif nose > 0.0:
        end = np.arccos(1.0 - nose / cutter.corner_radius)
        kappa.append((np.arange(PIECES) + 0.5) * (end / PIECES))
        ds.append(np.full(PIECES, cutter.corner_radius * end / PIECES))
    kappa.append(np.array([0.5 * np.pi]))
    ds.append(np.array([a_p - nose]))
    return np.concatenate(kappa), np.concatenate(ds)
