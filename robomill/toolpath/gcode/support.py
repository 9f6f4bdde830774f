"""What is read, what is left out and what is refused, as a table; every row holds the program that tests it."""

from dataclasses import dataclass
from typing import Literal

Status = Literal["read", "ignored", "refused"]


@dataclass(frozen=True)
class Support:
    """A row: the words, what they mean, and an ``example`` (in mm) that ends at ``end`` after ``moves`` moves.

    ``tools`` tells that the example needs a tool table.
    """

    words: str
    meaning: str
    status: Status
    example: str
    end: tuple[float, float, float] = (0.0, 0.0, 0.0)
    moves: int = 0
    dialect: str = "linuxcnc"
    tools: bool = False


def _row(
    words: str, meaning: str, example: str, end: tuple[float, float, float], moves: int, **more: object
) -> Support:
    return Support(words, meaning, "read", example, end, moves, **more)  # type: ignore[arg-type]


_TNC = "heidenhain"

SUPPORT: tuple[Support, ...] = (
    _row("G0 G1", "rapid and straight cut", "G0 X1 Y2\nG1 Z-3 F100", (1, 2, -3), 2),
    _row("G2 G3 I J K", "arcs and helices by centre", "F100\nG2 X10 Y10 I10 J0 Z-1", (10, 10, -1), 1),
    _row("G2 G3 R", "arcs by radius; negative: the larger arc", "F100\nG3 X10 Y10 R-10", (10, 10, 0), 1),
    _row("G2 G3 P", "arcs of several turns", "F100\nG3 I5 P3 Z-2", (0, 0, -2), 1),
    _row("G4 P", "dwell", "G4 P0.5\nG0 X1", (1, 0, 0), 1),
    _row("G5 G5.1", "splines, as straight pieces", "F100\nG5.1 X10 Y0 I5 J5", (10, 0, 0), 45),
    _row("G5.2 G5.3", "NURBS, as straight pieces", "F100\nG5.2 X1 Y3 P1\nX4 Y4 P1\nX8 Y0 P1\nG5.3", (8, 0, 0), 60),
    _row("G7 G8", "X as diameter or radius", "G7 G0 X10", (5, 0, 0), 1),
    _row("G10 L2", "place a coordinate system, R turns it", "G10 L2 P1 X5 R90\nG0 X10 Y0", (5, 10, 0), 1),
    _row("G10 L20", "let a coordinate system say where we are", "G0 X3\nG10 L20 P1 X0\nG0 X1", (4, 0, 0), 2),
    _row(
        "G10 L1 L10 L11",
        "change the tool table",
        "G10 L1 P3 R5 Z0\nT3 M6\nF9\nG41\nG1 X20\nX40",
        (40, 5, 0),
        2,
        tools=True,
    ),
    _row("G17 G18 G19", "planes", "F100 G18\nG2 X10 Z10 I10 K0", (10, 0, 10), 1),
    _row("G20 G21", "inch and mm", "G20 G0 X1", (25.4, 0, 0), 1),
    _row("G28 G30", "go to a stored point by way of the point given", "G28 X5 Z9", (0, 0, 0), 2),
    _row("G28.1 G30.1", "store the point", "G0 X2 Y3\nG30.1\nG0 X9\nG30", (2, 3, 0), 4),
    _row("G33", "feed in step with the spindle", "S60 M3\nG33 Z-5 K1", (0, 0, -5), 1),
    _row("G33.1", "rigid tapping, there and back", "S60 M3\nG33.1 Z-5 K1\nG0 X1", (1, 0, 0), 2),
    _row("G38.2 to G38.5", "probing: the probe is taken to travel its whole way", "F100\nG38.2 Z-5", (0, 0, -5), 1),
    _row("G40", "cutter compensation off", "F100\nG41.1 D2\nG1 X10\nX20\nG40\nG0 Y5", (20, 5, 0), 3),
    _row(
        "G41 G42 D",
        "cutter compensation with the tool table",
        "T1 M6\nF100\nG42\nG1 X10\nX20",
        (20, -1.5, 0),
        2,
        tools=True,
    ),
    _row("G41.1 G42.1 D", "cutter compensation with a diameter", "F100\nG41.1 D2\nG1 X10\nX20", (20, 1, 0), 2),
    _row(
        "G43 G43.1 G43.2 G49",
        "tool length: the tip goes where the program says",
        "T2 M6\nG43\nG0 Z5\nG49",
        (0, 0, 5),
        1,
        tools=True,
    ),
    _row("G52", "shift of all coordinate systems", "G52 X5\nG0 X1", (6, 0, 0), 1),
    _row("G53", "machine coordinates for one line", "G10 L2 P1 X5\nG53 G0 X1", (1, 0, 0), 1),
    _row("G54 to G59.3", "nine coordinate systems", "G10 L2 P9 Y7\nG59.3 G0 X1 Y0", (1, 7, 0), 1),
    _row(
        "G61 G61.1 G64",
        "exact path, exact stop, blending: the path is the programmed one",
        "G64 P0.1\nG0 X1",
        (1, 0, 0),
        1,
    ),
    _row("G73 G83 Q", "drilling in pecks", "F100\nG83 Z-4 R1 Q2", (0, 0, 1), 10),
    _row("G74 G84", "tapping with a floating chuck", "F100 S60 M3\nG84 X1 Z-4 R1", (1, 0, 1), 4),
    _row("G76", "thread in passes (lathe)", "S60 M3 G18\nG0 X10\nG76 P1 Z-5 I-1 J0.5 K1", (10, 0, -5), 10),
    _row("G80 to G82", "drilling, with a dwell", "F100\nG82 X1 Z-4 R1 P0.1\nG80", (1, 0, 1), 4),
    _row("G85 to G89", "boring", "F100\nG85 X1 Z-4 R1", (1, 0, 1), 5),
    _row("L", "repeats of a cycle", "F100 G91\nG81 X5 Z-4 R1 L3", (15, 0, 1), 10),
    _row("G90 G91", "absolute and incremental", "G91 G0 X1\nX1", (2, 0, 0), 2),
    _row("G90.1 G91.1", "arc centres absolute or incremental", "F9 G90.1\nG2 X10 Y10 I10 J0", (10, 10, 0), 1),
    _row("G92 G92.1 G92.2 G92.3", "shift so that we are where we say", "G0 X5\nG92 X0\nG0 X1\nG92.1", (6, 0, 0), 2),
    _row("G93 G94 G95", "feed: inverse time, per minute, per turn", "G93 G1 X10 F2", (10, 0, 0), 1),
    _row("G96 G97", "constant surface speed: the speed is then unknown", "G96 S100 D500 M3\nG0 X1", (1, 0, 0), 1),
    _row("G98 G99", "where cycles retract to", "F100 G0 Z9\nG98 G81 Z-4 R1", (0, 0, 9), 5),
    _row("M0 M1 M60", "stops: reading goes on", "M0\nG0 X1\nM1", (1, 0, 0), 1),
    _row("M2 M30 %", "ends of the program", "G0 X1\nM30\nG0 X9", (1, 0, 0), 1),
    _row("M3 M4 M5 S", "spindle", "S600 M3\nG0 X1\nM5", (1, 0, 0), 1),
    _row("M6 M61 T", "tools", "T2 M6\nG0 X1", (1, 0, 0), 1, tools=True),
    _row("M7 M8 M9", "coolant", "M8\nG0 X1\nM9", (1, 0, 0), 1),
    _row("M19 M48 to M53", "orientation and overrides: nothing moves", "M49\nG0 X1\nM48", (1, 0, 0), 1),
    _row("M70 to M73", "keep and restore modes", "M70\nG91\nM72\nG0 X1\nX1", (1, 0, 0), 2),
    _row("M98 M99", "subprograms O1000", "M98 P7 L2\nM2\nO7\nG91 G0 X1\nM99", (2, 0, 0), 2, dialect="fanuc"),
    _row("A B C", "rotary axes: A and B tilt the tool", "G0 A10 B-5 C3\nG0 X1", (1, 0, 0), 2),
    _row("@ ^", "polar words", "G0 @10 ^90", (0, 10, 0), 1),
    _row("( ) ; / N", "comments, block delete (off), line numbers", "N10 (a) G0 X1 ; b\n/ G0 Y2", (1, 2, 0), 2),
    _row("#1 #<name>", "parameters", "#1=4 #<a>=[#1+1]\n#<a>=[#1*2]\nG0 X#<a>", (8, 0, 0), 1),
    _row("[ ]", "expressions and functions", "G0 X[2+3*4**0.5] Y[SIN[30]*2] Z[ATAN[1]/[1]]", (8, 1, 45), 1),
    _row(
        "O sub call return",
        "subroutines with arguments and values",
        "O1 sub\nG0 X#1\nO1 endsub [7]\nO1 call [5]\nG0 Y#<_value>",
        (5, 7, 0),
        2,
    ),
    _row("O if elseif else", "branches", "O1 if [1 GT 2]\nG0 X1\nO1 else\nG0 X2\nO1 endif", (2, 0, 0), 1),
    _row(
        "O while do repeat break continue",
        "loops",
        "#1=0\nO1 while [#1 LT 3]\n#1=[#1+1]\nO1 endwhile\nG0 X#1",
        (3, 0, 0),
        1,
    ),
    Support("M62 to M68", "inputs and outputs", "ignored", "M64 P1\nG0 X1", (1, 0, 0), 1),
    Support("M100 to M199", "M codes that users of a machine make", "ignored", "M101\nG0 X1", (1, 0, 0), 1),
    Support("other M codes", "counted", "ignored", "M36\nG0 X1", (1, 0, 0), 1),
    Support("other G codes", "they may move the machine", "refused", "G130 X1"),
    Support("G70 to G72", "lathe roughing", "refused", "G71 Q100 X5 Z5 D1"),
    Support("U V W, G17.1", "axes that the machine lacks", "refused", "G0 U1"),
    _row("G68 G69", "rotation in the plane G17", "G68 X0 Y0 R90\nG0 X5\nG69", (0, 5, 0), 1, dialect="fanuc"),
    _row("G31", "probing, as G38.2", "F100\nG31 Z-5.", (0, 0, -5), 1, dialect="fanuc"),
    _row("G15 G16", "X and Y as radius and angle", "G16\nG0 X5 Y90\nG15", (0, 5, 0), 1, dialect="fanuc"),
    _row(
        "G70 G71 with a cycle",
        "holes on a circle (Haas)",
        "F9 G0 Z9\nG99 G81 Z-5 R2 L0\nG70 I5 J90 L1",
        (0, 5, 2),
        5,
        dialect="fanuc",
    ),
    _row(
        "G72 with a cycle",
        "holes in a row (Haas)",
        "F9 G0 Z9\nG99 G81 Z-5 R2 L0\nG72 X3 I5 J90 L2",
        (3, 5, 2),
        8,
        dialect="fanuc",
    ),
    _row(
        "G100 T",
        "fetches a tool and brings it to a place (Brother)",
        "G100 T2 X5 Y4 G43 Z3 L1 H2 S9 M3",
        (5, 4, 3),
        2,
        dialect="fanuc",
    ),
    _row(",R ,C", "rounded and chamfered corners", "G1 X9 ,R2 F9\nY9", (9, 9, 0), 3, dialect="fanuc"),
    _row(
        "M97",
        "part of a program by its line",
        "M97 P5 L2\nM2\nN5 G91 G0 X1\nM99",
        (2, 0, 0),
        2,
        dialect="fanuc",
    ),
    _row(
        "IF GOTO WHILE DO END",
        "branches and loops of Macro B",
        "#1=0\nWHILE [#1 LT 3] DO1\n#1=#1+1\nEND1\nG0 X#1",
        (3, 0, 0),
        1,
        dialect="fanuc",
    ),
    _row("G51 G50", "scaled coordinates", "G51 X0 Y0 P2.\nG0 X5\nG50", (10, 0, 0), 1, dialect="fanuc"),
    _row("G51.1 G50.1", "mirrored coordinates", "G51.1 X0\nG0 X5\nG50.1 X0", (-5, 0, 0), 1, dialect="fanuc"),
    _row(
        "G65 G66 G67",
        "macros with values",
        "G65 P9 X5 L2\nM30\nO9\nG91 G0 X#24\nM99",
        (10, 0, 0),
        2,
        dialect="fanuc",
    ),
    _row(
        "G54.1 P, G154 P, G54 P",
        "further coordinate systems",
        "G10 L20 P3 X5\nG54.1 P3 G0 X1",
        (6, 0, 0),
        1,
        dialect="fanuc",
    ),
    _row("G68.2 G53.1", "tilted planes", "G68.2 I0 J90 K0\nG53.1\nG0 X1 Y2 Z3", (1, 2, 3), 1, dialect="fanuc"),
    _row(
        "CYCLE800",
        "tilted planes",
        'CYCLE800(1,"TC1",0,57,0,0,0,0,90,0,0,0,0,1)\nG0 X1 Y2 Z3',
        (1, 2, 3),
        1,
        dialect="sinumerik",
    ),
    _row("A3= B3= C3=", "direction of the tool", "G0 X1 A3=0 B3=0 C3=1", (1, 0, 0), 1, dialect="sinumerik"),
    _row("AC( ) IC( )", "places and steps", "G91\nG0 X=AC(4)\nG90\nX=IC(1)", (5, 0, 0), 2, dialect="sinumerik"),
    _row("R1= X=R1*2", "R parameters and expressions", "R1=2\nG0 X=R1*2+1", (5, 0, 0), 1, dialect="sinumerik"),
    _row("GOTOF GOTOB IF", "jumps", "IF 1<2 GOTOF L_A\nG0 X9\nL_A: G0 X1", (1, 0, 0), 1, dialect="sinumerik"),
    _row("TRANS ATRANS ROT AROT", "shifts and turns", "TRANS X5\nG0 X1", (6, 0, 0), 1, dialect="sinumerik"),
    _row("G63", "tapping in a chuck that gives", "S60 M3 F60 G0 Z9\nG63 Z-5", (0, 0, -5), 2, dialect="sinumerik"),
    _row("RND= CHF= CHR=", "corners", "G1 X9 RND=2 F9\nY9", (9, 9, 0), 3, dialect="sinumerik"),
    _row("CYCLE81 to 86, MCALL", "drilling", "F9 G0 Z9\nCYCLE81(9,0,1,-5)", (0, 0, 9), 4, dialect="sinumerik"),
    _row(
        "HOLES1 HOLES2 CYCLE801 CYCLE802",
        "patterns of holes",
        "F9 G0 Z9\nMCALL CYCLE81(9,0,1,-5)\nCYCLE801(0,0,0,5,5,2,2)",
        (0, 5, 9),
        17,
        dialect="sinumerik",
    ),
    _row(
        "G110 to G112, AP= RP= AR=",
        "polar places, arcs by their angle",
        "G111 X1 Y0\nG0 AP=90 RP=5",
        (1, 5, 0),
        1,
        dialect="sinumerik",
    ),
    _row("ANG=", "straight cuts by their angle", "G1 X9 ANG=45 F9", (9, 9, 0), 1, dialect="sinumerik"),
    Support("G147 to G348, DISR=", "soft approaches", "refused", "G1 F9\nG147 DISR=5 X5", dialect="sinumerik"),
    _row("RNDM=", "every corner rounded", "RNDM=2\nG1 X9 F9\nY9\nRNDM=0", (9, 9, 0), 3, dialect="sinumerik"),
    _row(
        "PROC NAME(REAL A), VAR, SAVE",
        "subprograms with values",
        "STEP(3)\nM30\nPROC STEP(REAL LEN)\nG0 X=LEN\nM17",
        (3, 0, 0),
        1,
        dialect="sinumerik",
    ),
    Support(
        "POCKET SLOT LONGHOLE CYCLE60 to 79, 90, 840",
        "passes that the control plans",
        "refused",
        "POCKET4(50,0,1,-5,20,0,0)",
        dialect="sinumerik",
    ),
    _row(
        "L100 P2, names, M17, RET",
        "subprograms in the same file",
        "L7 P2\nM30\n%_N_L7_SPF\nG91 G0 X1\nM17",
        (2, 0, 0),
        2,
        dialect="sinumerik",
    ),
    _row(
        "CR= X= G70 G71 MSG",
        "basics of Sinumerik",
        'G71\nG0 X=5\nG2 X10 Y5 CR=5 F100\nMSG("x")',
        (10, 5, 0),
        2,
        dialect="sinumerik",
    ),
    _row(
        "L, C, CC, CR, CP, LP, CT",
        "moves",
        "L X+10 Y+0 FMAX\nCC X+0 Y+0\nC X+0 Y+10 DR+ F99",
        (0, 10, 0),
        2,
        dialect=_TNC,
    ),
    _row("RND, CHF", "corners", "L X+9 F99\nRND R2\nL Y+9", (9, 9, 0), 3, dialect=_TNC),
    _row("LBL, CALL LBL, REP", "labels", "LBL 1\nL IX+5 F99\nCALL LBL 1 REP 2", (15, 0, 0), 3, dialect=_TNC),
    _row("FN 0 to 7, 9 to 12, Q", "Q parameters and jumps", "FN 0: Q1 = +5\nL X+Q1 F99", (5, 0, 0), 1, dialect=_TNC),
    _row("CYCL DEF 7, 10", "shifts and turns", "CYCL DEF 7.1 X+5\nL X+1 F99", (6, 0, 0), 1, dialect=_TNC),
    _row(
        "CYCL DEF 200 to 209, 240, CYCL CALL, M99",
        "drilling, bore milling",
        "L Z+9 FMAX M3\nCYCL DEF 200 ~\nQ200=2 ~\nQ201=-5 ~\nQ206=99\nL X+1 FMAX M99",
        (1, 0, 2),
        5,
        dialect=_TNC,
    ),
    _row(
        "TOOL CALL, M91, M140",
        "tools, places in the machine",
        "TOOL CALL 1 Z S9\nL X+1 FMAX",
        (1, 0, 0),
        1,
        dialect=_TNC,
    ),
    _row(
        "APPR, DEP LT LN CT LCT",
        "to a contour and away from it",
        "L X-9 F99\nAPPR LT X+1 Y+0 LEN5 R0\nL X+9\nDEP LT LEN2",
        (11, 0, 0),
        5,
        dialect=_TNC,
    ),
    _row(
        "CYCL DEF 8, 220, 221",
        "mirror images, patterns of holes",
        "CYCL DEF 8.1 X\nL X+1 F99",
        (-1, 0, 0),
        1,
        dialect=_TNC,
    ),
    _row("CYCL DEF 11, 26", "scales", "CYCL DEF 11.1 SCL 0.5\nL X+4 F99", (2, 0, 0), 1, dialect=_TNC),
    _row(
        "PLANE SPATIAL EULER VECTOR RELATIV RESET, CYCL DEF 19",
        "tilted planes",
        "PLANE SPATIAL SPA+0 SPB+90 SPC+0 TURN\nL X+1 Y+2 Z+3 FMAX",
        (1, 2, 3),
        1,
        dialect=_TNC,
    ),
    _row(
        "DIN/ISO: G00 to G03, G06, G10 to G13, I J K, R H, G24, G25, G40 to G42, G98 L, L1,2, D00 to D13, G54, G73",
        "Heidenhain's programs in G code, with cycles from G200 on",
        "%A G71 *\nN1 G00 X+1*\nN2 G91 X+1*",
        (2, 0, 0),
        2,
        dialect=_TNC,
    ),
    Support("FL, other PLANE, other cycles", "of Heidenhain", "refused", "FL X+1 LEN5", dialect=_TNC),
    _row("$ lines", "settings of grbl are left out", "$10=1\nG0 X1", (1, 0, 0), 1, dialect="grbl"),
    Support(
        "G81, G90.1, G95, A, #1, [ ], ...", "what grbl 1.1 does not know", "refused", "G81 X1 Z-1 R1", dialect="grbl"
    ),
    Support("$H $J", "grbl's own motion", "refused", "$H\nG0 X1", dialect="grbl"),
)
"""The table: what a page shows, and what the tests run."""

DIFFERENCES: tuple[str, ...] = (
    "A program may end without M2, M30 or %: LinuxCNC stops with an error, here it is a finding.",
    "M codes that LinuxCNC does not know are counted as ignored; G codes that it does not know stop the reading.",
    "Lines may be longer than 255 characters.",
    "Without a tool table every tool is accepted, of unknown size; G41 and G42 then need one.",
    "Lathe roughing G70, G71, G72, the axes U, V, W and arcs in G18 or G19 of a rotated system are refused.",
    "A condition after ELSEIF is reckoned only if no branch before it was taken.",
    "A G1, G2 or G3 without a feed rate is refused, as on the machine; LinuxCNC's preview takes a feed of 1.",
    "Probing is taken to travel its whole way and to touch nothing.",
    "Homes (G28, G30) and places in the machine (G53) are not known: the path stands clear of the part there.",
    "Holes in G91 behind one in G90 keep its R and depth, as on Fanuc and Haas, unless LinuxCNC is stated.",
    "Loops end after 1.3 s of computing or a million lines; what is not at its end by then is refused with its size.",
    "What LinuxCNC refuses and other controls run (axis words after G80, G0 beside G28) is read unless it is stated.",
)
"""Where reading differs from LinuxCNC 2.9, by design."""
