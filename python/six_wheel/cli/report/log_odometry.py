"""Results of dead reckoning in words: for the console, and as a written report."""

import math
from collections.abc import Mapping

from six_wheel.cli.report.markdown import picture, table
from six_wheel.kinematics.odometry.tracks import ROUNDING, SILENT
from six_wheel.log_odometry.evaluation.paths import Evaluation
from six_wheel.log_odometry.results import Reckoned
from six_wheel.log_odometry.run_log import REMARKS

Rows = list[tuple[str, str]]
WINDOWS = 5  # stretches of slip that the console shows, the longest ones


def facts(result: Reckoned) -> Rows:
    """The run, its end, and what was wrong with its rows."""
    x, y, yaw = result.pose.tolist()
    dx, dy, dyaw = result.deviations.tolist()
    end = f"x {x:.4f} ± {dx:.4f} m, y {y:.4f} ± {dy:.4f} m, "
    end += f"yaw {yaw:.4f} ± {dyaw:.4f} rad ({math.degrees(yaw):.2f}° ± {math.degrees(dyaw):.2f}°)"
    rows = [
        ("rows", f"{result.rows:,}"),
        ("duration", f"{result.duration:.6g} s"),
        ("distance", f"{result.distance:.6g} m"),
        ("end pose (1 σ)", end),
    ]
    out = [f"{reason}: {count}" for reason, count in result.left_out.items()]
    rows.append(("rows left out", "\n".join(out) if out else "none"))
    rows += [(REMARKS[flag], str(count)) for flag, count in result.flags.items()]
    if result.placed is not None:
        said = f"{result.placed.rmse:.4f} m after the best alignment: positions alone tell no heading"
        rows.append(("ATE", said))
    if result.gyroscope_bias is not None:
        bias, spread = result.gyroscope_bias
        rows.append(("gyroscope", f"its bias at the end {bias:.3g} ± {spread:.2g} rad/s"))
    return rows


def slipped(result: Reckoned) -> Rows:
    """Rows on the wheel that disagrees most with the others, and on the times of slip."""
    slip = result.slip
    if not slip.observable:
        known = _lost(result)
        return [("wheels", SILENT + ("" if known else "; a gyroscope or a truth can tell")), *known]
    worst = max(slip.wheels, key=lambda wheel: wheel.rms, default=None)
    if worst is None or worst.worst <= ROUNDING:
        return [("wheels", "none contradicts another"), *_lost(result)]
    rows = [
        (
            "most at odds",
            f"{worst.name}: slides {1e3 * worst.rms:.3g} mm/s rms, {1e3 * worst.worst:.3g} mm/s at most "
            f"(row {worst.worst_row}), more than any other {100 * worst.worst_share:.0f} % of the time",
        )
    ]
    windows = {
        f"{window.wheel}, {window.start:.6g} s to {window.end:.6g} s (rows {window.first_row} to "
        f"{window.last_row})": window.distance
        for window in slip.windows
    }
    return [*rows, ("slip", _longest(windows) or "no stretch in which a wheel slipped"), *_lost(result)]


def _longest(stretches: Mapping[str, float]) -> str:
    """A line for each of the longest stretches by how far a wheel slid in them [m]; empty without any."""
    longest = sorted(stretches.items(), key=lambda one: -one[1])[:WINDOWS]
    lines = [f"{name}: {1e3 * distance:.3g} mm" for name, distance in longest]
    more = len(stretches) - len(longest)
    return "\n".join([*lines, f"and {more} more"] if more else lines)


def _lost(result: Reckoned) -> Rows:
    """Stretches in which the truth moved otherwise than the wheels said; nothing without a truth."""
    if result.evaluation is None:
        return []
    stretches = {str(one): one.distance for one in result.lost}
    return [("slip by the truth", _longest(stretches) or "no stretch")]


def judged(evaluation: Evaluation | None) -> Rows:
    """The errors against the truth, nothing without one."""
    if evaluation is None:
        return []
    first, aligned, relative = evaluation.first, evaluation.aligned, evaluation.relative
    end = f"{first.final:.4f} m, {math.degrees(first.final_heading):+.2f}°"
    rows = [
        ("true distance", f"{evaluation.distance:.6g} m"),
        (
            "ATE",
            f"{first.rmse:.4f} m with the first pose given, {aligned.rmse:.4f} m after the best alignment",
        ),
        ("error at the end", end),
    ]
    if len(relative.rows):
        turn = math.degrees(relative.yaw_rmse)
        rows.append(
            ("error per distance", f"{relative.percent:.2f} % and {turn:.2f}° over {relative.length:g} m")
        )
    return rows


def written(result: Reckoned, picture_name: str) -> str:
    """The written report in Markdown, with the name of its picture."""
    wheels = [
        (
            wheel.name,
            f"{1e3 * wheel.rms:.3f}",
            f"{1e3 * wheel.mean:.3f}",
            f"{1e3 * wheel.worst:.3f}",
            str(wheel.worst_row),
            f"{100 * wheel.worst_share:.0f} %",
        )
        for wheel in result.slip.wheels
    ]
    heads = ("wheel", "rms [mm/s]", "mean [mm/s]", "worst [mm/s]", "in row", "most at odds")
    windows = [
        (
            f"{window.start:.3f} to {window.end:.3f}",
            f"{window.first_row} to {window.last_row}",
            window.wheel,
            f"{1e3 * window.distance:.2f}",
        )
        for window in result.slip.windows
    ]
    parts = [
        f"# Odometry of {result.name}",
        picture("path, errors and how the wheels slid", picture_name),
        "The ellipses hold the true position in 95 of 100 cases if the noise is as stated.",
        table(("", ""), facts(result)),
    ]
    if result.evaluation is not None:
        parts += [
            "## Against the truth",
            table(("", ""), judged(result.evaluation)),
            _growth(result.evaluation),
        ]
    parts += [
        "## Wheels",
        "How fast a contact slides if the fitted motion is the true one.",
        table(heads, wheels),
    ]
    if not result.slip.observable:
        parts.append(f"{SILENT[0].upper()}{SILENT[1:]}.")
    if result.lost:
        rows = [(f"{one.start:.2f} to {one.end:.2f}", f"{1e3 * one.distance:.1f}") for one in result.lost]
        parts += ["## Slip by the truth", table(("time [s]", "slid [mm]"), rows)]
    if windows:
        parts += ["## Slip", table(("time [s]", "rows", "wheel", "slid [mm]"), windows)]
    if result.warnings:
        parts += ["## Warnings", "\n".join(f"- {warning}" for warning in result.warnings)]
    return "\n\n".join(parts) + "\n"


def _growth(evaluation: Evaluation) -> str:
    growth = evaluation.growth
    rows = [
        (f"{length:.3g}", f"{position:.4f}", f"{100 * position / length:.2f}", f"{math.degrees(heading):.2f}")
        for length, position, heading in zip(growth.length, growth.position, growth.heading, strict=True)
    ]
    return table(("stretch [m]", "error, rms [m]", "[%]", "heading, rms [°]"), rows)
