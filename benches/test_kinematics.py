"""Inverse, forward and integrate: one call and batch, the core beside the plain reference.

Run by `make bench`. Times are of a call; a batch of the core has `ROWS` rows, one of the reference, which
takes its rows one by one, `FEW`. The group of a benchmark names the job, so that both stand together.
"""

import numpy as np
import pytest

import six_wheel as sw
from six_wheel import reference

ROWS, FEW = 100_000, 100

ROVER = sw.Rover.preset("perseverance")
PLAIN = reference.Rover.like(ROVER)
ANGLES = np.arange(ROWS) * 1e-3
TWISTS = np.stack([0.5 * np.cos(ANGLES), np.zeros(ROWS), 0.5 * np.sin(ANGLES)], axis=1)
STEERING, SPEEDS = ROVER.inverse(TWISTS)
ONE = (0.5, 0.0, 0.3)


def test_inputs_are_what_the_tests_trust():
    np.testing.assert_allclose(ROVER.forward(STEERING, SPEEDS), TWISTS, rtol=0, atol=1e-14)


@pytest.mark.benchmark(group="inverse, one call")
@pytest.mark.parametrize("rover", [ROVER, PLAIN], ids=["core", "reference"])
def test_inverse(benchmark, rover):
    benchmark(rover.inverse, ONE)


@pytest.mark.benchmark(group="inverse, one call")
def test_inverse_into_arrays(benchmark):
    benchmark(ROVER.inverse, ONE, out=(np.empty(4), np.empty(6)))


@pytest.mark.benchmark(group="forward, one call")
@pytest.mark.parametrize("rover", [ROVER, PLAIN], ids=["core", "reference"])
def test_forward(benchmark, rover):
    benchmark(rover.forward, STEERING[0], SPEEDS[0])


@pytest.mark.benchmark(group="inverse, batch")
def test_inverse_of_a_batch(benchmark):
    benchmark(ROVER.inverse, TWISTS, out=(np.empty((ROWS, 4)), np.empty((ROWS, 6))))


@pytest.mark.benchmark(group="inverse, batch")
def test_inverse_of_a_batch_by_the_reference(benchmark):
    benchmark(PLAIN.inverse, TWISTS[:FEW])


@pytest.mark.benchmark(group="forward, batch")
def test_forward_of_a_batch(benchmark):
    benchmark(ROVER.forward, STEERING, SPEEDS, out=np.empty((ROWS, 3)))


@pytest.mark.benchmark(group="forward, batch")
def test_forward_of_a_batch_by_the_reference(benchmark):
    benchmark(PLAIN.forward, STEERING[:FEW], SPEEDS[:FEW])


@pytest.mark.benchmark(group="integrate, batch")
def test_integrate(benchmark):
    benchmark(sw.integrate, TWISTS, 0.01, out=np.empty((ROWS + 1, 3)))


@pytest.mark.benchmark(group="integrate, batch")
def test_integrate_by_the_reference(benchmark):
    benchmark(reference.integrate, TWISTS[:FEW], 0.01)
