"""What consoles get: text that each can show, whatever its code page; what a code page lacks is spelled in ASCII.

The spelling is an error handler of the codecs, so it holds for everything that a stream writes: records, refusals,
argparse's help, warnings, tracebacks. A symbol of the field becomes its name (µm: um, 90°: 90 deg, θ: theta, 10⁻⁷:
10^-7), any other character its escape (ä: \\xe4), which is exact, as file names have to be.
"""

import codecs
import os
import sys
from contextlib import suppress
from typing import Any, TextIO

from robomill.errors import RobomillError
from robomill.wording import spelled

SPELLING = "robomill"
# Handlers that somebody chose (PYTHONIOENCODING=ascii:replace) stay; those that Python chooses itself do not.
OF_PYTHON = ("strict", "surrogateescape", "backslashreplace")

# Of what is shown, control characters (but tabs and line ends) would steer a terminal.
STEERING = {code: f"\\x{code:02x}" for code in (*range(9), *range(11, 32), *range(127, 160))}


def _escaped(character: str) -> str:
    return character.encode("ascii", "backslashreplace").decode()


def _spell(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return spelled(error.object, error.start, error.end, _escaped)


codecs.register_error(SPELLING, _spell)


def speak_plainly(*streams: Any) -> None:
    """From now on the streams (standard output and error) spell what their code page does not hold."""
    for stream in streams:
        if getattr(stream, "errors", None) in OF_PYTHON and hasattr(stream, "reconfigure"):
            stream.reconfigure(errors=SPELLING)


def shows_all(stream: Any) -> bool:
    """Whether the stream's code page holds every character."""
    with suppress(LookupError, TypeError, AttributeError):  # no stream at all, either
        return codecs.lookup(stream.encoding).name.startswith("utf")
    return False


def harmless(text: str) -> str:
    """``text`` without what would steer a terminal, and with the letters of names that the system gave as bytes."""
    with suppress(UnicodeEncodeError):
        text = text.encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")
    return text.translate(STEERING)


def one_line(text: str) -> str:
    """A sentence on one line, whatever the names in it hold."""
    return harmless(text.replace("\n", "\\n"))


def put(text: str, stream: TextIO | None) -> None:
    """Write a text and see that it arrives: at the end of the process nobody could say what went wrong.

    Whoever reads no further (``| head``) has what he wants. Raises RobomillError where nothing more can be written, and
    where the stream is closed (``>&-``) and there is something to say.
    """
    if stream is None:
        if text:
            raise RobomillError("standard output: it is closed, so nothing can be written; give it a place.")
        return
    try:
        stream.write(text)
        stream.flush()
    except BrokenPipeError:
        silence(stream)
    except OSError as exc:
        silence(stream)
        raise RobomillError(f"standard output: cannot be written ({exc.strerror}); give it another place.") from None


def silence(stream: TextIO | None) -> None:
    """Nobody reads the stream any more: what is still in it, or comes, goes nowhere and is no mistake."""
    with suppress(OSError, ValueError, AttributeError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())  # type: ignore[union-attr]


def refuse(sentence: object) -> None:
    """Say on standard error what is wrong."""
    with suppress(RobomillError):  # where nothing can be said, the exit code says it
        put(f"robomill: {one_line(str(sentence))}\n", sys.stderr)
