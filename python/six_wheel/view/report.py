"""The numbers of a motion as HTML that can be selected and copied."""

from __future__ import annotations

from html import escape

import numpy as np

from six_wheel.view.motion import Motion, words
from six_wheel.view.subject import Subject

STYLE = "font: 12px/1.5 ui-monospace, monospace; padding: 0 .9em; white-space: pre-wrap; user-select: text"
LEGEND = (
    f'<div style="{STYLE}">Upwards: the first axis of the plane, to the left: the second. '
    '<b style="color:#26a69e">Teal</b>: possible, <b style="color:#c99a2e">amber</b>: beyond a speed limit, '
    '<b style="color:#e25c58">hatched red</b>: wheels would slide. White: commanded, black: driven.</div>'
)


def status(subject: Subject, motion: Motion) -> str:
    """The feasibility, the twist driven and the attitude."""
    lines = [f"<b>{escape(words(subject, motion))}</b>"]
    vx, vy, omega = motion.twist.tolist()
    lines.append(f"driven {vx:+.4f} {vy:+.4f} m/s {np.degrees(omega):+.3f}°/s")
    if motion.stand is not None and motion.stands:
        stand = motion.stand
        lines.append(
            f"roll {np.degrees(stand.roll):+.1f}° pitch {np.degrees(stand.pitch):+.1f}° z {stand.z:.3f} m"
        )
        names = [name.replace("rho", "rocker").replace("beta_1", "bogie L").replace("beta_2", "bogie R")
                 for name in ("rho", "beta_1", "beta_2")]  # fmt: skip
        lines.append(
            " ".join(f"{n} {a:+.1f}°" for n, a in zip(names, np.degrees(motion.joints), strict=True))
        )
        if (stability := motion.stability) is not None:
            tilt = float(np.degrees(stability.tilt))
            over = " over the limit" if tilt > np.degrees(motion.state.tilt) else ""
            lines.append(
                f"tilt {tilt:.1f}°{over}, tips over {np.degrees(stability.tip_over_angle):.1f}° from here"
            )
        if motion.hanging:
            lines.append(f"in the air: {escape(', '.join(motion.hanging))}")
    if np.isfinite(motion.icr).all() and motion.twist[2]:
        x, y = motion.icr
        lines.append(f"centre of rotation {x:+.3f} {y:+.3f} m")
    lines += [escape(remark) for remark in motion.remarks]
    return f'<div style="{STYLE}">' + "<br>".join(lines) + "</div>"


def numbers(subject: Subject, motion: Motion) -> str:
    """A row for every wheel: steering, speed, sliding, load and contact."""
    head = ["wheel", "steer °", "rad/s", "slides mm/s"]
    steering = iter(np.degrees(motion.steering).tolist())
    rows = []
    loads = contacts = None
    if motion.stand is not None and motion.stands:
        head += ["load %", "contact °"]
        contacts = np.degrees(motion.stand.contact_angles)
        if motion.stability is not None:
            loads = 100.0 * motion.stability.loads / np.sum(motion.stability.loads)
    for k, wheel in enumerate(subject.rover.wheels):
        row = [wheel.name.replace("_", " "), f"{next(steering):+.2f}" if wheel.steered else ""]
        row += [f"{motion.wheel_speeds[k]:+.4f}", f"{1000.0 * motion.slide[k]:.2f}"]
        if contacts is not None:
            row += ["" if loads is None else f"{loads[k]:.1f}", f"{contacts[k]:+.1f}"]
        rows.append(row)
    cell = 'style="padding:0 .5em 0 0;text-align:right"'
    table = "".join(
        "<tr>" + "".join(f"<{tag} {cell}>{escape(text)}</{tag}>" for text in row) + "</tr>"
        for tag, row in [("th", head), *(("td", row) for row in rows)]
    )
    return f'<div style="{STYLE};overflow-x:auto"><table>{table}</table></div>'


def lines_to_say(command: str | None, python: str) -> str:
    """The command line and the Python lines of the picture."""
    blocks = [python] if command is None else [command, python]
    return f'<div style="{STYLE}">' + "<hr>".join(escape(block) for block in blocks) + "</div>"


def failure(error: Exception) -> str:
    """An error, for the place of the status."""
    return f'<div style="{STYLE}"><b>{escape(type(error).__name__)}</b>: {escape(str(error))}</div>'
