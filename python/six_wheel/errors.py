"""What this package raises beyond the built-in exceptions."""


class InfeasibleMotionError(ValueError):
    """A motion the rover cannot make: a wheel would slide sideways or steer past its range."""


class UnderdeterminedError(ValueError):
    """The readings of the wheels do not determine the twist."""


class ArgumentTypeError(ValueError, TypeError):
    """An argument of the wrong type. Bad input like any other here, and a `TypeError` by Python's custom."""


def printable(text: str) -> str:
    """The text with control characters as escapes: what a file says must not move a terminal's cursor."""
    return "".join(c if c.isprintable() or c == "\n" else c.encode("unicode_escape").decode() for c in text)


class FileError(ValueError):
    """A file that cannot be used. Its text may hold words of the file, and is printable all the same."""

    def __str__(self) -> str:
        return printable(super().__str__())


class SuspiciousUnitsWarning(UserWarning):
    """A number that cannot be a rover's in metres or radians; its text says what may have been meant."""
