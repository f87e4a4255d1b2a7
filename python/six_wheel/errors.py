"""What this package raises beyond the built-in exceptions."""


class InfeasibleMotionError(ValueError):
    """A motion the rover cannot make: a wheel would slide sideways or steer past its range."""


class UnderdeterminedError(ValueError):
    """The readings of the wheels do not determine the twist."""


class ArgumentTypeError(ValueError, TypeError):
    """An argument of the wrong type. Bad input like any other here, and a `TypeError` by Python's custom."""


class SuspiciousUnitsWarning(UserWarning):
    """A number that cannot be a rover's in metres or radians; its text says what may have been meant."""
