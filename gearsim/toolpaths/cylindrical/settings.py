"""What each operation of a cylindrical gear is told: one frozen dataclass an operation (Groover 2018, 5.1, 5.2)."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

from gearsim.errors import InputError
from gearsim.programs.operation import Tool
from gearsim.surfaces.flank_modification import FlankModification
from gearsim.toolpaths.cylindrical.steps import Spacing

# The thesis's tool, 1/8 in; it does not print a flute length: 1/2 in, as such tools have.
END_MILL = Tool(1, "end mill 1/8 in", 3.175, 12.7, 3)


def check_positive(what: str, numbers: dict[str, Any]) -> None:
    """Raise InputError for the first number that is not positive."""
    for name, value in numbers.items():
        if not value > 0.0:
            raise InputError(f"{what}: {name} must be positive, got {value:g}")


@dataclass(frozen=True)
class Cutting:
    """A tool and its conditions: ``spindle`` [1/min], ``feed_per_tooth`` [mm]. Raises InputError unless positive."""

    tool: Tool = END_MILL
    spindle: float = 12000.0
    feed_per_tooth: float = 0.0508

    def __post_init__(self) -> None:
        numbers = {"spindle": self.spindle, "feed_per_tooth": self.feed_per_tooth, "flutes": self.tool.flutes}
        sizes = {"tool diameter": self.tool.diameter, "flute_length": self.tool.flute_length}
        check_positive("cutting conditions", numbers | sizes)

    @property
    def feed(self) -> float:
        """mm/min."""
        return self.spindle * self.tool.flutes * self.feed_per_tooth

    @property
    def radius(self) -> float:
        return 0.5 * self.tool.diameter

    def check_depth(self, what: str, depth: float) -> None:
        """Raise InputError where the flutes are shorter than a depth [mm]."""
        if depth > self.tool.flute_length:
            raise InputError(
                f"{what}: the depth of {depth:g} mm exceeds the flute length of {self.tool.flute_length:g} mm of "
                f"T{self.tool.number} ({self.tool.name}); take a longer tool"
            )


FINISH = Cutting(feed_per_tooth=0.0254)


@dataclass(frozen=True)
class Clearance:
    """How far rapids keep off [mm]: ``rim`` from the tip cylinder, ``top`` above the top face (5 and 5)."""

    rim: float = 5.0
    top: float = 5.0

    def __post_init__(self) -> None:
        check_positive("clearance", {"rim": self.rim, "top": self.top})


@dataclass(frozen=True, kw_only=True)
class Settings:
    """What all operations share: positive lengths, checked. Raises InputError otherwise."""

    cutting: Cutting = Cutting()
    clearance: Clearance = Clearance()

    def __post_init__(self) -> None:
        named = {f.name: getattr(self, f.name) for f in fields(self)}
        check_positive(type(self).__name__, {k: v for k, v in named.items() if isinstance(v, float | int)})
        immersion = named.get("radial_immersion", 1.0)
        if immersion > 1.0:
            raise InputError(f"{type(self).__name__}: radial_immersion is at most 1, got {immersion:g}")


@dataclass(frozen=True, kw_only=True)
class Immersed(Settings):
    """Operations in layers ``radial_immersion`` tool diameters thick."""

    radial_immersion: float = 0.25


@dataclass(frozen=True, kw_only=True)
class Levelled(Immersed):
    """Operations in levels ``axial_step`` [mm] apart."""

    axial_step: float = 1.0


@dataclass(frozen=True, kw_only=True)
class Roughing(Levelled):
    """Tooth roughing by layers of stock (table 5.1): ``stock`` [mm] is left on the flanks.

    ``involute_step`` in mm of arc or, by ``spacing``, in rad of roll.
    """

    involute_step: float = 1.0
    spacing: Spacing = "arc"
    stock: float = 0.1


@dataclass(frozen=True, kw_only=True)
class Finishing(Settings):
    """Tooth finishing by generation (table 5.2), one layer; steps as of ``Roughing``.

    A ``modification`` is cut by the tool's end, the axis leaning along the flank there; hollow ones are overcut above.
    """

    cutting: Cutting = FINISH
    axial_step: float = 0.5
    involute_step: float = 1.0
    spacing: Spacing = "arc"
    modification: FlankModification | None = None


@dataclass(frozen=True, kw_only=True)
class Slotting(Immersed):
    """Radial slots in the spaces of an external gear, before roughing; ``radial_step`` [mm] a pass.

    ``root_stock`` [mm] is left above the root circle for a tool of its own.
    """

    radial_step: float = 1.0
    stock: float = 0.1
    root_stock: float | None = None


@dataclass(frozen=True, kw_only=True)
class RootMilling(Settings):
    """Root land and fillets of an external spur gear, ``fillet`` [mm] their radius, in levels ``axial_step`` apart."""

    axial_step: float = 1.0
    fillet: float | None = None


@dataclass(frozen=True)
class Facing(Levelled):
    """The top face: ``allowance`` [mm] above z = 0 taken off a blank of ``radius`` [mm]."""

    radius: float
    allowance: float = 1.0


@dataclass(frozen=True)
class Bore(Levelled):
    """A hole of ``radius`` [mm] from the top face to ``depth`` [mm]: centre bore, or an internal gear hogged out."""

    radius: float
    depth: float


@dataclass(frozen=True)
class OutsideDiameter(Levelled):
    """The outside turned down from ``blank_radius`` to ``radius`` [mm] over ``depth`` [mm]."""

    blank_radius: float
    radius: float
    depth: float


@dataclass(frozen=True)
class ReferenceRing(Levelled):
    """A round groove in the top face, by which a measuring machine finds the axis; radii and depth in mm."""

    inner: float
    outer: float
    depth: float
