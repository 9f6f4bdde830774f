"""Points of designs against what defines them, and distributions against their moments."""

import numpy as np
import pytest
from scipy import stats

from robomill.errors import StudyError
from robomill.study.design import Parameter, points


def test_a_grid_has_every_combination_the_last_parameter_first() -> None:
    found = points((Parameter("a", (1, 2)), Parameter("b", low=0.0, high=1.0, steps=3)), "grid", 0, 0)
    assert found == [[1, 0.0], [1, 0.5], [1, 1.0], [2, 0.0], [2, 0.5], [2, 1.0]]


def test_a_grid_by_equal_ratios_ends_at_its_bounds() -> None:
    (one,) = (Parameter("a", low=1.0, high=100.0, steps=3, log=True),)
    assert one.levels() == pytest.approx([1.0, 10.0, 100.0])


def test_a_latin_hypercube_has_one_point_in_every_part_of_each_range() -> None:
    two = (Parameter("a", low=0.0, high=20.0), Parameter("b", low=-1.0, high=1.0))
    found = np.array(points(two, "latin_hypercube", 20, 4))
    assert sorted(np.floor(found[:, 0]).astype(int)) == list(range(20))
    assert sorted(np.floor((found[:, 1] + 1.0) * 10).astype(int)) == list(range(20))


def test_sobol_points_fill_every_elementary_box() -> None:
    """16 points of a (0, 4, 2)-net: one in each of the 16 boxes of every shape with sides of powers of two."""
    u = np.array(points((Parameter("a", low=0.0, high=1.0), Parameter("b", low=0.0, high=1.0)), "sobol", 16, 1))
    for k in range(5):
        cells = np.floor(u * [2**k, 2 ** (4 - k)]).astype(int)
        assert len({tuple(cell) for cell in cells}) == 16


@pytest.mark.parametrize(
    ("name", "stated", "same"),
    [
        ("normal", (3.0, 0.5), stats.norm(3.0, 0.5)),
        ("uniform", (1.0, 3.0), stats.uniform(1.0, 2.0)),
        ("lognormal", (2.0, 1.5), stats.lognorm(np.log(1.5), scale=2.0)),
        ("triangular", (1.0, 2.0, 4.0), stats.triang(1 / 3, 1.0, 3.0)),
    ],
)
def test_distributions_are_those_of_their_names(name: str, stated: tuple, same: stats.rv_continuous) -> None:
    found = np.array(points((Parameter("a", distribution=name, stated=stated),), "sobol", 4096, 2))[:, 0]
    assert stats.kstest(found, same.cdf).statistic < 2e-3


def test_lists_are_drawn_evenly_and_seeds_tell_points_apart() -> None:
    one = (Parameter("a", ("x", "y", "z")), Parameter("b", low=0.0, high=1.0))
    found = points(one, "latin_hypercube", 30, 0)
    assert {name: sum(row[0] == name for row in found) for name in "xyz"} == {"x": 10, "y": 10, "z": 10}
    assert found == points(one, "latin_hypercube", 30, 0) != points(one, "latin_hypercube", 30, 1)


def test_a_grid_without_end_is_refused() -> None:
    with pytest.raises(StudyError, match="the grid has 1.000.000.000 points"):
        points(tuple(Parameter(str(i), low=0.0, high=1.0, steps=1000) for i in range(3)), "grid", 0, 0)
