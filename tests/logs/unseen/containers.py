"""Containers of logs: text, columnar files, frames, bags, data sets."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
from pyarrow import feather, parquet

from tests.logs.unseen.drawn import COUNTS, Form


def text(
    form: Form, folder: Path, separator: str = ",", ending: str = ".csv", encoding: str = "utf-8"
) -> Path:
    frame = pd.DataFrame(form.columns)
    lines = [separator.join(map(str, frame.columns))]
    for row in frame.itertuples(index=False):
        cells = ["" if isinstance(cell, float) and np.isnan(cell) else str(cell) for cell in row]
        lines.append(separator.join(cells))
    extra = form.choose("", "", "crlf", "comment", "quoted")
    if extra == "comment":
        lines = ["# recorded by a field computer", *lines]
    if extra == "quoted":
        lines[0] = separator.join(f'"{head}"' for head in frame.columns)
    path = folder / f"log{ending}"
    path.write_bytes((("\r\n" if extra == "crlf" else "\n").join(lines) + "\n").encode(encoding))
    return path


def decimal_comma(form: Form, folder: Path) -> Path:
    path = folder / "log.csv"
    pd.DataFrame(form.columns).to_csv(path, sep=";", decimal=",", index=False)
    return path


def headless(form: Form, folder: Path) -> Path:
    names = form.owner.pop("columns", {})
    form.owner["columns"] = [names.get(head, head) or "number" for head in form.columns]
    path = folder / "log.csv"
    pd.DataFrame(form.columns).to_csv(path, header=False, index=False)
    return path


def with_truth(form: Form, folder: Path) -> Path:
    """Two files: the log and where the rover was, which changes nothing of the path."""
    path = text(form, folder)
    (folder / "truth.csv").write_text("time,x,y,yaw\n0,0,0,0\n1,0.1,0,0\n")
    return path


def to_parquet(form: Form, folder: Path) -> Path:
    parquet.write_table(pa.table(form.columns), folder / "log.parquet")
    return folder / "log.parquet"


def to_feather(form: Form, folder: Path) -> Path:
    feather.write_feather(pa.table(form.columns), str(folder / "log.feather"))
    return folder / "log.feather"


CONTAINERS: dict[str, Callable[[Form, Path], Any]] = {
    "csv": text,
    "tsv": lambda form, folder: text(form, folder, "\t", ".tsv"),
    "txt": lambda form, folder: text(form, folder, "\t", ".txt"),
    "semicolon": lambda form, folder: text(form, folder, ";"),
    "utf-16": lambda form, folder: text(form, folder, encoding="utf-16"),
    "bom": lambda form, folder: text(form, folder, encoding="utf-8-sig"),
    "decimal comma": decimal_comma,
    "no header": headless,
    "two files": with_truth,
    "parquet": to_parquet,
    "feather": to_feather,
    "pandas": lambda form, folder: pd.DataFrame(form.columns),
    "arrow": lambda form, folder: pa.table(form.columns),
    "dict": lambda form, folder: {head: np.asarray(values) for head, values in form.columns.items()},
}


def katwijk(form: Form, folder: Path) -> Path:
    """A part of a traverse: six wheels in radians, four joints, rocker and bogies."""
    form.drawn.append("katwijk")
    assert form.steering is not None
    lines = []
    for time, wheels, joints in zip(form.stamps, form.wheels, form.steering, strict=True):
        stamp = f"2015_11_26_16_{int(time) // 60:02d}_{int(time) % 60:02d}_{round(time % 1 * 1000):03d}"
        lines.append(" ".join([stamp, *(f"{number:.6f}" for number in [*wheels, *joints, 0, 0, 0])]))
    (folder / "odometry.txt").write_text("\n".join(lines) + "\n")
    return folder / "odometry.txt"


def rose_lab(form: Form, folder: Path) -> Path:
    """A trial: four encoders in radians beside the pose of the body."""
    form.drawn.append("rose lab")
    names = [
        "time_s",
        "pos_x",
        "pos_y",
        "quat_x",
        "quat_y",
        "quat_z",
        "quat_w",
        "enc1",
        "enc2",
        "enc3",
        "enc4",
    ]
    still = np.tile([0.0, 0.0, 0.0, 0.0, 0.0, 1.0], (len(form.stamps), 1))
    values = np.column_stack([form.stamps, still, form.wheels])
    pd.DataFrame(values, columns=names).round(6).to_csv(folder / "Processed_Data.csv", index=False)
    return folder / "Processed_Data.csv"


DATA_SETS = {"six": katwijk, "skid": rose_lab}


def bag(form: Form, folder: Path) -> Path:
    """Joint states of angles, rates or counts, or a topic of numbers for each wheel and steering joint."""
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    form.drawn.append("bag")
    kind = form.choose("positions", "rates", "counts", "float topics", "int topics")
    store = get_typestore(Stores.LATEST)
    rover, turned = form.rover, form.wheels
    counts = np.rint(turned * COUNTS / (2.0 * np.pi)) + 100.0
    form.owner["COUNTS"] = COUNTS
    values = {
        "positions": turned,
        "rates": np.gradient(turned, form.stamps, axis=0),
        "counts": counts,
        "float topics": turned,
        "int topics": counts,
    }[kind]
    steering = np.zeros((len(turned), 0)) if form.steering is None else form.steering
    if kind.endswith("topics"):
        unit = "ticks" if kind == "int topics" else "rad"
        topics = {f"/base/{name}/reading": f"{name} [{unit}]" for name in rover.wheel_names}
        topics |= {f"/base/{name}/angle": f"{name}_steering [rad]" for name in rover.steered_wheel_names}
        form.owner["topics"] = topics
    with Writer(folder / "bag", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        if kind.endswith("topics"):
            number = "std_msgs/msg/Int32" if kind == "int topics" else "std_msgs/msg/Float64"
            types = [number] * len(rover.wheels) + ["std_msgs/msg/Float64"] * steering.shape[1]
            links = [
                writer.add_connection(topic, each, typestore=store)
                for topic, each in zip(topics, types, strict=True)
            ]
        else:
            state = "sensor_msgs/msg/JointState"
            link = writer.add_connection("/joint_states", state, typestore=store)
        for time, wheels, joints in zip(form.stamps, values, steering, strict=True):
            stamp = 1_764_000_000 * 10**9 + round(1e9 * time)
            if kind.endswith("topics"):
                for one, each, reading in zip(links, types, [*wheels, *joints], strict=True):
                    cast = int if each == "std_msgs/msg/Int32" else float
                    writer.write(one, stamp, store.serialize_cdr(store.types[each](cast(reading)), each))
                continue
            clock = store.types["builtin_interfaces/msg/Time"](stamp // 10**9, stamp % 10**9)
            header = store.types["std_msgs/msg/Header"](clock, "")
            names = [*rover.traction_joints, *rover.steering_joints]
            still, nothing = np.zeros(len(joints)), np.zeros(0)
            position, velocity = np.concatenate([wheels, joints]), nothing
            if kind == "rates":
                position = np.concatenate([np.full(len(wheels), np.nan), joints]) if len(joints) else nothing
                velocity = np.concatenate([wheels, still])
            message = store.types[state](header, names, position, velocity, nothing)
            writer.write(link, stamp, store.serialize_cdr(message, state))
    return folder / "bag"
