#!/bin/sh
# zarr 3.1.6 brings a pytest plugin (entry point "zarr" of the group pytest11) that imports numpy
# before any conftest.py runs. A conftest that sets OPENBLAS_NUM_THREADS is then too late: numpy has
# read it at its import, and the suite of a package that stores with zarr runs on all cores.
# "-p no:zarr" helps; thermogear's own tests run with it.
set -eu
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cat > "$place/conftest.py" <<'PY'
import sys

BEFORE = "numpy" in sys.modules
PY
cat > "$place/test_see.py" <<'PY'
import conftest


def test_see():
    print("numpy before conftest:", conftest.BEFORE)
PY
python3 -m venv "$place/venv"
cd "$place"
"$place/venv/bin/pip" install --quiet zarr==3.1.6 numpy==2.4.6 pytest==9.2.0 hypothesis==6.170.15
"$place/venv/bin/python" -m pytest -q -s test_see.py | tee "$place/out"
grep -q 'numpy before conftest: True' "$place/out"
"$place/venv/bin/python" -m pytest -q -s -p no:zarr test_see.py | tee "$place/out"
grep -q 'numpy before conftest: False' "$place/out"
echo "as described"
