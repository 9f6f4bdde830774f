"""Forces along the cutting edges, summed over teeth, arc and depth: one law for every milling force model.

A slice of one tooth with chip thickness h and chip width db carries, for every term (e, Kt, Kr, Ka) of the law,

    dF_t = Kt h^e db  against the tooth's motion      dF_r = Kr h^e db  into the tool, normal to its surface
    dF_a = Ka h^e db  along the surface, towards the part where the helix pulls

with h = c sin(phi) sin(kappa) and db = dz / sin(kappa): c is the feed per tooth, phi the angle of the tooth
(clockwise from the left of the feed) and kappa the angle between the tool axis and the normal of the cutter's
surface (90 deg on a cylinder). Mechanistic models have the terms e = 1 (chip) and e = 0 (edge), Kienzle's has
e = 1 - mc. Source: Altintas, Manufacturing Automation, ch. 2; Engin and Altintas 2001 for general cutters.

``moments`` and ``push`` are the one statement of which way these act: whatever sums edges up (an arc that is the same
over the depth here, the part of the cutter as it is in ``engaged``, a kernel, a turn of the teeth in ``course``) ends
in them. Axes of all results: feed, feed-normal (left), axial (z_T).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray
from robomill.compiled import part
from robomill.cutting.profile_kernels import depth_moment
from robomill.cutting.sines import sine_integral
from robomill.cutting.tool import Cutter

MOMENTS = 8


@dataclass(frozen=True)
class EdgeTerm:
    """K h^exponent per width of chip (SI: N/m^(1+exponent)); tangential, radial and axial."""

    exponent: float
    Kt: float
    Kr: float
    Ka: float


@part
def moments(load: Any, upright: Any, lying: Any, sine: Any, cosine: Any, plain: Any = 1.0) -> tuple[Any, ...]:
    """The sums that a force follows from, of edges at an angle whose ``sine`` and ``cosine`` these are: ``load`` is the
    sum of h^e ds over them, ``upright`` and ``lying`` that times sin(kappa) and times cos(kappa).

    Over an arc, the integrals of (sin, cos, 1) sin^e(phi) stand for ``sine``, ``cosine`` and ``plain``.
    """
    return (
        load * cosine,
        load * sine,
        upright * sine,
        upright * cosine,
        lying * plain,
        lying * sine,
        lying * cosine,
        upright * plain,
    )


def push(term: EdgeTerm, cutter: Cutter, sums: Sequence[Any] | FloatArray) -> tuple[Any, Any, Any]:
    """What edges with these ``moments`` push the tool with, by one term of the law: feed, feed-normal, axial."""
    Kt, Kr, Ka = (term.Kt if cutter.hand == "right" else -term.Kt), term.Kr, cutter.pull * term.Ka
    return (
        -(Kt * sums[0] + Kr * sums[2] + Ka * sums[5]),
        Kt * sums[1] - Kr * sums[3] - Ka * sums[6],
        Kr * sums[4] - Ka * sums[7],
    )


def arc_moments(e: float, phi_st: FloatArray, phi_ex: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Integrals over the arc of sin^e(phi) times 1, sin(phi), cos(phi); each (...,)."""
    plain = sine_integral(e, phi_ex) - sine_integral(e, phi_st)
    sine = sine_integral(e + 1.0, phi_ex) - sine_integral(e + 1.0, phi_st)
    # sin(pi) must be 0 and not 1e-16, whose powers are not small.
    start, end = (np.sin(np.minimum(phi, np.pi - phi)) for phi in (phi_st, phi_ex))
    cosine = (np.maximum(end, 0.0) ** (e + 1.0) - np.maximum(start, 0.0) ** (e + 1.0)) / (e + 1.0)
    return plain, sine, cosine


def mean_force(
    terms: tuple[EdgeTerm, ...],
    cutter: Cutter,
    c: ArrayLike,
    a_p: ArrayLike,
    phi_st: ArrayLike,
    phi_ex: ArrayLike,
) -> FloatArray:
    """Mean force ON the tool over a revolution, (..., 3) N: feed, feed-normal, axial.

    ``c`` feed per tooth m, ``a_p`` depth m, arc ``phi_st``..``phi_ex`` rad (as in CutConditions). With a flat
    mill in a slot: F_x = -N a (Krc c/4 + Kre/pi), F_y = N a (Ktc c/4 + Kte/pi), |F_z| = N a (Kac c/pi + Kae/2).
    """
    c, a_p, st, ex = np.broadcast_arrays(*(np.asarray(v, dtype=np.float64) for v in (c, a_p, phi_st, phi_ex)))
    force = np.zeros((*c.shape, 3))
    for term in terms:
        e = term.exponent
        plain, sine, cosine = arc_moments(e, st, ex)
        load, upright, lying = (depth_moment(cutter.solid, a_p, *pq) for pq in ((e - 1.0, 0), (e, 0), (e - 1.0, 1)))
        sums = moments(load, upright, lying, sine, cosine, plain)
        force += np.stack(push(term, cutter, sums), axis=-1) * (c**e)[..., None]
    return np.asarray(force * (cutter.flutes / (2.0 * np.pi)))
