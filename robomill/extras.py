"""What ``pip install robomill`` leaves out: which extra brings it, and the sentence that says so."""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec

from robomill.errors import MissingExtraError

# Module -> what it is installed as, and the extra that brings it.
BROUGHT_BY = {
    "streamlit": ("streamlit", "app"),
    "plotly": ("plotly", "app"),
    "segno": ("segno", "app"),
    "pandas": ("pandas", "data"),
    "xarray": ("xarray", "data"),
    "pyarrow": ("pyarrow", "data"),
    "distributed": ("distributed", "study"),
    "pyvista": ("pyvista", "render"),
    "matplotlib": ("matplotlib", "plot"),
    "PIL": ("pillow", "render"),
    "imageio_ffmpeg": ("imageio-ffmpeg", "film"),
    "ezdxf": ("ezdxf", "drawing"),
    "svgelements": ("svgelements", "drawing"),
    "cssselect2": ("cssselect2", "drawing"),
    "shapely": ("shapely", "drawing"),
}


@contextmanager
def needed(what: str) -> Iterator[None]:
    """Imports that ``what`` (the first words of a sentence) needs. Raises MissingExtraError where one is not installed.

    >>> with needed("A table as Parquet"):
    ...     import pyarrow
    """
    try:
        yield
    except ModuleNotFoundError as exc:
        package = (exc.name or "").partition(".")[0]
        if package not in BROUGHT_BY or find_spec(package) is not None:
            raise
        raise _refusal(what, package, BROUGHT_BY[package][1]) from None


def missing(what: str, extra: str, *modules: str) -> MissingExtraError | None:
    """What ``needed`` raises where one of the ``modules`` of an extra is not installed; None where all are."""
    absent = [module for module in modules if find_spec(module) is None]
    return _refusal(what, absent[0], extra) if absent else None


def _refusal(what: str, module: str, extra: str) -> MissingExtraError:
    name = BROUGHT_BY[module][0]
    text = f'{what} needs {name}, which is not installed here; get it with: pip install "robomill[{extra}]"'
    return MissingExtraError(text, extra=extra)
