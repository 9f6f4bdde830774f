"""Where the samples lie."""

from __future__ import annotations

from pathlib import Path

from robomill.io import samples

ROOT = Path(__file__).resolve().parents[2]


def test_in_a_checkout_they_lie_beside_the_package() -> None:
    assert samples.app_dir() == ROOT
    assert samples.samples_dir() == ROOT / "samples"
    assert (samples.app_dir() / "app.py").is_file()


def test_in_a_wheel_they_lie_inside_the_package(tmp_path, monkeypatch) -> None:
    package = tmp_path / "site" / "robomill"
    (package / "io").mkdir(parents=True)
    monkeypatch.setattr(samples, "__file__", str(package / "io" / "samples.py"))
    assert samples.app_dir() == tmp_path / "site"
    (package / "_app").mkdir()
    assert samples.app_dir() == package / "_app"
    assert samples.samples_dir() == package / "_app" / "samples"
