"""OpenGL, which rendered pictures need and pip does not carry: what brings it, for each system."""

import platform
import sys
from collections.abc import Iterable

# Mesa's packages that draw without a screen, by the names that /etc/os-release gives a distribution and its parents.
INSTALL = {
    "debian": "apt-get install -y libegl1 libgl1-mesa-dri",
    "ubuntu": "apt-get install -y libegl1 libgl1-mesa-dri",
    "fedora": "dnf install -y mesa-libEGL mesa-dri-drivers",
    "rhel": "dnf install -y mesa-libEGL mesa-dri-drivers",
    "suse": "zypper install -y Mesa-libEGL1 Mesa-dri",
    "arch": "pacman -S --noconfirm mesa",
}
NEED = "Rendered pictures need an OpenGL library that this machine lacks"
ELSE = "Everything else works without it."


def no_opengl(system: str = sys.platform, distribution: Iterable[str] | None = None) -> str:
    """The refusal of a machine without OpenGL: what mends it there. ``distribution``: its names, the nearest first."""
    if system == "win32":
        mend = "install its graphics driver (Intel, AMD or NVIDIA; OpenGL 3.2 or newer)"
    elif system == "darwin":
        mend = "start robomill from a desktop session of this Mac, as macOS has OpenGL there only"
    else:
        names = _distribution() if distribution is None else distribution
        command = next((INSTALL[name] for name in names if name in INSTALL), "")
        mend = f"as root, run: {command}" if command else "install Mesa's EGL and its drivers with its package manager"
    return f"{NEED}; {mend}. {ELSE}"


def _distribution() -> list[str]:
    try:
        told = platform.freedesktop_os_release()
    except OSError:
        return []
    return [told.get("ID", ""), *told.get("ID_LIKE", "").split()]


def environment(system: str = sys.platform) -> dict[str, str]:
    """What VTK is told: on Linux EGL, with software as its fallback; its own choice would go through X11 and fail."""
    chosen = {"VTK_DEFAULT_OPENGL_WINDOW": "vtkEGLRenderWindow"} if system.startswith("linux") else {}
    return {**chosen, "PYVISTA_OFF_SCREEN": "true"}
