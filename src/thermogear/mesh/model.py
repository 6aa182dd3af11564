"""The named choices of a mesh model and its two bundles.

A choice is a name out of :data:`CHOICES` or a number, friction also a law with parameters of its
own; a bundle is a full set of them. No function asks which bundle it is in: it is handed the
choice it needs.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

from thermogear.base.errors import InputError, nearest
from thermogear.gears.mesh_system import LoadedModel
from thermogear.heat.friction import (
    LAWS,
    MEANINGS,
    ConstantDry,
    FrictionLaw,
    friction_law,
    friction_words,
)

CHOICES: dict[str, dict[str, str]] = {
    "friction": MEANINGS,
    "inlet": {
        "oil": "the film forms at the temperature of the oil supply",
        "body": "the film forms at the flanks' temperature, the mean of both addenda",
    },
    "flash": {
        "blok": "Blok's high-speed limit",
        "peclet": "Blok with the finite Peclet number",
    },
    "heat_distribution": {
        "ellipse": "u = 0.78598 with the half width: heat as the Hertzian pressure",
        "uniform": "u = 0.79788 with the half width",
        "parabola": "u = 0.82919 with the half width (Blok 1937)",
    },
    "flank": {
        "growth": "normal growth (B) of one flank from the annulus solution",
        "thesis": "printed Delta f, first term read as the half-thickness form, no u_b",
    },
    "bore": {
        "free": "free bore, plane stress (A1)",
        "rigid": "bore held by a rigid cold shaft, u_a = 0 (A2)",
        "shaft": "bore follows a same-steel shaft at its own temperature (A2)",
    },
    "housing": {
        "expands": "the axes move apart by lambda_h (T_h - T0) a_w",
        "rigid": "the centre distance stays",
    },
    "modulus": {
        "of-temperature": "E(T) of each material, by its slope",
        "constant": "E at 20 C",
    },
    "stiffness": {
        "loaded": "loaded contact: coupled teeth, Weber contact, corner contact",
        "textbook-root-circle": "potential-energy sum from the root circle, Sainsot, no coupling",
        "textbook-30-degree": "the same sum from the 30-degree section",
    },
    "tooth": {
        "solved": "loaded contact: finite elements of one sector, tooth, fillets and body",
        "beam": "loaded contact: beam of the true profile on a ring",
    },
    "plane": {
        "stress": "solved teeth in plane stress, their contact in plane strain",
        "strain": "solved teeth in plane strain: wide gears",
    },
    "spring": {
        "tangent": "tangent stiffness with its error delta - F_n/k at the mean load",
        "secant": "secant stiffness with the unloaded error",
    },
    "thermal_stiffness": {
        "none": "heat is an offset, not a spring",
        "thesis": "k_T = F_n/Delta f in series, added to k",
    },
    "body": {
        "rim": "no wind-up of the body against its bore: its inertia takes that torque",
        "bore-clamped": "body clamped at its bore: statics",
    },
    "sharing": {
        "loaded": "load shared by the loaded contact, deviations included",
        "stiffness": "load shared by the textbook pair stiffnesses, no deviations",
        "equal": "equal shares in double contact",
    },
}

DECIDES = {
    "friction": "the losses, and with them every temperature that is computed",
    "dry_coefficient": "friction where it is dry alone",
    "inlet": "how thick the film is",
    "flash": "the flash temperature",
    "heat_distribution": "the flash temperature, by at most 6 %",
    "flank": "how much backlash heat takes",
    "bore": "how far a warm or fast gear grows",
    "housing": "how far the axes move apart, and so the hot backlash",
    "modulus": "how soft hot gears are",
    "stiffness": "stiffness and transmission error, and so every motion",
    "tooth": "the stiffness of the loaded contact, by at most 5 %",
    "plane": "the stiffness of solved teeth, by 1 to 3 %",
    "body": "the stiffness and the mean transmission error; shares and its course stay",
    "spring": "which stiffness and which error a motion has",
    "thermal_stiffness": "the stiffness of a hot pair",
    "sharing": "the load of a tooth pair: pressure, film and flash temperature",
}
"""What hangs on each choice, in words."""


@dataclass(frozen=True)
class MeshModel:
    """Every choice of the quasi-static mesh cycle; see :data:`CHOICES` for the names.

    ``friction`` is the name of a law with its default parameters, or a law object; one with its
    defaults is kept by its name. Dry friction's coefficient is ``dry_coefficient``.

    >>> MeshModel.consistent().friction, MeshModel.thesis().friction
    ('lambda-blend', 'benedict-kelley')
    """

    name: str
    friction: str | FrictionLaw = "lambda-blend"
    dry_coefficient: float = 0.2
    inlet: str = "body"
    flash: str = "peclet"
    heat_distribution: str = "ellipse"
    flank: str = "growth"
    bore: str = "free"
    housing: str = "expands"
    modulus: str = "of-temperature"
    stiffness: str = "loaded"
    tooth: str = "solved"
    plane: str = "stress"
    body: str = "rim"
    spring: str = "tangent"
    thermal_stiffness: str = "none"
    sharing: str = "loaded"

    def __post_init__(self) -> None:
        law = self.friction
        if isinstance(law, ConstantDry) and law != LAWS[law.name]:
            raise InputError(
                "model.friction.coefficient",
                f"{law.coefficient:g}",
                why="dry friction's coefficient is a choice of its own",
                fix=f"write model.dry_coefficient = {law.coefficient:g}",
            )
        if not isinstance(law, str) and callable(law) and LAWS.get(law.name) == law:
            object.__setattr__(self, "friction", law.name)
        for field, known in CHOICES.items():
            value = getattr(self, field)
            if value not in known and not callable(value):
                raise InputError(
                    f"model.{field}",
                    repr(value),
                    allowed=" | ".join(known),
                    fix=nearest(str(value), known),
                )
        if (self.tooth, self.plane) == ("beam", "strain"):
            why = "a beam on a ring knows no other plane state"
            raise InputError("model.plane", "'strain'", allowed="stress with a beam", why=why)
        if not 0.0 < self.dry_coefficient <= 1.0:
            raise InputError("model.dry_coefficient", self.dry_coefficient, allowed="0 < mu <= 1")

    @property
    def law(self) -> FrictionLaw:
        """The law of friction with its parameters."""
        if self.friction == ConstantDry.name:
            return ConstantDry(self.dry_coefficient)
        return friction_law(self.friction) if isinstance(self.friction, str) else self.friction

    @property
    def loaded(self) -> LoadedModel:
        """The loaded contact with the tooth and the body of this model."""
        return LoadedModel(tooth=self.tooth, plane=self.plane, body=self.body.replace("-", "_"))

    @classmethod
    def consistent(cls) -> MeshModel:
        """Units, energy and limits close: the default."""
        return cls(name="consistent")

    @classmethod
    def thesis(cls) -> MeshModel:
        """As printed, with the smallest repair where print is impossible."""
        return cls(
            name="thesis",
            friction="benedict-kelley",
            inlet="oil",
            flash="blok",
            heat_distribution="parabola",
            flank="thesis",
            housing="rigid",
            modulus="constant",
            stiffness="textbook-root-circle",
            tooth="beam",
            thermal_stiffness="thesis",
            sharing="equal",
        )

    def override(self, **choices: object) -> MeshModel:
        """The same bundle with single choices replaced; an unknown name says the nearest."""
        known = {f.name for f in fields(self)} - {"name"}
        for key in choices:
            if key not in known:
                raise InputError(f"model.{key}", "an unknown choice", fix=nearest(key, known))
        if not choices:
            return self
        changed = {k: v for k, v in choices.items() if getattr(self, k) != v}
        if not changed:
            return self
        made = replace(self, **changed)  # type: ignore[arg-type]
        told = made.choices()
        words = ", ".join(f"{k}={told[k]}" for k in sorted(changed) if told[k] != self.choices()[k])
        return replace(made, name=f"{self.name} + {words}") if words else self

    def choices(self) -> dict[str, str | float]:
        """Field -> value, in order, without the name; a law with what is not its default."""
        values = {f.name: getattr(self, f.name) for f in fields(self) if f.name != "name"}
        law = self.friction
        return values | {"friction": law if isinstance(law, str) else friction_words(law)}
