"""What the results rest on: choices, assumptions, errata, figures, case file, sources."""

from __future__ import annotations

from thermogear.base.enclosed import folded
from thermogear.base.toml import told
from thermogear.results.result import Result
from thermogear.views import tables
from thermogear.views.page import Code, Section, Text
from thermogear.views.typesetting import field_name, prose


def background(results: Result) -> list[Section]:
    """What a reader needs to judge and to repeat the results."""
    found: list[Section] = []
    bundles = results.table("bundles")
    if bundles:
        table = tables.choices(bundles, results.table("choices"))
        title = "What differs between the bundles" if len(bundles) > 1 else "The model's choices"
        found.append(Section("choices", title, [table]))
    ours = results.rows("assumptions")
    if ours:
        rows = [
            (field_name(r.get("field", "")), prose(r.get("value", "")), prose(r.get("reason", "")))
            for r in ours
        ]
        table = tables.words(
            "Values that no source states, each with what it decides.",
            ["field", "value", "why, and what it decides"],
            rows,
        )
        found.append(Section("assumptions", "Assumptions that are ours", [table]))
    wrong = results.rows("errata")
    if wrong:
        found.append(Section("errata", "Errata of the thesis", [tables.errata(wrong)]))
    figures = results.rows("facts")
    if figures:
        found.append(Section("facts", "Figures of the pair", [tables.facts(figures)]))
    if results.text("case").strip():
        found.append(case_file(results))
    sources = results.rows("citations")
    if sources:
        used = [(r.get("text", ""), r.get("used_for", "")) for r in sources]
        found.append(
            Section("sources", "Sources", [tables.words("", ["source", "used for"], used)])
        )
    found.append(_version(results))
    return found


def case_file(results: Result) -> Section:
    """The case as it was read, and below it what the command line put in its place."""
    text = folded(results.text("case")).rstrip()
    if "# on the command line:" not in text:
        changes = [told(str(path), str(one)) for path, one in results.values("overrides")]
        text += "".join(f"\n# on the command line: {change}" for change in changes)
    return Section("case", "Case file", [Code(text)])


def _version(results: Result) -> Section:
    environment = results.table("environment")
    rows = [(name, version) for name, version in environment.items()]
    blocks = [
        Text(f"thermogear {results.text('thermogear')}, results written {results.text('created')}.")
    ]
    if not rows:
        return Section("version", "Version", blocks)
    table = tables.words("Versions the results depend on.", ["package", "version"], rows)
    return Section("version", "Version", [*blocks, table])
