"""What is said of G words that no control's reader takes: what they do where that is known, and what to do instead."""

from robomill.toolpath.gcode.codes import g_name

_OUT, _READ, _CHOOSE = "let the CAM system write its moves out", "which is read for", "choose that dialect"

_NAMED = {
    **{code: f"G{code // 10} mills a circular pocket (Haas), which is not read; {_OUT}." for code in (120, 130)},
    62: f"G6.2 makes a NURBS curve (Fanuc), which is not read; {_OUT}.",
    1500: f"G150 mills a pocket (Haas), which is not read; {_OUT}.",
    **{n: f"{g_name(n)} wraps a path about a cylinder, which is not read; {_OUT}." for n in (71, 1070)},
    **{n: f"{g_name(n)} is of polar interpolation, which is not read; {_OUT}." for n in (121, 131)},
    310: f"G31 goes until a probe or another signal stops it, {_READ} Fanuc-like controls, without P and Q; {_OUT}.",
    370: "G37 measures a tool, which ends where the machine finds it; remove the line.",
    2540: "G254 lets the part's place follow the rotary table (Haas), which is not read; let the CAM system follow it.",
    **{
        code: f"G{code // 10} makes holes on {places} (Haas) or is a lathe's cycle, which is not read; {_OUT}."
        for code, places in ((700, "a circle"), (710, "an arc"), (720, "a line"))
    },
    630: f"G63 taps with a compensating chuck (Sinumerik), {_READ} that alone; {_CHOOSE}.",
    470: f"G47 engraves text (Haas), which is not read; {_OUT}.",
    510: f"G51 scales coordinates, {_READ} Fanuc-like controls alone; {_CHOOSE}.",
    511: f"G51.1 mirrors coordinates, {_READ} Fanuc-like controls alone; {_CHOOSE}.",
    682: f"G68.2 tilts the working plane, {_READ} Fanuc-like controls alone; {_CHOOSE}.",
    **{n: f"G{n // 10} sets a pole, {_READ} Sinumerik controls alone; {_CHOOSE}." for n in (1100, 1110, 1120)},
    650: f"G65 calls a macro with values, {_READ} Fanuc-like controls alone; {_CHOOSE}.",
    660: f"G66 calls a macro at every point, {_READ} Fanuc-like controls alone; {_CHOOSE}.",
}


def not_read(code: int) -> str:
    """Why a G word, ten times its number, is refused."""
    return _NAMED.get(code, f"{g_name(code)} is not known; it may move the machine, so reading stops here.")
