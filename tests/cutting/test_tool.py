"""Cutters: shape against closed forms, and one sentence for each cutter that cannot be."""

import math

import numpy as np
import pytest

from robomill.cutting.tool import FAMILIES, Cutter
from robomill.errors import CuttingError
from robomill.quantities import quantities
from robomill.units import to_si

FLAT = Cutter("flat", 8e-3, flutes=3)
BALL = Cutter("ball", 8e-3)
BULL = Cutter("bull", 8e-3, corner_radius=1e-3)
CHAMFER = Cutter("chamfer", 8e-3, tip_angle=math.pi / 2, tip_diameter=2e-3)
ALL = [FLAT, BALL, BULL, CHAMFER]


def test_profiles_at_known_radii():
    r = np.array([0.0, 1e-3, 3e-3, 4e-3])
    np.testing.assert_array_equal(FLAT.profile(r), 0.0)
    np.testing.assert_allclose(BALL.profile(r), 4e-3 - np.sqrt(16e-6 - r**2), atol=1e-18)
    np.testing.assert_allclose(BULL.profile(r), [0.0, 0.0, 0.0, 1e-3], atol=1e-18)
    np.testing.assert_allclose(CHAMFER.profile(r), [0.0, 0.0, 2e-3, 3e-3], atol=1e-18)


@pytest.mark.parametrize("cutter", ALL, ids=lambda c: c.kind)
def test_profile_is_infinite_outside_and_keeps_the_shape(cutter):
    r = np.array([[-1e-6, 0.0], [4e-3, 4.0001e-3]])
    height = cutter.profile(r)
    assert height.shape == r.shape
    np.testing.assert_array_equal(np.isinf(height), [[True, False], [False, True]])
    assert height[1, 0] == pytest.approx(cutter.nose_height, abs=1e-18)
    assert np.ndim(cutter.profile(1e-3)) == 0


@pytest.mark.parametrize("cutter", [BALL, BULL, CHAMFER], ids=lambda c: c.kind)
def test_radius_at_inverts_the_profile(cutter):
    r = np.linspace(cutter.flat_radius, cutter.radius, 40)
    np.testing.assert_allclose(cutter.radius_at(cutter.profile(r)), r, atol=1e-15)
    assert cutter.radius_at(1.0) == cutter.radius
    assert np.isnan(cutter.radius_at(-1e-9))


def test_a_bull_nose_between_flat_and_ball():
    r = np.linspace(0, 4e-3, 30)
    np.testing.assert_allclose(Cutter("bull", 8e-3, corner_radius=4e-3).profile(r), BALL.profile(r), atol=1e-18)
    assert np.all(BULL.profile(r) <= BALL.profile(r) + 1e-18)


def test_pull_depends_on_helix_against_hand():
    assert FLAT.pull == 1
    assert FLAT.replace(helix="left").pull == -1
    assert FLAT.replace(helix="left", hand="left").pull == 1
    assert FLAT.replace(helix_angle=0.0).pull == 0


def test_ball_is_settled_and_can_be_replaced():
    assert BALL.corner_radius == 4e-3
    assert BALL.replace(diameter=6e-3).corner_radius == 3e-3
    assert BALL.replace(flutes=4) == Cutter("ball", 8e-3, corner_radius=4e-3, flutes=4)


def test_a_copy_keeps_the_corner_that_is_not_changed():
    assert BULL.replace(diameter=6e-3) == Cutter("bull", 6e-3, corner_radius=1e-3)
    assert CHAMFER.replace(flutes=3) == Cutter("chamfer", 8e-3, tip_angle=math.pi / 2, tip_diameter=2e-3, flutes=3)
    assert BALL.replace(kind="bull", corner_radius=2e-3) == Cutter("bull", 8e-3, corner_radius=2e-3)


def test_title():
    assert FLAT.title == "8.00 mm flat end mill, 3 flutes"


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"kind": "saw"}, f"Cutter, Kind: found 'saw'; expected {' or '.join(', '.join(FAMILIES).rsplit(', ', 1))}."),
        ({"flutes": 0}, "Cutter, Flutes: found 0; expected 1 to 100."),
        ({"flutes": 2.5}, "Flutes: found 2.5; expected a whole number, 1 to 100"),
        ({"flutes": 100_000}, "Flutes: found 100\u202f000; expected 1 to 100"),
        ({"flutes": "three"}, "Flutes: found 'three'"),
        ({"flutes": math.inf}, "Flutes: found inf"),
        ({"diameter": 0.0}, "Cutter, Diameter: found 0 mm; expected 0.001 mm to 2000 mm."),
        ({"diameter": -8e-3}, "Diameter: found −8 mm"),
        ({"diameter": math.nan}, "Diameter: found nan"),
        ({"diameter": "8 mm"}, "Diameter: found '8 mm'; expected 0.001 mm to 2000 mm"),
        ({"diameter": None}, "Diameter: found nothing"),
        ({"corner_radius": 1e-3}, "A flat end mill has no corner radius"),
        ({"kind": "bull", "corner_radius": 5e-3}, "larger than the cutter's radius 4.000 mm"),
        ({"kind": "bull"}, "needs a corner radius"),
        ({"kind": "bull", "corner_radius": -1e-3}, "Corner radius: found −1 mm; expected 0 mm or more"),
        ({"kind": "ball", "corner_radius": 1e-3}, "leave it out or choose a bull-nose mill"),
        ({"flute_length": -1e-3}, "Flute length: found −1 mm; expected more than 0 mm, or left out"),
        ({"stick_out": 0.0}, "Stick-out: found 0 mm"),
        ({"flute_length": 30e-3, "stick_out": 20e-3}, "longer than the stick-out"),
        ({"helix_angle": to_si(95.0, "deg")}, "Helix angle: found 95°; expected 0° to less than 85°"),
        ({"helix_angle": -0.5}, "Helix angle: found −28.6479°"),
        ({"helix": "up"}, "Helix: found 'up'; expected right or left"),
        ({"hand": 1}, "Hand: found 1; expected right or left"),
        ({"kind": "chamfer"}, "needs a tip angle"),
        (
            {"kind": "chamfer", "tip_angle": math.pi},
            "Full tip angle: found 180°; expected more than 0° to less than 180°",
        ),
        ({"kind": "chamfer", "tip_angle": 1.0, "tip_diameter": 8e-3}, "less than the cutter's diameter"),
        ({"tip_angle": 1.0}, "has no tip angle"),
    ],
)
def test_refusals(fields, sentence):
    with pytest.raises(CuttingError) as refusal:
        Cutter(**{"kind": "flat", "diameter": 8e-3, **fields})
    assert sentence in str(refusal.value)
    assert refusal.value.where is not None
    assert str(refusal.value).count("\n") == 0


@pytest.mark.parametrize("degrees", [1.6, 30.0, 60.0, 84.0])
def test_no_angle_of_a_cutter_that_was_given_in_radians_passes_for_degrees(degrees):
    """Nor is any angle in degrees that a cutter has taken for radians; a full tip angle is twice that of its flank."""
    radians = degrees * math.pi / 180.0
    for fields in ({"kind": "flat", "helix_angle_deg": radians}, {"kind": "chamfer", "tip_angle_deg": 2.0 * radians}):
        with pytest.raises(CuttingError, match="rad is meant"):
            Cutter(diameter=8e-3, **fields)
    assert Cutter("flat", 8e-3, helix_angle_deg=degrees).helix_angle == pytest.approx(radians)
    tip = Cutter("chamfer", 8e-3, tip_angle_deg=2.0 * degrees + 0.1).tip_angle
    assert tip == pytest.approx(2.0 * radians + 0.1 * math.pi / 180.0)


def test_what_nobody_said_of_a_cutter():
    plain = Cutter("flat", 8e-3)
    assert (plain.corner_radius, plain.flutes, plain.helix, plain.hand) == (0.0, 2, "right", "right")
    assert math.degrees(plain.helix_angle) == pytest.approx(30.0)
    assert (plain.flute_length, plain.stick_out, plain.tip_angle, plain.tip_diameter) == (None, None, None, 0.0)


def test_lengths_in_hand_are_shown_to_a_tenth():
    """And the helix to a tenth of a degree; diameters and corners as their unit is shown."""
    shown = {name: each.digits for name, each in quantities(Cutter).items()}
    assert {name for name, digits in shown.items() if digits == 1} == {"helix_angle", "flute_length", "stick_out"}
    assert shown["flutes"] == 0
    assert shown["diameter"] is shown["corner_radius"] is None


def test_limits_are_part_of_what_is_allowed():
    """Flutes as long as the stick-out, a corner as large as the radius, no helix; a cone without a flat at its tip."""
    assert Cutter("flat", 8e-3, flute_length=20e-3, stick_out=20e-3).flute_length == 20e-3
    assert Cutter("bull", 8e-3, corner_radius=4e-3).flat_radius == 0.0
    assert Cutter("flat", 8e-3, helix_angle=0.0).pull == 0
    assert Cutter("chamfer", 8e-3, tip_angle=1.0).nose_height == pytest.approx(4e-3 / math.tan(0.5))
    assert Cutter("flat", 8e-3, flutes=1).title == "8.00 mm flat end mill, 1 flute"
    # The radius of a ball may be off by rounding, and is then the cutter's.
    assert Cutter("ball", 8e-3, corner_radius=4e-3 * (1 + 1e-12)).corner_radius == 4e-3


@pytest.mark.parametrize("cutter", ALL, ids=lambda c: c.kind)
def test_below_its_tip_a_cutter_has_no_radius_and_above_its_nose_the_full_one(cutter):
    assert np.isnan(cutter.radius_at(-1e-9))
    assert cutter.radius_at(0.0) == pytest.approx(cutter.flat_radius)
    assert cutter.radius_at([cutter.nose_height, 1.0]) == pytest.approx([cutter.radius] * 2)
    assert np.isfinite(cutter.profile([0.0, cutter.radius])).all()
    assert np.isposinf(cutter.profile([-1e-12, cutter.radius * (1 + 1e-12)])).all()
