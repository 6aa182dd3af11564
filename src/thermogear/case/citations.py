"""The sources that the results of a case rest on: those of the laws it used, and no others."""

from __future__ import annotations

from collections.abc import Iterator

from thermogear.case.base import Case
from thermogear.case.case import GearCase
from thermogear.case.thesis_cases import of_the_thesis
from thermogear.heat.friction import ConstantDry, LambdaBlend
from thermogear.mesh.model import MeshModel

Source = tuple[str, str, str]
"""Key, text, what it is used for."""

THESIS = (
    "Dynamic Modeling and Analysis of Spur Gear Transmission Systems Considering Thermal "
    "Deformation (web summary of a thesis)"
)
BLOK = ("blok", "H. Blok (1937), flash temperature of a moving heat source", "flash temperature")
JAEGER = (
    "jaeger",
    "J. C. Jaeger (1942), moving sources of heat at sliding contacts",
    "flash temperature at finite speed",
)
FLASH = {"blok": (BLOK,), "peclet": (BLOK, JAEGER)}
HERTZ = ("johnson", "K. L. Johnson, Contact Mechanics, eqs. 4.43 and 4.45", "Hertzian contact")
FILM = ("dowson-higginson", "D. Dowson, G. R. Higginson, line contact", "least film thickness")
GRUBIN = ("grubin", "A. N. Grubin (1949)", "central film thickness")
LOADED = (
    (
        "weber-banaschek",
        "C. Weber, K. Banaschek (1953), deformation and profile relief of gears",
        "stiffness of tooth and contact",
    ),
    (
        "timoshenko-goodier",
        "S. Timoshenko, J. N. Goodier, Theory of Elasticity, sec. 43",
        "the gear body as a ring",
    ),
)
TEXTBOOK = (
    (
        "yang-sun",
        "D. C. H. Yang, Z. S. Sun, J. Mech. Trans. Autom. Des. 107 (1985) 529-535",
        "the tooth as a beam, energy method; contact stiffness",
    ),
    (
        "sainsot",
        "P. Sainsot, P. Velex, O. Duverger, J. Mech. Design 126 (2004) 748-752",
        "stiffness of the gear body, textbook sum",
    ),
)


def citations(case: Case) -> list[dict[str, str]]:
    """The sources that this case's results rest on."""
    found: list[Source] = []
    own = of_the_thesis(case)
    bundle = isinstance(case, GearCase) and any(m.name.startswith("thesis") for m in case.models)
    if own or bundle:
        found.append(
            ("thesis", THESIS, "the model under study" if own else "the bundle named thesis")
        )
    if isinstance(case, GearCase):
        found += dict.fromkeys(one for model in case.models for one in _of_choices(model))
        found += _of_materials(case)
    return [{"key": key, "text": text, "used_for": use} for key, text, use in found]


def _of_choices(model: MeshModel) -> Iterator[Source]:
    """Sources of the laws that a bundle chose."""
    yield from FLASH[model.flash]
    law = model.law
    if law.name != ConstantDry.name:
        yield law.name, law.source, f"friction, {law.name}"
    yield FILM
    if law.name == LambdaBlend.name:
        yield GRUBIN
    yield HERTZ
    loaded = model.stiffness == "loaded"
    if loaded or model.sharing == "loaded":
        yield from LOADED
    if not loaded or model.sharing == "stiffness":
        yield from TEXTBOOK


def _of_materials(case: GearCase) -> Iterator[Source]:
    """Sources of the oil and the materials."""
    oil = case.stated.lubricant
    yield "walther", "ASTM D341", "viscosity over temperature"
    yield "oil", oil.source, f"oil {oil.name}"
    bodies = (case.pair.pinion.material, case.pair.wheel.material, case.housing)
    for material in dict.fromkeys(bodies):
        yield "material", material.source, f"material {material.name}"
