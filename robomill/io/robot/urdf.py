"""A URDF file as a serial chain: joint axes become a modified D-H table, and every pose stays."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import reduce
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import RobotError
from robomill.files import ROBOT
from robomill.io.robot.urdf_axes import PARALLEL, dh_from_axes
from robomill.io.texts import read_text
from robomill.kinematics.transforms import rotation_x, rotation_y, rotation_z, transform
from robomill.provenance import Provenance
from robomill.robot.joints import ASSUMED_COMPLIANCE
from robomill.robot.model import Robot
from robomill.robot.table import doubtful_limit
from robomill.spelled import to_give
from robomill.typed_numbers import plain_number

MOVING = ("revolute", "continuous", "prismatic")
TIP = ("tip", "say which is the tip")
ROS_TIP = "tool0"  # the tool frame that ROS-Industrial asks of every arm
SAME_PLACE = 1e-9  # m, and of directions
FARTHEST, SHORTEST = 20.0, 0.01  # m: no joint stands farther from the one before, no arm has links as short
MOST_TURN = 2.0 * np.pi + 1e-2  # rad, as files round it
MOST_JOINTS = 20  # before a D-H table is made of them; the robot says how many it may have


@dataclass(frozen=True, eq=False)
class Joint:
    """One <joint>: T (4, 4) of its frame in its parent's, turned by rpy (3,) rad; axis (3,) in its own, limits (lower,
    upper) or None."""

    name: str
    type: str
    parent: str
    child: str
    T: FloatArray
    rpy: FloatArray
    axis: FloatArray
    limits: tuple[float, float] | None
    mimics: bool


def read_urdf(
    given: str | Path | bytes,
    *,
    tip: str | None = None,
    where: str = "",
) -> Robot:
    """The serial arm from the root to link ``tip`` of a URDF file (default: the only end link, or tool0).

    ``given`` is its path or its bytes, ``where`` the file's name then. Frames {M} and {T} are those of the two links,
    and the flange is the tip too, if that stands on the last axis with its z along it, as makers' flanges do; joint
    senses, zeros and limits are the file's. Compliances are not in a URDF: 1e-6 rad/(N m) (m/N) each, marked assumed.
    Raises RobotError for branches (name the tip), missing links or joints, closed loops, mimic and floating joints.
    Meshes are not looked at, and a file that declares entities is refused: no other file is ever opened.
    """
    name, joints, links, where = _read(given, where)
    return _robot(_serial_chain(joints, links, tip, where), name, where)


@dataclass(frozen=True)
class Tips:
    """Links of a URDF file that may be the tip, each with the joints that lead there from the root.

    ``chains`` are in the order of the file; ``ends`` are the links on which nothing hangs; ``only`` is the tip that is
    taken where none is named, None where the arm branches.
    """

    chains: Mapping[str, tuple[Joint, ...]]
    ends: tuple[str, ...]
    only: str | None


def tips_of_urdf(given: str | Path | bytes, where: str = "") -> Tips:
    """The links of a URDF file to which at least one moving joint leads. Raises RobotError as ``read_urdf``."""
    _, joints, links, where = _read(given, where)
    by_child, above = _by_child(joints, links, where), {joint.parent for joint in joints}
    ways = {link: tuple(_walk_up(by_child, link, where)) for link in links}
    chains = {link: way for link, way in ways.items() if any(joint.type != "fixed" for joint in way)}
    try:
        taken = _serial_chain(joints, links, None, where)
    except RobotError:
        taken = []
    ends = tuple(link for link in chains if link not in above)
    return Tips(chains, ends, taken[-1].child if taken and taken[-1].child in chains else None)


def _read(given: str | Path | bytes, where: str) -> tuple[str, list[Joint], list[str], str]:
    """Name, joints and links of a file, and how it is called in refusals."""
    text, where = read_text(given, RobotError, ROBOT, where)
    root = _root(text, where)
    links = [link.get("name", "") for link in root.findall("link")]
    joints = [_joint(each, where) for each in root.findall("joint")]
    _check_names(links, "link", where)
    _check_names([joint.name for joint in joints], "joint", where)
    if not joints and any("xacro" in each.tag for each in root.iter()):
        raise RobotError(f"{where}: this is a xacro template; make the URDF of it first (xacro FILE > arm.urdf).")
    return root.get("name") or Path(where).stem, joints, links, where


def _check_names(names: list[str], what: str, where: str) -> None:
    twice = next((name for name in names if names.count(name) > 1), None) if len({*names}) < len(names) else None
    if twice is not None:
        raise RobotError(
            f"{where}: {names.count(twice)} {what}s are called {twice!r:.60}; give each a name of its own."
        )


def _root(text: str, where: str) -> ElementTree.Element:
    """The <robot> of a file."""
    if "<!DOCTYPE" in text:
        raise RobotError(f"{where}: a URDF has no <!DOCTYPE> and no entities; take them out.")
    try:
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError) as exc:
        raise RobotError(f"{where}: this is not a URDF that can be read ({str(exc)[:80]}).") from None
    if root.tag != "robot":
        raise RobotError(f"{where}: this is not a URDF: found <{root.tag[:40]}>, expected <robot>.")
    return root


def _joint(element: ElementTree.Element, where: str) -> Joint:
    name = element.get("name", "")

    def inside(tag: str, key: str, default: str = "") -> str:
        found = element.find(tag)
        return default if found is None else found.get(key, default)

    def numbers(tag: str, key: str, default: str, count: int = 3) -> FloatArray:
        said = inside(tag, key, default)
        try:
            values = np.array([plain_number(word) for word in said.split()])
        except ValueError:
            values = np.array([np.nan])
        if len(values) != count or not np.isfinite(values).all():
            expected = "a number" if count == 1 else f"{count} numbers"
            raise RobotError(f"{where}: joint {name!r:.60} has {tag} {key}={said!r:.60}; expected {expected}.")
        return values

    xyz, rpy = numbers("origin", "xyz", "0 0 0"), numbers("origin", "rpy", "0 0 0")
    axis = numbers("axis", "xyz", "1 0 0")
    size = float(np.linalg.norm(axis))
    if not 0 < size < np.inf:
        raise RobotError(f"{where}: joint {name!r:.60} has a zero axis.")
    limited = element.find("limit") is not None and bool(inside("limit", "lower") and inside("limit", "upper"))
    return Joint(
        name,
        element.get("type", ""),
        inside("parent", "link"),
        inside("child", "link"),
        transform(rotation_z(rpy[2]) @ rotation_y(rpy[1]) @ rotation_x(rpy[0]), xyz),
        rpy,
        axis / size,
        (numbers("limit", "lower", "", 1)[0], numbers("limit", "upper", "", 1)[0]) if limited else None,
        element.find("mimic") is not None,
    )


def _by_child(joints: list[Joint], links: list[str], where: str) -> dict[str, Joint]:
    """The joint that every link hangs on, but the root; links that are not there and closed loops are refused."""
    parents: dict[str, Joint] = {}
    there = set(links)
    for joint in joints:
        for end, link in (("parent", joint.parent), ("child", joint.child)):
            if link not in there:
                named = f"joint {joint.name!r:.60} names the {end} link {link!r:.60}"
                raise RobotError(f"{where}: {named}, which the file does not have.")
        if joint.child in parents:
            raise RobotError(
                f"{where}: link {joint.child!r:.60} hangs on two joints, a closed loop; only a serial arm can be read."
            )
        parents[joint.child] = joint
    for joint in joints:
        _check_loop(joint, parents, where)
    return parents


def _check_loop(joint: Joint, parents: Mapping[str, Joint], where: str) -> None:
    """Refuse a joint from which the way up comes back to it."""
    link, way = joint.parent, [joint.name]
    while link != joint.child and link in parents and len(way) <= len(parents):
        way.append(parents[link].name)
        link = parents[link].parent
    if link == joint.child:
        some = f"joint {way[0]!r:.60} leads" if len(way) == 1 else f"joints {_listed(map(repr, way[::-1]))} lead"
        raise RobotError(f"{where}: {some} back to link {link!r:.60}, a closed loop; only a serial arm can be read.")


def _serial_chain(joints: list[Joint], links: list[str], tip: str | None, where: str) -> list[Joint]:
    """Joints from the root to the tip, in order."""
    parents = _by_child(joints, links, where)
    children: dict[str, list[Joint]] = {}
    for joint in joints:
        children.setdefault(joint.parent, []).append(joint)
    if tip is not None:
        if tip not in links:
            raise RobotError(f"{where}: has no link {tip!r}; its links are {_listed(links)}.")
        return _walk_up(parents, tip, where)
    roots = [link for link in links if link not in parents]
    if len(roots) != 1:
        raise RobotError(
            f"{where}: {len(roots)} links ({_listed(roots)}) have no parent joint; a joint between them is missing."
        )
    link = roots[0]
    moving = _above_what_moves(parents)
    chain: list[Joint] = []
    while children.get(link) and len(chain) <= len(parents):
        options = [j for j in children[link] if j.child in moving]
        if not options:
            return chain + _fixed_end(link, children, where)
        if len(options) > 1:
            ends = _listed(repr(joint.child) for joint in options)
            raise RobotError(
                f"{where}: the arm branches at link {link!r:.60} into {ends}; {to_give(*TIP)} of the branch you want."
            )
        chain.append(options[0])
        link = options[0].child
    return chain


def _fixed_end(link: str, children: Mapping[str, list[Joint]], where: str) -> list[Joint]:
    """Joints from the last link that moves to the tip: the only end that is fixed to it, or the first of those in one
    place, or the one that is called tool0. Raises RobotError where none of these tells which."""
    ways: list[list[Joint]] = [[joint] for joint in children[link]]
    ends: list[tuple[FloatArray, list[Joint]]] = []
    while ways:
        way = ways.pop(0)
        on = children.get(way[-1].child, [])
        ways[:0] = [[*way, joint] for joint in on if joint not in way]
        if not on:
            ends.append((reduce(np.matmul, (joint.T for joint in way)), way))
    named = [way for _, way in ends if way[-1].child == ROS_TIP]
    first, taken = ends[0]
    if named or all(np.allclose(T, first, atol=SAME_PLACE) for T, _ in ends):
        return named[0] if named else taken
    names = _listed(way[-1].child for _, way in ends)
    raise RobotError(f"{where}: several links are fixed to the last that moves ({names}); {to_give(*TIP)}.")


def _listed(names: Iterable[str]) -> str:
    every = list(names)
    return f"{', '.join(every[:12]):.300}" + (" and more" if len(every) > 12 else "")


def _above_what_moves(parents: dict[str, Joint]) -> set[str]:
    """Links that hang on a joint that is not fixed, or from which such a joint hangs."""
    moving: set[str] = set()
    for joint in parents.values():
        link = joint.child
        while joint.type != "fixed" and link in parents and link not in moving:
            moving.add(link)
            link = parents[link].parent
    return moving


def _walk_up(parents: dict[str, Joint], tip: str, where: str) -> list[Joint]:
    chain: list[Joint] = []
    link = tip
    while link in parents:
        chain.append(parents[link])
        if len(chain) > len(parents):
            raise RobotError(f"{where}: the joints above link {tip!r} form a loop; only a serial arm can be read.")
        link = parents[link].parent
    return chain[::-1]


def _robot(chain: list[Joint], name: str, where: str) -> Robot:
    _check_units(chain, where)
    T_M = np.eye(4)
    axes: list[FloatArray] = []
    points: list[FloatArray] = []
    moving: list[Joint] = []
    for joint in chain:
        T_M = T_M @ joint.T
        if joint.type == "fixed":
            continue
        if joint.type not in MOVING:
            raise RobotError(
                f"{where}: joint {joint.name!r:.60} is of type {joint.type!r:.60}; "
                "only revolute, continuous, prismatic and fixed joints can be read."
            )
        if joint.mimics:
            raise RobotError(
                f"{where}: joint {joint.name!r:.60} mimics another; only independent joints can be read. If the arm "
                f"ends before it, {to_give(*TIP)}."
            )
        axes.append(T_M[:3, :3] @ joint.axis)
        points.append(T_M[:3, 3].copy())
        moving.append(joint)
    if not moving:
        raise RobotError(f"{where}: has no moving joints; a robot needs 1 to 7.")
    if len(moving) > MOST_JOINTS:
        raise RobotError(f"{where}: has {len(moving)} moving joints in a row; a robot needs 1 to 7.")
    prismatic = np.array([joint.type == "prismatic" for joint in moving])
    sign = np.ones(len(moving))
    if float(axes[-1] @ T_M[:3, 2]) < PARALLEL - 1.0:  # the last joint turns about -z of the tip
        axes[-1], sign[-1] = -axes[-1], -1.0
    table: dict[str, Any] = dict(dh_from_axes(np.array(axes), np.array(points), T_M))
    file = Provenance("user", f"URDF file {where}")
    return Robot(
        name=name,
        title=f"{name} (from URDF)",
        convention="modified",
        sign=sign,
        prismatic=prismatic,
        limits_all=np.array([_limits(joint, where) for joint in moving]),
        C_theta_all=np.full(len(moving), ASSUMED_COMPLIANCE),
        provenance={
            "geometry": file,
            "limits": file,
            "base": file,
            "tool": file,
            "compliance": Provenance("assumed", "a URDF holds no compliances; 1e-6 rad/(N m) (m/N) for every joint"),
        },
        **table,
    )


def _limits(joint: Joint, where: str) -> tuple[float, float]:
    if joint.type == "continuous":
        return -np.pi, np.pi
    if joint.limits is None:
        raise RobotError(f"{where}: joint {joint.name!r:.60} has no limits; give <limit lower= upper=>.")
    doubt = doubtful_limit(np.array(joint.limits), joint.type == "prismatic")
    if doubt:
        raise RobotError(f"{where}: joint {joint.name!r:.60}, limit: {doubt} A URDF is in rad and m.")
    return joint.limits


def _check_units(chain: list[Joint], where: str) -> None:
    """Refuse places in mm and turns in degrees, by what from_dh refuses: a URDF is in m and rad."""
    for joint in chain:
        size, turn = float(np.linalg.norm(joint.T[:3, 3])), float(np.abs(joint.rpy).max())
        if size > FARTHEST:
            raise RobotError(
                f"{where}: joint {joint.name!r:.60}, origin xyz: found {size:g} m, expected at most {FARTHEST:g}; was "
                f"{size:g} mm meant? A URDF is in rad and m."
            )
        if turn > MOST_TURN:
            raise RobotError(
                f"{where}: joint {joint.name!r:.60}, origin rpy: found {turn:g} rad, expected at most {MOST_TURN:.3g}; "
                f"was {turn:g}° meant? A URDF is in rad and m."
            )
    reach = sum(float(np.linalg.norm(joint.T[:3, 3])) for joint in chain)
    if 0.0 < reach < SHORTEST and not any(joint.type == "prismatic" for joint in chain):
        raise RobotError(
            f"{where}: all links together are {reach:g} m long, expected at least {SHORTEST:g}: a URDF is in m; was "
            "another unit meant?"
        )
