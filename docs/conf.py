"""Sphinx: no network, no fonts, no CDN. The pages of the API are what `help()` shows of the module."""

import enum
import functools
import importlib
import inspect
import logging
import re
import types
from pathlib import Path
from typing import Any

import numpy as np
from docutils import nodes
from docutils.parsers.rst import Directive

import six_wheel as sw

HERE = Path(__file__).parent
HELP_WIDTH = 84  # columns of the command line's help

project, version = "six_wheel", sw.__version__
release, html_title = version, f"six_wheel {version}"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.autosummary", "numpydoc"]
templates_path = ["_templates"]
exclude_patterns = ["_build", "_static", "_templates", "pictures"]
default_role = "py:obj"  # `Rover.inverse` in a docstring becomes a link
myst_heading_anchors = 4  # the anchors that GitHub has
autodoc_typehints = "none"
autodoc_default_options = {"member-order": "bysource", "undoc-members": True}
autosummary_imported_members, autosummary_ignore_module_all = True, False
numpydoc_show_class_members = numpydoc_xref_param_type = False
html_theme, html_copy_source, html_show_sphinx = "furo", False, False
html_static_path, html_css_files, html_show_copyright = ["_static"], ["site.css"], False
html_show_search_summary = False  # summaries are fetched, which a page of a file:// address may not


def listed(text: str) -> list[str]:
    """The full names that a part of reference/index.md lists, in its order."""
    return [f"six_wheel.{name}" for name in re.findall(r"^   ([\w.]+)$", text, re.M)]


def places_elsewhere(modules: list[str]) -> dict[str, str]:
    """For each name that has its page elsewhere, that page: of six_wheel, or of the first module with it."""
    first = {id(getattr(sw, name)): f"six_wheel.{name}" for name in sw.__all__}
    elsewhere = {}
    for module in modules:
        package = importlib.import_module(module)
        for name in package.__all__:
            here = f"{module}.{name}"
            if (place := first.setdefault(id(getattr(package, name)), here)) != here:
                elsewhere[here] = place
    return elsewhere


def data_of(modules: list[str]) -> dict[str, list[str]]:
    """For each module its public names that are neither classes nor functions nor modules."""
    packages = {module: importlib.import_module(module) for module in modules}
    kinds = (type, types.FunctionType, types.BuiltinFunctionType, types.ModuleType)
    return {
        module: [name for name in package.__all__ if not isinstance(getattr(package, name), kinds)]
        for module, package in packages.items()
    }


contents = (HERE / "reference" / "index.md").read_text(encoding="utf-8")
modules = listed(contents.split("Modules\n")[1])
autosummary_context = {"elsewhere": places_elsewhere(modules), "data": data_of(modules)}
for stale in {path.stem for path in (HERE / "reference" / "api").glob("*.rst")} - set(listed(contents)):
    (HERE / "reference" / "api" / f"{stale}.rst").unlink()


SECTION = re.compile(r"^Attributes\n-+\n(.*?)(?=^\w[^\n]*\n---|\Z)", re.M | re.S)
ENTRY = re.compile(r"^(\w[\w, ]*)(?: : ([^\n]*))?\n((?:(?: +[^\n]*)?\n)*)", re.M)


def fields(docstring: str) -> dict[str, list[str]]:
    """Type and text of each entry of a docstring's section Attributes."""
    section = SECTION.search(docstring + "\n")
    found = {}
    for names, kind, text in ENTRY.findall(section[1]) if section else ():
        for name in names.split(", "):
            found[name] = [*([f"({kind})", ""] if kind else []), *inspect.cleandoc(text).splitlines(), ""]
    return found


def named(name: str) -> Any:
    """The object of a full name."""
    return functools.reduce(getattr, name.split(".")[1:], sw)


def shape_docstring(
    app: Any, kind: str, name: str, member: object, options: object, lines: list[str]
) -> None:
    """Fits a docstring to autodoc and numpydoc, before these read it.

    The paragraph "Source: ..." becomes the section References: it is no part of Raises. An initial at its
    begin is no number of a list. Entries of the section Attributes go to the members themselves. A flag, such
    as `Reason.STALE`, has its text in `help`.
    """
    text = re.sub(r"^Source: ([A-Z]\.)", r"Source: \\\1", "\n".join(lines), flags=re.M)
    text = re.sub(r"^Source: ", "References\n----------\n", text, flags=re.M)
    if isinstance(member, type):
        known = {
            name for one in member.__mro__ for name in (*vars(one), *vars(one).get("__annotations__", ()))
        }
        if fields(text).keys() <= known:
            text = SECTION.sub("", text + "\n")
        if issubclass(member, enum.Enum) and hasattr(member, "help"):
            text += "\n\n" + "\n\n".join(f"``{flag.name}``: {flag.help}." for flag in member)
    elif kind == "attribute" and not any(lines):
        owner, _, field = name.rpartition(".")
        text = "\n".join(fields(inspect.getdoc(named(owner)) or "").get(field, []))
    lines[:] = text.split("\n")


class CommandHelp(Directive):
    """A section for every command of `six-wheel`, with its ``--help``."""

    def run(self) -> list[nodes.Node]:
        import typer

        from six_wheel.cli.app import app
        from six_wheel.cli.names import COMMANDS, PROGRAM

        group: Any = typer.main.get_command(app)
        parent = typer.Context(group, info_name=PROGRAM, terminal_width=HELP_WIDTH, **group.context_settings)
        sections: list[nodes.Node] = []
        for name in COMMANDS:
            command = group.commands[name]
            context = typer.Context(command, parent=parent, info_name=name, terminal_width=HELP_WIDTH)
            section = nodes.section(ids=[f"{PROGRAM}-{name}"], names=[f"{PROGRAM} {name}"])
            section += nodes.title("", f"{PROGRAM} {name}")
            section += nodes.literal_block("", command.get_help(context), language="text")
            sections.append(section)
        return sections


def write_view(app: Any, error: Exception | None) -> None:
    """The page of a recorded drive that docs/howto/view.md embeds; it needs no server."""
    if error is not None or app.builder.format != "html":
        return
    logging.getLogger("websockets").setLevel(logging.WARNING)  # Sphinx shows what a server says of itself
    stamps = np.arange(0.0, 12.0, 1.0)
    twists = np.stack([np.full(12, 0.15), np.zeros(12), 0.06 * np.sin(stamps / 3.0)], axis=1)
    yard = sw.Terrain.yard(16.0, 0.1, 0.08, 4, roughness=0.2)
    arm = sw.RockerBogie.preset("perseverance")
    run = sw.simulate(arm, (stamps, twists), ground=yard, start=(6.0, 8.0, 0.0), rate=10.0, name="run")
    with sw.view(run, open=False) as view:
        view.save(Path(app.outdir) / "howto" / "recorded_drive.html")


def setup(app: Any) -> None:
    app.add_directive("command-help", CommandHelp)
    app.connect("autodoc-process-docstring", shape_docstring, priority=100)  # before numpydoc
    app.connect("build-finished", write_view)
