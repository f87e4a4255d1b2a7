"""A drive over ground in words."""

import numpy as np

from six_wheel.simulation.on_terrain import GroundSimulation


def ground_facts(run: GroundSimulation) -> list[tuple[str, str]]:
    """Results of a drive: names and values, a row each."""
    stand, flat = run.stand, run.flat_wheel_speeds
    statuses = np.asarray(stand.status).astype(str).tolist()
    tilt = np.degrees(np.arccos(np.cos(stand.roll) * np.cos(stand.pitch)))
    driving = np.abs(flat) > 1e-9
    off = np.abs(run.wheel_speeds - flat)[driving] / np.abs(flat)[driving]
    counted = ", ".join(f"{status} {statuses.count(status):,}" for status in dict.fromkeys(statuses))
    return [
        ("samples", f"{len(run.stamps):,}, {counted}"),
        ("duration", f"{run.stamps[-1] - run.stamps[0]:.6g} s"),
        ("largest tilt", f"{np.nanmax(tilt):.3g}°"),
        ("largest joint angle", f"{np.degrees(np.nanmax(np.abs(stand.joints))):.3g}°"),
        ("largest slip angle", f"{np.degrees(np.nanmax(np.abs(run.slip.angle))):.3g}°"),
        ("wheel speeds", f"off those on level ground by {np.median(off):.1%}, at most {off.max():.1%}")
        if off.size
        else ("wheel speeds", "all 0"),
    ]
