"""Truths in space out of files: a quaternion or roll and pitch beside z, with and without a header line."""

import math
from pathlib import Path

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.kinematics.poses import quaternions
from six_wheel.log_odometry.evaluation import evaluate
from six_wheel.logs import LogOptions, read_truth
from six_wheel.logs.ground_truth import rows_of, transforms
from tests.objects.samples import samples

TRACK = samples()["Track3"]
QUATERNIONS = quaternions(TRACK.poses[:, 3:])


def table(path: Path, header: str, *columns: np.ndarray) -> Path:
    rows = np.column_stack((TRACK.stamps, *columns))
    text = "\n".join(" ".join(map(repr, row)) for row in rows.tolist())
    path.write_text(f"{header}\n{text}\n" if header else f"{text}\n", encoding="utf-8")
    return path


FORMS = {
    "tum.txt": ("", (TRACK.poses[:, :3], QUATERNIONS)),
    "path.tum": ("# timestamp tx ty tz qx qy qz qw", (TRACK.poses[:, :3], QUATERNIONS)),
    "long.csv": ("t x y z qx qy qz qw", (TRACK.poses[:, :3], -3.0 * QUATERNIONS)),
    "angles.csv": ("t x y z roll pitch yaw", (TRACK.poses,)),
}


@pytest.mark.parametrize("name", FORMS)
def test_a_file_is_read_in_space(name, tmp_path):
    """Readers kept x, y and yaw: a track in space could be compared with a file only as seen from above."""
    header, columns = FORMS[name]
    path = table(tmp_path / name, header, *columns)
    stamps, poses, findings = read_truth(path)
    np.testing.assert_array_equal(stamps, TRACK.stamps)
    np.testing.assert_allclose(poses, TRACK.poses, rtol=0, atol=1e-14)
    assert findings.rows == 0
    for given in (path, str(path)):
        found = evaluate(TRACK, given)
        assert found.aligned.align == "se3"
        assert found.first.maximum < 1e-12
    planar = sw.Track.from_pandas({"time": TRACK.stamps, **dict(zip("xy", TRACK.poses.T, strict=False)),
                                   "yaw": TRACK.poses[:, 5]}, sw.Rover.preset("rocky7"))  # fmt: skip
    assert evaluate(planar, path).first.maximum < 1e-12


def test_heights_that_are_not_everywhere_leave_a_truth_in_the_plane(tmp_path):
    heights = TRACK.poses[:, 2].copy()
    heights[3] = math.nan
    path = table(tmp_path / "t.csv", "t x y z qx qy qz qw", TRACK.poses[:, :2], heights, QUATERNIONS)
    stamps, poses, _ = read_truth(path)
    assert len(stamps) == len(TRACK)
    np.testing.assert_allclose(poses, TRACK.poses[:, [0, 1, 5]], rtol=0, atol=1e-14)


def test_a_sensor_that_sits_elsewhere_is_moved_in_space():
    sensor = {"x": 0.3, "y": -0.1, "yaw": 0.5}
    mounted = transforms(np.array([[0.3, -0.1, 0.0, 0.0, 0.0, 0.5]]))
    seen = sw.GroundTruth(TRACK.stamps, rows_of(transforms(TRACK.poses) @ mounted))
    body = LogOptions(truth=sensor).of_body(seen)
    assert evaluate(TRACK, body).first.maximum < 1e-12


def test_one_instant_of_a_truth():
    """A number raised "invalid index to scalar variable"."""
    truth = samples()["GroundSimulation"].truth
    assert truth.at(1.05).shape == (3,)
    np.testing.assert_array_equal(truth.at(1.05), truth.at([1.05])[0])
    np.testing.assert_array_equal(truth.at_in_space(1.05), truth.at_in_space([1.05])[0])
    assert np.isnan(truth.at(1e9)).all()
    with pytest.raises(TypeError, match="stamps must be rows of as many numbers each, got 'a'"):
        truth.at("a")


def test_what_is_no_truth_is_said(tmp_path):
    with pytest.raises(ValueError, match="no such file"):
        evaluate(TRACK, tmp_path / "nothing.csv")
