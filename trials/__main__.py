"""Long evidence by its name: ``python trials NAME [ARGUMENT...]``; without one, what there is."""

from __future__ import annotations

import ast
import os
import sys
from pathlib import Path

HERE = Path(__file__).parent


def main(arguments: list[str]) -> int:
    """Run the trial of that name, or list all with the first line of each."""
    sources = {path.stem: path.read_text("utf-8") for path in sorted(HERE.glob("*.py"))}
    known = {n: text for n, text in sources.items() if "__main__" in text and n != "__main__"}
    if not arguments:
        for name, text in known.items():
            about = (ast.get_docstring(ast.parse(text)) or "").partition("\n")[0]
            print(f"{name:<20} {about}")
        print("make trial NAME=one of them, ARGS=what it takes")
        return 0
    name, *rest = arguments
    if name not in known:
        print(f"NAME: got {name}; allowed {', '.join(known)}", file=sys.stderr)
        return 2
    # In this process's place, so that Ctrl+C and worker processes are those of the trial
    os.execv(sys.executable, [sys.executable, "-W", "ignore", str(HERE / f"{name}.py"), *rest])
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
