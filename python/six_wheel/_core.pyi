from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from os import PathLike
from typing import Any, Final, Literal, Self, TypeAlias, final, type_check_only

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray
from typing_extensions import TypeVar, disjoint_base

from six_wheel.kinematics.controller import Reason
from six_wheel.kinematics.four_axle import (
    FourAxleMobility,
    FourAxleMotion,
    FourAxleSimulation,
    FourAxleState,
    FourAxleStep,
    TurnSequence,
)
from six_wheel.kinematics.geometry import Pose
from six_wheel.kinematics.objects.rollout_cost import RolloutCost
from six_wheel.kinematics.objects.wheels import Wheels
from six_wheel.kinematics.odometry.tracks import OdometryHealth, Track
from six_wheel.kinematics.odometry.tracks3 import Track3
from six_wheel.kinematics.profiles import Peaks, Phase, State, TransitionState
from six_wheel.kinematics.statuses import BoundsStatus, FeasibilityLimits, FeasibilityReason, SettleStatus
from six_wheel.logs import WheelLog

__all__ = ["BodySlip", "BodyTransition", "Controller", "ControllerOutput", "ControllerRun", "Costmap"]
__all__ += ["Encoder", "Feasibility", "FourAxle", "GroundCommand", "GroundMotion", "Gyroscope"]
__all__ += ["IcrTransition", "Limits", "Link", "MarginJacobian", "Mobility", "ModuleTransition", "Mppi"]
__all__ += ["MppiPlan", "Noise", "Odometry", "Odometry3", "Odometry3State", "OdometryState", "PoseBounds"]
__all__ += ["Preintegrated", "Profile", "RockerBogie", "Rover", "SettledPose", "Stability", "SteeringCommand"]
__all__ += ["Suspension", "Terrain", "Traction", "TwistFit", "TwistJacobian", "Wheel", "WheelSlip"]
__all__ += ["__version__", "ask_settings", "body_slip", "check_kind", "compose", "default_threads"]
__all__ += ["differentiate", "exp", "integrate", "log", "reason_bits", "rollout", "set_default_threads"]
__all__ += ["setting_questions", "simd_levels", "unit_questions", "without_questions", "wrap_angle"]

_Floats: TypeAlias = NDArray[np.float64]
_Out: TypeAlias = NDArray[np.float64] | NDArray[np.float32]
_T = TypeVar("_T")
_Real = TypeVar("_Real", np.float64, np.float32, default=np.float64)
_Keep: TypeAlias = Literal["curvature", "speed", "yaw_rate", "nearest"]
_Limit: TypeAlias = float | tuple[float, float]
_Ranges: TypeAlias = _Limit | Sequence[_Limit | None] | Mapping[str, _Limit] | None
_Each: TypeAlias = float | ArrayLike | Mapping[str, float] | None
_Driven: TypeAlias = Literal["front", "rear", "all"]
_Steered: TypeAlias = Literal["corners", "front", "all"]
_Interpolation: TypeAlias = Literal["bilinear", "bicubic"]
_Brake: TypeAlias = Literal["locked", "free"]
_Mode: TypeAlias = Literal["free", "crab", "front_only", "spin"]
_Align: TypeAlias = Literal["cosine", "hold"]
_Pair: TypeAlias = Literal["front", "rear"]
_Level: TypeAlias = Literal["scalar", "neon", "avx2", "avx512"]
_Quantity: TypeAlias = Literal[
    "wheel_speeds",
    "steering",
    "steering_rates",
    "slip",
    "side_slip",
    "x",
    "y",
    "heading",
    "radius",
    "scrub",
    "trail",
    "roller_angle",
]
_Method: TypeAlias = Literal["least_squares", "middle_wheels", "robust"]

__version__: str

@type_check_only
class _Value:
    def replace(self, **changes: Any) -> Self: ...
    def __replace__(self, **changes: Any) -> Self: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@type_check_only
class _Transition(_Value):
    duration: Final[float]
    rover: Final[Rover]
    def at(self, times: ArrayLike) -> TransitionState: ...

@type_check_only
class _Copied:
    def __copy__(self) -> Self: ...
    def __deepcopy__(self, memo: object) -> Self: ...

@final
class Wheel(_Value):
    def __new__(
        cls,
        name: str,
        x: float,
        y: float,
        *,
        radius: float,
        steered: bool = False,
        heading: float = 0.0,
        steering_limit: float | tuple[float, float] | None = None,
        scrub: float = 0.0,
        trail: float = 0.0,
        roller_angle: float | None = None,
        driven: bool | None = None,
        castor: bool = False,
    ) -> Wheel: ...
    name: Final[str]
    x: Final[float]
    y: Final[float]
    radius: Final[float]
    steered: Final[bool]
    heading: Final[float]
    steering_range: Final[tuple[float, float] | None]
    steering_limit: Final[float | tuple[float, float] | None]
    scrub: Final[float]
    trail: Final[float]
    roller_angle: Final[float | None]
    driven: Final[bool]
    castor: Final[bool]

@final
class TwistFit:
    rover: Final[Rover]
    twist: Final[_Floats]  # (..., 3)
    residuals: Final[_Floats]  # (..., wheels) [m/s], >= 0
    rank: Final[int | NDArray[np.int64]]
    sigma_min: Final[Any]
    weights: Final[_Floats]  # (..., wheels), 0 to 1
    @property
    def worst_wheel(
        self,
    ) -> str | list[Any]: ...  # name of the wheel with the largest residual; nested lists for a batch

@final
class TwistJacobian:  # what was not asked for is None
    twist: Final[_Floats]  # (..., 3)
    wheel_speeds: Final[_Floats]  # (..., 3, wheels), as all but the next two
    steering: Final[_Floats]  # (..., 3, steered wheels)
    steering_rates: Final[_Floats]  # (..., 3, steered wheels)
    slip: Final[_Floats]
    side_slip: Final[_Floats]
    x: Final[_Floats]
    y: Final[_Floats]
    heading: Final[_Floats]
    radius: Final[_Floats]
    scrub: Final[_Floats]
    trail: Final[_Floats]
    roller_angle: Final[_Floats]

@final
class Profile(_Value):
    @staticmethod
    def linear(start: ArrayLike, end: ArrayLike, duration: float) -> Profile: ...
    @staticmethod
    def trapezoid(
        start: ArrayLike, end: ArrayLike, duration: float, *, ramp: float | None = None
    ) -> Profile: ...
    @staticmethod
    def s_curve(
        start: ArrayLike, end: ArrayLike, duration: float, *, ramp: float | None = None
    ) -> Profile: ...
    @staticmethod
    def time_optimal(
        start: ArrayLike,
        end: ArrayLike,
        *,
        velocity: ArrayLike,
        acceleration: ArrayLike | None = None,
        jerk: ArrayLike | None = None,
        start_velocity: ArrayLike | None = None,
        start_acceleration: ArrayLike | None = None,
        end_velocity: ArrayLike | None = None,
        end_acceleration: ArrayLike | None = None,
        min_velocity: ArrayLike | None = None,
        min_acceleration: ArrayLike | None = None,
        duration: float | None = None,
        synchronise: Literal["time", "phase", "none"] = "time",
    ) -> Profile: ...
    duration: Final[float]
    durations: Final[Any]
    peaks: Final[Peaks]
    def at(self, times: ArrayLike) -> State: ...

@final
class BodyTransition(_Transition):
    @staticmethod
    def between(
        rover: Rover,
        start_twist: ArrayLike,
        end_twist: ArrayLike,
        duration: float | None = None,
        *,
        shape: Literal["linear", "trapezoid", "s_curve"] | None = None,
        acceleration: float | None = None,
        angular_acceleration: float | None = None,
        jerk: float | None = None,
        angular_jerk: float | None = None,
        synchronise: Literal["time", "phase", "none"] | None = None,
        previous: ArrayLike | None = None,
    ) -> BodyTransition: ...

@final
class ModuleTransition(_Transition):
    @staticmethod
    def between(
        rover: Rover,
        start: tuple[ArrayLike, ArrayLike],
        end: tuple[ArrayLike, ArrayLike],
        duration: float | None = None,
        *,
        shape: Literal["linear", "trapezoid", "s_curve"] | None = None,
        steering_rate: float | None = None,
        steering_acceleration: float | None = None,
        steering_jerk: float | None = None,
        wheel_acceleration: float | None = None,
        wheel_jerk: float | None = None,
        synchronise: Literal["time", "phase", "none"] | None = None,
    ) -> ModuleTransition: ...

@final
class IcrTransition(_Transition):
    @staticmethod
    def between(
        rover: Rover,
        start_twist: ArrayLike,
        end_twist: ArrayLike,
        *,
        steering_rate: float,
        steering_acceleration: float | None = None,
        steering_jerk: float | None = None,
        wheel_speed: float | None = None,
        wheel_acceleration: float | None = None,
        acceleration: float | None = None,
        angular_acceleration: float | None = None,
        previous: ArrayLike | None = None,
    ) -> IcrTransition: ...
    stops: Final[int]
    phases: Final[tuple[Phase, ...]]

@final
class Mobility:
    degree_of_mobility: Final[int]
    degree_of_steerability: Final[int]
    degree_of_manoeuvrability: Final[int]
    rank: Final[int]
    margin: Final[float]
    singular_values: Final[_Floats]  # (3,)
    motion: Final[_Floats]  # (degree_of_mobility, 3)

@final
class Rover(_Value):
    def __new__(
        cls,
        wheels: Sequence[Wheel],
        *,
        traction_joints: Mapping[str, str] | None = None,
        steering_joints: Mapping[str, str] | None = None,
        reversed_joints: Sequence[str] | None = None,
        suspension: RockerBogie | None = None,
    ) -> Rover: ...
    @staticmethod
    def six_wheel(
        *,
        front_to_middle: float,
        middle_to_rear: float,
        track_width: float,
        middle_track_width: float | None = None,
        wheel_radius: float,
        steering_limit: _Ranges = None,
        scrub: _Each = 0.0,
        trail: _Each = 0.0,
        names: Sequence[str] | None = None,
    ) -> Rover: ...
    @staticmethod
    def swerve(
        positions: ArrayLike,
        wheel_radius: float,
        *,
        steering_limit: _Ranges = None,
        names: Sequence[str] | None = None,
        scrub: _Each = 0.0,
        trail: _Each = 0.0,
    ) -> Rover: ...
    @staticmethod
    def differential(
        track_width: float,
        wheel_radius: float | tuple[float, float],
        *,
        wheels_per_side: int = 1,
        wheelbase: float | None = None,
        icr_left: float | None = None,
        icr_right: float | None = None,
        icr_forward: float = 0.0,
        scrub: _Each = None,
        trail: _Each = None,
        names: Sequence[str] | None = None,
    ) -> Rover: ...
    @staticmethod
    def tracked(
        track_width: float,
        wheel_radius: float | tuple[float, float],
        *,
        icr_left: float | None = None,
        icr_right: float | None = None,
        icr_forward: float = 0.0,
        scrub: _Each = None,
        trail: _Each = None,
        names: Sequence[str] | None = None,
    ) -> Rover: ...
    @staticmethod
    def ackermann(
        wheelbase: float,
        track_width: float,
        wheel_radius: float,
        *,
        steering_limit: _Ranges = None,
        driven: _Driven = "rear",
        scrub: _Each = 0.0,
        trail: _Each = 0.0,
        names: Sequence[str] | None = None,
    ) -> Rover: ...
    @staticmethod
    def tricycle(
        wheelbase: float,
        track_width: float,
        wheel_radius: float,
        *,
        steering_limit: _Ranges = None,
        driven: _Driven = "front",
        scrub: _Each = 0.0,
        trail: _Each = 0.0,
        names: Sequence[str] | None = None,
    ) -> Rover: ...
    @staticmethod
    def bicycle(
        wheelbase: float,
        wheel_radius: float,
        *,
        steering_limit: _Ranges = None,
        driven: _Driven = "rear",
        scrub: _Each = 0.0,
        trail: _Each = 0.0,
        names: Sequence[str] | None = None,
    ) -> Rover: ...
    @staticmethod
    def mecanum(
        wheelbase: float,
        track_width: float,
        wheel_radius: float,
        *,
        roller_angle: float = 0.7853981633974483,
        scrub: _Each = 0.0,
        trail: _Each = 0.0,
        names: Sequence[str] | None = None,
    ) -> Rover: ...
    @staticmethod
    def omni(
        positions: ArrayLike,
        headings: ArrayLike,
        wheel_radius: float,
        *,
        roller_angle: float = 1.5707963267948966,
        names: Sequence[str] | None = None,
        scrub: _Each = 0.0,
        trail: _Each = 0.0,
    ) -> Rover: ...
    @staticmethod
    def preset(name: str, *, steering_limit: float | tuple[float, float] | None = None) -> Rover: ...
    @staticmethod
    def presets() -> dict[str, str]: ...
    def rollout_cost(
        self,
        controls: ArrayLike,
        dt: ArrayLike,
        start: ArrayLike = (0.0, 0.0, 0.0),
        *,
        previous: ArrayLike | None = None,
        out: tuple[_Out, _Out, _Out, _Out, _Out] | None = None,
        dtype: type[_Real] | None = None,
        threads: int | None = None,
        level: _Level | None = None,
    ) -> RolloutCost: ...
    def inverse(
        self,
        twist: ArrayLike,
        *,
        previous: ArrayLike | None = None,
        steering_rates: ArrayLike | None = None,
        centre: ArrayLike | None = None,
        previous_wheel_speeds: ArrayLike | None = None,
        out: tuple[_Out, _Out] | None = None,
        dtype: type[_Real] | None = None,
        threads: int | None = None,
        level: _Level | None = None,
    ) -> tuple[NDArray[_Real], NDArray[_Real]]: ...
    def forward(
        self,
        steering: ArrayLike | None,
        wheel_speeds: ArrayLike,
        *,
        steering_rates: ArrayLike | None = None,
        allow_underdetermined: bool = False,
        out: _Out | None = None,
        dtype: type[_Real] | None = None,
        threads: int | None = None,
        level: _Level | None = None,
    ) -> NDArray[_Real]: ...
    def fit(
        self,
        steering: ArrayLike | None,
        wheel_speeds: ArrayLike,
        *,
        method: _Method = "least_squares",
        steering_rates: ArrayLike | None = None,
        allow_underdetermined: bool = False,
        threads: int | None = None,
    ) -> TwistFit: ...
    def sensitivity(
        self,
        steering: ArrayLike | None,
        wheel_speeds: ArrayLike,
        *,
        steering_rates: ArrayLike | None = None,
        quantities: Sequence[_Quantity] | None = None,
        threads: int | None = None,
    ) -> TwistJacobian: ...
    def mobility(self, steering: ArrayLike | None = None) -> Mobility: ...
    def admissible(self, twist: ArrayLike, *, threads: int | None = None) -> Any: ...
    def project(
        self,
        twist: ArrayLike,
        keep: _Keep = "curvature",
        *,
        out: _Out | None = None,
        dtype: type[_Real] | None = None,
        threads: int | None = None,
    ) -> NDArray[_Real]: ...
    def icr(
        self,
        twist: ArrayLike,
        *,
        out: _Out | None = None,
        dtype: type[_Real] | None = None,
        threads: int | None = None,
    ) -> NDArray[_Real]: ...
    def commands(
        self,
        twist: ArrayLike,
        *,
        previous: ArrayLike | None = None,
        dtype: type[_Real] | None = None,
        threads: int | None = None,
    ) -> dict[str, float] | dict[str, NDArray[_Real]]: ...
    def readings(self, joints: Mapping[str, ArrayLike]) -> tuple[_Floats, _Floats]: ...
    def desaturate(self, wheel_speeds: ArrayLike, max_wheel_speed: ArrayLike) -> _Floats: ...
    def urdf(self, name: str = "rover") -> str: ...
    wheels: Final[Wheels]
    wheel_names: Final[tuple[str, ...]]
    steered_wheel_names: Final[tuple[str, ...]]
    traction_joints: Final[dict[str, str]]  # joint -> wheel, in the order of the wheels
    steering_joints: Final[dict[str, str]]
    joint_names: Final[tuple[str, ...]]  # in the caller's order
    reversed_joints: Final[tuple[str, ...]]
    suspension: Final[RockerBogie | None]
    min_radius: Final[float]
    spin_radius: Final[float]
    def save(self, path: str | PathLike[str], **others: Any) -> None: ...
    def replace(self, wheel: str | None = None, /, **changes: Any) -> Rover: ...

@final
class Noise(_Value):
    def __new__(
        cls,
        speed: float | None = None,
        steering: float | None = None,
        *,
        slip: float | None = None,
        side_slip: float | None = None,
        yaw: float = 0.0,
        yaw_rate: float = 0.0,
        period: float | None = None,
    ) -> Noise: ...
    @staticmethod
    def typical(*, yaw: float = 0.0, yaw_rate: float = 0.0, period: float | None = None) -> Noise: ...
    @staticmethod
    def from_logs(rover: Rover, logs: Any, truth: Any = None) -> Noise: ...
    speed: Final[float]  # [m/s]
    steering: Final[float]  # [rad]
    slip: Final[float]  # [m per root m]
    side_slip: Final[float]
    yaw: Final[float]  # [rad]
    yaw_rate: Final[float]  # [rad/s]
    period: Final[float | None]  # [s]

@final
class Encoder(_Value):
    def __new__(
        cls,
        ticks_per_turn: float | None = None,
        *,
        gear_ratio: float = 1.0,
        wraps_at: float | None = None,
        offset: float = 0.0,
    ) -> Encoder: ...
    ticks_per_turn: Final[float | None]
    gear_ratio: Final[float]
    wraps_at: Final[float | None]
    offset: Final[float]  # [rad]
    angle_per_tick: Final[float]  # [rad]

@final
class OdometryState:
    rover: Final[Rover]
    stamp: Final[float | None]
    pose: Final[_Floats]  # (3,)
    yaw: Final[float]
    twist: Final[_Floats]  # (3,)
    velocity: Final[_Floats]  # (3,)
    covariance: Final[_Floats]  # (3, 3)
    twist_covariance: Final[_Floats]  # (3, 3)
    residuals: Final[_Floats]  # (wheels,) [m/s]
    weights: Final[_Floats]  # (wheels,)
    worst_wheel: Final[str | None]
    health: Final[OdometryHealth]
    def covariance_6x6(self, unmeasured: float = 1e6) -> _Floats: ...
    def twist_covariance_6x6(self, unmeasured: float = 1e6) -> _Floats: ...

_Encoders: TypeAlias = Encoder | Sequence[Encoder] | Mapping[str, Encoder]

@final
class Odometry(_Copied):
    def __new__(
        cls,
        rover: Rover,
        noise: Noise | None = None,
        *,
        readings: Literal["angles", "speeds", "ticks"] = "angles",
        increments: bool = False,
        wheel_encoders: _Encoders | None = None,
        steering_encoders: _Encoders | None = None,
        method: _Method = "least_squares",
        inflate: bool = False,
        slip_threshold: float | None = None,
        max_gap: float | None = None,
        max_speed: float | None = None,
        max_steering_rate: float | None = None,
        smoothing: float = 0.0,
        lag: float = 1.0,
        history: int = 1024,
        gyroscope: Gyroscope | None = None,
        wheel_noise: ArrayLike | Mapping[str, float] | None = None,
        dimensions: ArrayLike | None = None,
    ) -> Odometry: ...
    gyroscope_bias: Final[tuple[float, float] | Any]
    def update(
        self,
        steering: ArrayLike | None,
        wheel_angles: ArrayLike,
        stamp: float,
        *,
        yaw: float | None = None,
        yaw_rate: float | None = None,
    ) -> OdometryState: ...
    def run(
        self,
        steering: ArrayLike | None,
        wheel_angles: ArrayLike,
        stamps: ArrayLike,
        *,
        yaw: ArrayLike | None = None,
        yaw_rate: ArrayLike | None = None,
        errors: Literal["flag", "raise"] = "flag",
        covariances: bool = True,
        residuals: bool = True,
    ) -> Track: ...
    def command(self, twist: ArrayLike, stamp: float) -> OdometryState: ...
    def correct(
        self,
        pose: ArrayLike,
        stamp: float,
        covariance: ArrayLike | None = None,
        *,
        std: ArrayLike | None = None,
    ) -> OdometryState: ...
    def at(self, stamp: float) -> Pose: ...
    def set_pose(self, pose: ArrayLike, covariance: ArrayLike | None = None) -> None: ...
    def reset(self, pose: ArrayLike = (0.0, 0.0, 0.0), covariance: ArrayLike | None = None) -> None: ...
    state: Final[OdometryState]
    rover: Final[Rover]
    noise: Final[Noise]

@final
class Gyroscope(_Value):
    def __new__(
        cls,
        noise: float = 0.005,
        *,
        bias: float = 0.0,
        bias_noise: float = 0.05,
        bias_walk: float = 0.0001,
        scale_noise: float = 0.0,
    ) -> Gyroscope: ...
    noise: Final[float]
    bias: Final[float]
    bias_noise: Final[float]
    bias_walk: Final[float]
    scale_noise: Final[float]

_Changes: TypeAlias = dict[str, ArrayLike]

@final
class Odometry3State:
    stamp: Final[float | None]  # [s]
    pose: Final[_Floats]  # (6,) x, y, z, roll, pitch, yaw [m, rad]
    position: Final[_Floats]  # (3,) [m]
    attitude: Final[_Floats]  # (3,) roll, pitch, yaw [rad]
    orientation: Final[_Floats]  # (4,) x, y, z, w
    transform: Final[_Floats]  # (4, 4)
    twist: Final[_Floats]  # (6,) [m/s, rad/s]
    covariance: Final[_Floats]  # (6, 6)
    twist_covariance: Final[_Floats]  # (6, 6)
    residuals: Final[_Floats]  # (wheels,) [m/s]
    slips: Final[_Floats]  # (wheels, 2) [m/s]
    worst_wheel: Final[str | None]
    health: Final[OdometryHealth]

@final
class Odometry3(_Copied):
    def __new__(
        cls,
        suspension: Suspension,
        noise: Noise | None = None,
        *,
        ground: Terrain | None = None,
        attitude_noise: float = 0.002,
        joint_noise: float = 0.001,
        readings: Literal["angles", "speeds", "ticks"] = "angles",
        increments: bool = False,
        wheel_encoders: _Encoders | None = None,
        steering_encoders: _Encoders | None = None,
        slip_threshold: float | None = None,
        max_gap: float | None = None,
        max_speed: float | None = None,
        max_steering_rate: float | None = None,
        lag: float = 1.0,
        history: int = 1024,
    ) -> Odometry3: ...
    def update(
        self,
        steering: ArrayLike | None,
        wheel_angles: ArrayLike,
        stamp: float,
        *,
        joints: ArrayLike | None = None,
        attitude: ArrayLike | None = None,
        yaw_rate: float | None = None,
    ) -> Odometry3State: ...
    def run(
        self,
        steering: ArrayLike | None,
        wheel_angles: ArrayLike,
        stamps: ArrayLike,
        *,
        joints: ArrayLike | None = None,
        attitude: ArrayLike | None = None,
        yaw_rate: ArrayLike | None = None,
        errors: Literal["flag", "raise"] = "flag",
        covariances: bool = True,
        slips: bool = True,
    ) -> Track3: ...
    def correct(
        self,
        pose: ArrayLike,
        stamp: float,
        covariance: ArrayLike | None = None,
        *,
        std: ArrayLike | None = None,
    ) -> Odometry3State: ...
    def set_pose(self, pose: ArrayLike, covariance: ArrayLike | None = None) -> None: ...
    def reset(self, pose: ArrayLike = (0.0, 0.0, 0.0), covariance: ArrayLike | None = None) -> None: ...
    state: Final[Odometry3State]
    suspension: Final[Suspension]
    ground: Final[Terrain | None]
    noise: Final[Noise]

@final
class Preintegrated(_Copied):
    def __new__(
        cls,
        rover: Rover,
        noise: Noise | None = None,
        *,
        gyroscope: Gyroscope | None = None,
        readings: Literal["angles", "speeds", "ticks"] = "angles",
        increments: bool = False,
        wheel_encoders: _Encoders | None = None,
        steering_encoders: _Encoders | None = None,
        method: _Method = "least_squares",
        in_space: bool = False,
        attitude_noise: float = 0.01,
    ) -> Preintegrated: ...
    def add(
        self,
        steering: ArrayLike | WheelLog | None,
        wheel_angles: ArrayLike | None = None,
        stamp: ArrayLike | None = None,
        *,
        yaw_rate: ArrayLike | None = None,
        attitude: ArrayLike | None = None,
    ) -> None: ...
    delta: Final[_Floats]  # (3,) or (4, 4)
    covariance: Final[_Floats]  # (3, 3) or (6, 6)
    def covariance_in(self, tangent: Literal["end", "begin", "coordinates"]) -> _Floats: ...
    tangent: Final[Literal["end"]]
    by_dimension: Final[dict[str, _Floats]]  # each (3 or 6, wheels)
    by_slip: Final[dict[str, _Floats]]  # each (3 or 6, wheels)
    by_gyroscope_bias: Final[_Floats]  # (3,) or (6,)
    def corrected(self, changes: _Changes) -> _Floats: ...
    def residual(self, pose_i: ArrayLike, pose_j: ArrayLike) -> tuple[_Floats, _Floats, _Floats]: ...
    def factor(
        self, pose_i: ArrayLike, pose_j: ArrayLike, changes: _Changes
    ) -> tuple[_Floats, _Floats, _Floats, dict[str, _Floats]]: ...
    def split(self, stamp: float) -> tuple[Preintegrated, Preintegrated]: ...
    def merge(self, other: Preintegrated) -> Preintegrated: ...
    begin: Final[float | None]
    end: Final[float | None]
    duration: Final[float]
    rover: Final[Rover]
    noise: Final[Noise]
    gyroscope: Final[Gyroscope | None]
    def __len__(self) -> int: ...

@final
class Link:
    frame: Final[str]
    parent: Final[str]
    joint: Final[str | None]
    sign: Final[float]  # of the joint's angle
    gamma: Final[float]  # [rad]
    d: Final[float]  # [m]
    a: Final[float]  # [m]
    alpha: Final[float]  # [rad]

@final
class SteeringCommand:
    steering: Final[_Floats]  # (..., steered wheels) [rad]
    wheel_speeds: Final[_Floats]  # (..., 6) [rad/s]
    turning_radius: Final[Any]  # [m]
    scrub: Final[_Floats]  # (..., unsteered wheels) [m/s]

@final
class Terrain(_Value):
    def __new__(
        cls,
        heights: ArrayLike,
        spacing: float | tuple[float, float] | None = None,
        origin: tuple[float, float] | None = None,
        yaw: float = 0.0,
        *,
        north_up: bool | None = None,
        nodata: float | Sequence[float] | None = None,
        unit: str | float | None = None,
    ) -> Self: ...
    @staticmethod
    def read(
        path: str | PathLike[str],
        *,
        window: tuple[float, float, float, float] | None = None,
        topic: str | None = None,
        layer: str | None = None,
        band: int | str | None = None,
        nodata: float | Sequence[float] | None = None,
        unit: str | float | None = None,
        north_up: bool | None = None,
        spacing: float | tuple[float, float] | None = None,
        origin: tuple[float, float] | None = None,
    ) -> Terrain: ...
    @staticmethod
    def yard(
        size: float | tuple[float, float] | None = None,
        spacing: float = 0.05,
        cover: float = 0.1,
        seed: int | None = None,
        *,
        roughness: float = 0.1,
    ) -> Terrain: ...
    heights: Final[NDArray[np.float32] | _Floats]
    shape: Final[tuple[int, int]]
    spacing: Final[tuple[float, float]]
    origin: Final[tuple[float, float]]
    yaw: Final[float]
    def height_at(
        self,
        xy: ArrayLike,
        *,
        method: _Interpolation = "bilinear",
        out: _Out | None = None,
        dtype: type[_Real] | None = None,
        threads: int | None = None,
    ) -> Any: ...
    def gradient_at(
        self,
        xy: ArrayLike,
        *,
        method: _Interpolation = "bilinear",
        out: _Out | None = None,
        dtype: type[_Real] | None = None,
        threads: int | None = None,
    ) -> NDArray[_Real]: ...
    def normal_at(
        self,
        xy: ArrayLike,
        *,
        method: _Interpolation = "bilinear",
        out: _Out | None = None,
        dtype: type[_Real] | None = None,
        threads: int | None = None,
    ) -> NDArray[_Real]: ...
    def contains(self, xy: ArrayLike, *, threads: int | None = None) -> Any: ...

@final
class GroundCommand:
    steering: Final[_Floats]  # (..., steered wheels) [rad]
    wheel_speeds: Final[_Floats]  # (..., wheels) [rad/s]
    twist: Final[_Floats]  # (..., 6) [m/s, rad/s]
    joint_rates: Final[_Floats]  # (..., joints) [rad/s]
    scale: Final[Any]
    def __len__(self) -> int: ...
    def __getitem__(self, index: int, /) -> _Floats: ...
    def __iter__(self) -> Iterator[_Floats]: ...

@final
class GroundMotion:
    twist: Final[_Floats]  # (..., 6) [m/s, rad/s]
    joint_rates: Final[_Floats]  # (..., joints) [rad/s]
    residuals: Final[_Floats]  # (..., wheels, 3) [m/s]

@final
class Traction:
    wheel_speeds: Final[_Floats]  # (..., wheels) [rad/s]
    steering: Final[_Floats]  # (..., steered wheels) [rad]
    contact_angles: Final[_Floats]  # (..., wheels) [rad]
    lifted: Final[NDArray[np.bool_]]  # (..., wheels)
    vertical_speed: Final[Any]  # [m/s]

@final
class WheelSlip:
    ratio: Final[_Floats]  # (..., wheels)
    angle: Final[_Floats]  # (..., wheels) [rad]

@final
class BodySlip:
    slip: Final[_Floats]  # (n,)
    statistic: Final[float]
    threshold: Final[float]
    probability: Final[float]
    slipping: Final[bool]
    def compensate(self, wanted: ArrayLike) -> _Floats: ...

def body_slip(
    navigated: ArrayLike, kinematic: ArrayLike, covariance: ArrayLike, *, false_alarm: float = 0.01
) -> BodySlip: ...

@disjoint_base
class Suspension(_Value):
    @staticmethod
    def triple_bogie(
        *,
        bogie_pivot: ArrayLike,
        bogie_to_front: ArrayLike,
        bogie_to_middle: ArrayLike,
        rear_pivot: ArrayLike,
        rear_to_wheel: ArrayLike,
        wheel_radius: float,
        steered: _Steered = "corners",
        steering_limit: float | tuple[float, float] | None = None,
        bogie_limit: float | tuple[float, float] | None = None,
    ) -> Suspension: ...
    @staticmethod
    def pivoting_axles(
        *,
        wheelbase: float,
        track_width: float,
        drop: float,
        wheel_radius: float,
        steering_limit: float | tuple[float, float] | None = None,
        roll_limit: float | tuple[float, float] | None = None,
    ) -> Suspension: ...
    @staticmethod
    def preset(name: str) -> Suspension: ...
    @staticmethod
    def presets() -> dict[str, str]: ...
    @staticmethod
    def rigid(
        centres: ArrayLike,
        wheel_radius: float,
        *,
        names: Sequence[str] | None = None,
        steered: Sequence[int] = ...,
        steering_limit: float | tuple[float, float] | None = None,
    ) -> Suspension: ...
    wheel_names: Final[tuple[str, ...]]
    free_joints: Final[tuple[str, ...]]
    def inverse(
        self,
        stand: SettledPose,
        command: ArrayLike,
        *,
        view: Literal["body", "plan"] = "body",
        steering: ArrayLike | None = None,
        max_wheel_speed: float | None = None,
        out: tuple[_Out | None, ...] | None = None,
        threads: int | None = None,
        level: _Level | None = None,
    ) -> GroundCommand: ...
    def forward(
        self,
        stand: SettledPose,
        steering: ArrayLike | None,
        wheel_speeds: ArrayLike,
        joint_rates: ArrayLike | None = None,
        angular_velocity: ArrayLike | None = None,
        *,
        steering_rates: ArrayLike | None = None,
        weights: ArrayLike | None = None,
        out: _Out | tuple[_Out | None, ...] | None = None,
        threads: int | None = None,
        level: _Level | None = None,
    ) -> GroundMotion: ...
    def traction(
        self,
        speed: ArrayLike,
        curvature: ArrayLike | None,
        angular_velocity: ArrayLike,
        joints: ArrayLike,
        joint_rates: ArrayLike,
        *,
        yaw_rate: ArrayLike | None = None,
        steering: ArrayLike | None = None,
        wheel_speeds: ArrayLike | None = None,
        lift_angle: float = 1.0,
        lift_speed: float = 0.01,
        out: tuple[_Out | None, ...] | None = None,
        threads: int | None = None,
        level: _Level | None = None,
    ) -> Traction: ...
    def slip(
        self,
        stand: SettledPose,
        wheel_speeds: ArrayLike,
        twist: ArrayLike,
        joint_rates: ArrayLike,
        *,
        out: tuple[_Out | None, ...] | None = None,
        threads: int | None = None,
    ) -> WheelSlip: ...
    def settle(
        self,
        ground: Terrain,
        poses: ArrayLike,
        steering: ArrayLike | None = None,
        *,
        derivatives: bool = False,
        centre_of_mass: ArrayLike | None = None,
        threads: int | None = None,
        level: _Level | None = None,
    ) -> SettledPose: ...
    def stability(
        self,
        stand: SettledPose,
        *,
        mass: float,
        centre_of_mass: ArrayLike | None = None,
        gravity: float = 9.80665,
        belly: tuple[float, float, float, float] | None = None,
        out: tuple[_Out | None, ...] | None = None,
        threads: int | None = None,
    ) -> Stability: ...

@final
class PoseBounds:
    z: Final[_Floats]  # (..., 2) [m]
    roll: Final[_Floats]  # (..., 2) [rad]
    pitch: Final[_Floats]  # (..., 2) [rad]
    tilt: Final[_Floats]  # (..., 2) [rad]
    clearance: Final[_Floats]  # (..., 2) [m]
    rocker: Final[_Floats]  # (..., 2) [rad]
    bogies: Final[_Floats]  # (..., 2, 2) [rad]
    wheel_drop: Final[_Floats]  # (..., 2) [m]
    status: Final[BoundsStatus | NDArray[Any]]  # (...) BoundsStatus

@final
class Feasibility:
    ok: Final[Any]
    reason: Final[FeasibilityReason | NDArray[Any]]  # (...) FeasibilityReason
    reason_codes: Final[int | NDArray[np.uint8]]
    margin: Final[Any]
    tilt: Final[Any]  # [rad]
    clearance: Final[Any]  # [m]
    exact: Final[Any]

@final
class Stability:
    loads: Final[_Floats]  # (..., wheels) [N]
    tip_over_angle: Final[Any]  # [rad]
    clearance: Final[Any]  # [m]
    joint_margins: Final[_Floats]  # (..., joints) [rad]
    tilt: Final[Any]  # [rad]
    by_pose: Final[MarginJacobian | None]
    by_dimension: Final[MarginJacobian | None]

@final
class MarginJacobian:
    tip_over_angle: Final[_Floats]  # (..., 3) or (..., 16)
    clearance: Final[_Floats]  # (..., 3) or (..., 16)
    joint_margins: Final[_Floats]  # (..., joints, 3) or (..., joints, 16)
    tilt: Final[_Floats]  # (..., 3) or (..., 16)

@final
class SettledPose:
    status: Final[SettleStatus | NDArray[Any]]  # (...) SettleStatus
    reason: Final[str | NDArray[Any]]  # (...) str
    ground: Final[Terrain]
    suspension: Final[Suspension]
    stands: Final[Any]
    poses: Final[_Floats]  # (..., 3) [m, m, rad]
    steering: Final[_Floats]  # (..., steered) [rad]
    z: Final[Any]  # [m]
    roll: Final[Any]  # [rad]
    pitch: Final[Any]  # [rad]
    joints: Final[_Floats]  # (..., joints) [rad]
    stops: Final[_Floats]  # (..., joints) -1, 0, 1
    gap: Final[_Floats]  # (..., wheels) [m]
    contact_angles: Final[_Floats]  # (..., wheels) [rad]
    next_contact_angles: Final[_Floats]  # (..., wheels) [rad]
    contacts: Final[_Floats]  # (..., wheels, 3) [m]
    next_contacts: Final[_Floats]  # (..., wheels, 3) [m]
    normals: Final[_Floats]  # (..., wheels, 3)
    transform: Final[_Floats]  # (..., 4, 4)
    wheel_centres: Final[_Floats]  # (..., wheels, 3) [m]
    by_pose: Final[_Floats | None]  # (..., 3 + joints, 3)
    by_dimension: Final[_Floats | None]  # (..., 6, 16)
    def __len__(self) -> int: ...

@final
class RockerBogie(Suspension):
    def __new__(
        cls,
        rocker_pivot: ArrayLike,
        rocker_to_front: ArrayLike | None = None,
        rocker_to_bogie: ArrayLike | None = None,
        bogie_to_middle: ArrayLike | None = None,
        bogie_to_rear: ArrayLike | None = None,
        wheel_radius: float | None = None,
        steered: _Steered = "corners",
        steering_limit: float | tuple[float, float] | None = None,
        *,
        rocker_to_rear: ArrayLike | None = None,
        bogie_to_front: ArrayLike | None = None,
        rocker_limit: float | tuple[float, float] | None = None,
        bogie_limit: float | tuple[float, float] | None = None,
        differential_bar: ArrayLike | None = None,
    ) -> RockerBogie: ...
    @staticmethod
    def preset(name: str) -> RockerBogie: ...
    @staticmethod
    def presets() -> dict[str, str]: ...
    @staticmethod
    def bogie_behind(
        rocker_pivot: ArrayLike,
        rocker_to_front: ArrayLike,
        rocker_to_bogie: ArrayLike,
        bogie_to_middle: ArrayLike,
        bogie_to_rear: ArrayLike,
        wheel_radius: float,
        steered: _Steered = "corners",
        steering_limit: float | tuple[float, float] | None = None,
        *,
        rocker_limit: float | tuple[float, float] | None = None,
        bogie_limit: float | tuple[float, float] | None = None,
        differential_bar: ArrayLike | None = None,
    ) -> RockerBogie: ...
    @staticmethod
    def bogie_in_front(
        rocker_pivot: ArrayLike,
        rocker_to_rear: ArrayLike,
        rocker_to_bogie: ArrayLike,
        bogie_to_front: ArrayLike,
        bogie_to_middle: ArrayLike,
        wheel_radius: float,
        steered: _Steered = "corners",
        steering_limit: float | tuple[float, float] | None = None,
        *,
        rocker_limit: float | tuple[float, float] | None = None,
        bogie_limit: float | tuple[float, float] | None = None,
        differential_bar: ArrayLike | None = None,
    ) -> RockerBogie: ...
    def frames(
        self, joints: ArrayLike, steering: ArrayLike | None = None, *, threads: int | None = None
    ) -> dict[str, _Floats]: ...
    def jacobians(
        self, joints: ArrayLike, steering: ArrayLike | None = None, *, threads: int | None = None
    ) -> dict[str, _Floats]: ...
    def planar(self, joints: ArrayLike = (0.0, 0.0, 0.0)) -> Rover: ...
    def bounds(
        self,
        ground: Terrain,
        poses: ArrayLike,
        yaw_margin: ArrayLike | None = None,
        *,
        position_margin: ArrayLike | None = None,
        map_error: float = 0.0,
        belly: tuple[float, float, float, float] | None = None,
        within: tuple[float, float, float] | None = None,
        out: tuple[_Out | None, ...] | None = None,
        threads: int | None = None,
        level: str | None = None,
    ) -> PoseBounds: ...
    def feasible(
        self,
        ground: Terrain,
        poses: ArrayLike,
        limits: FeasibilityLimits | None = None,
        *,
        map_error: float = 0.0,
        belly: tuple[float, float, float, float] | None = None,
        out: tuple[_Out | None, ...] | None = None,
        threads: int | None = None,
    ) -> Feasibility: ...
    def urdf(self, name: str = "rover") -> str: ...
    def icr_offset(
        self,
        joints: ArrayLike,
        *,
        out: _Out | None = None,
        dtype: type[_Real] | None = None,
        threads: int | None = None,
    ) -> Any: ...
    def steer(
        self,
        speed: ArrayLike,
        yaw_rate: ArrayLike,
        joints: ArrayLike,
        *,
        previous: ArrayLike | None = None,
        previous_wheel_speeds: ArrayLike | None = None,
        threads: int | None = None,
    ) -> SteeringCommand: ...
    links: Final[tuple[Link, ...]]
    joint_names: Final[tuple[str, ...]]
    dimensions: Final[dict[str, Any]]

@final
class FourAxle(_Value):
    def __new__(
        cls,
        pivots: ArrayLike,
        axle_length: float,
        wheel_radius: float,
        *,
        steering_limit: float | tuple[float, float] | None = None,
        tolerance: float = 0.001,
    ) -> FourAxle: ...
    def inverse(
        self,
        twist: ArrayLike,
        *,
        previous: ArrayLike | None = None,
        out: tuple[_Out, _Out] | None = None,
        dtype: type[_Real] | None = None,
        threads: int | None = None,
    ) -> tuple[NDArray[_Real], NDArray[_Real]]: ...
    def forward(
        self,
        steering: ArrayLike,
        wheel_speeds: Iterable[float | None],
        *,
        front_brake: _Brake = "locked",
        rear_brake: _Brake = "locked",
    ) -> FourAxleMotion: ...
    def mobility(self, steering: ArrayLike) -> FourAxleMobility: ...
    def concurrent_angles(
        self,
        icr: ArrayLike,
        *,
        out: _Out | None = None,
        dtype: type[_Real] | None = None,
        threads: int | None = None,
    ) -> NDArray[_Real]: ...
    def lock(self, state: FourAxleState, pair: _Pair) -> FourAxleState: ...
    def release(self, state: FourAxleState, pair: _Pair) -> FourAxleState: ...
    def drive(self, state: FourAxleState, speed: float, duration: float) -> FourAxleStep: ...
    def turn_sequence(
        self,
        state: FourAxleState,
        curvature: float,
        *,
        steer: Literal["both", "front", "rear"] = "both",
        speed: float = 0.0,
        pivot_rate: float = 0.5,
        brake_time: float = 0.0,
    ) -> TurnSequence: ...
    def aim_sequence(
        self,
        state: FourAxleState,
        icr: ArrayLike,
        *,
        speed: float = 0.0,
        pivot_rate: float = 0.5,
        brake_time: float = 0.0,
    ) -> TurnSequence: ...
    def simulate(
        self, sequence: Iterable[FourAxleStep], dt: float, *, state: FourAxleState | None = None
    ) -> FourAxleSimulation: ...
    rover: Final[Rover]
    pivots: Final[tuple[float, float]]
    axle_length: Final[float]
    wheel_radius: Final[float]
    steering_range: Final[tuple[float, float]]
    tolerance: Final[float]

@final
class Limits(_Value):
    def __new__(
        cls,
        *,
        speed: float | None = None,
        yaw_rate: float | None = None,
        acceleration: float | None = None,
        deceleration: float | None = None,
        jerk: float | None = None,
        angular_acceleration: float | None = None,
        angular_deceleration: float | None = None,
        angular_jerk: float | None = None,
        lateral_acceleration: float | None = None,
        wheel_speed: float | None = None,
        wheel_acceleration: float | None = None,
        steering_limit: float | None = None,
        steering_rate: float | None = None,
        steering_acceleration: float | None = None,
        halt_deceleration: float | None = None,
    ) -> Limits: ...
    speed: Final[float]
    yaw_rate: Final[float]
    acceleration: Final[float]
    deceleration: Final[float]
    jerk: Final[float]
    angular_acceleration: Final[float]
    angular_deceleration: Final[float]
    angular_jerk: Final[float]
    lateral_acceleration: Final[float]
    wheel_speed: Final[float]
    wheel_acceleration: Final[float]
    steering_limit: Final[float]
    steering_rate: Final[float]
    steering_acceleration: Final[float]
    halt_deceleration: Final[float]
    def on(self, rover: Rover) -> Limits: ...
    def replace(self, **changes: float | None) -> Limits: ...
    def __replace__(self, **changes: float | None) -> Limits: ...
    def halting_distance(self, speed: float) -> float: ...
    def stopping_distance(self, speed: float) -> float: ...

@final
class Controller(_Copied):
    def __new__(
        cls,
        rover: Rover,
        limits: Limits | None = None,
        *,
        timeout: float | None = 0.5,
        period: float | None = None,
        max_step: float = 0.1,
        mode: _Mode = "free",
        align: _Align | None = "cosine",
        align_tolerance: float = 0.02,
        following_error: float | None = 0.2,
        following_time: float | None = 0.5,
        discretise: bool = False,
        steering: ArrayLike | None = None,
        twist: ArrayLike | None = None,
    ) -> Controller: ...
    def command(self, twist: ArrayLike, stamp: float, mode: _Mode | None = None) -> bool: ...
    def step(self, stamp: float, measured: ArrayLike | None = None) -> ControllerOutput: ...
    def run(self, twists: ArrayLike, stamps: ArrayLike, step_stamps: ArrayLike) -> ControllerRun: ...
    def reset(self, steering: ArrayLike | None = None) -> None: ...
    def halt(self) -> None: ...
    def release(self) -> bool: ...
    halted: Final[bool]
    rover: Final[Rover]
    @property
    def limits(self) -> Limits: ...
    @limits.setter
    def limits(self, limits: Limits) -> None: ...
    twist: Final[_Floats]
    steering: Final[_Floats]
    stamp: Final[float | None]
    stopped: Final[bool]
    stopping_distance: Final[float]

@final
class ControllerOutput:
    rover: Final[Rover]
    commands: Final[dict[str, float]]
    steering: Final[_Floats]
    steering_rates: Final[_Floats]
    wheel_speeds: Final[_Floats]
    joint_errors: Final[_Floats | Any]
    worst_joint: Final[str | None]
    speed_share: Final[float]
    twist: Final[_Floats]
    reasons: Final[Reason]

@final
class ControllerRun:
    def to_arrays(self) -> dict[str, NDArray[Any]]: ...
    def to_pandas(self) -> Any: ...
    def to_arrow(self) -> Any: ...
    def to_csv(self, path: str | PathLike[str]) -> None: ...
    stamps: Final[_Floats]
    rover: Final[Rover]
    commands: Final[dict[str, _Floats]]
    steering: Final[_Floats]
    steering_rates: Final[_Floats]
    wheel_speeds: Final[_Floats]
    twist: Final[_Floats]
    reasons: Final[NDArray[np.uint32]]
    def __len__(self) -> int: ...

@final
class Costmap(_Value):
    def __new__(
        cls,
        values: ArrayLike,
        spacing: float | ArrayLike,
        origin: ArrayLike | None = None,
        yaw: float = 0.0,
        *,
        lethal: float | None = None,
        outside: float | None = None,
        frame: str | None = None,
    ) -> Costmap: ...
    @staticmethod
    def from_occupancy_grid(
        msg: Any, *, inflation: float = 0.0, unknown: float = 0.5, lethal: float = 0.65
    ) -> Costmap: ...
    @staticmethod
    def read(
        path: str | PathLike[str],
        *,
        inflation: float = 0.0,
        unknown: float = 0.5,
        lethal: float | None = None,
    ) -> Costmap: ...
    values: Final[NDArray[np.float32]]
    spacing: Final[tuple[float, float]]
    origin: Final[tuple[float, float]]
    yaw: Final[float]
    lethal: Final[float | None]
    outside: Final[float | None]
    frame: Final[str | None]

@final
class Mppi:
    def __new__(
        cls,
        rover: Rover,
        limits: Limits | None = None,
        *,
        horizon: int = 56,
        dt: float = 0.05,
        samples: int = 2000,
        seed: int = 0,
        sampling_std: ArrayLike | None = None,
        correlation: float = 0.5,
        temperature: float = 1.0,
        cost_weights: Mapping[str, float] | None = None,
        smoothing: bool = True,
        delay: float = 0.0,
        dtype: DTypeLike = "float64",
        footprint: ArrayLike | None = None,
    ) -> Mppi: ...
    def step(
        self,
        state: Any,
        *,
        twist: ArrayLike | None = None,
        steering: ArrayLike | None = None,
        path: ArrayLike | None = None,
        costmap: Costmap | None = None,
        goal: ArrayLike | None = None,
        extra_cost: Callable[[_Floats, _Floats], ArrayLike] | None = None,
        frame: str | None = None,
        out: tuple[_Floats, _Floats] | None = None,
        threads: int | None = None,
        level: _Level | None = None,
    ) -> MppiPlan: ...
    def reset(self) -> None: ...
    def restore(self, state: Mapping[str, Any]) -> None: ...
    state: Final[dict[str, Any]]
    wishes: Final[_Floats]
    costs: Final[_Floats]
    rover: Final[Rover]
    @property
    def limits(self) -> Limits: ...
    horizon: Final[int]
    dt: Final[float]
    samples: Final[int]
    seed: Final[int]
    sampling_std: Final[_Floats]
    cost_weights: Final[dict[str, float]]

@final
class MppiPlan:
    twist: Final[_Floats]
    steering: Final[_Floats]
    wheel_speeds: Final[_Floats]
    twists: Final[_Floats]
    poses: Final[_Floats]
    controls: Final[_Floats]
    cost: Final[float]
    effective_samples: Final[float]
    reason: Final[str]

def reason_bits() -> list[tuple[str, int]]: ...
def integrate(
    twists: ArrayLike,
    dt: ArrayLike,
    start: ArrayLike = (0.0, 0.0, 0.0),
    *,
    out: _Out | None = None,
    dtype: type[_Real] | None = None,
    threads: int | None = None,
    level: _Level | None = None,
) -> NDArray[_Real]: ...
def rollout(
    controls: ArrayLike,
    dt: ArrayLike,
    start: ArrayLike = (0.0, 0.0, 0.0),
    *,
    out: _Out | None = None,
    dtype: type[_Real] | None = None,
    rover: Rover | None = None,
    limits: Limits | None = None,
    twist: ArrayLike | None = None,
    steering: ArrayLike | None = None,
    delay: float = 0.0,
    threads: int | None = None,
    level: _Level | None = None,
) -> NDArray[_Real]: ...
def simd_levels() -> list[_Level]: ...
def default_threads() -> int: ...
def set_default_threads(threads: int) -> None: ...
def differentiate(
    poses: ArrayLike,
    dt: ArrayLike,
    *,
    out: _Out | None = None,
    dtype: type[_Real] | None = None,
    threads: int | None = None,
) -> NDArray[_Real]: ...
def exp(
    twist: ArrayLike,
    dt: ArrayLike = 1.0,
    *,
    out: _Out | None = None,
    dtype: type[_Real] | None = None,
    threads: int | None = None,
) -> NDArray[_Real]: ...
def log(
    pose: ArrayLike,
    dt: ArrayLike = 1.0,
    *,
    out: _Out | None = None,
    dtype: type[_Real] | None = None,
    threads: int | None = None,
) -> NDArray[_Real]: ...
def compose(
    first: ArrayLike,
    second: ArrayLike,
    *,
    out: _Out | None = None,
    dtype: type[_Real] | None = None,
    threads: int | None = None,
) -> NDArray[_Real]: ...
def unit_questions(rover: Rover) -> list[tuple[str, str, str]]: ...
def setting_questions(settings: Mapping[str, Any]) -> list[tuple[str, str, str]]: ...
def ask_settings(settings: Mapping[str, Any]) -> None: ...
def check_kind(argument: str, value: object) -> None: ...
def without_questions(call: Callable[[], _T]) -> _T: ...
def wrap_angle(
    angle: ArrayLike, *, out: _Out | None = None, dtype: type[_Real] | None = None, threads: int | None = None
) -> Any: ...
