"""Coverage-guided fuzzing of the boundary by atheris: ``python fuzzed.py -max_total_time=60 corpus``.

Any arrays of any dtype, order and overlap: an answer, or an error of the library; never anything else, and
what is read stays as it was.
"""

import sys

import atheris
import numpy as np

from tests.rovers import CART, SWERVE

with atheris.instrument_imports(include=["six_wheel"]):
    import six_wheel as sw

ROVERS = [
    sw.Rover.preset("perseverance"),
    SWERVE,
    CART,
]
DTYPES = ["d", "f", "e", ">f8", "i4", "u8", "i1", "?", "O", "c16"]


@atheris.instrument_func
def array(data: "atheris.FuzzedDataProvider", memory: np.ndarray) -> np.ndarray:
    """A view of the shared memory, or an array of its own."""
    dtype = np.dtype(DTYPES[data.ConsumeIntInRange(0, len(DTYPES) - 1)])
    shape = [data.ConsumeIntInRange(0, 40) for _ in range(data.ConsumeIntInRange(0, 2))]
    shape.append([2, 3, 4, 6][data.ConsumeIntInRange(0, 3)])
    if dtype.char == "d" and data.ConsumeBool():
        strides = [8 * data.ConsumeIntInRange(0, 4) for _ in shape]
        reach = 8 + sum(
            (length - 1) * stride for length, stride in zip(shape, strides, strict=True) if length
        )
        start = data.ConsumeIntInRange(0, max(memory.nbytes - max(reach, 8), 0)) // 8
        return np.lib.stride_tricks.as_strided(memory[start:], shape, strides)
    count = int(np.prod(shape))
    if dtype.char == "O":
        return np.full(shape, None)
    values = np.frombuffer(data.ConsumeBytes(8 * count).ljust(8 * count, b"\0"), np.float64)
    with np.errstate(all="ignore"):
        return values.astype(dtype).reshape(shape)


@atheris.instrument_func
def one(given: bytes) -> None:
    """One call."""
    data = atheris.FuzzedDataProvider(given)
    memory = np.linspace(-1.0, 1.0, 1000)
    rover = ROVERS[data.ConsumeIntInRange(0, len(ROVERS) - 1)]
    a, b, c = (array(data, memory) for _ in range(3))
    calls = [
        lambda: rover.inverse(a, out=(b, c)),
        lambda: rover.inverse(a, previous=b, previous_wheel_speeds=c),
        lambda: rover.inverse(a, centre=b, steering_rates=c),
        lambda: rover.forward(a, b, out=c),
        lambda: rover.fit(a, b, method="robust"),
        lambda: rover.project(a, out=b),
        lambda: sw.integrate(a, b, c),
        lambda: sw.integrate(a, 0.1, out=b),
        lambda: sw.compose(a, b),
        lambda: sw.exp(a, b),
        lambda: sw.Odometry(rover).run(a, b, c),
        lambda: sw.Controller(rover).run(a, b, c),
    ]
    before = memory.tobytes()
    call = calls[data.ConsumeIntInRange(0, len(calls) - 1)]
    try:
        call()
    except ValueError:  # every error of the library is one
        if memory.tobytes() != before:
            raise AssertionError("a failed call has written") from None


if __name__ == "__main__":
    np.seterr(all="ignore")
    atheris.Setup(sys.argv, one)
    atheris.Fuzz()
