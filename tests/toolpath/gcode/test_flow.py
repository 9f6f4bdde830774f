"""O words, parameters and expressions, each against what the text says."""

from __future__ import annotations

import math

import pytest

from robomill.toolpath.gcode import interpret


def xs(text: str) -> list[float]:
    return [round(float(x) * 1e3, 9) for x in interpret("G21\n" + text + "\nM2\n").end[:, 0]]


def test_loops() -> None:
    assert xs("#1=0\nO1 while [#1 LT 3]\n#1=[#1+1]\nG0 X#1\nO1 endwhile") == [1, 2, 3]
    assert xs("#1=0\nO1 do\n#1=[#1+1]\nG0 X#1\nO1 while [#1 LT 3]") == [1, 2, 3]
    assert xs("G91\nO1 repeat [2]\nO2 repeat [2]\nG0 X1\nO2 endrepeat\nG0 X10\nO1 endrepeat") == [1, 2, 12, 13, 14, 24]
    assert xs("O1 while [0]\nG0 X1\nO1 endwhile\nG0 X2") == [2]


@pytest.mark.parametrize("times", [0, 1, 63, 200, -3])
def test_a_repeat_runs_as_often_as_it_says(times: int) -> None:
    assert xs(f"#1=0\nO1 repeat [{times}]\n#1=[#1+1]\nO1 endrepeat\nG0 X#1") == [max(times, 0)]


def test_break_and_continue() -> None:
    body = (
        "#1=0\nO1 while [1]\n#1=[#1+1]\nO2 if [#1 EQ 2]\nO1 continue\nO2 endif\nO3 if [#1 GT 3]\nO1 break\nO3 endif\n"
    )
    assert xs(body + "G0 X#1\nO1 endwhile") == [1, 3]


def test_branches() -> None:
    for value, expected in ((1, 10), (2, 20), (3, 30)):
        text = f"#1={value}\nO1 if [#1 EQ 1]\nG0 X10\nO1 elseif [#1 EQ 2]\nG0 X20\nO1 else\nG0 X30\nO1 endif"
        assert xs(text) == [expected]


def test_subroutines_keep_their_own_names_and_arguments() -> None:
    text = (
        "O<f> sub\n#<n>=#1\nO1 if [#<n> LE 1]\nO<f> return [1]\nO1 endif\nO<f> call [#<n>-1]\n"
        "O<f> endsub [#<n>*#<_value>]\n#1=99 #<n>=7\nO<f> call [5]\nG0 X#<_value>\nG0 X#1\nG0 X#<n>"
    )
    assert xs(text) == [120, 99, 7]
    assert xs("O1 sub\nG0 X#<n_args>\nO1 endsub\nO1 call [4] [5] [6]") == [3]
    assert xs("O1 call [3]\nM2\nO1 sub\nG0 X#1\nO1 endsub") == [3]


def test_left_over_flags_follow_the_reference_and_are_said() -> None:
    body = "O1 while [1]\nO1 break\nO1 endwhile\n#1=0\nO2 do\n#1=[#1+1]\nG0 X#1\nO2 while [#1 LT 3]\nM2\n"
    program = interpret(body)
    assert len(program) == 1
    assert any("does not loop as written" in f.message for f in program.findings)


@pytest.mark.parametrize(("inside", "kept"), [("", True), ("continue", True), ("break", False)])
def test_only_a_loop_that_could_be_broken_off_leaves_a_flag_behind(inside: str, kept: bool) -> None:
    """A while that ends by its condition, with a word in it that is never met; a do after it loops as written unless
    that word is break, as in the reference."""
    word = f"O2 if [0]\nO1 {inside}\nO2 endif\n" if inside else ""
    after = "#1=0\nO3 do\n#1=[#1+1]\nG0 X#1\nO3 while [#1 LT 3]"
    assert xs(f"#2=0\nO1 while [#2 LT 2]\n#2=[#2+1]\n{word}O1 endwhile\n{after}") == ([1, 2, 3] if kept else [1])


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2+3*4**2/8", 8),
        ("[2+3]*4", 20),
        ("2**3**2", 64),
        ("-2**2", 4),
        ("7 MOD 3", 1),
        ("[-7] MOD 3", 2),
        ("1 OR 0 AND 0", 0),
        ("1 AND [0 XOR 1]", 1),
        ("2 GT 1", 1),
        ("2 LE 1", 0),
        ("1 EQ 1.00001", 1),
        ("1 NE 2", 1),
        ("SIN[30]", 0.5),
        ("ATAN[1]/[-1]", 135),
        ("ACOS[0.5]", 60),
        ("FIX[-2.8]", -3),
        ("FUP[2.1]", 3),
        ("ROUND[2.5]", 3),
        ("ROUND[-2.5]", -3),
        ("LN[EXP[2]]", 2),
        ("SQRT[2]*SQRT[2]", 2),
        ("ABS[-3]", 3),
        ("10-3-2", 5),
        ("8/4/2", 1),
        ("1 - -1", 2),
        ("EXISTS[#<a>]", 0),
        ("EXISTS[#5]", 1),
    ],
)
def test_expressions(text: str, value: float) -> None:
    assert xs(f"G0 X[{text}]") == [pytest.approx(value)]


def test_whether_a_parameter_exists_is_one_or_nothing() -> None:
    said = "#<here>=9\n" + "\n".join(f"G0 X[EXISTS[{what}]]" for what in ("#<here>", "#<there>", "#1", "#0", "#5602"))
    assert xs(said)[:4] == [1, 0, 1, 0]


def test_parameters_are_set_after_their_line() -> None:
    assert xs("#1=1\n#1=8 #2=[#1*10]\nG0 X#1\nG0 X#2\n#1=3 G0 X#1\nG0 X#1") == [8, 10, 8, 3]
    assert xs("#3=4 #4=3\nG0 X##4\nG0 X#[1+2]") == [4, 4]


def test_provided_parameters() -> None:
    assert xs("G0 X3 Y4\nG0 X[#5420+#5421]\nG0 X[#<_x>+1]\nG20\nG0 X[#<_y>*25.4]") == [
        3,
        7,
        8,
        pytest.approx(4 * 25.4),
    ]
    assert xs("G0 X#<_metric>\nG0 X#<_plane>\nG0 X#<_motion_mode>\nG0 X#<_coord_system>") == [1, 170, 0, 540]
    assert xs("G10 L2 P3 X7\nG0 X#5261") == [7]


def test_order_of_execution_in_a_line() -> None:
    program = interpret("G21 F60\nG1 X1 G91 G20 F120 S600 M3 (all before the move)\nM2\n")
    assert program.end[0, 0] == pytest.approx(25.4e-3)
    assert program.v_f[0] == pytest.approx(2e-3)
    assert program.n_s[0] == pytest.approx(10)
    assert math.isclose(interpret("G0 Z1 G92.1 X1\n").end[0, 0], 1e-3)
