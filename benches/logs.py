"""Cost of the checks of a clean log, and of calibration beside other work.

`python benches/logs.py` measures time and memory of 10^6 rows with and without the checks of plausibility, in
turns; `python benches/logs.py --calibrate 20` the time of so many runs, alone and beside a busy loop on each
core. Memory is that of Linux.
"""

import argparse
import os
import re
import subprocess
import sys
import time
from multiprocessing import Process
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import six_wheel as sw

ROVER = sw.Rover.differential(0.4, 0.1)
KINDS = ("arrays", "dict", "parquet", "csv")
TURNS = [(0.0, 0.0), (6.0, 0.5), (16.0, -0.5), (26.0, 0.0), (40.0, 0.4)]  # [s], [rad/s]


def written(kind, rows, folder):
    """A clean log: arguments of `dead_reckon` behind the rover, or a path for `read_log`."""
    stamps = 0.05 * np.arange(rows)
    speed, turn = 0.15 + 0.05 * np.sin(stamps / 30.0), 0.1 * np.sin(stamps / 7.0)
    wheels = np.cumsum(np.stack([speed * (1.0 - turn), speed * (1.0 + turn)], axis=1), axis=0)
    if kind == "arrays":
        return None, wheels, stamps
    columns = dict(zip(("time [s]", "left [rad]", "right [rad]"), (stamps, *wheels.T), strict=True))
    if kind == "dict":
        return (columns,)
    import pyarrow as pa
    from pyarrow import csv, parquet

    path = Path(folder) / f"log.{kind}"
    (parquet.write_table if kind == "parquet" else csv.write_csv)(pa.table(columns), path)
    return path


def read(log, checked):
    if isinstance(log, Path):
        from six_wheel.logs import read_log

        return read_log(log, ROVER, plausibility=checked)
    return sw.dead_reckon(ROVER, *log, plausibility=checked)


def peak(kind, rows, checked):
    """Memory above what the log takes itself [MiB], of a process of its own."""
    code = "import logs, resource, sys; logs.told(sys.argv[1], int(sys.argv[2]), sys.argv[3] == 'True')"
    command = [sys.executable, "-c", code, kind, str(rows), str(checked)]
    done = subprocess.run(command, cwd=Path(__file__).parent, capture_output=True, text=True, check=True)
    return float(done.stdout)


def told(kind, rows, checked):
    def status(name):
        return float(re.search(rf"{name}:\s*(\d+)", Path("/proc/self/status").read_text())[1])

    with TemporaryDirectory() as folder:
        log = written(kind, rows, folder)
        Path("/proc/self/clear_refs").write_text("5")  # the peak begins anew
        before = status("VmRSS")
        read(log, checked)
        print((status("VmHWM") - before) / 1024.0)


def checks(rows, rounds):
    print(f"{'':8} {'without':>9} {'with':>9} {'ratio':>6}   processor time, the least of {rounds}; peaks")
    for kind in KINDS:
        with TemporaryDirectory() as folder:
            log, taken = written(kind, rows, folder), {False: [], True: []}
            for _ in range(rounds):
                for checked, times in taken.items():
                    begin = time.process_time()
                    read(log, checked)
                    times.append(time.process_time() - begin)
        for unit, without, along in (
            ("s", min(taken[False]), min(taken[True])),
            ("MiB", peak(kind, rows, False), peak(kind, rows, True)),
        ):
            print(f"{kind:8} {without:9.3f} {along:9.3f} {along / without:6.2f}   {unit}")


def busy():
    while True:
        pass


def calibrations(runs):
    drives = [
        sw.simulate(ROVER, [(when, 0.4, 0.0, omega) for when, omega in TURNS], seed=seed)
        for seed in range(runs)
    ]
    others = []
    for name in ("alone", "beside a busy loop on each core"):
        begin = time.perf_counter()
        sw.calibrate(ROVER, drives, parameters=["wheel_radius", "track_width"])
        print(f"{runs} runs {name}: {time.perf_counter() - begin:.1f} s, load {os.getloadavg()[0]:.1f}")
        if not others:
            others = [Process(target=busy, daemon=True) for _ in range(os.cpu_count() or 1)]
            for each in others:
                each.start()
    for each in others:
        each.terminate()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", type=float, default=1e6)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--calibrate", type=int, metavar="RUNS")
    given = parser.parse_args()
    if given.calibrate:
        calibrations(given.calibrate)
    else:
        checks(int(given.rows), given.rounds)


if __name__ == "__main__":
    main()
