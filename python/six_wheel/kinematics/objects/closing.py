"""Objects that hold a file or a thread, and let go of it at the end of a `with` block."""

from typing import Self


class Closing:
    """Its `close` is called at the end of a `with` block."""

    def close(self) -> None:
        """Nothing is open."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()
