"""The numbers under the pictures of the start page are those that a run gives, and the pictures are light."""

from __future__ import annotations

import base64

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


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.sample)
def test_the_picture_is_small_and_clear_beside_the_part(row: Carved) -> None:
    head, _, held = row.address.partition(",")
    assert (head, base64.b64decode(held)) == ("data:image/webp;base64", row.picture.read_bytes())
    assert row.picture.stat().st_size < 60_000
    picture = Image.open(row.picture)
    assert picture.mode == "RGBA"
    alpha = picture.getchannel("A")
    assert alpha.getpixel((0, 0)) == 0
    assert alpha.getpixel((picture.width // 2, picture.height // 2)) == 255


def test_six_and_each_once() -> None:
    assert len(ROWS) == len({row.sample for row in ROWS}) == 6
