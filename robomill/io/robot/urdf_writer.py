"""A robot as a URDF file: joint axes, limits and frames; a URDF has no place for compliances."""

from xml.sax.saxutils import quoteattr

import numpy as np

from robomill.arrays import FloatArray
from robomill.kinematics.transforms import turns_from_rotation
from robomill.robot.dh import screw_z
from robomill.robot.model import Robot


def robot_to_urdf(robot: Robot) -> str:
    """The free joints of the robot as a URDF file that ``read_urdf`` reads back to the same poses and limits.

    Links base_link ({M}), link_1 to link_n and tool0 ({T}); zeros and senses of the joints stay. Held axes become parts
    of the links; compliances are not in it, since a URDF holds none.
    """
    chain = robot.chain
    links = ["base_link", *(f"link_{i + 1}" for i in range(chain.n)), "tool0"]
    lines = ['<?xml version="1.0"?>', f"<robot name={quoteattr(robot.name)}>"]
    lines += [f"  <link name={quoteattr(link)}/>" for link in links]
    for i in range(chain.n):
        slides, offset = bool(chain.prismatic[i]), float(chain.offset[i])
        zero = screw_z(0.0, offset) if slides else screw_z(offset, 0.0)
        low, high = (repr(float(value)) for value in robot.limits[i])
        lines += _joint(
            (f"joint_{robot.joint_numbers[i]}", "prismatic" if slides else "revolute"),
            (links[i], links[i + 1]),
            (chain.T_0 if i == 0 else chain.E[i - 1]) @ zero,
            f'<axis xyz="0 0 {int(chain.sign[i])}"/>',
            f'<limit lower="{low}" upper="{high}" effort="0" velocity="0"/>',
        )
    lines += _joint(("tool", "fixed"), (links[-2], links[-1]), chain.E[-1])
    return "\n".join([*lines, "</robot>"]) + "\n"


def _joint(named: tuple[str, str], ends: tuple[str, str], T: FloatArray, *more: str) -> list[str]:
    """A <joint> of a name and a type between two links, its frame at T (4, 4) of the first one's."""
    rpy = -turns_from_rotation(T[:3, :3].T)  # R_z(yaw) R_y(pitch) R_x(roll), turned over, is R_x R_y R_z of these
    xyz, turn = (" ".join(repr(float(v)) for v in np.asarray(values) + 0.0) for values in (T[:3, 3], rpy))
    inside = [
        f'<parent link="{ends[0]}"/>',
        f'<child link="{ends[1]}"/>',
        f'<origin xyz="{xyz}" rpy="{turn}"/>',
        *more,
    ]
    return [f'  <joint name="{named[0]}" type="{named[1]}">', *(f"    {line}" for line in inside), "  </joint>"]
