"""Columns of results of the core that are tables over time."""

from __future__ import annotations  # NumPy is not loaded for its names

from typing import TYPE_CHECKING

from six_wheel.kinematics.objects.tables import Columns, Tabular, twist_columns

if TYPE_CHECKING:
    from six_wheel._core import ControllerRun


class RunTable(Tabular):
    """Stamps of the steps of a controller, joint commands by name, the motion, the bits of the reasons."""

    __slots__ = ("_run",)

    def __init__(self, run: ControllerRun) -> None:
        self._run = run

    def _columns(self) -> Columns:
        run, steering = self._run, self._run.rover.steering_joints
        joints: Columns = {
            joint: ("rad" if joint in steering else "rad/s", values) for joint, values in run.commands.items()
        }
        return (
            {"time": ("s", run.stamps)} | joints | twist_columns(run.twist) | {"reasons": ("", run.reasons)}
        )
