"""Enumerations that print their names, and what each means: ``SPEED|STALE`` and not ``65568``."""

from enum import EnumType, IntFlag, StrEnum
from typing import Any


class Listed(EnumType):
    """A kind of enumerations whose own text is their members, a line each: ``print(Reason)``."""

    def __str__(cls) -> str:
        members: Any = cls
        return "\n".join(f"{each.name}: {each.help}" for each in members)


class TextFlag(IntFlag, metaclass=Listed):
    """An `IntFlag` that prints names of members, with a meaning each: ``MEMBER = bit, "meaning"``."""

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
        names = "|".join(str(each.name) for each in type(self) if each in self)
        return names or self.name or "none"

    def __repr__(self) -> str:
        return super().__repr__() if self.name else "none"

    def __format__(self, spec: str) -> str:
        return format(int(self) if spec[-1:] in tuple("bdoxX") else str(self), spec)


class TextName(StrEnum, metaclass=Listed):
    """A `StrEnum` that prints its values, with a meaning each: ``member = "member", "meaning"``."""

    _value_: str

    def __new__(cls, value: str, text: str = "") -> "TextName":
        member = str.__new__(cls, value)
        member._value_ = value
        member.__doc__ = text
        return member

    @property
    def help(self) -> str:
        """The meaning of the member, and what to do."""
        return self.__doc__ or ""

    def __repr__(self) -> str:
        return self.value
