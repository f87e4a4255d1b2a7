"""Every row of the tables under pytest-benchmark; `make bench` prints them with ratios and goals."""

import contenders
import pytest

CASES = [
    (job.name, name, timing)
    for job in (*contenders.calls(), *contenders.batches())
    for name, timing in job.timings.items()
]


@pytest.mark.parametrize(("job", "name", "timing"), CASES, ids=[f"{job}-{name}" for job, name, _ in CASES])
def test_row(benchmark, job, name, timing):
    benchmark.group = job
    benchmark.extra_info["items"] = timing.items
    benchmark(timing.once)
