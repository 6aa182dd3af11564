"""The command reference: a page, a section per command, made by sphinx-click."""

from __future__ import annotations

import click

from thermogear.front.cli import cli

NOTE = """\
Every command answers ``--help``. A user's error is one line on the error stream, exit code 2;
Ctrl+C ends with 130 and keeps what was finished. ``CASE`` is a case file, or the name of a
ready-made one as ``thermogear example`` lists them.
"""


def every_command() -> dict[str, click.Command]:
    """Commands by their words: "run", "new", ..."""
    found: dict[str, click.Command] = {}

    def walk(group: click.Group, words: tuple[str, ...]) -> None:
        for name, command in group.commands.items():
            found[" ".join((*words, name))] = command
            if isinstance(command, click.Group):
                walk(command, (*words, name))

    walk(cli, ())
    return found


def commands() -> dict[str, str]:
    """The page of all commands, in the order of the help."""
    title = "Commands"
    text = f"{title}\n{'=' * len(title)}\n\n{NOTE}\n"
    text += ".. click:: thermogear.front.cli:cli\n   :prog: thermogear\n   :nested: full\n"
    return {"generated/commands.rst": text}
