"""Refusals. Each says where, what was found, what was expected and what to do, in one sentence.

Pages and the command line catch ``RobomillError`` only; anything else is a bug and must be seen.
"""

import re

_ENDLESS, _SHOWN = re.compile(r"\S{300,}"), 100


class RobomillError(ValueError):
    """Input that robomill refuses. ``str(error)`` is the sentence a person reads.

    ``where`` names the place (file, line, cell, joint, field) as data, for whoever wants to jump there. A word of
    hundreds of characters is not quoted to its end.

    Examples
    --------
    >>> import robomill as rm
    >>> try:
    ...     rm.load_robot("nobody")
    ... except rm.RobomillError as refusal:
    ...     print(refusal.where)
    nobody
    """

    def __init__(self, message: str, *, where: str | None = None) -> None:
        super().__init__(_ENDLESS.sub(lambda word: f"{word[0][:_SHOWN]}…", message))
        self.where = where


class ArgumentError(RobomillError, TypeError):
    """An argument that a function or class does not take, or one that it lacks: Python's TypeError, and a refusal."""


class NumberError(RobomillError):
    """A text that is no number, or no single one, of the unit it is typed in."""


class RobotError(RobomillError):
    """A robot that cannot be: its table, limits, frames or compliances."""


class KinematicsError(RobomillError):
    """A configuration or pose that cannot be evaluated (shape, NaN, wrong number of joints)."""


class ToolpathError(RobomillError):
    """A path that cannot be followed: no points, no motion, not finite."""


class UnitAskedError(ToolpathError):
    """Numbers of a file that does not say their unit: whoever knows it has to say it."""


class GCodeError(ToolpathError):
    """A program refused at a line. ``line`` is the 1-based source line, 0 for the whole file."""

    def __init__(self, message: str, *, line: int = 0) -> None:
        super().__init__(message, where=f"line {line}" if line else None)
        self.line = line

    @classmethod
    def at(cls, line: int, message: str) -> "GCodeError":
        """The refusal of a line, which is named first."""
        return cls(f"Line {line}: {message}", line=line)


class CuttingError(RobomillError):
    """A cutter, material, force or engagement that makes no sense."""


class SurfaceError(RobomillError):
    """A stock, cell size or cut that cannot be computed."""


class SetupError(RobomillError):
    """A simulation set-up that cannot be run."""


class CompensationError(RobomillError):
    """A path that is not corrected: its prediction is not to be trusted, or no correction is found."""


class StudyError(RobomillError):
    """A study that cannot be run, or that stops before its end: what is finished is kept."""


class LoadTestError(RobomillError):
    """Measurements that cannot be read or identified from."""


class WorkspaceError(RobomillError):
    """A grid or map that cannot be computed."""


class LearnError(RobomillError):
    """A student number, an exercise or a file of answers that cannot be used."""


class ProjectError(RobomillError):
    """A project file that cannot be opened."""


class RenderError(RobomillError):
    """A picture that could not be drawn, and why. ``again_s``: after so many seconds it may be asked for again."""

    def __init__(self, message: str, *, again_s: float | None = None) -> None:
        super().__init__(message)
        self.again_s = again_s


class MissingExtraError(RobomillError):
    """Something that is installed with an ``extra`` only (``pip install "robomill[extra]"``), and is not here."""

    def __init__(self, message: str, *, extra: str = "") -> None:
        super().__init__(message)
        self.extra = extra
