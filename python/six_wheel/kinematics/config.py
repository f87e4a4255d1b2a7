"""Settings of the machine: number of threads, and the instructions that kernels use."""

from typing import TYPE_CHECKING

from six_wheel._core import default_threads, set_default_threads, simd_levels
from six_wheel.kinematics.lazy import attach

__all__ = ["default_threads", "set_default_threads", "simd_levels"]

if not TYPE_CHECKING:
    __getattr__, __dir__ = attach(__name__, {})
