"""YAML as ROS 2 reads it, with the line and the spelling of every key and value.

PyYAML reads YAML 1.1, where ``1e-3`` is text; the parameter parser of ROS 2 (libyaml and C's ``strtod``)
reads a number, ``010`` is octal and ``0x10`` hexadecimal. Here the scanning and nesting are PyYAML's, the
meaning of an unquoted word is that of ROS 2: there are no aliases, a tab may follow a value but never indent
one, and of a key that is given twice the later counts.
"""

import re
from collections.abc import Callable
from functools import reduce
from operator import getitem
from typing import Any, NamedTuple, TypeAlias

import yaml
from yaml.composer import ComposerError
from yaml.reader import ReaderError

Path: TypeAlias = tuple[str | int, ...]
# line, where in the tree, message, remedy
Report: TypeAlias = Callable[[int | None, Path, str, str | None], None]

# A parameter file nests four or five levels. The bound keeps recursion away from Python's own.
MAX_DEPTH = 32

_TAG = "tag:yaml.org,2002:"
_NULL = re.compile(r"(?:~|null|Null|NULL|)\Z")
_BOOL = re.compile(r"(?:[yYnN]|yes|no|true|false|on|off|Yes|No|True|False|On|Off|YES|NO|TRUE|FALSE|ON|OFF)\Z")
_TRUE = {"y", "yes", "true", "on"}
# As C's strtoll reads them with base 0: a leading zero makes an octal number.
_INT = re.compile(r"[-+]?(?:0[xX][0-9a-fA-F]+|0[0-7]*|[1-9][0-9]*)\Z")
_EXPONENT = r"[eE][-+]?[0-9]+"
_FLOAT = re.compile(
    rf"[-+]?(?:(?:[0-9]+\.[0-9]*|\.[0-9]+)(?:{_EXPONENT})?|[0-9]+{_EXPONENT}|0[0-9]+|(?i:\.?inf|infinity|\.?nan))\Z"
)


class Place(NamedTuple):
    """Line of a value and its text there."""

    line: int
    text: str


class Tree(NamedTuple):
    """Plain data (None, bool, int, float, str, list, dict) and the place of every part of it."""

    data: Any
    places: dict[Path, Place]

    def at(self, path: Path) -> Any:
        """The data at a path."""
        return value_at(self.data, path)


def value_at(data: Any, path: Path) -> Any:
    """The value of nested lists and mappings at a path."""
    return reduce(getitem, path, data)


def spell(path: Path) -> str:
    """A path as a reader would write it: ``limits.speed``, ``traction_joints[3]``."""
    parts = (f"[{part}]" if isinstance(part, int) else f".{one_line(part)}" for part in path)
    return "".join(parts).removeprefix(".")


def one_line(text: str) -> str:
    """Text from a file as it is, unless it would break a line or shout: then quoted and cut."""
    if text.isprintable() and len(text) <= 60:
        return text
    return repr(text if len(text) <= 60 else text[:57] + "...")


def nearest(places: dict[Path, Place], path: Path) -> Place:
    """The place of `path`, or of the closest thing around it that has one."""
    while path and path not in places:
        path = path[:-1]
    return places.get(path, Place(1, ""))


class YamlSyntaxError(Exception):
    """The text is not YAML: nothing after this line can be judged."""

    def __init__(self, line: int | None, message: str, remedy: str) -> None:
        super().__init__(line, message, remedy)
        self.line, self.message, self.remedy = line, message, remedy


class Loader(yaml.SafeLoader):
    """PyYAML's, without its meaning of words and without aliases."""

    yaml_implicit_resolvers = {}  # none of YAML 1.1's  # noqa: RUF012 - PyYAML's own way to start afresh

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self._depth = 0

    def scan_to_next_token(self) -> None:
        # libyaml, and so ROS 2, lets a tab stand between a key and its value; PyYAML does not.
        super().scan_to_next_token()
        while self.peek() == "\t" and (self.flow_level or not self.allow_simple_key):
            self.forward()
            super().scan_to_next_token()

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        if self.check_event(yaml.AliasEvent):
            event = self.peek_event()  # type: ignore[no-untyped-call]
            raise ComposerError(None, None, f"found the alias *{event.anchor}", event.start_mark)
        if self._depth == MAX_DEPTH:
            mark = self.peek_event().start_mark  # type: ignore[no-untyped-call]
            raise ComposerError(None, None, f"nested more than {MAX_DEPTH} levels deep", mark)
        self._depth += 1
        node = super().compose_node(parent, index)
        self._depth -= 1
        return node


class _Dumper(yaml.SafeDumper):
    """Quotes what either YAML 1.1 or ROS 2 would not read as text."""


for _name, _regex in (("null", _NULL), ("bool", _BOOL), ("int", _INT), ("float", _FLOAT)):
    for _class in (Loader, _Dumper):
        _class.add_implicit_resolver(_TAG + _name, _regex, None)


def parse(text: str, report: Report, warn: Report | None = None) -> Tree:
    """Read one YAML document; the data of one without content is None.

    `report` is called for every mistake that leaves the rest readable, a key that is no text or an unknown
    tag; `warn` for what ROS 2 reads although it may be a mistake: a key that is given twice, octal numbers.
    Raises `YamlSyntaxError` if the text is not YAML, or uses what ROS 2 does not read.
    """
    try:
        root = Loader(text).get_single_node()
    except yaml.YAMLError as error:
        raise _explain(error, text) from None
    except (ValueError, OverflowError) as error:  # PyYAML on "\UFFFFFFFF", or a version number of 5000 digits
        remedy = "look for escapes such as \\U in quoted text"
        raise YamlSyntaxError(None, f"not valid YAML: {error}", remedy) from None
    reader = _Reader(report, warn or (lambda *_: None))
    return Tree(None if root is None else reader.read(root, ()), reader.places)


# Messages of PyYAML, each with its usual cause.
_PLAINLY = {
    "expected <block end>": "this line is not indented like those it belongs to",
    "mapping values are not allowed": "a colon where no key can be; the line above may lack its own",
    "could not find expected ':'": "a key without its colon",
    "expected ',' or": "a bracket is not closed",
    "found unexpected end of stream": "a quote is not closed",
}


def write(data: dict[str, Any]) -> str:
    """The text of a document that reads the same here, in YAML 1.1 and in ROS 2."""
    return yaml.dump(data, Dumper=_Dumper, sort_keys=False, allow_unicode=True)


def _explain(error: yaml.YAMLError, text: str) -> YamlSyntaxError:
    if isinstance(error, ReaderError):
        character = f"U+{ord(text[error.position]):04X}"
        at = text.count("\n", 0, error.position) + 1
        return YamlSyntaxError(at, f"not a text file: it has the character {character}", "give a YAML file")
    if not isinstance(error, yaml.MarkedYAMLError):
        return YamlSyntaxError(None, "not valid YAML", "check its indentation and colons")
    mark, problem = error.problem_mark or error.context_mark, error.problem or "cannot be read"
    line = None if mark is None else mark.line + 1
    if "'\\t'" in problem:
        return YamlSyntaxError(line, "not valid YAML: a tab in the indentation", "replace the tab by spaces")
    if "alias" in problem:
        return YamlSyntaxError(line, f"{problem}, which ROS 2 does not read", "write the value out")
    if "expected a single document" in str(error.context):
        return YamlSyntaxError(line, "a second YAML document begins", "remove it, or put it in its own file")
    problem = next((plain for phrase, plain in _PLAINLY.items() if phrase in problem), problem)
    opened = error.context_mark
    if opened is not None and line is not None and opened.line + 1 < line and error.context:
        problem = f"{problem}, {error.context} that starts on line {opened.line + 1}"
    remedy = "check the indentation, colons, quotes and brackets here and just above"
    return YamlSyntaxError(line, f"not valid YAML: {problem}", remedy)


class _Reader:
    """Turns composed nodes into data, remembering where each came from."""

    def __init__(self, report: Report, warn: Report) -> None:
        self.report, self.warn = report, warn
        self.places: dict[Path, Place] = {}

    def read(self, node: yaml.Node, path: Path) -> Any:
        line = node.start_mark.line + 1
        self.places.setdefault(path, Place(line, ""))
        if isinstance(node, yaml.MappingNode):
            data: dict[str, Any] = {}
            self._fill(data, node, path)
            return data
        if isinstance(node, yaml.SequenceNode):
            return [self.read(item, (*path, index)) for index, item in enumerate(node.value)]
        # A key's place is the key's line; an item's place is its own.
        self.places[path] = Place(self.places[path].line, node.value)
        return self._scalar(node, line, path)

    def _scalar(self, node: yaml.Node, line: int, path: Path) -> Any:
        text: str = node.value
        match node.tag.removeprefix(_TAG):
            case "str":
                return text
            case "null":
                return None
            case "bool" if _BOOL.match(text):
                return text.lower() in _TRUE
            case "int" if _INT.match(text) and len(text) < 18:
                return self._whole(text, line, path)
            case "int" | "float" if _FLOAT.match(text) or _INT.match(text):
                # Python spells .inf and .nan without the point
                return float(re.sub(r"\.(?=[ni])", "", text.lower()))
        tag = one_line(node.tag.removeprefix(_TAG))
        message = f"{spell(path[-1:])} has the tag {tag}, which does not fit its value"
        self.report(line, path, message, "remove the tag")
        return text

    def _fill(self, data: dict[str, Any], node: yaml.MappingNode, path: Path) -> None:
        for key_node, value_node in node.value:
            line = key_node.start_mark.line + 1
            if not isinstance(key_node, yaml.ScalarNode):
                self.report(line, path, "a key is a list or a mapping", "use a plain word as the key")
                continue
            key: str = key_node.value
            here = (*path, key)
            if key in data:
                message = f"{one_line(key)} is given twice, first on line {self.places[here].line}"
                self.warn(line, here, message, "the later counts, as in ROS 2; remove one of the two")
                if isinstance(value_node, yaml.MappingNode) and isinstance(data[key], dict):
                    self.places[here] = Place(line, "")
                    self._fill(data[key], value_node, here)
                    continue
                self.places = {at: place for at, place in self.places.items() if at[: len(here)] != here}
            self.places[here] = Place(line, "")
            data[key] = self.read(value_node, here)

    def _whole(self, text: str, line: int, path: Path) -> int:
        """A whole number as C reads it."""
        digits = text.lstrip("+-")
        if digits[:2] in ("0x", "0X"):
            return int(text, 16)
        if len(digits) == 1 or digits[0] != "0":
            return int(text)
        value = int(text, 8)
        self.warn(line, path, f"{text} is octal and means {value}, as ROS 2 reads it", f"write {value}")
        return value
