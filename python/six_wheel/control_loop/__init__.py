"""Control loop of a rover, without a middleware: commands and joint states in, joint commands, odometry out.

`settings` is everything it is told, from a parameter file and changes to it; `options` lists what it can be
told beside that; `joints` reads joint states by name; `faults` counts what was wrong; `starting` is the
motion at the start; `loop` puts a `Controller` and an `Odometry` together and decides what happens when
something is wrong. It reads no clock and sends nothing: the same calls give the same bits, which is what
`six_wheel.control_loop.replay` lives on.
"""

from six_wheel.control_loop.loop import Loop
from six_wheel.control_loop.options import OPTIONS, Option, Options
from six_wheel.control_loop.settings import Settings
from six_wheel.control_loop.steps import Step

__all__ = ["OPTIONS", "Loop", "Option", "Options", "Settings", "Step"]
