"""The six components of a symmetric matrix, by their letters."""

import numpy as np

from robomill.compliance.components import COLUMN, COMPONENTS, CROSS, DIRECT, ROW, symmetric


def test_the_six_names_are_those_of_a_symmetric_matrix_and_make_it_up() -> None:
    pairs = {frozenset((a, b)) for a in "xyz" for b in "xyz"}
    assert len(COMPONENTS) == len(pairs)
    assert {frozenset(name) for name in COMPONENTS} == pairs
    assert set(DIRECT) == {"xx", "yy", "zz"}
    assert set(CROSS) == set(COMPONENTS) - set(DIRECT)
    A = np.random.default_rng(0).normal(size=(2, 3, 3))
    C = A + np.swapaxes(A, -1, -2)
    six = np.stack([C[:, "xyz".index(name[0]), "xyz".index(name[1])] for name in COMPONENTS], axis=-1)
    np.testing.assert_array_equal(symmetric(six), C)
    np.testing.assert_array_equal(C[:, ROW, COLUMN], six)
