"""The shortest way through the solutions of a path, compiled: dynamic programming over branches and whole turns.

A node is a solution of a pose with each angle at one of its whole turns within the limits.
"""

# mypy: disable-error-code="no-untyped-def"
# Parts are typed by whoever calls them.
from __future__ import annotations

import numpy as np

from robomill.compiled import Out2, OutInt1, kernel, part
from robomill.kinematics.decoupled import LIMIT_SLACK
from robomill.kinematics.inverse_kernels import TURN
from robomill.kinematics.path_solutions import BEFORE, FROM_HOME, KNOWN, NEW, PathSolutions, Way

STANDS_OUT = 1e3  # rad: what is turned beyond the easy turn counts before all other motion


@part
def turns(theta, limits, lowest, count):
    """How many nodes a solution theta (n,) has: each joint's lowest whole turn within limits, and their count (n,)."""
    nodes = 1
    for j in range(len(theta)):
        lowest[j] = int(np.ceil((limits[j, 0] - LIMIT_SLACK - theta[j]) / TURN))
        count[j] = int(np.floor((limits[j, 1] + LIMIT_SLACK - theta[j]) / TURN)) - lowest[j] + 1
        nodes *= max(count[j], 0)
    return nodes


@part
def nodes_of(course, i, lowest, count, node, branch):
    """The nodes of pose i into node (k, n) and their branches into branch (k,); how many there are."""
    k = 0
    for b in range(8):
        if not course.possible[i, b]:
            continue
        theta = course.theta[i, b]
        for code in range(turns(theta, course.limits, lowest, count)):
            rest = code
            for j in range(len(theta)):
                turned = theta[j] + TURN * (lowest[j] + rest % count[j])
                rest //= count[j]
                node[k, j] = min(max(turned, course.limits[j, 0]), course.limits[j, 1])
            branch[k] = b
            k += 1
    return k


@part
def step_cost(theta, before, easy):
    """What a step costs: all joint motion squared, and first what any joint turns beyond the easy turn."""
    cost = 0.0
    for j in range(len(theta)):
        turn = abs(theta[j] - before[j])
        cost += turn * turn + STANDS_OUT * max(turn - easy, 0.0)
    return cost


@part
def first_cost(theta, start, extra):
    """What the first pose of a path costs: a little for its distance from ``start``, and that of its branch."""
    cost = extra
    for j in range(len(theta)):
        cost += FROM_HOME * (theta[j] - start[j]) ** 2
    return cost


@kernel
def most_nodes(course: PathSolutions) -> int:
    """The largest number of nodes of any pose, at least 1."""
    n, most = len(course.start), 1
    lowest, count = np.empty(n, np.int64), np.empty(n, np.int64)
    for i in range(len(course.theta)):
        nodes = 0
        for b in range(8):
            if course.possible[i, b]:
                nodes += turns(course.theta[i, b], course.limits, lowest, count)
        most = max(most, nodes)
    return most


@kernel
def go_on(course: PathSolutions, begin: int, end: int, way: Way, index: OutInt1) -> None:
    """The shortest ways to every node of poses ``begin`` to ``end``; index (m,) is the pose that each goes on from.

    Poses without a node are bridged, and -1: the way goes on from the last pose that has one.
    """
    n = len(course.start)
    lowest, count = np.empty(n, np.int64), np.empty(n, np.int64)
    node, total, at = way.node, way.total, way.at
    for i in range(begin, end):
        way.easy[0] += course.easy[i]
        new, before = at[NEW], at[BEFORE]
        nodes = nodes_of(course, i, lowest, count, node[new], way.branch)
        index[i] = -1 if nodes == 0 else before
        if nodes == 0:
            continue
        old = 1 - new
        for k in range(nodes):
            here = node[new, k]
            if before < 0:
                total[new, k] = first_cost(here, course.start, course.first[way.branch[k]])
                continue
            best = np.inf
            for q in range(at[KNOWN]):
                if total[old, q] < best:
                    cost = total[old, q] + step_cost(here, node[old, q], way.easy[0])
                    if cost < best:
                        best, way.came[i, k] = cost, q
            total[new, k] = best
        at[BEFORE], at[KNOWN], at[NEW], way.easy[0] = i, nodes, old, 0.0


@kernel
def come_back(course: PathSolutions, way: Way, theta: Out2, index: OutInt1) -> float:
    """theta (m, n) and branch index (m,) of the way that costs least, and its cost; -1 where a pose has no node."""
    n = len(course.start)
    lowest, count = np.empty(n, np.int64), np.empty(n, np.int64)
    i, last, k = way.at[BEFORE], 1 - way.at[NEW], 0
    if i < 0:
        return 0.0
    for q in range(way.at[KNOWN]):
        if way.total[last, q] < way.total[last, k]:
            k = q
    cost = way.total[last, k]
    while i >= 0:
        earlier = index[i]
        nodes_of(course, i, lowest, count, way.node[0], way.branch)
        for j in range(n):
            theta[i, j] = way.node[0, k, j]
        index[i], k, i = way.branch[k], way.came[i, k], earlier
    return cost
