"""How sure a measured map is: what its own numbers say of their errors, at the points and between them.

An elastic arm's matrix is symmetric, so C_ij - C_ji is error of measurement and nothing else. A map is interpolated
linearly; how far a point lies off its neighbours' plane says how bent the map is. With curvature f'' and spacing h that
gap is h^2 f'' / 2, and a straight line between two points misses at most h^2 f'' / 8, a quarter of it.
"""

import numpy as np

from robomill.arrays import FloatArray

PART_BETWEEN = 0.25


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


def between_points(p: FloatArray, C: FloatArray, stderr: FloatArray) -> FloatArray:
    """(3, 3) m/N, rms over the map of what linear interpolation between points p (k, d) may miss of each entry.

    Points whose nearest neighbours do not surround them say nothing; zero where none is surrounded.
    """
    from scipy.spatial import cKDTree

    k, d = p.shape
    if d == 0 or k < 2 * d + 1:
        return np.zeros((3, 3))
    near = cKDTree(p).query(p, k=2 * d + 1)[1][:, 1:]
    plane = np.concatenate([np.ones((k, 2 * d, 1)), p[near] - p[:, None]], axis=2)  # offset and slopes at the point
    weight = np.linalg.pinv(plane)[:, 0]
    surrounded = (weight > 0.0).all(axis=1) & np.isclose(weight.sum(axis=1), 1.0)
    if not surrounded.any():
        return np.zeros((3, 3))
    weight, near, own = weight[surrounded], near[surrounded], np.nan_to_num(stderr)
    gap = C[surrounded] - np.einsum("kw,kwij->kij", weight, C[near])
    by_noise = own[surrounded] ** 2 + np.einsum("kw,kwij->kij", weight**2, own[near] ** 2)
    return PART_BETWEEN * np.sqrt(np.clip(np.mean(gap**2 - by_noise, axis=0), 0.0, None))
