"""Ready rolling bearings by their designation, of 17 to 100 mm bore.

Bore, outside diameter, width (ISO 15) and the load ratings of balls are those of public maker's
lists. The balls of series 62 follow from the ratings: on the circle midway between bore and outside
only one whole number Z of balls of a size D_w in steps of 1/64 inch puts C 4.5 to 6.7 % above ISO
281's 1.3 f_c Z^(2/3) D_w^1.8 (makers' steel) and has 4200 MPa within 0.3 % under the heaviest ball
at C0 (Q = 5 C0/Z, ISO 76). 6211 is left out, none does. Elements of the other rows are recalled
and closed alike (7206B 0.6 %, C0 within 2 %). Makers differ (a 6305 is also made with 8 balls of
10.319 mm): the table is a default, a user's own numbers come first. Ratings of the last four rows
are from older lists.
"""

from __future__ import annotations

import math
import re

from thermogear.base.errors import InputError, nearest
from thermogear.shafts.bearings.geometry import RollingBearing

_ROWS = {
    # d, D, B, Z, D_w, d_m [mm], C, C0 [kN], roller length [mm]
    "6203": (17, 40, 12, 8, 6.747, 28.5, 9.95, 4.75, None),
    "6204": (20, 47, 14, 8, 7.938, 33.5, 13.5, 6.55, None),
    "6205": (25, 52, 15, 9, 7.938, 38.5, 14.8, 7.8, None),
    "6206": (30, 62, 16, 9, 9.525, 46, 20.3, 11.2, None),
    "6207": (35, 72, 17, 9, 11.112, 53.5, 27.0, 15.3, None),
    "6208": (40, 80, 18, 9, 12.303, 60, 32.5, 19.0, None),
    "6209": (45, 85, 19, 10, 12.303, 65, 35.1, 21.6, None),
    "6210": (50, 90, 20, 10, 12.7, 70, 37.1, 23.2, None),
    "6212": (60, 110, 22, 10, 15.875, 85, 55.3, 36.0, None),
    "6213": (65, 120, 23, 11, 15.875, 92.5, 58.5, 40.5, None),
    "6214": (70, 125, 24, 11, 16.669, 97.5, 63.7, 45.0, None),
    "6215": (75, 130, 25, 11, 17.462, 102.5, 68.9, 49.0, None),
    "6216": (80, 140, 26, 12, 17.462, 110, 72.8, 55.0, None),
    "6217": (85, 150, 28, 11, 19.844, 117.5, 87.1, 64.0, None),
    "6218": (90, 160, 30, 11, 21.431, 125, 101.0, 73.5, None),
    "6220": (100, 180, 34, 10, 25.4, 140, 127.0, 93.0, None),
    "6305": (25, 62, 17, 7, 11.5, 43.5, 23.4, 11.6, None),
    "6306": (30, 72, 19, 8, 12.303, 51, 29.6, 16.0, None),
    "6308": (40, 90, 23, 8, 15.081, 65, 42.3, 24.0, None),
    "7206B": (30, 62, 16, 13, 9.525, 46, 20.5, 13.5, None),
    "NU204E": (20, 47, 14, 11, 7.5, 34, 27.5, 24.7, 8.7),
    "NU206E": (30, 62, 16, 13, 9, 46.5, 39.0, 37.5, 9),
    "NU2206E": (30, 62, 20, 13, 9, 46.5, 49.0, 50.0, 12),
}


def _made(name: str) -> RollingBearing:
    d, outside, b, z, dw, dm, c, c0, length = _ROWS[name]
    return RollingBearing(
        designation=name,
        kind="ball" if length is None else "roller",
        bore=1e-3 * d,
        outside_diameter=1e-3 * outside,
        width=1e-3 * b,
        elements=z,
        element_diameter=1e-3 * dw,
        pitch_diameter=1e-3 * dm,
        element_length=None if length is None else 1e-3 * length,
        contact_angle=math.radians(40.0) if name == "7206B" else 0.0,
        dynamic_rating=1e3 * c,
        static_rating=1e3 * c0,
    )


CATALOGUE = {name: _made(name) for name in _ROWS}
"""Ready bearings by designation."""
_TAIL = re.compile(
    r"(2?RS[12HLR]?H?|2?RZ|2?Z|ZZ|DDU?|LL[UB]|VV"  # seals and shields
    r"|TN9?|TVP2?|M[AB]?|EC(P|PH|J|M|ML)?"  # cages
    r"|C[2-5]|CN|CM|P[456])+$"  # clearance and tolerances
)


def catalogue_bearing(name: str) -> RollingBearing:
    """The bearing of that designation; seals, cages and classes behind it do not matter.

    What follows a slash never tells of the inside. NU206 is NU206E, as made today; the contact
    angle of a 7206 has to be said (7206B). Raises InputError with the nearest name.

    >>> catalogue_bearing("6205-2RS/C3").elements
    9
    """
    bare = re.sub(r"[\s._-]", "", name.upper().split("/")[0])
    short = _TAIL.sub("", bare)
    for tried in (bare, short, f"{short}E"):
        if tried in CATALOGUE:
            return CATALOGUE[tried]
    raise InputError(
        "type",
        repr(name),
        allowed=" | ".join(CATALOGUE),
        fix=f"{nearest(short, CATALOGUE)}; or describe its elements",
    )
