"""Where the samples lie: beside the package in a checkout, inside it in an installed wheel."""

from pathlib import Path


def app_dir() -> Path:
    """Folder that holds app.py, pages/, samples/ and .streamlit/."""
    package = Path(__file__).resolve().parent.parent
    installed = package / "_app"
    return installed if installed.is_dir() else package.parent


def samples_dir() -> Path:
    """Folder of the samples: robots/, materials/ and one folder a case."""
    return app_dir() / "samples"
