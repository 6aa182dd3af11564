"""What thermogear is built from: licences, bill of materials, known vulnerabilities.

make licences    docs/licences.md; fails on a GPL or AGPL licence, or on none that can be read
make sbom        dist/sbom.json, CycloneDX
make audit       asks a vulnerability service about every locked package

All three speak of requirements/dev.txt, the lock of the core and of every extra. The first two
read the metadata of the packages installed in .venv.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
LOCK = ROOT / "requirements" / "dev.txt"
TOOLS = ROOT / ".audit-venv" / "bin"
OWN = "thermogear"
COPYLEFT = re.compile(r"(?<!L)GPL|Affero|(?<!Lesser )General Public", re.IGNORECASE)
SERVICES = ("osv", "pypi")
NO_ANSWER = 3


def locked(text: str) -> list[Requirement]:
    """The pins of a lock, each with its marker."""
    pins = re.findall(r"^[A-Za-z0-9][^\\\n]*==[^\\\n]*", text, flags=re.MULTILINE)
    return [Requirement(pin.strip()) for pin in pins]


def licence_of(about: metadata.PackageMetadata) -> str | None:
    """SPDX expression, else a short licence field, else the classifiers; None if none is there."""
    expression = about.get("License-Expression")
    if expression:
        return str(expression)
    field = (about.get("License") or "").strip()
    if field and "\n" not in field and len(field) <= 40:
        return field
    classifiers = [c for c in about.get_all("Classifier") or [] if c.startswith("License ::")]
    named = [c.rsplit(" :: ", 1)[-1] for c in classifiers if c != "License :: OSI Approved"]
    return " and ".join(named) or None


def refused(licence: str | None) -> bool:
    """Unknown, or GPL or AGPL in every alternative of the expression."""
    return licence is None or all(COPYLEFT.search(part) for part in licence.split(" OR "))


def needed_by(extra: str) -> set[str]:
    """Canonical names of all that the core ("") or the core with one extra pulls in here."""
    found: set[tuple[str, str]] = set()
    waiting = [(OWN, extra)]
    while waiting:
        name, wanted = waiting.pop()
        if (name, wanted) in found:
            continue
        found.add((name, wanted))
        for line in metadata.requires(name) or []:
            needs = Requirement(line)
            if needs.marker is None or needs.marker.evaluate({"extra": wanted}):
                target = canonicalize_name(needs.name)
                waiting += [(target, part) for part in ("", *needs.extras)]
    return {name for name, _ in found}


def rows() -> Iterator[tuple[str, str, str | None, str]]:
    """Package, version, licence, who needs it; for every pin of the lock."""
    extras = metadata.metadata(OWN).get_all("Provides-Extra") or []
    core = needed_by("")
    closures = {extra: needed_by(extra) for extra in sorted(extras)}
    for pin in locked(LOCK.read_text(encoding="utf-8")):
        version = str(pin.specifier).removeprefix("==")
        if pin.marker is not None and not pin.marker.evaluate():
            yield pin.name, version, f"not installed here: only for `{pin.marker}`", ""
            continue
        try:
            installed = metadata.distribution(pin.name)
        except metadata.PackageNotFoundError:
            sys.exit(f"{pin.name} is locked but not installed in .venv; run: make check")
        if installed.version != version:
            sys.exit(f"{pin.name}: lock {version}, installed {installed.version}; run: make check")
        name = canonicalize_name(pin.name)
        who = [extra for extra, needs in closures.items() if name in needs]
        who = ["core"] if name in core else who
        yield pin.name, version, licence_of(installed.metadata), ", ".join(who)


def licences() -> int:
    """Write docs/licences.md; 1 if a licence is refused."""
    table = list(rows())
    lines = [
        "# Licences of what thermogear uses",
        "Every package of `requirements/dev.txt`, from the metadata it carries itself; written by",
        "`make licences`, which fails on GPL, AGPL, or a licence it cannot read. LGPL and MPL",
        "packages are imported unchanged. What the core needs, every extra needs too. A package",
        "that the lock names for another system or another Python is listed by its marker; it is",
        "judged where it is installed. Libraries bundled in a wheel are read only as far as its",
        "licence expression names them.",
        "",
        "| package | version | licence | needed by |",
        "|---|---|---|---|",
        *(f"| {n} | {v} | {licence or 'UNKNOWN'} | {who} |" for n, v, licence, who in table),
        "",
        "Copied into `src/thermogear/views/script`, its licence beside it and in every page:",
        "uPlot 1.6.32, MIT.",
    ]
    (ROOT / "docs" / "licences.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    bad = [
        f"{name}: {licence or 'unknown licence'}"
        for name, _, licence, _ in table
        if refused(licence)
    ]
    print(f"{len(table)} packages in docs/licences.md, {len(bad)} refused", *bad, sep="\n  ")
    return int(bool(bad))


def sbom() -> int:
    """Write dist/sbom.json: the locked packages as installed, without paths and addresses."""
    done = subprocess.run(
        [TOOLS / "cyclonedx-py", "environment", "--output-reproducible", "--short-PURLs",
         "--pyproject", ROOT / "pyproject.toml", sys.executable],
        check=True, capture_output=True, text=True,
    )  # fmt: skip
    bill = json.loads(done.stdout)
    names = {canonicalize_name(pin.name) for pin in locked(LOCK.read_text(encoding="utf-8"))}
    bill["components"] = [c for c in bill["components"] if canonicalize_name(c["name"]) in names]
    for thing in [*bill["components"], bill["metadata"]["component"]]:
        thing.pop("externalReferences", None)
    for tool in bill["metadata"]["tools"]["components"]:
        tool.pop("externalReferences", None)
    kept = {c["bom-ref"] for c in [*bill["components"], bill["metadata"]["component"]]}
    bill["dependencies"] = [d for d in bill["dependencies"] if d["ref"] in kept]
    for depends in bill["dependencies"]:
        depends["dependsOn"] = [ref for ref in depends.get("dependsOn", []) if ref in kept]
    target = ROOT / "dist" / "sbom.json"
    target.parent.mkdir(exist_ok=True)
    target.write_text(json.dumps(bill, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    print(f"{len(bill['components'])} components in dist/sbom.json")
    return 0


def audit() -> int:
    """0 none known, 1 some known, 3 no service answered for every package."""
    for service in SERVICES:
        done = subprocess.run(
            [TOOLS / "pip-audit", "-r", LOCK, "--require-hashes", "--disable-pip",
             "--progress-spinner", "off", "-f", "json", "-s", service],
            check=False, capture_output=True, text=True,
        )  # fmt: skip
        try:
            packages = json.loads(done.stdout)["dependencies"]
        except (json.JSONDecodeError, KeyError):
            reason = (done.stderr.strip().splitlines() or ["no output"])[-1]
            print(f"{service}: no answer ({reason[:100]})")
            continue
        asked = [p for p in packages if "skip_reason" not in p]
        known = [(p["name"], p["version"], v["id"]) for p in asked for v in p["vulns"]]
        print(f"{service}: {len(asked)} of {len(packages)} packages answered, {len(known)} known")
        for found in known:
            print("  ", *found)
        if known:
            return 1
        if asked and len(asked) == len(packages):
            return 0
    print("no vulnerability service answered for every package: nothing is proven, exit code 3")
    return NO_ANSWER


if __name__ == "__main__":
    sys.exit({"licences": licences, "sbom": sbom, "audit": audit}[sys.argv[1]]())
