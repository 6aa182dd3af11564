#!/bin/sh
# h5netcdf 1.7.0 cannot write an attribute that is an empty text: ValueError "Size must be positive",
# out of h5py's type of fixed length 0. netCDF allows such an attribute (NC_CHAR of length 0), and a
# Dataset of xarray with attrs {"comment": ""} is valid. 1.8.0 writes it. thermogear asks for
# h5netcdf 1.8 or newer.
set -eu
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cat > "$place/see.py" <<'PY'
import warnings

import h5netcdf
import numpy as np
import xarray as xr

warnings.simplefilter("ignore")
data = xr.Dataset({"force": ("sample", np.arange(3.0))}, attrs={"title": "a pair", "comment": ""})
try:
    data.to_netcdf("a.nc", engine="h5netcdf")
    with xr.open_dataset("a.nc", engine="h5netcdf") as read:
        print(h5netcdf.__version__, "comment read back:", repr(read.attrs["comment"]))
except ValueError as error:
    print(h5netcdf.__version__, "ValueError:", error)
PY
python3 -m venv "$place/venv"
cd "$place"
see() {
    "$place/venv/bin/pip" install --quiet "h5netcdf==$1" xarray==2025.12.0 h5py==3.14.0 numpy==2.1.0
    "$place/venv/bin/python" "$place/see.py" | tee "$place/out"
}
see 1.7.0
grep -q '^1.7.0 ValueError: Size must be positive' "$place/out"
see 1.8.0
grep -q "^1.8.0 comment read back: ''" "$place/out"
echo "as described"
