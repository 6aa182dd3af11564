"""Both gears as a DXF file for a drawing program: true outlines in mm (extra ``[cad]``)."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from thermogear.base.errors import of_extra
from thermogear.base.files import put
from thermogear.views.gears import PINION, WHEEL, GearDrawing

COLOURS = {"cold": 5, "hot": 30, "construction": 8, "contact": 3}
"""Layers of the file and their colours by AutoCAD's index."""


def layer_of(state: str) -> str:
    """The layer of a state of heat."""
    return "hot" if state == "hot" else "cold"


def put_dxf(drawing: GearDrawing, path: Path, *, place: int, shown: Sequence[str]) -> Path:
    """Write both gears at the drawn phase number ``place`` as DXF R2010, whole or not at all.

    Layers "cold" and "hot": the states of ``shown``, each gear one closed polyline in true size,
    its bore a circle; "construction": base, pitch and operating pitch circles, the line of action;
    "contact": a point where each pair touches that carries load. Raises InputError without the
    extra ``[cad]``.
    """
    ezdxf = of_extra("ezdxf", "cad", field="output", got="a DXF file", use="writing it")
    document = ezdxf.new("R2010", setup=["linetypes"], units=4)
    for name, colour in COLOURS.items():
        document.layers.add(name, color=colour)
    space = document.modelspace()
    for name in shown:
        state = drawing.state(name)
        look = {"layer": layer_of(name)}
        for gear in (PINION, WHEEL):
            line = drawing.whole(state, gear, phase=place)[:-1]
            corners = np.column_stack([line.real, line.imag]).tolist()
            space.add_lwpolyline(corners, close=True, dxfattribs=look)
            centre = (drawing.centre(state, gear, factor=1.0), 0.0)
            space.add_circle(centre, drawing.circles[gear]["bore"], dxfattribs=look)
    look = {"layer": "construction", "linetype": "CENTER"}
    for gear in (PINION, WHEEL):
        centre = (0.0 if gear == PINION else drawing.centre_distance, 0.0)
        rolling = abs(drawing.pitch_point - centre[0])
        for radius in (drawing.circles[gear]["base"], drawing.circles[gear]["pitch"], rolling):
            space.add_circle(centre, radius, dxfattribs=look)
    first, last = drawing.line_of_action
    space.add_line((first.real, first.imag), (last.real, last.imag), dxfattribs=look)
    carried = drawing.state(shown[-1]).share[place]
    for point, share in zip(drawing.contact[place], carried, strict=True):
        if np.isfinite(point) and share > 0.0:
            space.add_point((point.real, point.imag), dxfattribs={"layer": "contact"})
    stream = io.StringIO()
    document.write(stream)
    return put(path, stream.getvalue())
