"""The sources that the results of a case rest on."""

from __future__ import annotations

from thermogear.case.case import Case, GearCase
from thermogear.case.thesis_cases import of_the_thesis
from thermogear.heat.friction import LAWS


def citations(case: Case) -> list[dict[str, str]]:
    """The sources that this case's results rest on."""
    found: list[tuple[str, str, str]] = []
    own = of_the_thesis(case)
    bundle = isinstance(case, GearCase) and any(m.name.startswith("thesis") for m in case.models)
    if own or bundle:
        found.append(
            (
                "thesis",
                "Dynamic Modeling and Analysis of Spur Gear Transmission Systems Considering "
                "Thermal Deformation (web summary of a thesis)",
                "the model under study" if own else "the bundle named thesis",
            )
        )
    if isinstance(case, GearCase):
        found += _gear_citations(case)
    return [{"key": key, "text": text, "used_for": use} for key, text, use in found]


def _gear_citations(case: GearCase) -> list[tuple[str, str, str]]:
    """Sources of the formulas, the oil and the materials that a gear case uses."""
    found = [
        ("blok", "H. Blok (1937), flash temperature of a moving heat source", "flash temperature"),
        (
            "benedict-kelley",
            "G. H. Benedict, B. W. Kelley, ASLE Transactions 4 (1961) 59-70",
            "friction of lubricated flanks",
        ),
        ("johnson", "K. L. Johnson, Contact Mechanics, eqs. 4.43 and 4.45", "Hertzian contact"),
        (
            "yang-sun",
            "D. C. H. Yang, Z. S. Sun, J. Mech. Trans. Autom. Des. 107 (1985) 529-535",
            "the tooth as a beam, energy method",
        ),
    ]
    for name in dict.fromkeys(m.friction for m in case.models):
        if name not in ("benedict-kelley", "dry"):
            found.append((name, LAWS[name].source, f"friction, {name}"))
    if any(m.stiffness == "loaded" for m in case.models):
        found.append(
            (
                "weber-banaschek",
                "C. Weber, K. Banaschek (1953), deformation and profile relief of gears",
                "stiffness of tooth and contact",
            )
        )
    if any(m.stiffness.startswith("textbook") for m in case.models):
        found += [
            (
                "sainsot",
                "P. Sainsot, P. Velex, O. Duverger, J. Mech. Design 126 (2004) 748-752",
                "stiffness of the gear body, textbook sum",
            ),
        ]
    oil = case.operating.lubricant
    found += [
        ("walther", "ASTM D341", "viscosity over temperature"),
        ("oil", oil.source, f"oil {oil.name}"),
    ]
    bodies = (case.pair.pinion.material, case.pair.wheel.material, case.housing)
    for material in dict.fromkeys(bodies):
        found.append(("material", material.source, f"material {material.name}"))
    return found
