"""What holds at many configurations, as kernels fill it."""

from typing import NamedTuple

from robomill.compiled import Out1, Out3


class Laws(NamedTuple):
    """What holds at m configurations: J (m, 6, n); shares (m, n, 6), each joint's part of C_xx, C_yy, C_zz, C_xy,
    C_xz, C_yz; det_J (m,)."""

    J: Out3
    shares: Out3
    det_J: Out1
