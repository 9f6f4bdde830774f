"""What the paper sets where the program needs something to start from: its milling test and its box. SI.

Slavkovic, Milutinovic, Kokotovic, Glavonjic, Zivanovic, Ehmann, FME Transactions 41 (2013) 83-95; its words stand in
``report.paper``.
"""

from dataclasses import dataclass

Point = tuple[float, float, float]

BOX_SIZE = (1.2, 0.6, 0.5)  # m, Fig. 3
BOX: tuple[Point, Point] = ((-0.6, -1.6, -0.4), (0.6, -1.0, 0.1))  # m in {M}, corners; its place in Y_M is assumed


@dataclass(frozen=True)
class Slot:
    """The milling test of Sec. 5.2, SI: a slot as wide as its cutter, in the direction of +X_M."""

    diameter: float = 8e-3
    flutes: int = 3
    a_p: float = 2e-3
    n_s: float = 200.0  # 12 000 per minute
    v_f: float = 0.03
    point: Point = (0.0, -1.3, 0.0)
    force: float = 100.0  # static, feed-normal, about
    from_table_2: float = 0.23e-3  # deviation in Y_M, predicted
    from_map: float = 0.29e-3  # by the measured compliances
    measured: float = 0.30e-3  # on the part, about


SLOT = Slot()
