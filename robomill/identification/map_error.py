"""How sure a measured map is: what its own numbers say of their errors, at the points and between them.

An elastic arm's matrix is symmetric, so C_ij - C_ji is error of measurement and nothing else. A map is interpolated
linearly; how far a point lies off its neighbours' plane says how bent the map is. With curvature f'' and spacing h that
gap is h^2 f'' / 2, and a straight line between two points misses at most h^2 f'' / 8, a quarter of it. In the middle of
a cell of a grid that is so along every axis at once: bilinear interpolation misses the sum.
"""

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray

PART_BETWEEN = 0.25
BEYOND_CHANCE = 6.63  # of minus twice the logarithm of a likelihood: less than once in a hundred without a share
ROUNDS = 12
LEAST = 1e-6  # of the mean square: no smaller one is expected anywhere
GRID = 1e-6  # m: coordinates closer than this are one grid line


def noise_by_asymmetry(C: FloatArray) -> float:
    """m/N, standard error of one entry of C (k, 3, 3) where all are alike; NaN where no matrix is asymmetric."""
    apart = (C - np.swapaxes(C, -1, -2))[..., *np.triu_indices(3, 1)]
    rms = float(np.sqrt(np.mean(apart**2) / 2.0))
    return rms if rms > 0.0 else float("nan")


def noise_of_tests(C: FloatArray, spread: FloatArray, stated: FloatArray) -> float:
    """m, standard deviation of one reading behind a map: what the asymmetry shows, or what was stated if that is more.

    C (k, 3, 3); spread (k, 3) 1/N, standard error of an entry by its force, per unit of noise; stated (m,) m, NaN where
    not. NaN when nothing shows it.
    """
    i, j = np.triu_indices(3, 1)
    apart = (C[:, i, j] - C[:, j, i]) / np.hypot(spread[:, i], spread[:, j])
    known = stated[np.isfinite(stated)]
    noise = max(float(np.sqrt(np.mean(apart**2))), float(np.median(known)) if len(known) else 0.0)
    return noise if noise > 0.0 else float("nan")


def errors_of_tests(C: FloatArray, spread: FloatArray, by_size: FloatArray, stated: FloatArray) -> FloatArray:
    """(k, 3, 3) m/N, standard error of each entry of a map: by noise that is alike in every reading
    (``noise_of_tests``), and by loads or gauges that err by a share of what they read, where the asymmetry shows these
    beyond chance. A weight that is 2 % off makes every entry of its column 2 % wrong, the large ones most.

    spread (k, 3) 1/N and by_size (k, 3, 3) m/N: standard error of an entry per unit of noise, and per unit of share.
    """
    noise, share = noise_of_tests(C, spread, stated), 0.0
    i, j = np.triu_indices(3, 1)
    apart2 = (C[:, i, j] - C[:, j, i]).ravel() ** 2
    largest = float(spread.max())
    alike = (np.hypot(spread[:, i], spread[:, j]) / largest).ravel() ** 2
    shared = (by_size[:, i, j] ** 2 + by_size[:, j, i] ** 2).ravel()
    if apart2.any():
        columns = np.stack([alike, shared], axis=1)
        parts, both = _two_noises(apart2, columns)
        alone = alike * float(np.mean(apart2 / alike))
        if _unlikely(apart2, alone) - _unlikely(apart2, both) > BEYOND_CHANCE:
            known = stated[np.isfinite(stated)]
            noise = max(float(np.sqrt(parts[0])) / largest, float(np.median(known)) if len(known) else 0.0)
            share = float(np.sqrt(parts[1]))
    return np.asarray(np.sqrt((noise * spread[:, None, :]) ** 2 + (share * by_size) ** 2))


def _two_noises(apart2: FloatArray, columns: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The parts (2,) of the columns (e, 2) in the squares (e,), and the squares that these make expected."""
    from scipy.optimize import nnls

    typical = np.maximum(columns.mean(axis=0), np.finfo(np.float64).tiny)
    expected, parts = np.full(len(apart2), float(np.mean(apart2))), np.zeros(2)
    for _ in range(ROUNDS):
        parts = nnls(columns / typical / expected[:, None], apart2 / expected)[0]
        expected = np.maximum((columns / typical) @ parts, LEAST * float(np.mean(apart2)))
    return np.asarray(parts / typical), expected


def _unlikely(apart2: FloatArray, expected: FloatArray) -> float:
    """Minus twice the logarithm of how likely normal numbers of these squares are, but for a constant."""
    return float(np.sum(np.log(expected) + apart2 / expected))


def between_points(p: FloatArray, C: FloatArray, stderr: FloatArray) -> FloatArray:
    """(3, 3) m/N, rms over the map of what linear interpolation between points p (k, d) may miss of each entry.

    On a grid every point between two others of its line shows the bend along that axis, and in the middle of a cell
    what is missed along each axis adds up. Elsewhere points count whose nearest neighbours surround them. Zero where
    no point shows a bend.
    """
    own = np.nan_to_num(stderr) ** 2
    if p.shape[1] == 0:
        return np.zeros((3, 3))
    if (axes := _grid(p)) is not None:
        order = np.lexsort(np.round(p / GRID).T[::-1])
        shape = (*(len(axis) for axis in axes), 3, 3)
        return _along_lines(axes, C[order].reshape(shape), own[order].reshape(shape))
    return _about_points(p, C, own)


def shows_bend(p: FloatArray) -> bool:
    """Whether points p (k, d) m show how bent a map is along all axes on which they vary: three on each line of a grid,
    elsewhere one that others surround."""
    axes = _grid(p)
    return all(len(axis) > 2 for axis in axes) if axes is not None else _surrounded(p) is not None


def _grid(p: FloatArray) -> list[FloatArray] | None:
    """The lines (d) of the grid that points p (k, d) m fill; None where they lie anyhow."""
    axes = [np.unique(np.round(x / GRID)) * GRID for x in p.T]
    return axes if np.prod([len(axis) for axis in axes]) == len(p) else None


def _along_lines(axes: list[FloatArray], C: FloatArray, own: FloatArray) -> FloatArray:
    """The same on a grid with C and the variances of its entries (..., 3, 3)."""
    missed = np.zeros((3, 3))
    for i, x in enumerate(axes):
        if len(x) < 3:
            continue
        before, after = np.diff(x)[:-1], np.diff(x)[1:]
        before, after = (h.reshape(-1, *(1,) * (C.ndim - 1)) for h in (before, after))
        w = after / (before + after)
        wider = np.maximum(before, after) / np.minimum(before, after)  # of two unequal gaps the wider one misses more
        at, noise = np.moveaxis(C, i, 0), np.moveaxis(own, i, 0)
        gap = at[1:-1] - w * at[:-2] - (1.0 - w) * at[2:]
        by_noise = noise[1:-1] + w**2 * noise[:-2] + (1.0 - w) ** 2 * noise[2:]
        bend2 = np.mean((wider**2 * (gap**2 - by_noise)).reshape(-1, 3, 3), axis=0)
        missed += PART_BETWEEN * np.sqrt(np.clip(bend2, 0.0, None))
    return missed


def _about_points(p: FloatArray, C: FloatArray, own: FloatArray) -> FloatArray:
    """The same of points that lie anyhow: their plane averages the bends along d axes, which add up between them."""
    found, d = _surrounded(p), p.shape[1]
    if found is None:
        return np.zeros((3, 3))
    surrounded, weight, near = found
    gap = C[surrounded] - np.einsum("kw,kwij->kij", weight, C[near])
    by_noise = own[surrounded] + np.einsum("kw,kwij->kij", weight**2, own[near])
    return d * PART_BETWEEN * np.sqrt(np.clip(np.mean(gap**2 - by_noise, axis=0), 0.0, None))


def _surrounded(p: FloatArray) -> tuple[BoolArray, FloatArray, IntArray] | None:
    """Which points p (k, d) m their nearest neighbours surround, and of those (q, 2 d) the weights by which these make
    the plane there, and their numbers; None where there is no such point."""
    from scipy.spatial import cKDTree

    k, d = p.shape
    if k < 2 * d + 1:
        return None
    near = np.asarray(cKDTree(p).query(p, k=2 * d + 1)[1][:, 1:], dtype=np.int64)
    plane = np.concatenate([np.ones((k, 2 * d, 1)), p[near] - p[:, None]], axis=2)  # offset and slopes at the point
    weight = np.linalg.pinv(plane)[:, 0]
    around = np.asarray((weight > 0.0).all(axis=1) & np.isclose(weight.sum(axis=1), 1.0))
    return (around, weight[around], near[around]) if around.any() else None
