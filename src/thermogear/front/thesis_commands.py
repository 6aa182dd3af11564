"""``thermogear thesis``: a command for the main group to register."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from thermogear.base.progress import Progress
from thermogear.front import delivery

if TYPE_CHECKING:
    from thermogear.results.result import Result


@click.command()
@delivery.output("Directory of the report; made if new.")
@delivery.as_json
def thesis(output: str, as_json: bool) -> None:
    """Judge every claim of the thesis and write the report to DIR.

    Sections 2 to 6: what is said, what is computed as in the thesis and consistently, a verdict,
    its argument and the code behind it. Ctrl+C keeps what is finished.
    """
    from thermogear.study.sensitivity import require_salib

    require_salib()

    def make(report: Progress) -> Result:
        from thermogear.thesis.report import build

        return build(progress=lambda stage, done, total: report("thesis", done, total))

    delivery.deliver(make, output, as_json=as_json, kept="the claims judged so far stay")


COMMANDS: list[click.Command] = [thesis]
