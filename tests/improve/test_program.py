"""Samples and moves of a program, and pieces against the corrections that they stand for."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import robomill as rm
from robomill.improve.program import Moves
from robomill.improve.written import writing
from robomill.io.gcode_out import toolpath_to_gcode
from robomill.io.samples import samples_dir
from robomill.toolpath.gcode.reading import interpret

SLOT = rm.load_setup(samples_dir() / "paper_flute")
TEXT = (
    "G21 G90\nG0 X0 Y0 Z5\nG0 Z-2\nG1 X20 F600\nG2 X30 Y-10 I0 J-10\nG1 Y-30\nG0 Z5\nG0 X50\nG0 Z-2\nG1 Y0\nG0 Z9\nM2\n"
)


@pytest.fixture(scope="module")
def moves() -> Moves:
    return Moves.of_program(SLOT.replace(source=rm.GCodeSource(TEXT, "x.nc")), interpret(TEXT))


def test_every_sample_knows_its_move_and_how_much_of_it_is_made(moves: Moves) -> None:
    path = moves.wanted
    np.testing.assert_array_equal(path.block, interpret(TEXT).line[moves.owner])
    ends = np.append(np.diff(moves.owner) > 0, True)
    np.testing.assert_allclose(moves.share[ends & path.cutting], 1.0)
    np.testing.assert_allclose(path.p[ends], moves.end[moves.owner[ends]], atol=1e-12)
    half = path.p[(moves.owner == 2) & (np.abs(moves.share - 0.5) < 1e-9)]
    np.testing.assert_allclose(half, [[10e-3, 0.0, -2e-3]], atol=1e-12)


def test_one_shift_for_all_changes_no_shape(moves: Moves) -> None:
    c = np.where(moves.wanted.cutting[:, None], [1e-4, -2e-4, 3e-4], 0.0)
    pieces, ends = moves.corrected(c, 2e-6)
    assert [len(pieces[j]) for j in pieces] == [2, 1, 1, 2]  # where a rapid has not been moved a link leads in
    np.testing.assert_allclose(ends[[2, 3, 4]], moves.end[[2, 3, 4]] + [1e-4, -2e-4, 3e-4])
    assert pieces[3][0].centre is not None
    np.testing.assert_allclose(pieces[3][0].centre, [20.1e-3, -10.2e-3, -1.7e-3], atol=1e-8)


def test_rapids_go_straight_up_and_down_beside_a_cut(moves: Moves) -> None:
    path = moves.wanted
    c = np.where(path.cutting[:, None], [1e-4, -2e-4, 3e-4], 0.0)
    place = (np.diff(path.p, axis=0) == 0.0).all(axis=1)
    arrives = np.flatnonzero(~path.cutting[:-1] & path.cutting[1:] & place)
    c[arrives] = c[arrives + 1]
    _, ends = moves.corrected(c, 2e-6)
    shift = ends - moves.end
    np.testing.assert_allclose(shift[[0, 1, 5, 6, 7, 9]][:, :2], np.tile([1e-4, -2e-4], (6, 1)), atol=1e-15)
    np.testing.assert_allclose(shift[[0, 5, 6, 9], 2], 0.0, atol=1e-15)
    np.testing.assert_allclose(shift[[1, 7], 2], 3e-4)


def test_a_rapid_out_goes_aside_as_the_tool_stands_at_its_end(moves: Moves) -> None:
    """The tool leans until the last sample of all: across its axis there, not across the one that it had before."""
    last = np.arange(len(moves.owner)) == len(moves.owner) - 1
    leaning = np.where(last[:, None], [0.0, 0.0, 1.0], [0.0, 0.6, 0.8])
    turned = replace(moves, wanted=replace(moves.wanted, k=leaning))
    c = np.where(moves.wanted.cutting[:, None], [1e-4, -2e-4, 3e-4], 0.0)
    np.testing.assert_allclose((turned.corrected(c, 2e-6)[1] - moves.end)[9], [1e-4, -2e-4, 0.0], atol=1e-15)


def test_a_rapid_that_goes_nowhere_first_of_all_is_moved_across_the_tool_as_it_stands_there() -> None:
    text = "G21 G90\nG0 X0 Y0 Z0\nG0 Z-2\nG1 X20 F600\nG0 Z9\nM2\n"
    moves = Moves.of_program(SLOT.replace(source=rm.GCodeSource(text, "x.nc")), interpret(text))
    first = np.arange(len(moves.owner)) == 0
    k = np.where(first[:, None], [0.0, 0.6, 0.8], [0.0, 0.0, 1.0])
    c = np.where((moves.owner > 0)[:, None], [1e-4, -2e-4, 3e-4], 0.0)
    leaning = replace(moves, wanted=replace(moves.wanted, k=k))
    led = (leaning.corrected(c, 2e-6)[1] - moves.end)[0]
    np.testing.assert_allclose(led, np.cross(k[0], np.cross([1e-4, -2e-4, 3e-4], k[0])), atol=1e-15)


@pytest.mark.parametrize("bound", [1e-6, 5e-6, 20e-6])
def test_pieces_stay_within_their_bound_and_are_fewer_the_wider_it_is(moves: Moves, bound: float) -> None:
    p = moves.wanted.p
    c = np.where(moves.wanted.cutting[:, None], 2e-4 * np.sin(70.0 * p[:, [1, 0, 0]] + [0.3, 0.1, 0.0]), 0.0)
    pieces, _ = moves.corrected(c, bound)
    start, made = p[0], {}
    for j in range(len(moves.end)):
        made[j] = []
        for piece in pieces.get(j, []):
            made[j].append((start, piece))
            start = piece.end
        start = start if j in pieces else moves.end[j]
    q = moves.places({j: some for j, some in made.items() if some})
    straight = (moves.sweep[moves.owner] == 0.0) & moves.wanted.cutting
    assert np.linalg.norm(q - p - c, axis=1)[straight].max() <= bound
    arc = (moves.owner == 3) & (moves.share > 0.0)
    off = q - p - c
    out = p[arc] - [20e-3, -10e-3, -2e-3]
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    assert np.abs(np.einsum("mi,mi->m", off[arc], out)).max() <= 1.5 * bound
    count = sum(map(len, pieces.values()))
    assert count < len(p)
    assert bound > 1e-6 or count > 20


def test_samples_come_closer_where_a_cut_begins() -> None:
    setup = rm.load_setup(samples_dir() / "paper_flute" / "setup_process.toml")
    text = setup.source.block_texts()
    moves = Moves.of_program(setup, interpret("\n".join(text)))
    finer = moves.finer(rm.simulate(setup))
    step = finer.wanted.step_length
    x = finer.wanted.p[:, 0]
    begins = finer.wanted.cutting & (step > 0.0) & (x < -49e-3)
    assert step[begins].max() < 0.15e-3
    assert step[finer.wanted.cutting & (x > -45e-3)].max() == pytest.approx(1e-3)
    np.testing.assert_array_equal(np.unique(finer.owner), np.unique(moves.owner))


def test_where_a_deflection_changes_samples_are_as_close_as_it_changes_by_ten_micrometres(moves: Moves) -> None:
    """Not closer than a tenth of a millimetre, and not on a rapid; each new one lies on its way, of the same move."""
    path = moves.wanted
    own = np.flatnonzero(path.cutting & (moves.owner == 2))
    delta = np.zeros((len(path), 3))
    delta[own[3] :, 1] += 35e-6  # four parts
    delta[own[5] :, 0] -= 9e-6  # none
    delta[own[7] :, 2] += 1.0  # as many as there is room for
    delta[np.flatnonzero(~path.cutting)[-1] :, 1] += 1.0
    fine = moves.finer(SimpleNamespace(delta=delta))  # type: ignore[arg-type]
    room = len(fine.wanted) - len(path) - 2
    assert 0.1e-3 - 1e-9 <= path.step_length[own[7]] / room < 0.12e-3
    for i, parts in ((own[3], 4), (own[7], room)):
        begin = int(np.argmin(np.abs(fine.wanted.s - path.s[i - 1])))
        told = path.p[i - 1] + np.outer(np.arange(1, parts + 1) / parts, path.p[i] - path.p[i - 1])
        np.testing.assert_allclose(fine.wanted.p[begin + 1 : begin + 1 + parts], told, atol=1e-12)
        assert (fine.owner[begin + 1 : begin + 1 + parts] == 2).all()
    length = np.linalg.norm(moves.end[2] - moves.end[1])
    on = fine.wanted.cutting & (fine.owner == 2)
    np.testing.assert_allclose(fine.share[on], np.abs(fine.wanted.p[on, 0] - moves.end[1][0]) / length, atol=1e-9)
    assert moves.finer(SimpleNamespace(delta=np.zeros_like(delta))) is moves  # type: ignore[arg-type]


def test_a_move_that_goes_nowhere_ends_where_the_one_before_it_was_sent() -> None:
    """Written again as it stands, twice; the cut goes on from there."""
    text = "G21 G90\nG0 X0 Y0 Z5\nG0 Z-2\nG1 X20 F600\nG1 X20\nG4 P1\nG1 X20\nG1 Y-10\nG0 Z5\nM2\n"
    moves = Moves.of_program(SLOT.replace(source=rm.GCodeSource(text, "x.nc")), interpret(text))
    c = np.outer(1e-3 * moves.wanted.p[:, 0], [1.0, 2.0, 3.0]) * moves.wanted.cutting[:, None]
    pieces, ends = moves.corrected(c, 2e-6)
    there = moves.end[2] + 20e-6 * np.array([1.0, 2.0, 3.0])
    for j in (2, 3, 4):
        np.testing.assert_allclose(ends[j], there, atol=1e-15)
    for j in (3, 4):
        ((f0, f1, end),) = ((each.f0, each.f1, each.end) for each in pieces[j])
        assert (f0, f1) == (0.0, 1.0)
        np.testing.assert_array_equal(end, ends[j])
    assert len(pieces[5]) == 1


@pytest.mark.parametrize(
    ("still", "lines"),
    [
        ("G0 X0", ("G0 Z-2", "G0 X0", "G1 X20 F600", "G0 Z5")),
        ("G0 X20", ("G0 Z-2", "G1 X20 F600", "G0 X20", "G0 Z5")),
    ],
)
def test_a_rapid_that_goes_nowhere_goes_nowhere_in_the_corrected_program(still: str, lines: tuple[str, ...]) -> None:
    """Told once more where the tool is, before a cut or behind it: it stays as deep as the cut is corrected to."""
    text = "\n".join(["G21 G90 S12000 M3", "G0 X0 Y0 Z5", *lines, "G0 X30", "M2", ""])
    back = writing(SLOT.replace(source=rm.GCodeSource(text, "x.nc")), toolpath_to_gcode)
    c, wanted = np.zeros_like(back.moves.wanted.p), back.moves.wanted
    c[wanted.cutting | np.append(wanted.cutting[1:], False)] = [0.01e-3, 0.1e-3, -0.05e-3]
    made = interpret(back.write(c, 2e-6).text.encode())
    step = np.linalg.norm(np.diff(made.end, axis=0), axis=1)
    assert np.flatnonzero(step < 1e-9).tolist() == [lines.index(still)]
    low = made.end[made.end[:, 2] < 0.0]
    np.testing.assert_allclose(low[:, 1:], np.tile([0.1e-3, -2.05e-3], (len(low), 1)), atol=1e-9)
    assert len(low) == 3
