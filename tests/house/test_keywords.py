"""A keyword that no call has is refused with the nearest one: constructors, layouts, functions, methods."""

import importlib
import inspect
import pickle
import re
from collections.abc import Callable, Iterator
from dataclasses import is_dataclass
from typing import Any

import numpy as np
import pytest

import six_wheel as sw
from six_wheel import _core, profiles
from six_wheel.kinematics.keywords import unknown_keyword
from tests.objects.samples import public_classes, samples
from tests.rovers import PAIR, SIX_SIZES

ROVER = sw.Rover.preset("perseverance")
FUNCTIONS = (
    "body_slip", "calibrate", "compose", "dead_reckon", "differentiate", "drive", "evaluate", "exp",
    "integrate", "load", "log", "read_log", "replay", "rollout", "simulate", "traverse", "umbmark",
    "wrap_angle",
)  # fmt: skip# Has the options of one call or of another, by what it reads.
READ: dict[str, tuple[Any, ...]] = {"read_log": ("log.csv", ROVER)}


def calls() -> Iterator[tuple[str, Callable[..., Any]]]:
    """Constructors and static methods of the core that take keywords, and the functions written in Python."""
    for name in _core.__all__:
        made = getattr(_core, name)
        if not inspect.isclass(made):
            continue
        if made.__text_signature__:
            yield name, made
        for part, member in vars(made).items():
            if isinstance(member, staticmethod) and not part.startswith("_") and parameters(member.__func__):
                yield f"{name}.{part}", member.__func__
    for name in FUNCTIONS:
        yield name, getattr(sw, name)
    for name in sw.se2.__all__:
        if name not in FUNCTIONS:
            yield name, getattr(sw.se2, name)


def parameters(call: Callable[..., Any]) -> list[str]:
    kinds = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    return [name for name, each in inspect.signature(call).parameters.items() if each.kind in kinds]


CALLS = dict(calls())


@pytest.mark.parametrize("name", CALLS)
def test_a_misspelt_keyword_is_refused_with_the_nearest_one(name: str) -> None:
    """Constructors said that an argument was missing: the one that was misspelt."""
    call = CALLS[name]
    names = parameters(call)
    longest = max(names, key=len)
    wrong = longest[:-1] + "q" if len(longest) > 2 else longest + "q"
    with pytest.raises(TypeError) as caught:
        call(*READ.get(name, ()), **{wrong: 1})
    text = str(caught.value)
    assert text.startswith(f"{name}() has no {wrong}; did you mean ")
    assert all(re.search(rf"\b{each}\b", text.partition("takes ")[2]) for each in names)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: sw.Limits(max_speed=1.0), "Limits() has no max_speed; did you mean speed? It takes speed, "),
        (lambda: sw.Encoder(resolution=64), "Encoder() has no resolution; did you mean ticks_per_turn? It "),
        (lambda: sw.Encoder(64, bits=16), "Encoder() has no bits: bits=16 is wraps_at=65536. It takes ticks"),
        (
            lambda: sw.Rover.mecanum(half_wheelbase=1, half_track=1, wheel_radius=0.1),
            "Rover.mecanum() has no half_wheelbase: half_wheelbase is half of wheelbase. It takes ",
        ),
        (lambda: sw.Wheel("one", 0, 0, raduis=0.1), "Wheel() has no raduis; did you mean radius? It takes "),
        (lambda: sw.Wheel("one", 0, 0), "Wheel() needs the argument radius"),
        (lambda: sw.Noise(rate=50), "Noise() has no rate: give period = 1 / rate. It takes speed, steering"),
        (lambda: sw.Terrain([[0, 0]], 1, resolution=1), "Terrain() has no resolution; did you mean spacing?"),
        (lambda: sw.Costmap([[0, 0]], 1, resolution=1), "Costmap() has no resolution; did you mean spacing?"),
        (
            lambda: sw.Rover.six_wheel(**SIX_SIZES, d1=0.4),
            "Rover.six_wheel() has no d1: d1 is half of track_width. It takes front_to_middle, ",
        ),
        (lambda: sw.FourAxle((1, 1), 1, 1, hinges=1), "FourAxle() has no hinges; did you mean pivots?"),
        (lambda: sw.dead_reckon(None, None, nosie=1), "dead_reckon() has no nosie; did you mean noise? It "),
        (lambda: sw.simulate(None, None, encoder=1), "simulate() has no encoder; did you mean wheel_encod"),
        (
            lambda: sw.Limits().replace(sped=1.0),
            "Limits.replace() has no sped; did you mean speed? It takes ",
        ),
        (lambda: profiles.trapezoid(0, 1, 1, rmap=1), "Profile.trapezoid() has no rmap; did you mean ramp?"),
    ],
)
def test_the_message_says_what_is_meant(call: Callable[[], Any], message: str) -> None:
    with pytest.raises(TypeError, match="^" + re.escape(message)):
        call()


def test_far_from_every_name_there_is_no_guess() -> None:
    assert unknown_keyword("call", "xyz", ["speed"]) == "call() has no xyz; it takes speed"


def test_a_picture_names_the_public_call() -> None:
    pytest.importorskip("matplotlib")
    rover = sw.Rover.preset("perseverance")
    with pytest.raises(TypeError, match=r"^sw.plot\(\) has no twst; did you mean twist\?"):
        sw.plot(rover, twst=(0.1, 0, 0))


def test_a_module_suggests_names() -> None:
    with pytest.raises(
        AttributeError, match=r"^module 'six_wheel' has no attribute 'Rovr'; did you mean Rover\?"
    ):
        sw.Rovr  # noqa: B018


@pytest.mark.parametrize(
    ("module", "wrong", "meant"),
    [
        ("se2", "wrap_angel", "wrap_angle"),
        ("config", "simd_level", "simd_levels"),
        ("profiles", "scurve", "s_curve"),
    ],
)
def test_a_module_of_the_first_page_suggests_names(module: str, wrong: str, meant: str) -> None:
    there = getattr(sw, module)
    with pytest.raises(AttributeError, match=rf"has no attribute '{wrong}'; did you mean {meant}\?$"):
        getattr(there, wrong)
    with pytest.raises(TypeError, match="is a module, not a function; call one of its functions: "):
        there()
    assert {name for name in dir(there) if not name.startswith("_")} == set(there.__all__)


def methods() -> Iterator[tuple[str, Callable[..., Any]]]:
    """Every public method with keywords of an object of every public class, but those that make any."""
    for name, one in samples().items():
        for part in dir(one):
            member = None if part.startswith("_") else getattr(one, part)
            if (
                part in ("replace", "save", "count", "index")
                or not callable(member)
                or inspect.isclass(member)
            ):
                continue
            kinds = {each.kind for each in inspect.signature(member).parameters.values()}
            if inspect.Parameter.VAR_KEYWORD in kinds:
                continue  # its own keywords are those of what it calls
            if not isinstance(inspect.getattr_static(type(one), part), staticmethod) and parameters(member):
                yield f"{name}.{part}", member


METHODS = dict(methods())


@pytest.mark.parametrize("name", METHODS)
def test_a_misspelt_keyword_of_a_method_is_refused_with_the_nearest_one(name: str) -> None:
    """Those of the core said "got an unexpected keyword argument", without the others."""
    names = parameters(METHODS[name])
    longest = max(names, key=len)
    wrong = longest[:-1] + "q" if len(longest) > 2 else longest + "q"
    with pytest.raises(TypeError) as caught:
        METHODS[name](**{wrong: 1})
    text = str(caught.value)
    assert re.match(rf"[\w.]+\.{name.partition('.')[2]}\(\) has no {wrong}; did you mean ", text), text
    assert all(re.search(rf"\b{each}\b", text.partition("takes ")[2]) for each in names)


@pytest.mark.parametrize(
    "kind", [kind for kind in public_classes() if issubclass(kind, tuple) or is_dataclass(kind)]
)
def test_a_misspelt_keyword_of_a_class_of_python_is_refused(kind: type) -> None:
    names = parameters(kind)
    with pytest.raises(TypeError, match=f"^{kind.__name__}\\(\\) has no {names[0]}q; did you mean "):
        kind(**{names[0] + "q": 1})


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: ROVER.inverse((1, 0, 0), center=(0, 0)), "Rover.inverse() has no center; did you mean ce"),
        (lambda: sw.Controller(ROVER).step(now=1.0), "Controller.step() has no now; it takes stamp"),
        (lambda: samples()["Track"].to_pandas(unit="m"), "Track.to_pandas() has no unit; it takes "),
        (lambda: samples()["WheelLog"].to_csv("a", rovr=1), "WheelLog.to_csv() has no rovr; did you mean"),
    ],
)  # fmt: skip
def test_a_method_says_what_is_meant(call: Callable[[], Any], message: str) -> None:
    with pytest.raises(TypeError, match="^" + re.escape(message)):
        call()


def test_other_errors_of_methods_stay_what_they_are() -> None:
    with pytest.raises(ValueError, match="twist must be finite"):
        ROVER.inverse(twist=(np.nan, 0, 0))
    with pytest.raises(TypeError, match="missing 1 required positional argument"):
        ROVER.inverse(previous=None)


LOG = samples()["WheelLog"]
TRACK = samples()["Track"]
# A call that is fine, by keywords.
FINE: dict[str, tuple[Callable[..., Any], dict[str, Any]]] = {
    "dead_reckon": (sw.dead_reckon, {"rover": ROVER, "steering": LOG}),
    "evaluate": (sw.evaluate, {"estimate": TRACK, "truth": LOG}),
    "simulate": (sw.simulate, {"rover": ROVER, "path": [(0.0, 0.1, 0.0, 0.0), (1.0, 0.1, 0.0, 0.0)]}),
    "read_log": (sw.read_log, {"path": LOG.to_arrays(), "rover": ROVER}),
    "se2.between": (sw.se2.between, {"first": (0, 0, 0), "second": (0, 0, 0)}),
    "se2.interpolate": (sw.se2.interpolate, {"first": (0, 0, 0), "second": (0, 0, 0), "share": 0.5}),
    "Track.from_pandas": (sw.Track.from_pandas, {"frame": TRACK.to_arrays(), "rover": ROVER}),
    "Track.slip_report": (TRACK.slip_report, {}),
    "umbmark": (
        sw.umbmark,
        {"rover": PAIR, "clockwise": [(0.1, 0.0)], "counter_clockwise": [(0.1, 0.0)], "side": 4.0},
    ),
}
TYPED = [
    (name, parameter.name)
    for name, (call, _) in FINE.items()
    for parameter in inspect.signature(call).parameters.values()
    if re.search(r"Rover|float|int\b|ArrayLike|Callable|Path", str(parameter.annotation))
    and (name, parameter.name) not in (("dead_reckon", "stamps"), ("Track.slip_report", "gap"))  # not needed
]


@pytest.mark.parametrize(("name", "argument"), TYPED)
def test_an_argument_of_another_type_is_named(name: str, argument: str) -> None:
    """`read_log(path, "perseverance")` said "'str' object has no attribute 'steered_wheel_names'"."""
    call, arguments = FINE[name]
    for wrong in (object(), ["a", None]):
        with pytest.raises((TypeError, ValueError)) as caught:
            call(**(arguments | {argument: wrong}))
        assert re.search(rf"\b{argument}\b", str(caught.value)), str(caught.value)
        assert "\n" not in str(caught.value)


def test_a_rover_is_loaded_first() -> None:
    with pytest.raises(TypeError, match=r"^rover must be a Rover, got 'zoe': give sw.load\('zoe'\)$"):
        sw.read_log(LOG.to_arrays(), "zoe")  # type: ignore[arg-type]


def test_an_error_of_arguments_that_fit_stays_what_it_is() -> None:
    with pytest.raises(ValueError, match="^side must be"):
        sw.umbmark(PAIR, [(0.1, 0.0)], [(0.1, 0.0)], -1.0)


ROOMS = (
    "calibration", "control_loop", "log_odometry", "log_odometry.evaluation", "logs", "maps", "parallel",
    "plotting", "robot_description.urdf", "simulation", "simulation.drive", "view",
)  # fmt: skip
# Of this room as well: options that are passed on, and what makes the options of others.
FREE = {"figure", "replacing"}


def functions_of_rooms() -> list[str]:
    """Public functions of the inner packages by their full names."""
    found = []
    for room in ROOMS:
        module = importlib.import_module(f"six_wheel.{room}")
        for name in module.__all__:
            one = getattr(module, name)
            if inspect.isfunction(one) and parameters(one) and name not in FREE:
                found.append(f"{room}.{name}")
    return found


@pytest.mark.parametrize("name", functions_of_rooms())
def test_functions_of_inner_packages_suggest_keywords(name: str) -> None:
    """They spoke of an unexpected keyword argument, without the nearest one."""
    room, _, last = name.rpartition(".")
    call = getattr(importlib.import_module(f"six_wheel.{room}"), last)
    longest = max(parameters(call), key=len)
    with pytest.raises(TypeError, match=r"has no \w+; did you mean \w+\? It takes "):
        call(**{longest[:-1] + "q": 1})
    # By the name of its package, where processes find it again.
    assert pickle.loads(pickle.dumps(call)) is call


def python_functions() -> dict[str, Callable[..., Any]]:
    """The calls written in Python, of the first page, of `FINE` and of inner packages, by their names."""
    found = {name: call for name, call in CALLS.items() if inspect.isfunction(call)}
    found |= {name: call for name, (call, _) in FINE.items()}
    for name in functions_of_rooms():
        room, _, last = name.rpartition(".")
        found[name] = getattr(importlib.import_module(f"six_wheel.{room}"), last)
    return found


@pytest.mark.parametrize("name", python_functions())
def test_arguments_that_are_missing_are_named_as_those_of_the_core(name: str) -> None:
    """`read_log(path)` said that 1 required positional argument was missing, in words of the interpreter."""
    call = python_functions()[name]
    required = [
        each.name for each in inspect.signature(call).parameters.values() if each.default is each.empty
    ]
    required = [each for each in required if each in parameters(call)]
    plural = "s" * (len(required) > 1)
    if not required:
        return
    with pytest.raises(TypeError, match=rf"\(\) needs the argument{plural} {', '.join(required)}$"):
        call()
    if len(required) > 1:
        with pytest.raises(TypeError, match=rf"\(\) needs the argument {required[-1]}$"):
            call(**dict.fromkeys(required[:-1]))
