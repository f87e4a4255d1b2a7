"""A joint log that has been opened: where its rows come from, and what they hold."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from six_wheel._core import Rover
from six_wheel.logs.bags.bag_files import is_bag
from six_wheel.logs.columns import Column, Unit
from six_wheel.logs.ground_truth import TRUTH
from six_wheel.logs.gyroscope.rates import RATES, upward
from six_wheel.logs.gyroscope.sources import rate_table
from six_wheel.logs.joint_columns import JointColumns, Reading, joint_columns
from six_wheel.logs.skip_bad_rows import Source, TolerantTable

__all__ = ["JointSource"]


class JointSource:
    """Rows of a table or messages of a bag, before encoders make angles of them.

    Parameters are those of `JointLog`.

    Attributes
    ----------
    rows : Source
        Of the joints, and of the truth and the gyroscope if a table has them.
    rates : Source or None
        Of a gyroscope whose readings have other stamps than the rows.
    readings : {"angles", "speeds", "ticks"}
        What the wheels are read as.
    names : sequence of str
        Values of a row: ``"wheel NAME"``, ``"steering NAME"`` and others.
    counted : set of str
        Steered wheels whose angle is read in ticks.
    turned : frozenset of str
        Names whose column has the sign of a reversed joint.
    stated : bool
        True if the log states the unit of its times.
    has_rates : bool
        True if the rows have a gyroscope's readings.
    warnings : list of str
    """

    def __init__(
        self,
        path: Path,
        rover: Rover,
        readings: Reading | None = None,
        columns: Mapping[str, str] | None = None,
        topics: Sequence[str] | None = None,
        gyroscope: Mapping[str, Any] | None = None,
        frame: str = "",
    ) -> None:
        self.path, self.rover = path, rover
        self.gyroscope = dict(gyroscope or {})
        self.up = upward(*(self.gyroscope.get(turn, 0.0) for turn in ("roll", "pitch")))
        self.warnings: list[str] = []
        self.stated, self.has_rates = True, False
        self.counted: set[str] = set()
        self.turned: frozenset[str] = frozenset()
        self.rows: Source
        self.rates: Source | None = None
        self.names: Sequence[str]
        self.bagged = is_bag(path)
        silent = (
            self._open_bag(readings, topics, frame) if self.bagged else self._open_table(readings, columns)
        )
        if silent:
            self.warnings.append(f"{path}: no readings of {', '.join(silent)}: taken as without encoder")

    @property
    def time_unit(self) -> Unit:
        """Unit of the stamps."""
        return self.rows.time_unit

    def close(self) -> None:
        """Close the file."""
        self.rows.close()
        if self.rates is not None:
            self.rates.close()

    def _open_table(self, readings: Reading | None, columns: Mapping[str, str] | None) -> list[str]:
        """Wheels with a motor but without a column, once the table is open."""
        found: list[JointColumns] = []

        def find(headers: Sequence[str], field_units: Mapping[int, str]) -> dict[str, Column]:
            found.append(joint_columns(headers, self.rover, readings, field_units))
            return dict(found[-1].columns)

        table = TolerantTable(self.path, find, columns, (*TRUTH, *RATES))
        joints = found[-1]
        self.rows, self.readings, self.names = table, joints.readings, list(joints.columns)
        self.stated = joints.columns["time"].stated
        self.turned = joints.reversed
        columns_of = {w: joints.columns[f"steering {w}"] for w in self.rover.steered_wheel_names}
        self.counted = {w for w, column in columns_of.items() if column.unit.symbol == "ticks"}
        self.has_rates = any(name in joints.columns for name in RATES)
        if self.has_rates and self.gyroscope.get("time_offset"):
            self.rates, self.has_rates = rate_table(self.path, columns), False
        return list(joints.silent)

    def _open_bag(self, readings: Reading | None, topics: Sequence[str] | None, frame: str) -> list[str]:
        """Wheels with a motor but without a joint state, once the bag is open."""
        from six_wheel.logs.bags.imu_bag import RateBag
        from six_wheel.logs.bags.joint_bag import JointBag

        bag = JointBag(self.path, self.rover, readings, topics)
        self.rows, self.readings, self.names = bag, bag.readings, bag.names
        if any(one.msgtype == RateBag.IMU and one.msgcount for one in bag.connections):
            try:
                self.rates = self._rates_of_bag(frame)
            except BaseException:
                bag.close()
                raise
        return [w for w in self.rover.traction_joints.values() if f"wheel {w}" not in bag.names]

    def _rates_of_bag(self, frame: str) -> Source | None:
        """The gyroscope of a bag, if there is one; what is not known of it is said."""
        from six_wheel.logs.bags.imu_bag import RateBag
        from six_wheel.logs.bags.messages import OWN_FRAMES, Bag

        keys, bag = self.gyroscope, Bag(self.path)
        try:
            rates = RateBag(bag, keys.get("topic"), [name for name in (frame, *OWN_FRAMES) if name])
        except BaseException:
            bag.close()
            raise
        if rates.topic is None:
            bag.close()
            if rates.others:
                rule = f"{len(rates.others)} topics have angular velocities, {', '.join(rates.others)}"
                self.warnings.append(f"{self.path}: {rule}: none is read unless gyroscope.topic names it")
            return None
        if keys.keys().isdisjoint({"roll", "pitch"}):
            if rates.up is not None:
                self.up = rates.up
            else:
                rule = f"no transform tells how {rates.frame} of {rates.topic} sits in the rover"
                remedy = (
                    "its z is taken for the rover's; gyroscope.roll and gyroscope.pitch can say otherwise"
                )
                self.warnings.append(f"{self.path}: {rule}: {remedy}")
        return rates
