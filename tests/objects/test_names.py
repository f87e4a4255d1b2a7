"""One name for one thing: what is on the first page, and which names calls, results and options have."""

import importlib
import inspect
import itertools
import re
from collections.abc import Iterator

import numpy as np
import pytest

pytest.importorskip("scipy", reason="walks every public name, and calibration needs SciPy")

import six_wheel as sw
from tests.objects.samples import ARM, ROVER, public_classes, samples, terrain

# Where a name of old, or of another layer, must not come back: calls, then attributes.
OLD_ARGUMENTS = re.compile(
    r"speeds|arm|rho|beta|psi|how|tell|client|encoder|steering_encoder|resolution|gear|modulus|hinges|"
    r"half_\w+|d[1-4]|minimum_\w+|maximum_\w+|least|most|now|reading|orientation|kernel|center"
)
OLD_ATTRIBUTES = re.compile(
    r"steered_names|command_joints|angle_per_count|has_headings|heading_rmse|told|asked|degree|hinges|times|"
    r"half_\w+|alignment|residual"
)
MODULES = (
    "profiles",
    "se2",
    "config",
    "logs",
    "maps",
    "calibration",
    "simulation",
    "log_odometry.evaluation",
)


def calls() -> Iterator[tuple[str, inspect.Signature]]:
    """Every public function, constructor and method with a signature."""
    modules = [
        sw,
        *(importlib.import_module(f"six_wheel.{name}") for name in MODULES[3:]),
        sw.profiles,
        sw.se2,
    ]
    for module in modules:
        for name in module.__all__:
            thing = getattr(module, name)
            made = [(name, thing)]
            if inspect.isclass(thing):
                made += [(f"{name}.{part}", getattr(thing, part)) for part in dir(thing) if part[0] != "_"]
            for call, one in made:
                if callable(one):
                    try:
                        yield f"{module.__name__}.{call}", inspect.signature(one)
                    except (TypeError, ValueError):
                        continue


def test_the_first_page_has_about_sixty_names():
    names = [name for name in dir(sw) if not name.startswith("_")]
    assert len(names) <= 68, names
    hidden = {"calibration", "cli", "control_loop", "kinematics", "parallel", "plotting", "robot_description"}
    assert hidden.isdisjoint(names)
    assert all(hasattr(sw, name) for name in (*hidden, *sw.__all__))


def test_no_call_takes_an_old_name():
    found = [
        f"{call}({name}=)"
        for call, signature in calls()
        for name, each in signature.parameters.items()
        if each.kind is not each.VAR_KEYWORD and OLD_ARGUMENTS.fullmatch(name)
    ]
    assert found == []


def test_no_result_has_an_old_name():
    found = [
        f"{kind.__name__}.{name}"
        for kind in public_classes()
        for name in dir(kind)
        if OLD_ATTRIBUTES.fullmatch(name)
    ]
    assert found == ["Preintegrated.residual"]  # the error of a factor between two poses


def test_no_two_classes_share_a_name():
    rooms = ("control_loop", "log_odometry", "simulation.drive", "kinematics.odometry")
    named: dict[str, set[int]] = {}
    for module in itertools.chain(
        [sw], (importlib.import_module(f"six_wheel.{room}") for room in (*MODULES[3:], *rooms))
    ):
        for name in getattr(module, "__all__", ()):
            thing = getattr(module, name)
            if inspect.isclass(thing):
                named.setdefault(name, set()).add(id(thing))
    assert [name for name, kinds in named.items() if len(kinds) > 1] == []


def test_groups_of_names():
    assert sw.se2.compose is sw.compose
    assert sw.config.set_default_threads is sw.set_default_threads
    assert sw.config.simd_levels()[0] == "scalar"
    for call in (sw.drive, sw.traverse, sw.replay, sw.plot, sw.simulate, sw.calibrate):
        assert callable(call)


def test_joints_and_steering():
    frames = ARM.frames(joints=(0.1, 0.2, -0.1), steering=(0.1,) * 2)
    np.testing.assert_array_equal(frames["A1"], ARM.frames([(0.1, 0.2, -0.1)], [(0.1,) * 2])["A1"][0])
    assert ARM.planar() == ARM.planar((0, 0, 0)) == ARM.planar(joints=(0.0, 0.0, 0.0))
    stand = samples()["SettledPose"]
    assert set(ARM.frames(stand.joints, stand.steering)) == set(frames)


def test_more_values_than_places_are_told_which_go_by_name():
    """`Wheel("a", 0, 0, 0.1)` was answered with `Wheel.__new__() takes 3 positional arguments`."""
    said = r"^Wheel\(\) takes 3 values without names \(name, x, y\), got 4: give radius, "
    with pytest.raises(TypeError, match=said):
        sw.Wheel("a", 0, 0, 0.1)
    said = r"^dead_reckon\(\) takes \d values without names \(rover, .*\), got 21: give noise, "
    with pytest.raises(TypeError, match=said):
        sw.dead_reckon(ROVER, *[0.0] * 20)
    told = []
    for kind in public_classes():
        try:
            kind(*[1.0] * 60)
        except (TypeError, ValueError) as error:
            told.append(str(error))
    assert sum("without names" in message for message in told) >= 9


def test_two_constructors_without_anything_optional():
    behind, front = sw.RockerBogie.preset("rocky7"), sw.RockerBogie.preset("open_source_rover")
    for arm, make in ((behind, sw.RockerBogie.bogie_behind), (front, sw.RockerBogie.bogie_in_front)):
        given = arm.dimensions
        assert make(**given) == arm
        first = dict(list(given.items())[:4])
        parameters = inspect.signature(make).parameters
        missing = [
            name for name, each in parameters.items() if each.default is each.empty and name not in first
        ]
        assert len(missing) == 2
        with pytest.raises(TypeError, match=rf"\(\) needs the arguments {', '.join(missing)}$"):
            make(**first)
    with pytest.raises(
        TypeError, match="rocker_to_bogie, bogie_to_rear, wheel_radius must be given, got nothing"
    ):
        sw.RockerBogie((0, 0.1, 0), rocker_to_front=(0.1, 0, 0), bogie_to_middle=(0.1, 0, 0))


def test_wheels_by_name():
    assert ROVER.wheels["front_left"] is ROVER.wheels[0]
    assert list(ROVER.wheels.keys()) == list(ROVER.wheel_names)
    assert ROVER.wheels[:2] == tuple(ROVER.wheels)[:2]
    with pytest.raises(KeyError, match="no wheel 'front_lef'; did you mean front_left"):
        ROVER.wheels["front_lef"]
    other = ROVER.replace(wheels={"front_left": {"scrub": 0.03}, "rear_left": ROVER.wheels["rear_left"]})
    assert other == ROVER.replace("front_left", scrub=0.03)
    with pytest.raises(
        ValueError, match="wheels must be some of front_left, .* got 'front'; did you mean front_"
    ):
        ROVER.replace(wheels={"front": {"scrub": 0.03}})


@pytest.mark.parametrize("ending", ["yaml", "urdf"])
def test_a_rover_is_saved_and_loaded(ending, tmp_path):
    pytest.importorskip("yaml")
    path = tmp_path / f"rover.{ending}"
    ROVER.save(path)
    assert sw.load(path).wheel_names == ROVER.wheel_names
    if ending == "yaml":
        ROVER.save(path, limits=sw.Limits(speed=0.3))
        assert "speed: 0.3" in path.read_text()
        assert sw.load(path) == ROVER
    with pytest.raises(ValueError, match="path must end in .yaml, .yml or .urdf, got 'rover.txt'"):
        ROVER.save("rover.txt")


def test_a_preset_is_loaded_by_its_name(tmp_path, monkeypatch):
    assert sw.load("perseverance") == ROVER
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rocky7").write_text("")  # a file of that name counts
    with pytest.raises(ValueError, match="rocky7"):
        sw.load("rocky7")
    with pytest.raises(ValueError, match=r"or the name of a preset; did you mean perseverance\?"):
        sw.load("perseverence")
    with pytest.raises(ValueError, match=r"\.yaml or \.json, or the name of a preset\)$"):
        sw.load("rover.yaml")
    (tmp_path / "rover_1.yaml").write_text("")
    with pytest.raises(ValueError, match=r'the name of a preset; did you mean "rover_1\.yaml"\?\)$'):
        sw.load("rover1.yaml")


def test_readings_and_increments():
    steps = np.full((5, 6), 0.1)
    stamps = np.arange(5.0)
    straight = np.zeros((5, 4))
    total = sw.dead_reckon(ROVER, straight, np.cumsum(steps, axis=0), stamps)
    for options in ({"increments": True}, {"readings": "angles", "increments": True}):
        each = sw.dead_reckon(ROVER, straight, steps, stamps, **options)
        np.testing.assert_allclose(each.poses, total.poses, atol=1e-12)
    ticks = sw.dead_reckon(
        ROVER,
        straight,
        np.cumsum(steps, axis=0),
        stamps,
        readings="ticks",
        wheel_encoders=sw.Encoder(2 * np.pi),
    )
    np.testing.assert_allclose(ticks.poses, total.poses, atol=1e-12)
    for options, message in (
        ({"readings": "increments"}, "'increments': leave it out and give increments=True"),
        ({"readings": "ticks"}, "wheel_encoders must be given with readings='ticks', got None"),
        (
            {"readings": "speeds", "increments": True},
            "increments must be left out with readings='speeds', got True",
        ),
    ):
        with pytest.raises(ValueError, match=message):
            sw.Odometry(ROVER, **options)


def test_a_pose_from_outside_has_deviations_or_variances():
    def corrected(**known):
        odometry = sw.Odometry(ROVER)
        for k in range(5):
            odometry.update([0.0] * 4, [0.1 * k] * 6, 0.1 * k)
        return odometry.correct((0.1, 0.0, 0.0), 0.2, **known)  # a second late at most, by default

    one, other = corrected(std=(0.1, 0.2, 0.3)), corrected(covariance=np.square((0.1, 0.2, 0.3)))
    np.testing.assert_allclose(one.pose, other.pose, atol=1e-15)
    np.testing.assert_allclose(one.covariance, other.covariance, atol=1e-15)
    for known, message in (
        ({}, "covariance must be given, or std in its place, got None"),
        ({"std": (1, 1, 1), "covariance": (1, 1, 1)}, "std must be left out beside covariance, got both"),
        ({"std": (1, -1, 1)}, "std must hold deviations of at least 0, got -1"),
    ):
        with pytest.raises(ValueError, match=message):
            corrected(**known)
    space = sw.Odometry3(ARM, ground=terrain())
    log = samples()["GroundSimulation"]
    for k in range(3):
        space.update(log.steering[k], log.wheel_angles[k], log.stamps[k])
    assert np.isfinite(space.correct((0.0, 0.0, 0.0), log.stamps[1], std=(0.1, 0.1, 0.1)).pose).all()


def test_limits_of_curiosity_are_asked_for():
    assert sw.FeasibilityLimits().roll == np.inf
    assert sw.FeasibilityLimits.curiosity().roll == pytest.approx(np.deg2rad(15))
    assert repr(sw.FeasibilityLimits.curiosity()) == "FeasibilityLimits.curiosity()"
    assert repr(sw.FeasibilityLimits(tilt=0.3)) == "FeasibilityLimits(tilt=0.3)"
    assert eval(repr(sw.FeasibilityLimits(tilt=0.3)), vars(sw)) == sw.FeasibilityLimits(tilt=0.3)


def test_noise_that_nobody_measured_is_called_so():
    typical = sw.Noise.typical()
    assert sw.Noise() == typical == sw.Noise(0.01, 0.009, slip=0.03, side_slip=0.03)
    assert hash(sw.Noise()) == hash(sw.Noise(0.01, 0.009, slip=0.03, side_slip=0.03))
    assert repr(sw.Noise()) == "Noise.typical()"
    assert repr(sw.Noise(yaw=0.1)) == "Noise.typical(yaw=0.1)"
    assert eval(repr(sw.Noise(yaw=0.1, period=0.2)), vars(sw)) == sw.Noise(yaw=0.1, period=0.2)
    assert repr(sw.Noise(speed=0.02)).startswith("Noise(speed=0.02, ")


def test_noise_of_a_log_in_one_line():
    from tests.rovers import PAIR

    true = sw.Noise(0.0, 0.0, slip=0.02, side_slip=0.01)
    times = np.linspace(0.0, 40.0, 81)
    twists = np.stack((0.2 + 0 * times, 0 * times, 0.5 * np.sin(times)), axis=-1)
    logs = [sw.simulate(PAIR, (times, twists), noise=true, seed=seed) for seed in range(12)]
    found = sw.Noise.from_logs(PAIR, logs)
    assert found.slip == pytest.approx(true.slip, rel=0.6)  # three numbers of an end, twelve ends
    assert found.speed == found.steering == 0.0
    with pytest.raises(ValueError, match="logs must have their truth"):
        sw.Noise.from_logs(PAIR, sw.WheelLog([0.0, 1.0], None, np.zeros((2, 2))))
