"""The supply-chain commands: what they read from a lock and from metadata, and what they refuse."""

from __future__ import annotations

import re
from email.message import Message

import pytest
from scripts import ROOT, script

supply = script("supply")


def metadata(**fields: str) -> Message:
    """Metadata of a package as importlib gives it."""
    about = Message()
    for name, value in fields.items():
        about[name.replace("_", "-")] = value
    return about


@pytest.mark.parametrize(
    ("fields", "licence"),
    [
        ({"License_Expression": "MIT OR Apache-2.0", "License": "other"}, "MIT OR Apache-2.0"),
        ({"License": "BSD-3-Clause"}, "BSD-3-Clause"),
        (
            {
                "License": "Copyright (c) 2015\nAll rights reserved.",
                "Classifier": "License :: OSI Approved :: BSD License",
            },
            "BSD License",
        ),
        ({"Classifier": "License :: OSI Approved"}, None),
        ({}, None),
    ],
)
def test_licence_is_read_from_what_the_package_says(
    fields: dict[str, str], licence: str | None
) -> None:
    assert supply.licence_of(metadata(**fields)) == licence


@pytest.mark.parametrize(
    ("licence", "refused"),
    [
        ("MIT", False),
        ("LGPL-3.0-only", False),
        ("GNU Lesser General Public License v3 or later (LGPLv3+)", False),
        ("GPL-3.0-only", True),
        ("AGPL-3.0-or-later", True),
        ("GNU General Public License v2 (GPLv2)", True),
        ("GNU Affero General Public License v3", True),
        ("MIT OR GPL-2.0-only", False),
        ("MIT AND GPL-2.0-only", True),
        (None, True),
    ],
)
def test_gpl_agpl_and_unknown_are_refused(licence: str | None, refused: bool) -> None:
    assert supply.refused(licence) is refused


def test_pins_of_a_lock_keep_their_markers() -> None:
    pins = supply.locked(
        "numpy==2.4.6 ; python_full_version < '3.12' \\\n    --hash=sha256:00\n    # via x\n"
        "attrs==26.1.0 \\\n    --hash=sha256:11\n"
    )
    assert [(p.name, str(p.specifier)) for p in pins] == [
        ("numpy", "==2.4.6"),
        ("attrs", "==26.1.0"),
    ]
    assert pins[0].marker is not None
    assert pins[0].marker.evaluate({"python_full_version": "3.11.0"})
    assert pins[1].marker is None


def test_the_licence_list_is_the_lock() -> None:
    """A changed lock wants `make licences`."""
    table = (ROOT / "docs" / "licences.md").read_text(encoding="utf-8")
    listed = re.findall(r"^\| ([^ ]+) \| ([^ ]+) \|", table, flags=re.MULTILINE)[1:]
    pins = supply.locked(supply.LOCK.read_text(encoding="utf-8"))
    assert listed == [(p.name, str(p.specifier).removeprefix("==")) for p in pins]
    assert "UNKNOWN" not in table


def test_the_tools_are_locked_with_hashes_and_without_addresses() -> None:
    text = (ROOT / "requirements" / "audit.txt").read_text(encoding="utf-8")
    assert text.count("--hash=sha256:") >= len(supply.locked(text)) > 0
    assert "://" not in text
