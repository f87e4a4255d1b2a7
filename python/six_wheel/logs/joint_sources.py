"""A joint log that has been opened: where its rows come from, and what they hold."""

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from six_wheel._core import Rover
from six_wheel.kinematics.errors import TableError
from six_wheel.kinematics.poses import Floats
from six_wheel.logs.bags.bag_files import is_bag
from six_wheel.logs.ground_truth import TRUTH
from six_wheel.logs.gyroscope.rates import Turning, about_z, upward
from six_wheel.logs.headers.columns import Column, Unit
from six_wheel.logs.headers.joint_columns import (
    JointColumns,
    Reading,
    direction_columns,
    joint_columns,
    unsaid_units,
)
from six_wheel.logs.headers.rate_columns import RATES, rate_columns
from six_wheel.logs.headers.time_columns import in_seconds, time_columns
from six_wheel.logs.joint_totals import Encoders
from six_wheel.logs.log_options import LogOptions
from six_wheel.logs.plausibility.checks import ReadingChecks
from six_wheel.logs.plausibility.proposals import Column as Label
from six_wheel.logs.plausibility.proposals import ImplausibleReadingError, encoders
from six_wheel.logs.plausibility.readings import Readings
from six_wheel.logs.skip_bad_rows import Sieve, Source, TolerantTable

CHUNK = 200_000  # rows
READINGS = 65_536  # of a gyroscope at a time


class JointSource:
    """Rows of a table or messages of a bag, before encoders make angles of them."""

    def __init__(self, path: Path, rover: Rover, options: LogOptions) -> None:
        self.path, self.rover, self.options = path, rover, options
        self.up = upward(*(options.gyroscope.get(turn, 0.0) for turn in ("roll", "pitch")))
        self.warnings: list[str] = []
        self.stated = True  # the unit of the times
        self.has_rates = False  # of a gyroscope, in the rows
        self.readings: Reading
        self.counted: set[str] = set()  # steered wheels whose angle is read in ticks
        self.columns: Mapping[str, Column] = {}  # of a table
        self.turned: frozenset[str] = frozenset()  # names whose column has the sign of a reversed joint
        self.directions: Mapping[str, str] = {}  # wheel to the header of its direction, of a table
        self.rows: Source  # of the joints, and of the truth and the gyroscope if a table has them
        self.rates: Source | None = None  # of a gyroscope with other stamps than the rows
        self.names: Sequence[str]  # values of a row: "wheel NAME", "steering NAME" and others
        self.bagged = is_bag(path)
        with contextlib.ExitStack() as self._files:
            silent = self._open_bag() if self.bagged else self._open_table()
            self._files = self._files.pop_all()  # they stay open
        if silent:
            self.warnings.append(f"{path}: no readings of {', '.join(silent)}: taken as without encoder")

    @property
    def time_unit(self) -> Unit:
        """Unit of the stamps."""
        return self.rows.time_unit

    def describe(self, wheels: Encoders, steering: Encoders, increments: bool | None) -> Readings:
        """The readings as the checks of their plausibility have to know them."""

        def columns_of(part: str, wheels: Sequence[str]) -> list[Label]:
            known = {name: column.header for name, column in self.columns.items()}
            return [
                Label(known.get(f"{part} {wheel}", wheel if self.bagged else ""), wheel) for wheel in wheels
            ]

        def stated(part: str, encoders: Encoders) -> bool:
            there = [column for name, column in self.columns.items() if name.startswith(part)]
            return encoders is not None or (bool(there) and all(column.stated for column in there))

        def wraps(encoders: Encoders) -> bool:
            each = encoders.values() if isinstance(encoders, Mapping) else [encoders]
            return any(encoder is not None and encoder.wraps_at is not None for encoder in each)

        each = list(wheels.values()) if isinstance(wheels, Mapping) else [wheels]
        return Readings(
            self.rover,
            kind="increments" if increments else self.readings,
            wheels=columns_of("wheel", self.rover.wheel_names),
            steering=columns_of("steering", self.rover.steered_wheel_names),
            time=self.columns["time"].header if "time" in self.columns else "stamps",
            named=not self.bagged,
            clock_stated=self.stated,
            wheels_stated=self.readings == "ticks" or stated("wheel", wheels),
            steering_stated=stated("steering", steering),
            wraps=wraps(wheels),
            steering_wraps=wraps(steering),
            counts_unknown=self.readings == "ticks" and not each[0],
            turn=each[0].ticks_per_turn if each and each[0] is not None else None,
            increments_stated=increments is not None,
            directions=self.directions,
            max_speed=self.options.max_speed,
            max_gap=self.options.max_gap,
        )

    def turning(self, origin: int) -> Turning | None:
        """Rates of a gyroscope with stamps of its own, at rows that count from the second `origin`."""
        return None if self.rates is None else Turning(self._readings(self.rates, origin))

    def _readings(self, rates: Source, origin: int) -> Iterator[tuple[Floats, Floats]]:
        """Stamps in the clock of the log and rates about the rover's z."""
        keys, unit = self.options.gyroscope, rates.time_unit
        for batch in Sieve(rates.findings, RATES, self.stated).pass_on(rates.batches(READINGS)):
            values = about_z(batch.values, self.up)
            there = np.isfinite(values)
            stamps = in_seconds(batch.time[there], unit.scale, origin) - keys.get("time_offset", 0.0)
            yield stamps, keys.get("scale", 1.0) * values[there]

    def close(self) -> None:
        """Close the file."""
        self._files.close()

    def _open_table(self) -> list[str]:
        """Wheels with a motor but without a column, once the table is open."""
        found: list[JointColumns] = []
        columns, clock = self.options.columns, self.options.stamp_unit

        def find(headers: Sequence[str], field_units: Mapping[int, str]) -> dict[str, Column]:
            self.directions = direction_columns(headers, self.rover)
            found.append(joint_columns(headers, self.rover, self.options.readings, field_units, clock))
            return dict(found[-1].columns)

        table = self._files.enter_context(TolerantTable(self.path, find, columns, (*TRUTH, *RATES)))
        joints = found[-1]
        self.rows, self.readings, self.names = table, joints.readings, list(joints.columns)
        self.columns, self.stated = joints.columns, table.stated
        self.turned = joints.reversed
        if unsaid := unsaid_units(joints, self.rover):
            self.warnings.append(f"{self.path}: {unsaid}")
        columns_of = {w: joints.columns[f"steering {w}"] for w in self.rover.steered_wheel_names}
        self.counted = {w for w, column in columns_of.items() if column.unit.symbol == "ticks"}
        self.has_rates = any(name in joints.columns for name in RATES)
        if self.has_rates and self.options.gyroscope.get("time_offset"):

            def find_rates(headers: Sequence[str], field_units: Mapping[int, str]) -> dict[str, Column]:
                return time_columns(headers, field_units, clock) | rate_columns(headers, field_units)

            rates = TolerantTable(self.path, find_rates, columns, RATES)  # the same table again
            self.rates, self.has_rates = self._files.enter_context(rates), False
        return list(joints.silent)

    def _open_bag(self) -> list[str]:
        """Wheels with a motor but without a joint state, once the bag is open."""
        from six_wheel.logs.bags.imu_bag import RateBag
        from six_wheel.logs.bags.joint_bag import JointBag

        bag: JointBag
        readings, topics = self.options.readings, self.options.topics
        if isinstance(topics, Mapping) and topics:
            from six_wheel.logs.bags.topic_bag import TopicBag

            bag = mapped = TopicBag(self.path, self.rover, topics, readings)
            self.columns, self.counted = mapped.columns, mapped.counted
        else:
            bag = JointBag(self.path, self.rover, readings, list(topics) or None)
        self._files.callback(bag.close)
        self.rows, self.readings, self.names = bag, bag.readings, bag.names
        if any(one.msgtype == RateBag.IMU and one.msgcount for one in bag.connections):
            self.rates = self._rates_of_bag()
        return [w for w in self.rover.traction_joints.values() if f"wheel {w}" not in bag.names]

    def _rates_of_bag(self) -> Source | None:
        """The gyroscope of a bag, if there is one; what is not known of it is said."""
        from six_wheel.logs.bags.imu_bag import RateBag
        from six_wheel.logs.bags.messages import OWN_FRAMES

        keys = self.options.gyroscope
        own = [name for name in (self.options.frame, *OWN_FRAMES) if name]
        rates = RateBag(self.path, keys.get("topic"), own)
        self._files.callback(rates.close)
        if rates.rate_topic is None:
            if rates.others:
                rule = f"{len(rates.others)} topics have angular velocities, {', '.join(rates.others)}"
                self.warnings.append(f"{self.path}: {rule}: none is read unless gyroscope.topic names it")
            return None
        if keys.keys().isdisjoint({"roll", "pitch"}):
            if rates.up is not None:
                self.up = rates.up
            else:
                rule = f"no transform tells how {rates.frame} of {rates.rate_topic} sits in the rover"
                remedy = (
                    "its z is taken for the rover's; gyroscope.roll and gyroscope.pitch can say otherwise"
                )
                self.warnings.append(f"{self.path}: {rule}: {remedy}")
        return rates


def refuse_counts(source: JointSource, part: str, keys: Mapping[str, Any]) -> NoReturn:
    """Counts of which nobody says how many a turn has; where they wrap is said with it."""
    of_steering = part == "steering"
    what = "the steering is" if of_steering else "the wheels are"
    known = source.describe(None, None, keys.get("increments"))
    known = replace(known, clock_stated=True, wraps="wraps_at" in keys)
    known = replace(known, wheels=()) if of_steering else known
    checks = ReadingChecks(known, lambda line: None)
    wheels = source.rover.steered_wheel_names if of_steering else source.rover.wheel_names
    names = [f"{part} {wheel}" for wheel in wheels]
    try:
        for batch in source.rows.batches(CHUNK):
            raw = batch.columns(names)
            stamps = np.arange(len(batch), dtype=float)
            if of_steering:
                checks.take(stamps, np.zeros((len(batch), 0)), None, raw, batch.rows)
            else:
                checks.take(stamps, raw, None, None, batch.rows)
    except ImplausibleReadingError as error:
        raise TableError(f"{source.path}: ", error, "; COUNTS are those of a turn") from None
    proposal = encoders(counts=True, steering=of_steering)
    rule = f"{what} in ticks, and how many a turn has must be said"
    raise TableError(f"{source.path}: {rule}: give ", proposal)
