"""Pictures of lists: paths in one, other results one below the other."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from six_wheel.plotting.drawing import (
    PAGE_WIDTH,
    SERIES,
    draw_legend,
    equal_scales,
    one_axes,
    page_figure,
    tidy,
    with_title,
    write_heading,
)
from six_wheel.plotting.pictures.fields import LEAST

MOST = 6  # pictures below each other
DENSITY = 200  # pixels an inch of a picture inside another


def list_figure(results: Sequence[Any], *, title: str | None) -> Figure:
    """Paths in one picture; other results one below the other, those of one kind at the same scales."""
    from six_wheel.plotting.results import figure

    if not results:
        raise TypeError("a list must hold results that have pictures, got an empty one")
    if all(path_of(one) is not None for one in results):
        return paths_figure(results, title=title)
    if len(results) > MOST:
        raise TypeError(f"a list must hold at most {MOST} results, or paths, got {len(results)}")
    return stacked([figure(one) for one in results], [type(one) for one in results], title=title)


def path_of(result: Any) -> Any:
    """The poses of a track, a truth or a log that has one; None of anything else."""
    poses = getattr(getattr(result, "truth", None) or result, "poses", None)
    is_path = getattr(poses, "ndim", 0) == 2 and hasattr(result, "stamps")
    return poses if is_path else None


def paths_figure(results: Sequence[Any], *, title: str | None) -> Figure:
    """Several paths in one picture."""
    axes = one_axes(5.6)
    for number, one in enumerate(results):
        style = ("-", "--", ":")[number % 3]
        label = getattr(one, "name", "") or f"{type(one).__name__} {number + 1}"
        x, y = path_of(one)[:, :2].T
        axes.plot(x, y, color=SERIES[number % len(SERIES)], linestyle=style, linewidth=1.6, label=label)
    equal_scales(axes, LEAST)
    draw_legend(axes)
    tidy(axes, "x [m]", "y [m]")
    return with_title(axes, title, f"{len(results)} paths")


def stacked(pictures: Sequence[Figure], kinds: Sequence[type], *, title: str | None) -> Figure:
    """Pictures one below the other; axes of one kind of result have the same limits."""
    for kind in set(kinds):
        alike = [picture.axes for picture, one in zip(pictures, kinds, strict=True) if one is kind]
        if len({len(axes) for axes in alike}) == 1:
            for ones in zip(*alike, strict=True):
                _same_limits(ones)
    images = []
    for picture in pictures:
        picture.set_dpi(DENSITY)
        picture.canvas.draw()
        image: NDArray[np.uint8] = np.asarray(picture.canvas.buffer_rgba())  # type: ignore[attr-defined]
        images.append(image)
    heights = [image.shape[0] / image.shape[1] for image in images]
    figure = page_figure(PAGE_WIDTH * sum(heights) + (0.0 if title is None else 0.4))
    write_heading(figure, title)
    panels = figure.subplots(len(images), 1, height_ratios=heights, squeeze=False)[:, 0]
    for frame, image in zip(panels, images, strict=True):
        frame.imshow(image)
        frame.axis("off")
    return figure


def _same_limits(panels: Sequence[Any]) -> None:
    for limits, wide in (("xlim", "get_xlim"), ("ylim", "get_ylim")):
        ends = np.array([getattr(axes, wide)() for axes in panels])
        turned = ends[0, 0] > ends[0, 1]
        low, high = ends.min(), ends.max()
        for axes in panels:
            axes.set(**{limits: (high, low) if turned else (low, high)})
