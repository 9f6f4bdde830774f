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
from robomill.kinematics.path_solutions import FROM_HOME, PathSolutions

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
def shortest(course: PathSolutions, most: int, theta: Out2, index: OutInt1) -> float:
    """theta (m, n) and branch index (m,) of the way that costs least, and its cost; -1 where a pose has no node.

    Such poses are bridged: the way goes on from the last pose that has one. ``most`` nodes a pose at most.
    """
    m, n = theta.shape
    lowest, count = np.empty(n, np.int64), np.empty(n, np.int64)
    node, branch = np.empty((2, most, n)), np.empty(most, np.int64)
    total, came = np.zeros((2, most)), np.zeros((m, most), np.int16)
    before, known, new, easy = -1, 0, 0, 0.0  # the last pose with nodes, how many, and where the new ones go
    for i in range(m):
        easy += course.easy[i]
        nodes = nodes_of(course, i, lowest, count, node[new], branch)
        index[i] = -1 if nodes == 0 else before
        if nodes == 0:
            continue
        old = 1 - new
        for k in range(nodes):
            here = node[new, k]
            if before < 0:
                total[new, k] = first_cost(here, course.start, course.first[branch[k]])
                continue
            best = np.inf
            for q in range(known):
                if total[old, q] < best:
                    cost = total[old, q] + step_cost(here, node[old, q], easy)
                    if cost < best:
                        best, came[i, k] = cost, q
            total[new, k] = best
        before, known, new, easy = i, nodes, old, 0.0
    if before < 0:
        return 0.0
    k = 0
    for q in range(known):
        if total[1 - new, q] < total[1 - new, k]:
            k = q
    cost = total[1 - new, k]
    i = before
    while i >= 0:
        earlier = index[i]
        nodes_of(course, i, lowest, count, node[0], branch)
        for j in range(n):
            theta[i, j] = node[0, k, j]
        index[i], k, i = branch[k], came[i, k], earlier
    return cost
