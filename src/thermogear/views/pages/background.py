"""What the results rest on: choices, assumptions, errata, figures, case file, sources."""

from __future__ import annotations

from thermogear.base.enclosed import folded
from thermogear.base.toml import told
from thermogear.results.result import Result
from thermogear.views import tables
from thermogear.views.columns import Column, declared
from thermogear.views.page import Block, Code, Section, Table, Text
from thermogear.views.typesetting import field_name, prose

ASSUMPTIONS = (
    Column("field", lambda row: field_name(row.get("field", ""))),
    Column("value", lambda row: prose(row.get("value", ""))),
    Column("why, and what it decides", lambda row: prose(row.get("reason", ""))),
)
SOURCES = (
    Column("source", lambda row: row.get("text", "")),
    Column("used for", lambda row: row.get("used_for", "")),
)
PACKAGES = (Column("package", "package"), Column("version", "version"))


def background(results: Result) -> list[Section]:
    """What a reader needs to judge and to repeat the results."""
    bundles = results.table("bundles")
    chosen = "What differs between the bundles" if len(bundles) > 1 else "The model's choices"
    assumed = declared(
        "Values that no source states, each with what it decides.",
        ASSUMPTIONS,
        results.rows("assumptions"),
        names=3,
        wordy=True,
    )
    sources = declared("", SOURCES, results.rows("citations"), names=2, wordy=True)
    found = [
        Section("choices", chosen, [tables.choices(bundles, results.table("choices"))]),
        Section("assumptions", "Assumptions that are ours", [assumed]),
        Section("errata", "Errata of the thesis", [tables.errata(results.rows("errata"))]),
        Section("facts", "Figures of the pair", [tables.facts(results.rows("facts"))]),
        case_file(results),
        Section("sources", "Sources", [sources]),
        _version(results),
    ]
    return [one for one in found if not _empty(one.blocks[0])]


def _empty(block: Block) -> bool:
    """Whether there is nothing in a table or a text."""
    return not (block.rows if isinstance(block, Table) else getattr(block, "words", ""))


def case_file(results: Result) -> Section:
    """The case as it was read, and below it what the command line put in its place."""
    text = folded(results.text("case")).rstrip()
    if "# on the command line:" not in text:
        changes = [told(str(path), str(one)) for path, one in results.values("overrides")]
        text += "".join(f"\n# on the command line: {change}" for change in changes)
    return Section("case", "Case file", [Code(text)])


def _version(results: Result) -> Section:
    rows = [
        {"package": name, "version": version}
        for name, version in results.table("environment").items()
    ]
    table = declared("Versions the results depend on.", PACKAGES, rows, names=2, wordy=True)
    told = f"thermogear {results.text('thermogear')}, results written {results.text('created')}."
    return Section("version", "Version", [Text(told), *[table] * bool(rows)])
