"""The numbers under the pictures of the start page are those that a run gives, and the pictures are light."""

from __future__ import annotations

import base64

import numpy as np
import pytest
from PIL import Image

from robomill.simulation.run import simulate
from robomill.ui.project import preset_setup, presets
from robomill.ui.start.carved import Carved, carved

TIMES, ROWS = carved()


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.sample)
def test_the_number_is_that_of_a_run_of_the_sample(row: Carved) -> None:
    assert row.sample in presets()
    verdict = simulate(preset_setup(row.sample)).verdict
    assert verdict.deciding is not None
    rests = verdict.deciding[1]
    assert row.value == pytest.approx(abs(rests.value), abs=0.6e-7)
    assert row.tolerance == rests.tolerance
    assert row.level == verdict.level


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.sample)
def test_the_picture_is_small_and_clear_beside_the_part(row: Carved, dark: bool) -> None:
    head, _, held = row.address(dark).partition(",")
    assert (head, base64.b64decode(held)) == ("data:image/webp;base64", row.picture(dark).read_bytes())
    assert row.picture(dark).stat().st_size < 60_000
    picture = Image.open(row.picture(dark))
    assert picture.mode == "RGBA"
    alpha = picture.getchannel("A")
    assert alpha.getpixel((0, 0)) == 0
    assert alpha.getpixel((picture.width // 2, picture.height // 2)) == 255


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.sample)
def test_on_a_dark_page_the_part_is_darker(row: Carved) -> None:
    light, dark = (Image.open(row.picture(each)) for each in (False, True))
    grey = [np.asarray(each.convert("LA"), dtype=float) for each in (light, dark)]
    bright, dim = (float(each[..., 0][each[..., 1] > 250].mean()) for each in grey)
    assert dim < 0.75 * bright


def test_six_and_each_once() -> None:
    assert len(ROWS) == len({row.sample for row in ROWS}) == 6
