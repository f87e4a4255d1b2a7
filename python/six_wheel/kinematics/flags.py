"""Flags that print their names, and what each means: ``SPEED|STALE`` and not ``65568``."""

from enum import IntFlag

__all__ = ["NamedFlag", "TextFlag"]


class NamedFlag(IntFlag):
    """An `IntFlag` whose text is the names of its members."""

    def __str__(self) -> str:
        names = "|".join(str(each.name) for each in type(self) if each in self)
        return names or self.name or "none"

    def __format__(self, spec: str) -> str:
        return format(int(self) if spec[-1:] in tuple("bdoxX") else str(self), spec)


class TextFlag(NamedFlag):
    """A `NamedFlag` whose members have a text each: ``MEMBER = bit, "text"``."""

    _value_: int
    _text: str

    def __new__(cls, value: int, text: str = "") -> "TextFlag":
        member = int.__new__(cls, value)
        member._value_ = value
        member._text = member.__doc__ = text
        return member

    @property
    def help(self) -> str:
        """The meaning of the member, or of each of several, one after the other; empty for none."""
        return "; ".join(each._text for each in type(self) if each in self)

    def __str__(self) -> str:
        return "; ".join(f"{each.name}: {each._text}" for each in type(self) if each in self)
