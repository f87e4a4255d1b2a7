"""Settings of the machine: number of threads, and the instructions that kernels use."""

from six_wheel._core import default_threads, set_default_threads, simd_levels

__all__ = ["default_threads", "set_default_threads", "simd_levels"]
