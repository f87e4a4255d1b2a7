"""Common parts of all pictures: colours, frame, sizes of a rover, and the rover from above."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import io
import textwrap
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Ellipse, FancyBboxPatch, Polygon
from matplotlib.ticker import ScalarFormatter
from matplotlib.transforms import Affine2D, Transform
from numpy.typing import ArrayLike, NDArray

from six_wheel._core import Rover, Wheel
from six_wheel.kinematics.poses import Floats

INK, SOFT, FAINT = "#22303c", "#64717d", "#d5dbe0"
BODY, WHEEL, AXLE = "#e9e3d8", "#33424f", "#4a7fa7"
MOTION, CENTRE, TRACK = "#2a7f62", "#c1440e", "#ddd2bf"  # CENTRE is a centre of rotation in every picture
MINUS = "\N{MINUS SIGN}"
FORBIDDEN, RECORDED = "#8e2f5b", "#e0a050"
# Lines of one picture, which the colour-blind tell apart.
# Source: M. Okabe, K. Ito, Color universal design, 2008.
SERIES = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00")
LABEL, TICK = 9, 8.5  # [pt] of the words at an axis, of its numbers
LETTERS = 14.5  # of size `LABEL` in an inch, about
LIKELY = 5.991  # chi squared of two degrees of freedom at 95 %: the ellipse a position is in that often
DRAWN = 5000  # points of a line at most, more than any screen shows
TINY = 2e-3  # ends of an axis below which its numbers have a power of ten in common
FORWARD_UP = np.pi / 2  # yaw that turns x forward to the top of the page, so that left is left
WHEEL_WIDTH = 0.45  # of its diameter; a Rover does not know how wide its wheels are


def draw_rover(
    axes: Axes,
    rover: Rover,
    pose: ArrayLike = (0.0, 0.0, 0.0),
    steering: ArrayLike | None = None,
    *,
    fade: float = 0.0,
    scale: float = 1.0,
    body_color: str = BODY,
    wheel_color: str = WHEEL,
    treads: bool = True,
    zorder: float = 3.0,
) -> None:
    """Draw a rover from above at its true size.

    Wheels without a motor are pale; rollers are stripes along their axes, as seen from above; castors stand
    in the ring in which they swivel. A cross marks where an unsteered wheel acts, if that is not where it is.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Axes to draw on; their limits are left alone.
    rover : Rover
        Any layout of wheels.
    pose : array_like, shape (3,)
        x, y, yaw of the body in the axes' frame [m, m, rad].
    steering : array_like, shape (steered wheels,), optional
        Angles of the steered wheels from their headings [rad]; straight without it.
    fade, scale, body_color, wheel_color, treads, zorder
        Share of white in the colours (0 to 1), enlargement, colours, lines across the wheels, and
        height above other drawings.

    Raises
    ------
    ValueError
        If `steering` does not hold one angle per steered wheel.
    """
    x, y, yaw = (float(value) for value in np.asarray(pose, dtype=np.float64))
    page_from_body = Affine2D().scale(scale).rotate(yaw).translate(x, y) + axes.transData
    angles = headings(rover, steering)
    if angles.shape != (len(rover.wheels),):
        raise ValueError(f"steering must be one row of angles, got {len(angles)} rows")
    drawing = _FromAbove(axes, page_from_body, *body_box(rover), fade, wheel_color, treads, zorder)
    drawing.body(_faded(body_color, fade))
    for wheel, angle in zip(rover.wheels, angles.tolist(), strict=True):
        drawing.wheel(wheel, angle)


@dataclass(frozen=True)
class _FromAbove:
    """A rover that is drawn from above: where its body is, and how it is drawn."""

    axes: Axes
    page_from_body: Transform
    centre: Floats
    half: Floats
    fade: float
    wheel_color: str
    treads: bool
    zorder: float

    @property
    def ink(self) -> tuple[float, float, float]:
        return _faded(INK, self.fade)

    @property
    def soft(self) -> tuple[float, float, float]:
        return _faded(SOFT, self.fade)

    def body(self, fill: tuple[float, float, float]) -> None:
        """The body, and the nose that tells its front."""
        centre, half = self.centre, self.half
        self._box(centre, 2 * half, 0.3 * half.min(), fill, 0.9, 0.1, self.page_from_body)
        tip, base, side = centre[0] + 0.82 * half[0], centre[0] + 0.5 * half[0], 0.3 * half[1]
        corners = [(tip, centre[1]), (base, centre[1] + side), (base, centre[1] - side)]
        self._add(Polygon(corners, facecolor=self.soft, linewidth=0), 0.2, self.page_from_body)

    def wheel(self, wheel: Wheel, angle: float) -> None:
        """A wheel at an angle from straight ahead, and the arms that hold it."""
        length, width = 2 * wheel.radius, 2 * wheel.radius * WHEEL_WIDTH
        frame = Affine2D().rotate(angle).translate(wheel.x, wheel.y) + self.page_from_body
        contact = np.array((-wheel.trail, wheel.scrub))
        middle = contact if wheel.steered or wheel.castor else np.zeros(2)
        pivot = np.array((wheel.x, wheel.y))
        at_body = np.clip(pivot, self.centre - self.half, self.centre + self.half)
        for ends, place in (((pivot, at_body), self.page_from_body), ((np.zeros(2), contact), frame)):
            self._add(Line2D(*np.transpose(ends), color=self.soft, linewidth=1.4), 0.0, place)
        pale = 0.0 if wheel.driven and wheel.roller_angle is None else 0.7
        fill = _faded(self.wheel_color, self.fade + (1.0 - self.fade) * pale)
        tyre = self._box(middle, np.array((length, width)), 0.3 * width, fill, 0.8, 0.3, frame)
        if np.any(contact != middle):
            self._add(Line2D(*contact[:, None], marker="x", color=self.ink), 0.5, frame)
        if wheel.castor:  # the circle in which it swivels
            reach = float(np.hypot(abs(wheel.trail) + length / 2, abs(wheel.scrub) + width / 2))
            look = {"edgecolor": self.soft, "linewidth": 0.9, "linestyle": (0, (4, 3))}
            self._add(Circle((wheel.x, wheel.y), reach, fill=False, **look), 0.2, self.page_from_body)
        if wheel.roller_angle is not None:
            color = _faded(self.wheel_color, self.fade)
            stripes = LineCollection(_rollers(wheel, length, width), linewidths=1.6, colors=color)
            self._add(stripes, 0.4, frame)
            stripes.set_clip_path(tyre)
        elif self.treads:
            across = np.array(
                [[(u, -0.3 * width), (u, 0.3 * width)] for u in np.linspace(-0.32, 0.32, 5) * length]
            )
            fill = to_rgb("white") if wheel.driven else self.ink
            treads = LineCollection(list(across + middle), colors=fill, linewidths=0.7, alpha=0.45)
            self._add(treads, 0.4, frame)

    def _box(
        self,
        middle: Floats,
        size: Floats,
        corner: float,
        fill: Any,
        line: float,
        up: float,
        frame: Transform,
    ) -> FancyBboxPatch:
        """A box with round corners."""
        round_ = f"round,pad=0,rounding_size={corner}"
        width, height = size
        look = {"facecolor": fill, "edgecolor": self.ink, "linewidth": line}
        box = FancyBboxPatch(tuple(middle - size / 2), width, height, boxstyle=round_, **look)
        self._add(box, up, frame)
        return box

    def _add(self, artist: Artist, up: float, frame: Transform) -> None:
        """Draw in a frame, so much above the rover; the limits of the axes stay as they are."""
        artist.set(zorder=self.zorder + up, transform=frame)
        self.axes.add_artist(artist)


def _rollers(wheel: Wheel, length: float, width: float) -> list[Floats]:
    """Ends of the axes of the rollers on top of a wheel, which lean the other way than those below."""
    angle = wheel.roller_angle or 0.0
    along, across = np.array((-np.sin(angle), np.cos(angle))), np.array((np.cos(angle), np.sin(angle)))
    reach = abs(across[0]) * length / 2 + abs(across[1]) * width / 2
    count = max(3, 2 * round(2.5 * reach / width) + 1)
    middles = np.linspace(-reach, reach, count + 2)[1:-1, None] * across
    return list(np.stack((middles - length * along, middles + length * along), axis=1))


def _faded(color: str, fade: float) -> tuple[float, float, float]:
    """A colour on its way to white. Unlike transparency it still hides what lies underneath."""
    red, green, blue = (1.0 - (1.0 - fade) * (1.0 - part) for part in to_rgb(color))
    return red, green, blue


LARGEST = 72_000  # [B] of a picture in a notebook: 96 kB in its cell, in base64
PAGE_WIDTH = 7.2  # [in] of a result's picture: 720 pixels of a page, on which its smallest words are 11 high


class Picture(Figure):
    """A figure that a notebook shows without a magic."""

    def _repr_png_(self) -> bytes:
        """The picture at 100 pixels an inch in 256 colours; in fewer where it were larger than `LARGEST`."""
        from PIL import Image

        whole = io.BytesIO()
        self.savefig(whole, format="rgba", dpi=100)
        width, height = self.canvas.get_width_height()
        image = Image.frombytes("RGBA", (width, height), whole.getvalue()).convert("RGB")
        for share, colours in ((1.0, 256), (1.0, 48), (1.0, 16), (0.6, 16), (0.4, 16)):
            small = io.BytesIO()
            fewer = image if share == 1.0 else image.resize((round(share * width), round(share * height)))
            fewer.quantize(colours, dither=Image.Dither.NONE).save(small, format="png", optimize=True)
            if small.tell() <= LARGEST:
                break
        return small.getvalue()


def new_figure(width: float, height: float) -> Figure:
    """A white figure of this size [in], tied to no window."""
    figure = Picture(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def page_figure(height: float) -> Figure:
    """A figure as wide as a page, and of this height [in]."""
    return new_figure(PAGE_WIDTH, height)


def one_axes(height: float, width: float = PAGE_WIDTH) -> Axes:
    """The only axes in a figure of this size [in]."""
    return new_figure(width, height).add_subplot()


def figure_of(axes: Axes) -> Figure:
    """The figure that holds the axes, which are in no part of it."""
    figure = axes.figure
    assert isinstance(figure, Figure)
    return figure


def write_heading(figure: Figure, title: str | None) -> None:
    """A bold title over all of the picture."""
    if title is not None:
        figure.suptitle(title, x=0.012, ha="left", fontsize=13, color=INK, weight="bold")


def draw_legend(target: Axes | Figure, *lines: Any, **options: Any) -> None:
    """The legend without a frame, in the words of `tidy`; arguments as of matplotlib's ``legend``."""
    target.legend(*lines, **{"frameon": False, "fontsize": TICK, "labelcolor": INK} | options)


def covariance_ellipse(position: Floats, covariance: Floats, **look: Any) -> Ellipse:
    """The ellipse that holds a position in 95 of 100 cases, by its covariance (2, 2)."""
    values, vectors = np.linalg.eigh(covariance)
    wide, high = 2.0 * np.sqrt(LIKELY * np.maximum(values[::-1], 0.0))
    turn = float(np.degrees(np.arctan2(vectors[1, 1], vectors[0, 1])))
    return Ellipse((position[0], position[1]), wide, high, angle=turn, **look)


def equal_scales(axes: Axes, least: float = 0.0) -> None:
    """Give both axes one scale and `least` [m] at least, and their figure the height it asks for."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    wide, tall = max(right - left, least), max(high - low, least)
    share = min(max(tall / wide, 0.4), 0.8)
    half = np.array((max(wide, tall / share), max(tall, share * wide))) / 2
    x, y = (left + right) / 2, (low + high) / 2
    axes.set_aspect("equal")
    axes.set(xlim=(x - half[0], x + half[0]), ylim=(y - half[1], y + half[1]))
    figure_of(axes).set_size_inches(PAGE_WIDTH, share * (PAGE_WIDTH - 0.8) + 0.9)


def color_bar(drawn: ScalarMappable, axes: Axes, label: str) -> None:
    """The scale of colours beside the axes, in the words of `tidy`."""
    scale = figure_of(axes).colorbar(drawn, ax=axes, shrink=0.8)
    scale.set_label(label, fontsize=LABEL, color=SOFT)
    scale.outline.set_visible(False)
    scale.ax.tick_params(colors=SOFT, labelsize=TICK, length=0)


def fit_page(axes: Axes) -> None:
    """Make the page as wide and high as the only axes, in which lengths are alike, ask for: 8 in at most."""
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    longest = 8.0 / max(right - left, top - bottom)  # [in/m], and words need some room
    size = max(4.0, longest * (right - left)), max(3.0, longest * (top - bottom)) + 0.9
    figure_of(axes).set_size_inches(*size)


def tidy(axes: Axes, xlabel: str, ylabel: str) -> None:
    """The quiet frame every picture here shares."""
    axes.grid(True, color=FAINT, linewidth=0.5, alpha=0.6, zorder=0)
    axes.set_axisbelow(True)
    axes.tick_params(colors=SOFT, labelsize=TICK, length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)
    for axis in (axes.xaxis, axes.yaxis):
        if isinstance(axis.get_major_formatter(), ScalarFormatter) and axis.get_scale() == "linear":
            if np.abs(axis.get_view_interval()).max() > TINY:
                axis.set_major_formatter(lambda value, _: number(value))
            else:  # a power of ten at the end of the axis
                axis.get_offset_text().set(color=SOFT, fontsize=TICK)
    axes.set_xlabel(xlabel, fontsize=LABEL, color=SOFT)
    axes.set_ylabel(ylabel, fontsize=LABEL, color=SOFT)


def number(value: float, form: str = "g") -> str:
    """A number as every tick and word of a picture has it: no needless digits, a minus sign that is one."""
    return f"{round(value, 12) + 0.0:{form}}".replace("-", MINUS)


def headings(rover: Rover, steering: ArrayLike | None = None) -> Floats:
    """Heading of every wheel in the body [rad]: (..., steered wheels) -> (..., wheels); straight without."""
    steered = [wheel.steered for wheel in rover.wheels]
    angles = np.zeros(sum(steered)) if steering is None else np.asarray(steering, dtype=np.float64)
    if angles.shape[-1:] != (sum(steered),):
        raise ValueError(f"steering must have shape (..., {sum(steered)}), got {angles.shape}")
    found = np.broadcast_to(
        [wheel.heading for wheel in rover.wheels], (*angles.shape[:-1], len(steered))
    ).copy()
    found[..., steered] += angles
    return found


def contacts(rover: Rover, steering: ArrayLike | None = None) -> Floats:
    """Contacts of the wheels with the ground, in the body [m]: (..., steered wheels) -> (..., wheels, 2)."""
    x, y, trail, scrub = np.array([(wheel.x, wheel.y, wheel.trail, wheel.scrub) for wheel in rover.wheels]).T
    cosine, sine = np.cos(headings(rover, steering)), np.sin(headings(rover, steering))
    return np.stack((x - trail * cosine - scrub * sine, y - trail * sine + scrub * cosine), axis=-1)


def in_world(poses: Floats, points: Floats) -> Floats:
    """Points (k, 2) or (n, k, 2) of the body where poses (n, 3) put them: (n, k, 2)."""
    cosine, sine = np.cos(poses[:, 2:]), np.sin(poses[:, 2:])
    x = poses[:, :1] + cosine * points[..., 0] - sine * points[..., 1]
    y = poses[:, 1:2] + sine * points[..., 0] + cosine * points[..., 1]
    return np.stack((x, y), axis=-1)


def body_box(rover: Rover) -> tuple[Floats, Floats]:
    """Centre and half lengths, in body axes, of a body that fits between the wheels."""
    points = contacts(rover)
    for i, wheel in enumerate(rover.wheels):
        if not (wheel.steered or wheel.castor):
            points[i] = wheel.x, wheel.y
    radius = max(wheel.radius for wheel in rover.wheels)
    centre = (points.min(axis=0) + points.max(axis=0)) / 2
    reach = np.ptp(points, axis=0) / 2
    beside = np.abs(points[:, 1] - centre[1])
    clear = min((float(gap) for gap in beside if gap > 1e-9), default=0.0) - 1.3 * WHEEL_WIDTH * radius
    half_width = max(min(0.62 * reach[1], clear), 0.5 * radius)
    return centre, np.array((max(0.62 * reach[0], 1.2 * radius, 0.5 * half_width), half_width))


def few_rows(*arrays: NDArray[Any]) -> list[NDArray[Any]]:
    """The same rows of all, few enough to draw, the last one among them."""
    count = len(arrays[0])
    rows = np.unique(np.linspace(0, count - 1, min(count, DRAWN)).astype(int))
    return [array[rows] for array in arrays]


def page(points: Floats) -> Floats:
    """Body coordinates on the page, forward up: (x, y) stands at (-y, x)."""
    return np.stack((-points[..., 1], points[..., 0]), axis=-1)


def bounds(rover: Rover) -> tuple[Floats, Floats, float]:
    """Lower and upper corner of the wheels on the page, forward up, and half the diagonal between them."""
    points = page(contacts(rover))
    radius = max(wheel.radius for wheel in rover.wheels)
    low, high = points.min(axis=0) - radius, points.max(axis=0) + radius
    return low, high, float(np.hypot(*(high - low))) / 2


def write(
    axes: Axes, words: str, place: tuple[Any, Any], shift: tuple[float, float], size: float, **look: Any
) -> None:
    """Words of a size [pt], so many points from a place; `look` as of matplotlib's ``annotate``."""
    axes.annotate(words, place, shift, textcoords="offset points", fontsize=size, **{"color": INK} | look)


def with_title(axes: Axes, title: str | None, below: str) -> Figure:
    """The figure of axes, with quiet lines above them, no longer than it is wide, and a bold title."""
    figure = figure_of(axes)
    room = int(LETTERS * figure.bbox.width / figure.dpi * (1.0 - axes.get_position().x0))
    lines = [piece for line in below.splitlines() for piece in textwrap.wrap(line, max(room, 40))]
    axes.set_title("\n".join(lines), loc="left", fontsize=LABEL, color=SOFT)
    write_heading(figure, title)
    return figure
