"""``robomill`` and ``python -m robomill`` are the command line, and this is its process: signals, code pages, crashes.

Exit codes beside those of the verbs: 130 interrupted at any time, 70 a mistake of robomill's own (``EX_SOFTWARE``).
"""

import os
import signal
import sys
from types import FrameType
from typing import NoReturn

from robomill.interrupts import heard

INTERRUPTED, CRASHED = 130, 70
DEBUG = "ROBOMILL_DEBUG"


def main() -> int:
    """Run the command line; returns the exit code, also of whoever interrupts while it loads, and of a crash."""
    heard.clear()
    signal.signal(signal.SIGINT, _interrupt)
    try:
        code = _run()
    except KeyboardInterrupt:
        code = INTERRUPTED
    except Exception as exc:
        code = CRASHED
        if not heard:  # some libraries make another exception of an interrupt
            _tell(exc)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # all is done or given up: nothing is left to be interrupted
    code = INTERRUPTED if heard else code
    heard.clear()
    return code


def _interrupt(number: int, frame: FrameType | None) -> None:
    heard.append(number)
    raise KeyboardInterrupt


def _run() -> int:
    from robomill.console import put, refuse, speak_plainly

    speak_plainly(sys.stdout, sys.stderr)
    from robomill.cli import main as run
    from robomill.errors import RobomillError

    try:
        code = run([word for word in sys.argv[1:] if word != "--debug"])
    except SystemExit as left:  # help, the version, and argparse's refusals
        code = left.code if isinstance(left.code, int) else 0
    try:
        put("", sys.stdout)
    except RobomillError as exc:
        refuse(exc)
        code = 2
    return code


def _tell(exc: Exception) -> None:
    """A sentence for whoever sees it, and the details in a file, or shown where that is asked for."""
    import tempfile
    import traceback

    from robomill.console import refuse

    details = "".join(traceback.format_exception(exc))
    if "--debug" in sys.argv[1:] or os.environ.get(DEBUG, "0") not in ("", "0"):
        print(details, end="", file=sys.stderr)
        where = "The details stand above."
    else:
        try:
            descriptor, name = tempfile.mkstemp(prefix="robomill-crash-", suffix=".txt")
            with open(descriptor, "w", encoding="utf-8", errors="backslashreplace") as file:
                file.write(f"{sys.argv!r}\nPython {sys.version}\n\n{details}")
            where = f"The details are in {name}; please send them to its makers."
        except OSError:
            where = f"Run it again with {DEBUG}=1 to see the details."
    if isinstance(exc, MemoryError):
        refuse(f"there is not enough memory for this; take coarser cells or steps. {where}")
    else:
        refuse(f"this is a mistake of robomill's own ({type(exc).__name__}), not of what you gave it. {where}")


def leave() -> NoReturn:
    """The process of the command line, to its end."""
    try:
        code = main()
    except KeyboardInterrupt:  # between what is done and what is said of it
        code = INTERRUPTED
    if code == INTERRUPTED:  # Python would end itself by the signal where it came in the midst of an import in C
        os._exit(code)
    raise SystemExit(code)


if __name__ == "__main__":
    leave()
