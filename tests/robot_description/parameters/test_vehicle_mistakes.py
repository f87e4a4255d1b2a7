"""Mistakes in files of any vehicle type, random values, and the page of all keys."""

import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from six_wheel.robot_description.parameters import ParameterFileError, read_parameters
from six_wheel.robot_description.parameters.detect_format import KEYS
from six_wheel.robot_description.parameters.foreign.keys_page import page
from six_wheel.robot_description.parameters.schema import NESTED
from six_wheel.robot_description.parameters.vehicle_types import KINDS
from tests.robot_description.parameters.vehicle_texts import CORNERS, unhurried

LENGTHS = {"wheelbase": 1.0, "track_width": 0.5, "wheel_radius": 0.1}


def lines(kind: str, **keys: object) -> str:
    """A file with kind on line 1 and a key on each line after it."""
    return "\n".join(f"{key}: {value}" for key, value in ({"kind": kind} | keys).items() if value is not ...)


def wheel(**keys: object) -> str:
    return lines("custom", wheels="\n  a: {x: 0, y: 0, radius: 1}\n  b: {%s}") % ", ".join(
        f"{key}: {value}" for key, value in ({"x": 1, "y": 0, "radius": 1} | keys).items() if value is not ...
    )


SWERVE = {"positions": [1, 0, -1, 0], "wheel_radius": 0.1}
OMNI = {"positions": [1, 0, -1, 0], "headings": [0, 1], "wheel_radius": 0.1}
PAIR = {"track_width": 0.5, "wheel_radius": 0.1}
MECANUM = {"wheelbase": 1, "track_width": 1, "wheel_radius": 0.1}
ARM = "{name: a, x: 0, y: 0, radius: 1}"
MISTAKES = {
    # mistakes: (file, line, words of message and remedy); one finding each
    "kind misspelt": (lines("swerv", **SWERVE), 1, "kind must be one of swerve, got 'swerv' mean swerve?"),
    "kind a list": ("kind: [swerve]\nd1: 1\nd2: 1\nd3: 1\nd4: 1\nwheel_radius: 1", 1, "got a list of 1"),
    "no kind": (lines(..., **LENGTHS), 1, "kind is missing kind: ackermann kind: tricycle"),
    "no kind, positions": (lines(..., **SWERVE), 1, "kind is missing (add kind: swerve)"),
    "other kind's key": (lines("tracked", **PAIR, wheelbase=1), 4, "wheelbase is no key of kind tracked"),
    "misspelt": (lines("tracked", track_widht=1, wheel_radius=1), 2, "did you mean track_width?"),
    "missing": (lines("bicycle", wheelbase=1), 1, "wheel_radius is missing (add wheel_radius, the"),
    "negative": (lines("bicycle", wheelbase=-1, wheel_radius=1), 2, "wheelbase must be finite got -1.0"),
    "driven": (lines("ackermann", **LENGTHS, driven="left"), 5, "driven must be 'front', 'rear' or 'all'"),
    "driven on": (lines("ackermann", **LENGTHS, driven="on"), 5, "driven must be text, got on (put it in"),
    "steering limit": (lines("tricycle", **LENGTHS, steering_limit=0), 5, "steering_limit must be got 0"),
    "odd": (lines("swerve", **SWERVE | {"positions": [1, 2, 3]}), 2, "x and y of every wheel, got 3 numbers"),
    "one module": (lines("swerve", **SWERVE | {"positions": [1, 2]}), 2, "at least 2 wheels, got 1"),
    "none": (lines("omni", **OMNI | {"positions": []}), 2, "x and y of at least 1 wheel, got 0"),
    "row of one": (lines("swerve", **SWERVE | {"positions": [[1, 2], [3]]}), 2, "[1] must be two numbers, x"),
    "mixed": (lines("swerve", **SWERVE | {"positions": [1, 2, [3, 4]]}), 2, "positions[0] must be a list"),
    "nan": (lines("swerve", **SWERVE | {"positions": "[[1, 2], [3, .nan]]"}), 2, "[1][1] must be finite"),
    "text": (lines("swerve", **SWERVE | {"positions": "[1, 2, 3, b]"}), 2, "[3] must be a number, got 'b'"),
    "same point": (lines("swerve", **SWERVE | {"positions": [1, 2, 1, 2]}), 2, "positions must differ from"),
    "names": (lines("swerve", **SWERVE, names="[a, a]"), 4, "names must differ, got a twice"),
    "too few names": (lines("swerve", **SWERVE, names="[a]"), 4, "names must hold 2 names, got 1"),
    "headings": (lines("omni", **OMNI | {"headings": [1]}), 3, "headings must hold 2 numbers, got 1"),
    "rollers": (lines("mecanum", **MECANUM, roller_angle=0.0), 5, "roller_angle must be no multiple of pi"),
    "no rollers": (lines("omni", **OMNI, roller_angle=0.0), 5, "roller_angle must be no multiple of pi"),
    "no wheelbase": (lines("differential", **PAIR, wheels_per_side=2), 4, "wheelbase is missing"),
    "half a wheel": (lines("differential", **PAIR, wheels_per_side=1.5), 4, "a whole number, got 1.5"),
    "no wheels": (lines("differential", **PAIR, wheels_per_side=0), 4, "must be at least 1, got 0"),
    "many wheels": (lines("differential", **PAIR, wheels_per_side=10**15), 4, "must be at most 32"),
    "centres": (lines("tracked", **PAIR, icr_left=-1), 4, "icr_left must lie to the left of icr_right"),
    "other centre": (lines("tracked", **PAIR, icr_right=1), 1, "icr_left must lie to the left of icr_right"),
    "centre nan": (lines("tracked", **PAIR, icr_forward=".nan"), 4, "icr_forward must be finite"),
    "three radii": (lines("tracked", track_width=1, wheel_radius=[1, 1, 1]), 3, "a number or two numbers"),
    "one radius": (lines("tracked", track_width=1, wheel_radius=[1, -1]), 3, "finite and positive, got -1"),
    "fixed wheels": (lines("mecanum", **MECANUM, steering_limit=1), 5, "steering_limit is no key of kind"),
    "far apart": (
        lines("omni", **OMNI | {"positions": "[1e300, 0, 0, 0]"}),
        2,
        "positions[0] must be smaller than 1e60",
    ),
    "wheels a number": (lines("custom", wheels=3), 2, "wheels must be a list, got 3"),
    "no wheel": (lines("custom", wheels="{}"), 2, "wheels must hold 1 to 64 wheels, got 0"),
    "same wheel": (lines("custom", wheels=f"[{ARM}, {ARM}]"), 2, 'have a name each, got "a" twice'),
    "wheel without name": (lines("custom", wheels="[{x: 0, y: 0, radius: 1}]"), 2, "[0].name is missing"),
    "wheel's name": (lines("custom", wheels='{"": {x: 0, y: 0, radius: 1}}'), 2, "visible characters"),
    "wheel a number": (lines("custom", wheels="{a: 3}"), 2, "wheels.a must be a mapping, got 3"),
    "wheel's key": (wheel(colour="red"), 4, "unknown key wheels.b.colour (remove it; a wheel has castor,"),
    "wheel misspelt": (wheel(radius=..., radios=1), 4, "unknown key wheels.b.radios (did you mean radius?)"),
    "wheel's place": (wheel(y=...), 4, "wheels.b.y is missing (add wheels.b.y, how far to the left"),
    "wheel's radius": (wheel(radius=0), 4, "wheels.b.radius must be finite and positive, got 0.0 (it is the"),
    "wheel's flag": (wheel(steered=1), 4, "wheels.b.steered must be true or false, got 1 (it is whether"),
    "wheel's limit": (wheel(steering_limit=1), 4, "wheels.b.steering_limit must be left out (it is an angle"),
    "castor": (wheel(castor="true"), 4, "wheels.b.trail must not be 0 for a castor"),
    "driven castor": (wheel(castor="true", trail=1, driven="true"), 4, "wheels.b.castor must be neither"),
    "limit of all": (wheel() + "\nsteering_limit: 1", 5, "steering_limit is no key of kind custom"),
    "joint count": (lines("swerve", **SWERVE, traction_joints="[a]"), 4, "must name 2 joints, got 1"),
    "motorless": (lines("ackermann", **LENGTHS, traction_joints="[fl, rr]"), 5, "front_left, has no motor"),
    "joint of none": (lines("bicycle", wheelbase=1, wheel_radius=1, traction_joints="[a, b]"), 4, "1 joint"),
    "half told": (lines("swerve", **SWERVE, traction_joints="[m_1, left]"), 4, "does not tell"),
    "numbers from 1": (lines("swerve", **SWERVE, traction_joints="[m_1, m_2]"), 4, "m_2, does not tell"),
    "nothing to state": (lines("swerve", **SWERVE, wheel_of_joint="{a: module_0}"), 4, "in neither"),
    "preset and key": ("preset: husky\ntrack_width: 1", 2, "track_width is given besides a preset"),
    "preset and kind": ("preset: husky\nkind: differential", 2, "kind differential does not fit"),
}  # fmt: skip


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_found_on_its_line_with_rule_and_remedy(findings, mistake):
    content, line, words = MISTAKES[mistake]
    errors = [finding for finding in findings(content) if finding.severity == "error"]
    assert errors[0].remedy
    text = f"{errors[0].message} ({errors[0].remedy})"
    assert re.search(".*".join(map(re.escape, words.split())), text), text
    assert errors[0].line == line
    assert len(errors) == 1 or mistake == "mixed", errors


def test_every_mistake_at_once(findings):
    text = lines(
        "ackermann",
        wheelbase=-1,
        track_width="wide",
        wheel_radius=0.1,
        driven="frnt",
        traction_joints="[left, left]",
        d1=3,
        limits="{speed: 0}",
        odom_frame_id=3,
    )
    assert [(finding.line, finding.key) for finding in findings(text)] == [
        (2, "wheelbase"),
        (3, "track_width"),
        (5, "driven"),
        (6, "traction_joints[1]"),
        (7, "d1"),
        (8, "limits.speed"),
        (9, "odom_frame_id"),
    ]


# Abuse

VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=6) | st.sampled_from(CORNERS),
    lambda inner: (
        st.lists(inner, max_size=6)
        | st.dictionaries(
            st.sampled_from([*CORNERS, "x", "y", "radius", "name", "castor", "type"]), inner, max_size=4
        )
    ),
    max_leaves=12,
)
GOOD = {
    "positions": [1.0, 0.0, -1.0, 0.5, 0.0, 1.0],
    "headings": [0.0, 1.0, 2.0],
    "wheelbase": 1.0,
    "wheel_radius": 0.1,
    "track_width": 0.5,
    "wheel_separation": 0.5,
    "wheel_names": ["a", "b", "c"],
    "kinematics": {"wheels_radius": 0.1, "base_frame_offset": {"x": 0.1}},
    "left_wheel_names": ["l"],
    "right_wheel_names": ["r"],
    "linear.x.max_velocity": 1.0,
    "steering": {"max_position": 1.0},
}


@given(
    kind=st.none() | st.sampled_from([*KINDS]) | VALUES,
    good=st.sets(st.sampled_from([*GOOD])),
    tree=st.dictionaries(st.sampled_from(sorted(KEYS)), VALUES, max_size=6),
    nested=st.booleans(),
)
@settings(unhurried, max_examples=200)
def test_random_values_are_read_or_refused(tmp_path, kind, good, tree, nested):
    tree = {key: GOOD[key] for key in sorted(good)} | ({} if kind is None else {"kind": kind}) | tree
    text = repr({"rover": {"ros__parameters": tree}} if nested else tree)
    text = re.sub(r"\b(None|True|False)\b", lambda match: match[0].lower().replace("none", "null"), text)
    path = tmp_path / "any.yaml"
    path.write_bytes(text.encode("utf-8", "surrogatepass"))
    try:
        found = read_parameters(path).warnings
    except ParameterFileError as error:
        found = error.findings
        assert len(str(error).splitlines()) == len(found) > 0  # noqa: PT017 - both outcomes are right
    assert all(str(finding).startswith(str(path)) for finding in found)


# The documentation

DOCS = Path(__file__).parents[3] / "docs"
DOCUMENT = "".join(
    (DOCS / page).read_text(encoding="utf-8")
    for page in ("reference/parameter_keys.md", "howto/rover_file.md")
)
KEYS_OF_OTHERS = (DOCS / "reference" / "other_keys.md").read_text(encoding="utf-8")


def test_the_page_of_the_keys_of_others_is_made_from_the_code():
    assert page() == KEYS_OF_OTHERS, "python docs/keys.py writes it"


def test_the_documentation_has_every_key():
    said = set(re.findall(r"`([\w.]+)`", DOCUMENT + KEYS_OF_OTHERS))
    wheel = NESTED["wheels"].model_fields.keys() - {"name"}
    nested = {key for group in ("limits", "control") for key in NESTED[group].model_fields}
    assert {*KEYS, *KINDS, *wheel, *nested} - said == {"preset"}
    assert "`preset: NAME`" in DOCUMENT


def test_the_documentation_shows_what_is_reported(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    file, output = (re.search(rf"```{kind}\n(.*?)```", DOCUMENT, re.DOTALL)[1] for kind in ("yaml", "text"))
    Path("rover.yaml").write_text(file)
    with pytest.raises(ParameterFileError) as caught:
        read_parameters("rover.yaml")
    assert f"{caught.value}\n" == output
