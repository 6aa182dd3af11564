"""The walls of the house: floors, no cycles, lazy names, and what a clone must hold."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import grimp
import numpy as np
import pytest
from importlinter.cli import EXIT_STATUS_SUCCESS, lint_imports

import thermogear

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "checks"))
import house  # noqa: E402

SOURCE = ROOT / "src" / "thermogear"


def test_import_contracts_are_kept(capsys: pytest.CaptureFixture[str]) -> None:
    status = lint_imports(config_filename=str(ROOT / "pyproject.toml"), no_cache=True)
    assert status == EXIT_STATUS_SUCCESS, capsys.readouterr().out


def test_import_graph_has_no_cycles() -> None:
    graph = grimp.build_graph("thermogear", cache_dir=None)
    modules = {m for m in graph.modules if m not in {"thermogear"}}
    remaining = {
        module: {
            imported
            for imported in graph.find_modules_directly_imported_by(module)
            if imported in modules
        }
        for module in modules
    }
    while free := [
        module for module, imported in remaining.items() if not imported & set(remaining)
    ]:
        for module in free:
            del remaining[module]
    assert sorted(remaining) == []


def test_importing_the_package_is_cheap() -> None:
    heavy = ["numpy", "scipy", "numba", "xarray", "matplotlib", "pydantic", "pint"]
    code = f"import sys, thermogear; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize("name", [n for n in thermogear.__all__ if n != "__version__"])
def test_every_public_name_loads_and_says_what_it_is(name: str) -> None:
    assert (getattr(thermogear, name).__doc__ or "").strip()


UNIT = re.compile(r"\[[^\]]+\]|\bSI\b|units of the model|model's unit|half backlashes|1/s")
"""How a docstring says what its numbers are in."""
WITHOUT_NUMBERS = {
    "ThermogearError", "InputError", "GeometryError", "ConvergenceError", "ValidityWarning",
    "material", "lubricant", "friction_law", "MeshModel", "LoadedModel", "load_case",
    "open_results", "save", "save_results", "write_report", "pictures", "slices",
}  # fmt: skip
"""Public names that take and give words, files or choices alone."""


def test_every_public_name_with_numbers_states_their_units() -> None:
    docs = {name: getattr(thermogear, name).__doc__ or "" for name, _, _ in house.names()}
    assert set(docs) >= WITHOUT_NUMBERS
    assert [n for n, doc in docs.items() if n not in WITHOUT_NUMBERS and not UNIT.search(doc)] == []


def test_every_public_name_is_loaded_when_first_used() -> None:
    code = "import sys, thermogear; print([m for m in sys.modules if m.startswith('thermogear.')])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
    assert set(thermogear.__all__) == {"__version__", *thermogear._HOME}


def test_the_house_in_figures_is_true() -> None:
    """docs/house.md: names and imports to the letter, counts of modules and lines within 10 %."""
    written = (ROOT / "docs" / "house.md").read_text(encoding="utf-8").splitlines()
    now = house.page().splitlines()
    counted = re.compile(r"\| (\d+) \| (\d+) \| (\d+) \|")
    assert [counted.sub("|", line) for line in written] == [counted.sub("|", line) for line in now]
    for old, new in zip(written, now, strict=True):
        if found := counted.search(old):
            said, is_ = (np.array(m.groups(), float) for m in (found, counted.search(new)) if m)
            np.testing.assert_allclose(said, is_, rtol=0.1, err_msg="run make house")


def test_an_unknown_public_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'mesh_cicle'"):
        _ = thermogear.mesh_cicle


def test_every_module_says_what_it_holds() -> None:
    silent = [
        str(path.relative_to(SOURCE))
        for path in SOURCE.rglob("*.py")
        if not path.read_text(encoding="utf-8").lstrip().startswith(('"""', 'r"""'))
    ]
    assert silent == []


def test_no_file_holds_two_ideas() -> None:
    long = [
        str(path.relative_to(ROOT))
        for folder in (SOURCE, ROOT / "tests", ROOT / "bench", ROOT / "checks")
        for path in folder.rglob("*.py")
        if len(path.read_text(encoding="utf-8").splitlines())
        > (house.MOST_LINES if folder == SOURCE else house.MOST_LINES_BESIDE)
    ]
    assert long == []


def test_the_locks_carry_hashes_and_no_addresses() -> None:
    for lock in (ROOT / "requirements").glob("*.txt"):
        text = lock.read_text(encoding="utf-8")
        pins = re.findall(r"^[a-z0-9._-]+==", text, flags=re.MULTILINE | re.IGNORECASE)
        assert pins
        assert text.count("--hash=sha256:") >= len(pins)
        assert "://" not in text
