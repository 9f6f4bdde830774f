"""What mends a machine without OpenGL, system by system."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from robomill.viz.rendered import graphics
from robomill.viz.rendered.graphics import environment, no_opengl


@pytest.mark.parametrize(
    ("system", "names", "said"),
    [
        ("linux", ["debian"], "as root, run: apt-get install -y libegl1 libgl1-mesa-dri."),
        ("linux", ["linuxmint", "ubuntu", "debian"], "as root, run: apt-get install -y libegl1 libgl1-mesa-dri."),
        ("linux", ["fedora"], "as root, run: dnf install -y mesa-libEGL mesa-dri-drivers."),
        ("linux", ["rocky", "rhel", "centos", "fedora"], "as root, run: dnf install -y mesa-libEGL mesa-dri-drivers."),
        ("linux", ["opensuse-leap", "suse", "opensuse"], "as root, run: zypper install -y Mesa-libEGL1 Mesa-dri."),
        ("linux", ["nobody-knows"], "install Mesa's EGL and its drivers with its package manager."),
        ("linux", [], "install Mesa's EGL and its drivers with its package manager."),
        ("darwin", [], "from a desktop session of this Mac"),
        ("win32", [], "install its graphics driver"),
    ],
)
def test_the_sentence_names_what_mends_this_system(system: str, names: list[str], said: str) -> None:
    text = no_opengl(system, names)
    assert said in text
    assert ("apt-get" in text) == ("debian" in names)
    assert text.endswith("Everything else works without it.")


def test_this_machine_is_known_by_its_own_word(monkeypatch: pytest.MonkeyPatch) -> None:
    release = {"ID": "nobara", "ID_LIKE": "fedora"}
    monkeypatch.setattr(graphics.platform, "freedesktop_os_release", lambda: release)
    assert "dnf install" in no_opengl("linux")

    def none() -> dict[str, str]:
        raise OSError

    monkeypatch.setattr(graphics.platform, "freedesktop_os_release", none)
    assert "its package manager" in no_opengl("linux")


def test_egl_is_asked_for_where_there_is_one() -> None:
    assert environment("linux")["VTK_DEFAULT_OPENGL_WINDOW"] == "vtkEGLRenderWindow"
    assert "VTK_DEFAULT_OPENGL_WINDOW" not in environment("win32")
    assert "VTK_DEFAULT_OPENGL_WINDOW" not in environment("darwin")


def test_the_set_up_script_and_the_container_install_the_same() -> None:
    packages = graphics.INSTALL["debian"].partition("-y ")[2]
    root = Path(__file__).resolve().parents[3]
    for name in ("Dockerfile", ".ci/run"):
        assert packages in re.sub(r"\s+", " ", (root / name).read_text())
