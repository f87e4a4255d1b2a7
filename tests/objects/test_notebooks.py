"""Objects in a notebook: text always, a picture where matplotlib is, never an error."""

import pickle
import subprocess
import sys

import numpy as np
import pytest

import six_wheel as sw
from tests.objects.samples import ROVER, samples

SHOWN = (
    "ControllerRun",
    "Costmap",
    "Evaluation",
    "FourAxle",
    "FourAxleSimulation",
    "GroundSimulation",
    "GroundTruth",
    "RockerBogie",
    "Rover",
    "SettledPose",
    "Simulation",
    "SlipReport",
    "Suspension",
    "Terrain",
    "Track",
    "Track3",
    "TwistFit",
    "WheelLog",
)
LARGEST = 100_000  # [B] of a bundle


@pytest.mark.parametrize("name", SHOWN)
def test_a_result_has_a_picture_beside_its_text(name):
    pytest.importorskip("matplotlib")
    one = samples()[name]
    before = pickle.dumps(one)
    bundle = one._repr_mimebundle_()
    assert bundle["text/plain"] == repr(one)
    assert bundle["text/html"].startswith("<pre>")
    assert 'src="data:image/png;base64,iVBOR' in bundle["text/html"]
    assert sum(map(len, bundle.values())) < LARGEST
    assert one._repr_html_() == bundle["text/html"]  # for viewers that know no bundles
    assert one._repr_mimebundle_(include=None, exclude={"text/html"})["text/plain"] == repr(one)
    assert pickle.dumps(one) == before


def test_every_class_that_shows_itself_is_among_them():
    known = {name for name, one in samples().items() if hasattr(one, "_repr_mimebundle_")}
    assert known == {*SHOWN}


def test_relief_that_compresses_badly_is_shown_in_fewer_colours():
    pytest.importorskip("matplotlib")
    heights = np.random.default_rng(0).normal(0.0, 0.05, (300, 300))
    bundle = sw.Terrain(heights, 1.0)._repr_mimebundle_()
    assert 20_000 < sum(map(len, bundle.values())) < LARGEST


def test_what_cannot_be_drawn_is_text():
    unknown = sw.Terrain(np.full((3, 3), np.nan), 1.0)
    assert unknown._repr_mimebundle_() == {"text/plain": repr(unknown)}
    assert unknown._repr_html_() is None


def test_without_matplotlib_there_is_the_text():
    code = (
        "import sys\nsys.modules['matplotlib'] = None\n"
        "import six_wheel as sw\nrover = sw.Rover.preset('perseverance')\n"
        "assert rover._repr_mimebundle_() == {'text/plain': repr(rover)}\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.stderr == ""


def test_a_figure_shows_itself_and_pyplot_is_left_alone():
    pytest.importorskip("matplotlib")
    code = (
        "import sys, six_wheel as sw\nrover = sw.Rover.preset('perseverance')\n"
        "assert sw.plot(rover)._repr_png_().startswith(b'\\x89PNG')\n"
        "assert 'matplotlib.pyplot' not in sys.modules\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.stderr == ""


def test_text_in_html_is_text():
    pytest.importorskip("matplotlib")
    wheels = [wheel.replace(name=f"<b>{number}") for number, wheel in enumerate(ROVER.wheels)]
    assert "<b>" not in sw.Rover(wheels)._repr_mimebundle_()["text/html"]
