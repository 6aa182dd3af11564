"""Commands made of their declarations: what is asked, its options, the way to its result."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import Field, fields
from functools import partial
from typing import Any

import click

from thermogear.base.errors import InputError
from thermogear.front import delivery, motion_commands
from thermogear.study.declared import COMMANDS as DECLARED
from thermogear.study.declared import Study

SUBJECTS: dict[str, Callable[[dict[str, Any]], Any]] = {
    "gears": lambda options: delivery.load_gears(options["case"], options["overrides"]),
    "point": motion_commands.point_of,
}
"""What a study is of, and how it is read from the options."""


def _shared(study: type[Study]) -> list[Callable[[Any], Any]]:
    """Options that say what a study is of, and what becomes of its result."""
    if study.of != "gears":
        return [motion_commands.point_options]
    words = study.stores or "Directory of the results; made if new."
    output = delivery.output(words, required=not study.stores)
    csv = [] if study.stores else [delivery.csv]
    return [delivery.case, output, delivery.overrides, *csv, delivery.as_json]


def _read(read: Callable[[str, Any], Any], _: Any, parameter: click.Parameter, value: Any) -> Any:
    return None if value is None else read(parameter.opts[0], value)


def _option(declared: Field[Any]) -> Callable[..., Any]:
    """The click option of a field; without a value the function's default counts."""
    about, default = dict(declared.metadata), declared.default
    flag, read, allowed, _ = (about.pop(name) for name in ("flag", "read", "allowed", "bounds"))
    if isinstance(default, bool):
        about["is_flag"] = True
    elif isinstance(default, int | float | str):
        about |= {"default": default, "show_default": True}
    if isinstance(allowed, tuple) and allowed:
        about["type"] = click.Choice(allowed)
    if read is not None:
        about["callback"] = partial(_read, read)
    return click.option(flag, declared.name, **about)


def command_of(name: str, study: type[Study]) -> click.Command:
    """The command ``name`` that carries out ``study``: the only place that passes options on."""
    declared = fields(study)  # type: ignore[arg-type]  # subclasses are dataclasses

    def carry_out(output: str | None, as_json: bool, **given: Any) -> None:
        wanted = {each.name: given.pop(each.name) for each in declared}
        known = {name: value for name, value in wanted.items() if value is not None}
        try:
            asked = study(**known)
            work = asked.of_subject(SUBJECTS[study.of](given))
            delivery.deliver(work, output, as_json=as_json)
        except InputError as error:
            if error.field not in wanted:
                raise
            # who gave an option knows it by its name
            flags = {each.name: each.metadata["flag"] for each in declared}
            raise error.named(flags[error.field]) from error

    command = delivery.together(*_shared(study), *map(_option, declared))(carry_out)
    return click.command(name, help=inspect.getdoc(study))(command)


COMMANDS = tuple(command_of(name, study) for name, study in DECLARED.items())
"""For the main group to register."""
