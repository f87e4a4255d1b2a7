"""Keys of a parameter file for dead reckoning: noise, encoders, options of odometry."""

from pathlib import Path

import pytest

pytest.importorskip("yaml")
pytest.importorskip("pydantic")

import six_wheel as sw
from six_wheel.robot_description.parameters import ParameterFileError, parse_parameters
from six_wheel.robot_description.parameters.schema import GROUPS

BICYCLE = "kind: bicycle\nwheelbase: 1.0\nwheel_radius: 0.1\n"
ENCODERS = (
    "ticks_per_turn: 64, gear_ratio: 30, wraps_at: 65536, reversed: [rear], increments: true, scale: 1.01"
)
GOOD = f"""\
{BICYCLE}noise: {{speed: 0.02, steering: 0.01, slip: 0.005, side_slip: 0.004}}
wheel_encoders: {{{ENCODERS}, steering_gain: {{front: 0.98}}}}
steering_encoders: {{ticks_per_turn: 4096, gear_ratio: -1.0, wraps_at: 4096, reversed: [front],
  offsets: {{front: 0.1}}}}
odometry: {{method: robust, inflate: true, slip_threshold: 0.1, max_gap: 1.0, max_speed: 2.0,
  max_steering_rate: 3.0, wheel_noise: {{rear: 1.5}}}}
gyroscope: {{noise: 0.002, period: 0.01, bias: 0.01, bias_noise: 0.02, bias_walk: 1.0e-4, scale: 1.01,
  scale_noise: 0.01, roll: 3.14, pitch: -0.1, time_offset: 0.02, topic: imu/data}}
"""


def test_every_key_is_read_and_taken_by_the_library() -> None:
    found = parse_parameters(GOOD)
    assert found.warnings == ()
    for group in ("noise", "wheel_encoders", "steering_encoders", "odometry", "gyroscope"):
        assert set(getattr(found, group)) == set(GROUPS[group].model_fields)
    sw.Odometry(found.rover, sw.Noise(**found.noise), gyroscope=found.known_gyroscope, **found.odometry)
    assert found.known_gyroscope == sw.Gyroscope(
        0.002, bias=0.01, bias_noise=0.02, bias_walk=1e-4, scale_noise=0.01
    )
    assert parse_parameters(f"{BICYCLE}gyroscope: {{scale: 1.01}}\n").known_gyroscope is None
    again = parse_parameters(f"base:\n  ros__parameters:\n{indented(GOOD)}", node="base")
    assert (again.noise, again.wheel_encoders, again.odometry) == (
        found.noise,
        found.wheel_encoders,
        found.odometry,
    )
    assert parse_parameters(f"{BICYCLE}noise.speed: 0.02\n").noise == {"speed": 0.02}
    assert parse_parameters(BICYCLE).wheel_encoders == {}


def indented(text: str) -> str:
    return "".join(f"    {line}\n" for line in text.splitlines())


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("noise: {speed: -1}", "noise.speed must be finite and not negative, got -1"),
        ("noise: {speed: wide}", "noise.speed must be a number, got 'wide'"),
        ("noise: {sped: 1.0}", "unknown key noise.sped (did you mean speed?)"),
        ("noise: 0.1", "noise must be a mapping, got 0.1"),
        (
            "odometry: {wheel_noise: {rear: -1.0}}",
            "odometry.wheel_noise.rear must be finite and not negative, got -1",
        ),
        (
            "odometry: {wheel_noise: {reer: 1.0}}",
            "names reer, which is no such wheel or joint (did you mean rear?)",
        ),
        (
            "wheel_encoders: {ticks_per_turn: 0}",
            "wheel_encoders.ticks_per_turn must be finite and positive, got 0",
        ),
        ("wheel_encoders: {gear_ratio: 0}", "wheel_encoders.gear_ratio must be finite and not 0, got 0"),
        ("wheel_encoders: {increments: 1}", "wheel_encoders.increments must be true or false, got 1"),
        (
            "wheel_encoders: {reversed: [rearr]}",
            "wheel_encoders.reversed names rearr, which is no such wheel or joint",
        ),
        ("wheel_encoders: {reversed: [rearr]}", "(did you mean rear?)"),
        ("wheel_encoders: {steering_gain: {rear: 1.0}}", "wheel_encoders.steering_gain names rear"),
        ("wheel_encoders: {steering_gain: {front: 0.0}}", "must be finite and positive, got 0"),
        ("steering_encoders: {offsets: {fornt: 0.1}}", "(did you mean front?)"),
        ("gyroscope: {noise: -1}", "gyroscope.noise must be finite and not negative, got -1"),
        ("gyroscope: {scale: 0.0}", "gyroscope.scale must be finite and positive, got 0"),
        ("gyroscope: {nois: 0.1}", "unknown key gyroscope.nois (did you mean noise?)"),
        ("odometry: {method: robst}", "or 'robust', got \"robst\""),
        ("odometry: {max_gap: 0}", "odometry.max_gap must be positive, got 0"),
        ("odometry: {inflate: 0.5}", "odometry.inflate must be true or false, got 0.5"),
    ],
)
def test_what_is_wrong_is_said_with_its_line(line: str, message: str) -> None:
    with pytest.raises(ParameterFileError) as caught:
        parse_parameters(f"{BICYCLE}{line}\n", path=Path("rover.yaml"))
    assert str(caught.value).startswith("rover.yaml:4: ")
    assert message in str(caught.value)
