"""What is not a number never counts as a relief."""

from __future__ import annotations

import pytest

from thermogear.base.errors import ConvergenceError
from thermogear.case.case import gear_case, load_case
from thermogear.gears import mesh_system
from thermogear.study.relief import relief_survey

NAN = float("nan")


def test_no_relief_without_a_settled_contact(monkeypatch: pytest.MonkeyPatch) -> None:
    case = gear_case(load_case("rig"))
    known = mesh_system.as_drawn

    def broken(*given: object) -> mesh_system.Drawn:
        drawn = known(*given)  # type: ignore[arg-type]
        return drawn._replace(tooth=NAN * drawn.tooth)

    monkeypatch.setattr(mesh_system, "as_drawn", broken)
    with pytest.raises(ConvergenceError, match=r"^loaded contact: 100 of 100 positions did not"):
        relief_survey(case)
