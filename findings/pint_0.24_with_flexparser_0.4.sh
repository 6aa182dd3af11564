#!/bin/sh
# pint 0.24 asks for flexparser 0.3 or newer, and with flexparser 0.4 `import pint` ends in
# TypeError "cannot inherit frozen dataclass from a non-frozen one": a fresh installation of pint==0.24
# cannot be used today. pint 0.24.4 works with the same flexparser.
# thermogear asks for pint 0.24.4 or newer.
set -eu
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cat > "$place/see.py" <<'PY'
from importlib.metadata import requires, version

print([r for r in requires("pint") if r.startswith("flexparser")], version("flexparser"))
try:
    import pint

    print(version("pint"), pint.UnitRegistry().Quantity("3 mm").to("m"))
except TypeError as error:
    print(version("pint"), "TypeError:", error)
PY
python3 -m venv "$place/venv"
see() {
    "$place/venv/bin/pip" install --quiet "pint==$1" flexparser==0.4
    "$place/venv/bin/python" "$place/see.py" | tee "$place/out"
}
see 0.24
grep -q '^0.24 TypeError: cannot inherit frozen dataclass from a non-frozen one$' "$place/out"
see 0.24.4
grep -q '^0.24.4 0.003 meter$' "$place/out"
echo "as described"
