"""A stock that steps of a path are cut into one after the other, each asked first what it meets."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import BoolArray, FloatArray, IntArray, as_floats
from robomill.cutting.edge import MOMENTS
from robomill.cutting.engaged import FACING, PANELS, sinks
from robomill.cutting.force import feed_frame
from robomill.cutting.profile_kernels import valley
from robomill.cutting.tool import DISH, Cutter
from robomill.cutting.tooling import Tooling
from robomill.errors import SurfaceError
from robomill.lazy import cached_property
from robomill.progress import checkpoint
from robomill.surface.passes import STRAIGHT, bends, check_rise, leaning, moves_at_feed, moves_of, tool_axes
from robomill.surface.raster import relief_of, stock_layers
from robomill.surface.stock import Cells, Stock, cells_about, stock_grid
from robomill.toolpath.sampling import CORNER

AT_ONCE = (2048, 8192)  # steps that are marched together: at least, where none goes on after them, and at most
JUST = 1e-6  # m before the end of a move, or after its start: there the tool has not only touched what stands there
SPARE_LAYERS = (2, 6)  # that leaning cutters may open in a column, beside those of the stock; more where needed


@dataclass(frozen=True, eq=False)
class March:
    """A path p (m, 3) m through a stock: ``meet`` says what a step meets, ``cut`` cuts it, ``run`` does both for all.

    The path gives feeds, axes and tools: entry i is the move p[i-1] -> p[i], k (3,) or (m, 3) unit tool axis (None:
    upright), cutting (m,) bool, ``way`` (m, 3) the unit feed at its end (None: that of the move), ``steep`` (m,) how
    steeply the tool's end ``sinks`` (None: as the feed says). A step is met where it ends, in what was left before it;
    a step of no length that begins a cut at that place, ahead of which the next one goes. ``really`` (m, 3) m is where
    the tip goes, if not where it is told to: the chip stays that of the feed it is told, and where a cut begins
    elsewhere than the tip was, the link to there is cut first. ``looked`` (m, 3) m is how far from where it is cut a
    step is asked what it would meet. Steps that are not finite or not at feed cut nothing.
    Steps are cut in the order of the path; ``meet`` and ``cut`` take their ends anew, ``run`` knows straight runs of
    them as one move.
    Raises SurfaceError for a cell size that does not fit and a tool axis too close to level.
    """

    stock: Stock
    cell: float
    cutter: Cutter | Tooling
    p: ArrayLike
    k: ArrayLike | None = None
    cutting: ArrayLike | None = None
    exponents: tuple[float, ...] = (1.0, 0.0)
    really: ArrayLike | None = None
    way: ArrayLike | None = None
    steep: ArrayLike | None = None
    looked: ArrayLike | None = None

    @cached_property
    def points(self) -> FloatArray:
        """(m, 3) m."""
        return as_floats(self.p, "toolpath points", (None, 3), error=SurfaceError, finite=False)

    @cached_property
    def tips(self) -> FloatArray:
        """(m, 3) m, where the tip goes."""
        given = self.p if self.really is None else self.really
        return as_floats(given, "toolpath points", (len(self.points), 3), error=SurfaceError, finite=False)

    @cached_property
    def tooling(self) -> Tooling:
        """The cutter of every step."""
        return Tooling.of(self.cutter, len(self.points))

    @cached_property
    def steps(self) -> IntArray:
        """(n,) entries of the path that cut, and those of no length that begin a cut."""
        used = moves_at_feed(self.points, self.cutting)
        known = np.asarray(np.isfinite(self.points).all(axis=1) & np.isfinite(self.tips).all(axis=1))
        used &= known & np.append(False, known[:-1])
        return np.flatnonzero(used & (self._move >= 0) & used[self._move])

    @cached_property
    def _move(self) -> IntArray:
        """(m,) the move that an entry is a part of: itself, or the next one where it has no length; -1 for none."""
        span = np.diff(self.points, axis=0, prepend=self.points[:1])
        return moves_of((span == 0.0).all(axis=1), moves_at_feed(self.points, self.cutting))

    @cached_property
    def _at_start(self) -> BoolArray:
        """(n,) which of ``steps`` only begin a move."""
        return np.asarray(self._move[self.steps] != self.steps)

    @cached_property
    def _links(self) -> BoolArray:
        """(n,) which of those bring the tip to another place all the same."""
        return np.asarray(self._at_start & (self._ends[:, 3:] != self._ends[:, :3]).any(axis=1))

    @cached_property
    def _ends(self) -> FloatArray:
        return np.hstack([self.tips[self.steps - 1], self.tips[self.steps]])

    @cached_property
    def _feed(self) -> FloatArray:
        if self.way is not None:
            return as_floats(self.way, "feed", (len(self.points), 3), error=SurfaceError)[self.steps]
        move = self._move[self.steps]
        span = self.points[move] - self.points[move - 1]
        return np.asarray(span / np.linalg.norm(span, axis=1, keepdims=True))

    @cached_property
    def _sinks(self) -> FloatArray:
        """(n,) how steeply each step sinks for the end of the tool."""
        if self.steep is None:
            return sinks(np.einsum("ni,ni->n", self._feed, self._axes[0]))
        return as_floats(self.steep, "slopes", (len(self.points),), error=SurfaceError)[self.steps]

    @cached_property
    def _heading(self) -> FloatArray:
        """(n, 3) the first axis of the frame that the force is given in, which a plunge's angles are counted from."""
        axes = self._axes[0]
        if np.linalg.norm(np.cross(self._feed, axes), axis=1).min(initial=1.0) > FACING:
            return self._feed  # nothing plunges
        way = np.diff(self.points, axis=0, prepend=self.points[:1]) if self.way is None else self.way
        return feed_frame(np.nan_to_num(way), tool_axes(self.k, len(self.points)))[self.steps, :, 0].copy()

    @cached_property
    def _turns(self) -> FloatArray:
        """(n, 3) 1/m: by how much the axis changes on the tip's way; 0 where it turns on the spot."""
        axes, move = tool_axes(self.k, len(self.points)), self._move[self.steps]
        length = np.linalg.norm(self.points[move] - self.points[move - 1], axis=1, keepdims=True)
        turn, k = axes[move] - axes[move - 1], self._axes[0]
        turn = turn - np.einsum("ni,ni->n", turn, k)[:, None] * k
        return np.divide(turn, length, out=np.zeros_like(turn), where=length > 0.0)

    @cached_property
    def _just(self) -> FloatArray:
        """(n,) m from where a step ends, along its feed, to where the tool is when it is looked at."""
        move = self._move[self.steps]
        length = np.linalg.norm(self.points[move] - self.points[move - 1], axis=1)
        just = np.minimum(JUST, 0.5 * length)
        return np.asarray(np.where(self._at_start, just, -just))

    @cached_property
    def _ahead(self) -> FloatArray:
        """(n, 3) m the same as a way of the tool that goes as it is told."""
        ahead = np.asarray(self._just[:, None] * self._feed)
        return ahead if self.looked is None else ahead + np.asarray(self.looked)[self.steps]

    @cached_property
    def _axes(self) -> tuple[FloatArray, FloatArray]:
        """(n, 3) tool axes at the ends of steps, and the middle ones under which they are cut."""
        axes, move = tool_axes(self.k, len(self.points)), self._move[self.steps]
        middle = axes[move - 1] + axes[move]
        middle /= np.linalg.norm(middle, axis=1, keepdims=True)
        found = axes[self.steps], middle
        for each in found:
            check_rise(each)
            each[~leaning(each)] = 0.0, 0.0, 1.0
        return found

    @cached_property
    def _begins(self) -> BoolArray:
        """(n,) bool: steps that do not go straight on from the one before, with the same tool and axis."""
        move, axes, tool = self._move[self.steps], self._axes[1], self.tooling.of_step[self.steps]
        other = (axes[:-1] != axes[1:]).any(axis=1) | (tool[:-1] != tool[1:])
        begins = ((self._bends > STRAIGHT) | other) & (move[:-1] != move[1:])
        begins |= self._links[1:] | self._links[:-1]
        return np.append(np.ones(min(len(move), 1), dtype=bool), begins)

    @cached_property
    def _stops(self) -> BoolArray:
        """(n,) bool: steps from whose end none goes on, round a ``CORNER`` at most, and covers their front."""
        return np.append(self._bends > CORNER, np.ones(min(len(self.steps), 1), dtype=bool)) | self._links

    @cached_property
    def _bends(self) -> FloatArray:
        return bends(self._ends)

    @cached_property
    def _stepwise(self) -> tuple[Any, Any]:
        """The state of ``meet`` and ``cut``."""
        from robomill.surface.contact.material_kernels import AXIS, ENDS

        state = self._state(np.ones(len(self.steps), dtype=bool), stock_grid(self.stock, self.cell))
        state[0].runs[:, ENDS:AXIS] = np.nan  # where a step goes is not known before
        return state

    @cached_property
    def _reached(self) -> Cells:
        """The cells of the stock that the path can meet: of upright tools those near their tips."""
        cells = stock_grid(self.stock, self.cell)
        if len(self.steps) == 0 or leaning(np.concatenate(self._axes)).any():
            return cells
        tips = np.vstack([self._ends[:, :2], self._ends[:, 3:5]])
        R = max(cutter.radius for cutter in self.tooling.cutters)
        return cells_about(cells, tips.min(axis=0) - R, tips.max(axis=0) + R)

    def _state(self, first: BoolArray, cells: Cells, spare: int = SPARE_LAYERS[-1]) -> tuple[Any, Any]:
        """The stock as it stands in some cells, and room for what a step meets: arrays that the kernels write.
        ``first`` (n,) bool: the steps that begin a run; ``spare``: layers that leaning cutters may open in a column."""
        from robomill.surface.contact.material_kernels import AXIS, ENDS, MOVE, RUN, SHAPE, Bounds, Dexels, World

        heights, facets = stock_layers(self.stock, cells, spare if leaning(np.concatenate(self._axes)).any() else 0)
        names = np.zeros((*heights.shape[:2], heights.shape[2] + 1), dtype=np.int32)  # all ``NOBODY``'s
        lost, grid = np.zeros(1, dtype=np.int64), (cells.x0, cells.y0, cells.dx, cells.dy)
        dexels = Dexels(heights, names, lost, *grid, self._slack(cells, heights.shape[2] > 1))
        shapes = np.array([[float(n) for n in cutter.solid] for cutter in self.tooling.cutters])
        runs = np.zeros((1 + int(first.sum()), RUN))
        runs[1:, SHAPE : len(shapes[0])] = shapes[self.tooling.of_step[self.steps][first]]
        runs[1:, ENDS:AXIS] = self._ends[first]
        runs[1:, AXIS:MOVE] = self._axes[1][first]
        bounds = Bounds(*map(float, (*self.stock.lower, *self.stock.upper)))
        relief = relief_of(self.stock, max(cutter.radius for cutter in self.tooling.cutters))
        return World(dexels, runs, bounds, facets, relief), self._room()

    def _room(self) -> Any:
        from robomill.surface.contact import division_kernels as division, engagement_kernels as kernels
        from robomill.surface.contact.rib_kernels import CIRCLES, COLUMNS
        from robomill.surface.contact.turn_kernels import ANGLES, half_turn

        places = kernels.END_PIECES + kernels.NOSE_PIECES + kernels.FLANK_PIECES + 3 * 3
        rows = np.zeros((division.ROWS, kernels.SUMS + 3 * len(self.exponents)))
        for half in range(2):
            phi = half * np.pi + half_turn()
            main = rows[half * ANGLES : (half + 1) * ANGLES]
            main[:, : kernels.LENGTH] = np.stack([phi, np.sin(phi), np.cos(phi)], axis=1)
        widest = max(cutter.radius for cutter in self.tooling.cutters)
        down = (np.einsum("ni,ni->n", self._feed, self._axes[0]) < -FACING).any()
        down |= (np.linalg.norm(self._turns, axis=1) * widest > DISH).any()
        return kernels.Room(
            np.array(self.exponents, dtype=float),
            np.zeros((3, 4)),
            np.zeros((places, 5)),
            rows,
            np.zeros((division.GAPS, 7)),
            np.zeros((division.GAPS * (2 * division.HALVINGS + 2), 4)),
            np.zeros((4 * PANELS * (2 if down else 1), 5)),
            np.zeros((3 * CIRCLES, COLUMNS)),
            np.zeros(1),
        )

    @cached_property
    def _number(self) -> IntArray:
        """(m,) which of ``steps`` an entry of the path is."""
        number = np.full(len(self.points), -1, dtype=np.int64)
        number[self.steps] = np.arange(len(self.steps))
        return number

    def _slack(self, cells: Cells, layered: bool) -> float:
        """How far off the heights of the cells around a place the height there may lie, m: a valley of the sharpest
        nose between them; half a cell where cutters lean or the stock has voids."""
        size = max(cells.dx, cells.dy)
        if layered:
            return 0.5 * size
        return max(0.01 * size, *(valley(cutter.solid, size) for cutter in self.tooling.cutters))

    def run(self) -> tuple[FloatArray, np.ndarray]:
        """Meet and cut every step: rows (m, 8 n_e + 7) and sectors (m, s, 4) of what they meet. Where a column has no
        room for another gap between layers of material, all is done again with more room in each."""
        for spare in SPARE_LAYERS:
            rows, sectors, lost = self._run(spare)
            if not lost:
                break
        sectors.flags.writeable = False  # kept as they are
        return rows, sectors

    def _run(self, spare: int) -> tuple[FloatArray, np.ndarray, bool]:
        """Rows and sectors with so many layers to spare in a column, and whether they were not enough."""
        from robomill.surface.contact.division_kernels import REST

        state, begins = self._state(self._begins, self._reached, spare), self._begins
        rows = np.zeros((len(self.points), MOMENTS * len(self.exponents) + REST))
        sectors = np.zeros((len(self.points), len(state[1].sectors), 4), dtype=np.float16)
        run, first = np.cumsum(begins, dtype=np.int64), 0
        while first < len(self.steps):
            checkpoint(first / len(self.steps), "What each step meets")
            n = slice(first, self._stop_after(first))
            first = n.stop
            rows[self.steps[n]], sectors[self.steps[n]] = self._march(
                state, n, self._ends[n], (run[n], begins[n], self._stops[n]), (True, True)
            )
        return rows, sectors, bool(state[0].dexels.lost[0])

    def _stop_after(self, first: int) -> int:
        """Where the steps end that are marched together: where nothing goes on, so that none needs to know the next."""
        n = slice(first + AT_ONCE[0] - 1, first + AT_ONCE[1])
        ends = np.flatnonzero(self._stops[n] & np.append(self._begins, True)[1:][n])
        return int(n.start + 1 + ends[0]) if len(ends) else min(n.stop, len(self.steps))

    def meet(
        self, i: int, a: FloatArray, b: FloatArray, fed: tuple[FloatArray, float] | None = None
    ) -> tuple[FloatArray, np.ndarray]:
        """What step ``i`` meets on the way from a (3,) to b (3,) m: its row (8 n_e + 7,) and sectors; cuts nothing.
        ``fed``: how it goes (3,), for a unit of the feed it is told, and how steeply its end sinks, if otherwise."""
        rows, sectors = self._one(i, np.concatenate([a, b]), (True, False), fed)
        return rows[0], sectors[0]

    def cut(self, i: int, a: FloatArray, b: FloatArray) -> None:
        """Cut step ``i`` from a (3,) to b (3,) m; every step is cut once, in the order of the path."""
        self._one(i, np.concatenate([a, b]), (False, True))

    def _one(
        self, i: int, ends: FloatArray, do: tuple[bool, bool], fed: tuple[FloatArray, float] | None = None
    ) -> tuple[FloatArray, np.ndarray]:
        n = int(self._number[i])
        alone = np.ones(1, dtype=bool)
        return self._march(self._stepwise, slice(n, n + 1), ends[None], (np.array([n + 1]), alone, alone), do, fed)

    def _march(
        self,
        state: tuple[Any, Any],
        n: slice,
        ends: FloatArray,
        runs: tuple[IntArray, BoolArray, BoolArray],
        do: tuple[bool, bool],
        fed: tuple[FloatArray, float] | None = None,
    ) -> tuple[FloatArray, np.ndarray]:
        from robomill.surface.contact.division_kernels import REST
        from robomill.surface.contact.march_kernels import Steps, as_halves, march

        world, room = state
        found = np.zeros((len(ends), MOMENTS * len(self.exponents) + REST))
        sectors = np.zeros((len(ends), 4 * len(room.sectors)), dtype=np.float32)
        # as it really goes: back along a steeper way, an end that sinks by little would not have met its floor
        tips = ends[:, 3:] + (self._ahead[n] if fed is None else self._just[n][:, None] * fed[0])
        steps = Steps(
            np.ascontiguousarray(ends),
            tips,
            self._feed[n] if fed is None else fed[0][None],
            self._axes[0][n],
            self._heading[n],
            self._turns[n],
            self._sinks[n] if fed is None else np.array([fed[1]]),
            runs[0],
            runs[1].astype(np.int64),
            runs[2].astype(np.int64),
            self._links[n].astype(np.int64),
        )
        march(world, room, steps, found, sectors, do)
        halves = np.empty((len(ends), len(room.sectors), 4), dtype=np.float16)
        as_halves(sectors.ravel(), sectors.view(np.int32).ravel(), halves.view(np.int16).ravel())
        return found, halves
