"""The attempts of ``make trial NAME=attacks`` and its server, as a module for tests."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[3]
_NAME = "trial_attacks"


def _loaded() -> Any:
    if _NAME not in sys.modules:
        spec = importlib.util.spec_from_file_location(_NAME, ROOT / "trials" / "attacks.py")
        assert spec is not None
        assert spec.loader is not None
        sys.path.append(str(ROOT / "trials"))
        sys.modules[_NAME] = module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    return sys.modules[_NAME]


trial = _loaded()
