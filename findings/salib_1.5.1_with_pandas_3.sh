#!/bin/sh
# SALib 1.5.1 samples with pandas 3 and cannot analyse: Sobol indices of a problem without groups end
# in a TypeError, since pandas.unique takes no list any more. Its declared bound, pandas>=2.0, lets
# both be installed together. SALib 1.5.2 analyses. thermogear asks for SALib 1.5.2 or newer.
set -eu
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cat > "$place/see.py" <<'PY'
import numpy as np
from SALib.analyze import sobol as analysis
from SALib.sample import sobol as sampling

problem = {"num_vars": 2, "names": ["a", "b"], "bounds": [[0, 1], [0, 1]]}
samples = sampling.sample(problem, 64, seed=1)
try:
    found = analysis.analyze(problem, samples[:, 0] + 2.0 * samples[:, 1], seed=1)
    print("first-order indices", np.round(found["S1"], 1).tolist())
except TypeError as error:
    print("TypeError:", str(error)[:40])
PY
python3 -m venv "$place/venv"
see() {
    "$place/venv/bin/pip" install --quiet "SALib==$1" pandas==3.0.3 numpy==2.4.6
    "$place/venv/bin/python" "$place/see.py" | tee "$place/out"
}
see 1.5.1
grep -q '^TypeError: unique requires a Series, Index' "$place/out"
see 1.5.2
grep -q '^first-order indices \[0.2, 0.8\]$' "$place/out"
echo "as described"
