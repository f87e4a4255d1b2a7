"""Errors of paths: laws, exact cases, the package evo, and the published figures of 45 recordings."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import six_wheel as sw
from six_wheel.log_odometry import evaluation
from six_wheel.logs import GroundTruth
from tests.optiodom_data import REQUIRED, ROBOTS, RUNS, read, reckon

POSES = st.tuples(*[st.floats(-5.0, 5.0)] * 2, st.floats(-3.0, 3.0))


def paths(seed: int, count: int = 200) -> tuple[np.ndarray, np.ndarray]:
    """A wandering path and a noisy, drifting copy of it."""
    random = np.random.default_rng(seed)
    twists = np.column_stack(
        (random.uniform(0.0, 0.1, count), random.normal(0.0, 0.01, count), random.normal(0.0, 0.2, count))
    )
    noise = random.normal((0.003, 0.001, 0.004), 0.01, twists.shape)
    return sw.integrate(twists + noise, 1.0), sw.integrate(twists, 1.0)


def moved(by: tuple[float, float, float], poses: np.ndarray) -> np.ndarray:
    return sw.compose(np.broadcast_to(by, poses.shape), poses)


@given(seed=st.integers(0, 50), by=POSES)
def test_a_path_moved_as_a_whole_has_no_error(seed, by):
    path, _ = paths(seed, 60)
    for how in ("first", "se2"):
        error = evaluation.absolute_error(moved(by, path), path, how)
        assert error.maximum < 1e-12
        assert np.abs(error.heading).max() < 1e-12
    assert evaluation.relative_error(moved(by, path), path, 0.3).rmse < 1e-13


@given(seed=st.integers(0, 50), by=POSES)
def test_errors_do_not_depend_on_where_the_estimate_lies(seed, by):
    estimate, truth = paths(seed, 60)
    for how in ("first", "se2"):
        here = evaluation.absolute_error(estimate, truth, how)
        there = evaluation.absolute_error(moved(by, estimate), truth, how)
        assert_allclose(there.position, here.position, atol=1e-12)
    assert_allclose(
        evaluation.relative_error(moved(by, estimate), truth).position,
        evaluation.relative_error(estimate, truth).position,
        atol=1e-12,
    )


@given(seed=st.integers(0, 50), by=POSES)
def test_no_rigid_motion_beats_the_alignment(seed, by):
    estimate, truth = paths(seed, 60)
    best = evaluation.absolute_error(estimate, truth, "se2").rmse
    nudged = moved(tuple(0.01 * value for value in by), evaluation.align(estimate, truth, "se2"))
    assert evaluation.absolute_error(nudged, truth, "none").rmse >= best - 1e-12


def test_a_path_one_percent_too_long():
    truth = np.column_stack((np.linspace(0.0, 10.0, 101), np.zeros(101), np.zeros(101)))
    result = evaluation.evaluate(truth * (1.01, 1.0, 1.0), truth, length=1.0, stride=1)
    assert result.distance == pytest.approx(10.0, abs=1e-12)
    assert result.first.final == pytest.approx(0.1, abs=1e-12)
    # Mean of the squares of 0, 1, ... 100 is 100 * 201 / 6.
    assert result.first.rmse == pytest.approx(0.001 * math.sqrt(100 * 201 / 6), abs=1e-12)
    # Aligned, the error is measured from the middle: -50 ... 50.
    assert result.aligned.rmse == pytest.approx(0.001 * math.sqrt((101**2 - 1) / 12), abs=1e-12)
    assert result.relative.percent == pytest.approx(1.0, rel=0.02)  # a stretch ends with the next sample
    growth = result.growth
    assert_allclose(growth.position / growth.length, 0.01, rtol=0.12)
    assert "ATE 0.0579 m" in repr(result)


def test_a_wrong_first_heading_turns_the_whole_path():
    truth = np.column_stack((np.linspace(0.0, 2.0, 21), np.zeros((21, 2))))
    estimate = truth.copy()
    estimate[0, 2] = 0.1
    assert evaluation.absolute_error(estimate, truth, "first").final == pytest.approx(4.0 * math.sin(0.05))
    assert evaluation.absolute_error(estimate, truth, "se2").maximum < 1e-12


def test_a_path_too_short_has_no_relative_error():
    estimate, truth = paths(1, 5)
    error = evaluation.relative_error(estimate, truth, 100.0)
    assert len(error.rows) == 0
    assert math.isnan(error.rmse)
    assert math.isnan(error.yaw_rmse)
    still = np.zeros((4, 3))
    assert len(evaluation.error_growth(still, still).length) == 0
    assert "nan" in repr(evaluation.evaluate(still, still))


@pytest.mark.parametrize(
    ("estimate", "truth", "rule"),
    [
        (np.zeros((4, 2)), np.zeros((4, 3)), "estimate must have shape"),
        (np.zeros((4, 3)), np.zeros((5, 3)), r"estimate must have shape \(5, 3\)"),
        (np.zeros((0, 3)), np.zeros((0, 3)), "truth must have shape"),
        (np.full((4, 3), np.nan), np.zeros((4, 3)), "estimate must be finite, got .* in row 0"),
    ],
)
def test_what_cannot_be_compared_is_refused(estimate, truth, rule):
    with pytest.raises(ValueError, match=rule):
        evaluation.evaluate(estimate, truth)


@pytest.mark.parametrize("place", [1e300, 1e20])
def test_stretches_of_a_path_without_end_come_to_an_end(place):
    """A length that was lost in the rounding of a distance added the same row for ever."""
    poses = np.zeros((4, 3))
    poses[2:, 0] = [place, 2.0 * place]
    assert len(evaluation.segments(poses, 0.5, stride=None)) <= 3
    assert len(evaluation.segments(1e10 + poses / place, 1e-12, stride=None)) <= 3


def test_arguments_out_of_range_are_refused():
    estimate, truth = paths(1, 5)
    for length in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(ValueError, match="length must be finite and positive"):
            evaluation.relative_error(estimate, truth, length)
    with pytest.raises(ValueError, match="stride must be 1 or more"):
        evaluation.segments(truth, 1.0, stride=0)
    with pytest.raises(ValueError, match="align must be"):
        evaluation.align(estimate, truth, "sim3")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="rows must be in 0 to 5"):
        evaluation.relative_error(estimate, truth, rows=[(0, 6)])


def test_truth_between_its_stamps():
    poses = [(0.0, 0.0, 3.0), (1.0, 0.0, -3.0), (1.0, 2.0, -2.8)]
    truth = GroundTruth([0.0, 1.0, 3.0], poses, max_gap=2.0)
    half = math.pi - 3.0
    assert_allclose(truth.at([0.5, 2.0])[:, :2], [(0.5, 0.0), (1.0, 1.0)])
    assert_allclose(truth.at([0.5, 2.0])[:, 2], [3.0 + half, -2.9])
    assert np.isnan(truth.at([-0.1, 3.1])).all()


# --- against the package evo -----------------------------------------------------------------------------


def evo_path(poses: np.ndarray):
    """Turned into evo's matrices."""
    trajectory = pytest.importorskip("evo.core.trajectory", reason="the package evo is not installed")
    matrices = np.tile(np.eye(4), (len(poses), 1, 1))
    cos, sin = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    matrices[:, 0, 0], matrices[:, 0, 1], matrices[:, 1, 0], matrices[:, 1, 1] = cos, -sin, sin, cos
    matrices[:, :2, 3] = poses[:, :2]
    return trajectory.PosePath3D(poses_se3=list(matrices))


@pytest.mark.parametrize("seed", range(5))
def test_absolute_errors_are_those_of_evo(seed):
    estimate, truth = paths(seed)
    estimate = moved((1.0, -2.0, 0.7), estimate)
    reference, other = evo_path(truth), evo_path(estimate)
    from evo.core import metrics

    for how, place in (("first", "align_origin"), ("se2", "align")):
        aligned = evo_path(estimate)
        getattr(aligned, place)(reference)
        position = metrics.APE(metrics.PoseRelation.translation_part)
        heading = metrics.APE(metrics.PoseRelation.rotation_angle_rad)
        position.process_data((reference, aligned))
        heading.process_data((reference, aligned))
        ours = evaluation.absolute_error(estimate, truth, how)
        assert_allclose(ours.position, position.error, atol=1e-9)
        # evo takes the angle from a rotation matrix of single places: good to 1e-7 near zero.
        assert_allclose(np.abs(ours.heading), heading.error, atol=1e-6)
        assert ours.rmse == pytest.approx(position.get_statistic(metrics.StatisticsType.rmse), rel=1e-9)
    assert evaluation.path_distance(truth)[-1] == pytest.approx(reference.path_length, rel=1e-12)
    assert other.num_poses == len(estimate)


def paths_in_space(seed: int, count: int = 200) -> tuple[np.ndarray, np.ndarray]:
    """A path over bumps, steep ones among them, and a noisy copy of it in a world of its own."""
    random = np.random.default_rng(seed)
    _, truth = paths(seed, count)
    along = np.linspace(0.0, 9.0, len(truth))
    space = np.column_stack((0.3 * np.sin(along), 0.6 * np.sin(2 * along), 1.2 * np.cos(along)))
    truth = np.column_stack((truth[:, :2], space, truth[:, 2]))
    estimate = truth + random.normal(0.0, 0.01, truth.shape)
    return estimate, truth


def evo_space(poses: np.ndarray):
    """The same path by evo, turned by its own package of rotations."""
    trajectory = pytest.importorskip("evo.core.trajectory", reason="the package evo is not installed")
    from scipy.spatial.transform import Rotation

    matrices = np.tile(np.eye(4), (len(poses), 1, 1))
    matrices[:, :3, :3] = Rotation.from_euler("ZYX", poses[:, :2:-1]).as_matrix()
    matrices[:, :3, 3] = poses[:, :3]
    return trajectory.PosePath3D(poses_se3=list(matrices))


@pytest.mark.parametrize("seed", range(3))
def test_errors_in_space_are_those_of_evo(seed):
    estimate, truth = paths_in_space(seed)
    reference = evo_space(truth)
    from evo.core import metrics

    assert evaluation.path_distance(truth)[-1] == pytest.approx(reference.path_length, rel=1e-12)
    for how, place in (("first", "align_origin"), ("se3", "align"), ("none", None)):
        aligned = evo_space(estimate)
        if place is not None:
            getattr(aligned, place)(reference)
        ours = evaluation.absolute_error(estimate, truth, how)
        for relation, error in (("translation_part", ours.position), ("rotation_angle_rad", ours.heading)):
            theirs = metrics.APE(metrics.PoseRelation[relation])
            theirs.process_data((reference, aligned))
            assert_allclose(error, theirs.error, atol=1e-7)
        moved_back = evo_space(evaluation.align(estimate, truth, how))
        assert_allclose(moved_back.positions_xyz, aligned.positions_xyz, atol=1e-9)
    pairs = evaluation.segments(truth, 0.5, stride=None)
    ours = evaluation.relative_error(estimate, truth, 0.5, rows=pairs)
    for relation, error in (("translation_part", ours.position), ("rotation_angle_rad", ours.heading)):
        theirs = metrics.RPE(
            metrics.PoseRelation[relation], 0.5, metrics.Unit.meters, pairs_from_reference=True
        )
        theirs.process_data((reference, evo_space(estimate)))
        assert_allclose(error, theirs.error, atol=1e-7)


@pytest.mark.parametrize("seed", range(3))
def test_a_path_in_the_plane_has_the_same_errors_as_one_in_space(seed):
    flat = paths(seed)
    tall = [np.column_stack((path[:, :2], np.zeros((len(path), 3)), path[:, 2])) for path in flat]
    plane, space = evaluation.evaluate(*flat), evaluation.evaluate(*tall)
    assert_allclose(space.first.position, plane.first.position, atol=1e-12)
    assert_allclose(space.first.heading, np.abs(plane.first.heading), atol=1e-12)
    assert_allclose(space.aligned.position, plane.aligned.position, atol=1e-9)
    assert space.relative.rmse == pytest.approx(plane.relative.rmse, rel=1e-9)
    assert space.distance == plane.distance


def test_alignments_of_the_other_space_are_refused():
    estimate, truth = paths_in_space(0, 20)
    with pytest.raises(ValueError, match="align must be 'first', 'se3' or 'none', got 'se2'"):
        evaluation.align(estimate, truth, "se2")
    with pytest.raises(ValueError, match="align must be 'first', 'se2' or 'none', got 'se3'"):
        evaluation.align(*paths(0, 20), "se3")
    with pytest.raises(ValueError, match=r"estimate must have shape \(n, 6\), n >= 1, got \(21, 3\)"):
        evaluation.evaluate(estimate[:, :3], truth)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("all_pairs", [False, True])
def test_relative_errors_are_those_of_evo(seed, all_pairs):
    estimate, truth = paths(seed)
    reference, other = evo_path(truth), evo_path(estimate)
    from evo.core import metrics

    length = 0.5
    pairs = metrics.id_pairs_from_delta(
        reference.poses_se3, length, metrics.Unit.meters, rel_tol=0.1, all_pairs=all_pairs
    )
    if not all_pairs:
        assert_allclose(evaluation.segments(truth, length, stride=None), pairs)
    for relation, name in (("translation_part", "position"), ("rotation_angle_rad", "heading")):
        theirs = metrics.RPE(
            metrics.PoseRelation[relation],
            length,
            metrics.Unit.meters,
            all_pairs=all_pairs,
            pairs_from_reference=True,
        )
        theirs.process_data((reference, other))
        ours = evaluation.relative_error(estimate, truth, length, rows=pairs)
        assert_allclose(np.abs(getattr(ours, name)), theirs.error, atol=1e-6)


# --- against published figures ---------------------------------------------------------------------------


@REQUIRED
@pytest.mark.parametrize("robot", ROBOTS)
def test_nominal_dimensions_give_the_published_errors(robot):
    assert len(RUNS[robot]) > 0
    for run in RUNS[robot]:
        rover, log = read(run)
        assert len(log) == run["n"]
        result = evaluation.evaluate(reckon(rover, log), log.truth.poses).to_dict()
        published = run["nominal"]
        assert result["distance_m"] == pytest.approx(run["path_m"], abs=1e-5)
        assert abs(result["final_deg"]) == pytest.approx(published["final_deg"], rel=0.02)
        for ours, theirs in {
            "ate_first_m": "ate_first",
            "ate_se2_m": "ate_se2",
            "final_m": "final_m",
            "relative_percent": "rpe_trans_pct",
            "relative_deg": "rpe_rot_deg",
        }.items():
            if published[theirs] is None:  # the run is shorter than a stretch
                assert math.isnan(result[ours])
            else:
                assert result[ours] == pytest.approx(published[theirs], rel=0.02), (run["run"], ours)
