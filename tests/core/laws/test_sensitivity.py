"""Derivatives of the estimated twist, against differences of the reference's estimate."""

import numpy as np
import pytest

import six_wheel as sw
from six_wheel import reference
from tests.rovers import PAIR, SIX_WHEELS

STEP = 1e-5  # differences err by its square, and by rounding (1e-16) over it: 1e-10 at this step
TOLERANCE = 1e-7


def rovers() -> dict[str, sw.Rover]:
    wheels = [
        sw.Wheel("front", 0.6, 0.05, radius=0.12, steered=True, heading=0.1, scrub=0.04, trail=0.03),
        sw.Wheel("left", 0.0, 0.3, radius=0.1),
        sw.Wheel("right", 0.05, -0.3, radius=0.11, scrub=0.02),
        sw.Wheel("back", -0.4, 0.0, radius=0.08, heading=0.7, roller_angle=0.9),
        sw.Wheel("castor", -0.5, 0.0, radius=0.05, castor=True, trail=0.05),
    ]
    return {
        "mixed": sw.Rover(wheels),
        "six_wheel": SIX_WHEELS,
        "differential": PAIR,
        "tricycle": sw.Rover.tricycle(0.6, 0.4, 0.1),
        "mecanum": sw.Rover.mecanum(0.6, 0.4, 0.05),
        "swerve": sw.Rover.swerve([(0.3, 0.2), (-0.3, 0.1), (0.0, -0.4)], 0.1),
    }


ROVERS = rovers()


def readings(rover: sw.Rover) -> list[np.ndarray]:
    """Steering angles, speeds and steering rates that contradict each other."""
    generator = np.random.default_rng(3)
    joints, wheels = len(rover.steered_wheel_names), len(rover.wheels)
    return [
        generator.uniform(-1, 1, joints),
        generator.uniform(-3, 3, wheels),
        generator.uniform(-1, 1, joints),
    ]


def plain(rover: sw.Rover, **moved: float) -> reference.Rover:
    """The same rover in the reference, attributes of its wheels moved: ``x_3=0.1``."""
    wheels = []
    for i, wheel in enumerate(rover.wheels):
        numbers = {name: getattr(wheel, name) for name in ("x", "y", "radius", "heading", "scrub", "trail")}
        numbers["roller_angle"] = wheel.roller_angle
        for name in numbers:
            numbers[name] = (numbers[name] or None) if name == "roller_angle" else numbers[name]
            if f"{name}_{i}" in moved:
                numbers[name] += moved[f"{name}_{i}"]
        wheels.append(
            reference.Wheel(
                wheel.name, steered=wheel.steered, castor=wheel.castor, driven=wheel.driven, **numbers
            )
        )
    return reference.Rover(wheels)


def twist(rover: reference.Rover, log: list[np.ndarray]) -> np.ndarray:
    return rover.forward(log[0], log[1], steering_rates=log[2])


@pytest.mark.parametrize("name", ROVERS)
@pytest.mark.parametrize(
    ("position", "quantity"), [(0, "steering"), (1, "wheel_speeds"), (2, "steering_rates")]
)
def test_by_the_readings(name, position, quantity):
    rover = ROVERS[name]
    log = readings(rover)
    found = getattr(rover.sensitivity(log[0], log[1], steering_rates=log[2]), quantity)
    assert found.shape == (3, len(log[position]))
    for i in range(len(log[position])):
        ahead, behind = ([row.copy() for row in log] for _ in range(2))
        ahead[position][i] += STEP
        behind[position][i] -= STEP
        difference = (twist(plain(rover), ahead) - twist(plain(rover), behind)) / (2 * STEP)
        np.testing.assert_allclose(found[:, i], difference, atol=TOLERANCE)


@pytest.mark.parametrize("name", ROVERS)
@pytest.mark.parametrize("quantity", ["x", "y", "heading", "radius", "scrub", "trail", "roller_angle"])
def test_by_the_dimensions(name, quantity):
    rover = ROVERS[name]
    log = readings(rover)
    found = getattr(rover.sensitivity(log[0], log[1], steering_rates=log[2]), quantity)
    for i, wheel in enumerate(rover.wheels):
        if quantity == "roller_angle" and wheel.roller_angle is None:
            np.testing.assert_array_equal(found[:, i], 0.0)
            continue
        ahead, behind = (twist(plain(rover, **{f"{quantity}_{i}": step}), log) for step in (STEP, -STEP))
        parallel = quantity == "heading" and name == "mixed" and wheel.name in ("left", "right")
        if not parallel:  # two axles that turn apart no longer share a line: the estimate jumps
            np.testing.assert_allclose(found[:, i], (ahead - behind) / (2 * STEP), atol=TOLERANCE)


def test_slip_is_a_reading_that_errs():
    rover = ROVERS["six_wheel"]
    steering, speeds = rover.inverse((0.5, 0.0, 0.3))
    found = rover.sensitivity(steering, speeds)
    np.testing.assert_allclose(found.slip * 0.15, found.wheel_speeds, rtol=1e-14)
    np.testing.assert_array_equal(found.twist, rover.forward(steering, speeds))


def test_batches_are_their_rows():
    rover = ROVERS["six_wheel"]
    generator = np.random.default_rng(5)
    steering, speeds = generator.uniform(-1, 1, (3, 40, 4)), generator.uniform(-3, 3, (3, 40, 6))
    found = rover.sensitivity(steering, speeds)
    one = rover.sensitivity(steering[2, 7], speeds[2, 7])
    for name in ("twist", "wheel_speeds", "steering", "x", "heading", "trail"):
        np.testing.assert_array_equal(getattr(found, name)[2, 7], getattr(one, name))


def test_only_what_is_asked_for():
    found = ROVERS["differential"].sensitivity(None, [1.0, 2.0], quantities=["radius", "y"])
    assert found.radius.shape == found.y.shape == (3, 2)
    assert found.x is None
    assert repr(found) == "TwistJacobian(of the twist by radius, y)"
    with pytest.raises(ValueError, match="quantities must name some of wheel_speeds, .*, got 'size'"):
        ROVERS["differential"].sensitivity(None, [1.0, 2.0], quantities=["size"])


def test_what_forward_refuses_has_no_derivative():
    rover = ROVERS["six_wheel"]
    with pytest.raises(ValueError, match="wheel_speeds must be finite"):
        rover.sensitivity(np.zeros(4), [np.nan] * 6)
    lonely = sw.Rover([sw.Wheel("w", 0.0, 0.0, radius=0.1)])
    with pytest.raises(sw.UnderdeterminedError):
        lonely.sensitivity(None, [1.0])
