"""A rover's true dimensions from its logs: what fits them, how well it is known, what they cannot tell.

What `six_wheel.robot_description.dimensions` names is calibrated from `drives`; `model` says where these
end, `fitting` solves, `observability` and `cross_validation` judge, `run_calibration` joins them to a
`result`; `files` does it for logs on disk.
"""

from typing import TYPE_CHECKING

from six_wheel.kinematics.lazy import attach
from six_wheel.robot_description.dimensions import deviations

if TYPE_CHECKING:
    from six_wheel.calibration.cross_validation import Candidate, CrossValidation
    from six_wheel.calibration.estimates import Estimate, RunErrors, Windows
    from six_wheel.calibration.files import Calibrated, calibrate_files, interval
    from six_wheel.calibration.noise import MeasuredNoise
    from six_wheel.calibration.observability import Observability
    from six_wheel.calibration.problem import Loss
    from six_wheel.calibration.result import Calibration
    from six_wheel.calibration.run_calibration import calibrate, parameter_names

__all__ = [
    "Calibrated",
    "Calibration",
    "Candidate",
    "CrossValidation",
    "Estimate",
    "Loss",
    "MeasuredNoise",
    "Observability",
    "RunErrors",
    "Windows",
    "calibrate",
    "calibrate_files",
    "deviations",
    "interval",
    "parameter_names",
]

__getattr__, __dir__ = attach(
    __name__,
    {
        "cross_validation": ("Candidate", "CrossValidation"),
        "drives": (),
        "files": ("Calibrated", "calibrate_files", "interval"),
        "fitting": (),
        "log_checks.units": (),
        "log_checks.slip": (),
        "model": (),
        "noise": ("MeasuredNoise",),
        "observability": ("Observability",),
        "problem": ("Loss",),
        "run_calibration": ("calibrate", "parameter_names"),
        "result": ("Calibration",),
        "estimates": ("Estimate", "RunErrors", "Windows"),
    },
)
