"""Memory of a batch beside its inputs and outputs: the peak of a process of its own (Linux)."""

import subprocess
import sys
from pathlib import Path

STATUS = Path("/proc/self/status")
JOBS = {
    "inverse": "rover.inverse(twists, out=(steering, speeds))",
    "forward": "rover.forward(steering, speeds, out=back)",
    "integrate": "sw.integrate(twists, 0.01, out=poses)",
    "inverse, Fortran order": "rover.inverse(fortran, out=(steering, speeds))",
    "inverse, every other row": "rover.inverse(strided, out=(steering, speeds))",
    "inverse, float32": "rover.inverse(single, out=(steering, speeds))",
}
CODE = """
import re, sys
from pathlib import Path
import numpy as np
import six_wheel as sw

def peak():
    return int(re.search(r"VmHWM:\\s*(\\d+) kB", Path("/proc/self/status").read_text())[1])

n, statement = int(sys.argv[1]), sys.argv[2]
rover = sw.Rover.six_wheel(
    front_to_middle=0.5, middle_to_rear=0.5, track_width=0.8, middle_track_width=0.9, wheel_radius=0.15
)
twists = np.full((n, 3), (0.5, 0.0, 0.3))
if "fortran" in statement:
    fortran = np.asfortranarray(twists)
if "strided" in statement:
    strided = np.full((2 * n, 3), (0.5, 0.0, 0.3))[::2]
if "single" in statement:
    single = twists.astype(np.float32)
steering, speeds, back, poses = (np.ones(shape) for shape in ((n, 4), (n, 6), (n, 3), (n + 1, 3)))
rover.inverse(twists[:1000], out=(steering[:1000], speeds[:1000]))
before = peak()
exec(statement)
print((peak() - before) / 1024)
"""


def beyond(rows):
    """Job to the memory [MiB] that it takes beyond what it is given; None where the system does not say."""
    if not STATUS.exists():
        return None
    results = {}
    for job, statement in JOBS.items():
        command = [sys.executable, "-c", CODE, str(rows), statement]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        results[job] = float(done.stdout)
    return results
