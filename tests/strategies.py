"""Random rovers and the twists they can make."""

from hypothesis import settings
from hypothesis import strategies as st

import six_wheel as sw


def at_most(cases: int) -> settings:
    """So many cases of a law, or those of the profile where it has fewer (`make quick`)."""
    return settings(max_examples=min(cases, settings().max_examples))


def offsets(largest: float) -> st.SearchStrategy[float]:
    """Zero or at least a micrometre: less on a metre is what counts as rounding of an axle's place."""
    return st.floats(-largest, largest).map(lambda value: round(value, 6))


def lengths(smallest: float = 0.05, largest: float = 3.0) -> st.SearchStrategy[float]:
    return st.floats(smallest, largest)


@st.composite
def six_wheel_rovers(draw: st.DrawFn, limits: st.SearchStrategy[float] | None = None) -> sw.Rover:
    names = ("front_to_middle", "middle_to_rear", "track_width", "middle_track_width")
    dimensions = {name: draw(lengths()) for name in names}
    limit = draw(limits) if limits is not None else None
    return sw.Rover.six_wheel(**dimensions, wheel_radius=draw(st.floats(0.02, 0.5)), steering_limit=limit)


def speeds(largest: float = 3.0) -> st.SearchStrategy[float]:
    """Zero and both signs, nothing between zero and a micrometre per second."""
    return st.one_of(st.just(0.0), st.floats(1e-6, largest), st.floats(-largest, -1e-6))


def forward_twists() -> st.SearchStrategy[tuple[float, float, float]]:
    """Twists that six-wheel rovers can make: straight, spin, rest and every radius between."""
    return st.tuples(speeds(), st.just(0.0), speeds())


def any_twists() -> st.SearchStrategy[tuple[float, float, float]]:
    return st.tuples(speeds(), speeds(), speeds())


@st.composite
def layouts(draw: st.DrawFn, *, offset: bool = False) -> sw.Rover:
    """Steered wheels anywhere, at most one axle line of fixed ones, scrub and trail if asked for."""
    count = draw(st.integers(2, 6))
    wheels = []
    for i in range(count):
        # A grid point each, so that no two pivots coincide.
        x, y = 0.4 * (i % 3) + draw(offsets(0.1)), 0.5 * (i // 3) + draw(offsets(0.1))
        wheels.append(
            sw.Wheel(
                f"steered_{i}",
                x,
                y,
                radius=draw(st.floats(0.05, 0.3)),
                steered=True,
                heading=draw(st.floats(-3.0, 3.0)),
                scrub=draw(offsets(0.1)) if offset else 0.0,
            )
        )
    axle = draw(offsets(0.5))
    for i in range(draw(st.integers(0, 2))):
        wheels.append(sw.Wheel(f"fixed_{i}", axle, 0.6 * i - 0.3, radius=draw(st.floats(0.05, 0.3))))
    return sw.Rover(wheels)
