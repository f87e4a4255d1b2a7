"""Flags that print their names: ``SPEED|STALE`` and not ``65568``."""

from enum import IntFlag

__all__ = ["NamedFlag"]


class NamedFlag(IntFlag):
    """An `IntFlag` whose text is the names of its members."""

    def __str__(self) -> str:
        names = "|".join(str(each.name) for each in type(self) if each in self)
        return names or self.name or "none"

    def __format__(self, spec: str) -> str:
        return format(int(self) if spec[-1:] in tuple("bdoxX") else str(self), spec)
