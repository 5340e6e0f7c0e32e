"""Tables [cutter] and [machine]: every entry of a catalogue, its keys taken from the function's parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from inspect import Parameter, signature
from math import degrees, radians
from typing import Annotated, Any, Literal, Union

import numpy as np
from pydantic import Field, TypeAdapter, ValidationError, create_model

from gearsim.cutters.catalogue import CUTTERS
from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.geometry.solid import Solid
from gearsim.machines.catalogue import MACHINES
from gearsim.machines.chain import Machine
from gearsim.scene.bodies import BodyTable
from gearsim.scene.tables import Length, Table

_Length = Annotated[float, Field(gt=-1e5, lt=1e5, allow_inf_nan=False)]
_ToolLength = Annotated[float, Field(gt=-1e4, lt=1e4, allow_inf_nan=False)]  # no tool is ten metres long
_Angle = Annotated[float, Field(gt=-180.0, lt=180.0, allow_inf_nan=False)]
_Vector = tuple[_Length, _Length, _Length]
_ANGLES = {"alpha", "beta", "taper", "psi_u", "psi_l"}


class CatalogueTable(Table):
    """An entry of a catalogue; lengths end in ``_mm``, angles in ``_deg``."""

    kind: str

    def parameters(self) -> dict[str, Any]:
        """What the catalogue's function is given; lengths in mm, angles in rad."""
        given = {name: getattr(self, key) for name, key in _keys(_MAKERS[self.kind]).items()}
        return {name: radians(v) if _is_angle(name) else v for name, v in given.items()}

    def build(self) -> Any:
        """The tool or machine. Raises InputError where the parameters are impossible."""
        return _MAKERS[self.kind](**self.parameters())


class MillTable(CatalogueTable):
    """A cutter of the catalogue that is held against what it must not touch.

    ``flute_length_mm``: how high over its tip it cuts (none: all of it does); its upper part must touch nothing.
    """

    flute_length_mm: Length | None = None


class MachineTable(CatalogueTable):
    """A machine of the catalogue, with travel ``limits`` [mm, deg] of its owner's by axis name."""

    limits: dict[str, tuple[_Length, _Length]] = Field(default_factory=dict)

    def build(self) -> Machine:
        """The machine. Raises InputError for limits of axes it has not."""
        machine: Machine = super().build()
        turned = {joint.name for joint in machine.joints if joint.is_rotary}
        inside = {a: np.radians(ends) if a in turned else ends for a, ends in self.limits.items()}
        return machine.limited(**{a: (float(low), float(high)) for a, (low, high) in inside.items()})


class RunMachineTable(MachineTable):
    """A machine that runs a scene's program: its bodies and speeds as well, where its owner names them.

    ``spindle_nose_mm`` stands on what holds the tool, or on the tool itself: lower diameter, upper diameter and length
    of its pieces. ``table`` and ``fixture`` move with the workpiece. ``max_feed`` and ``max_rapid`` [mm/min, deg/min]
    are the fastest that axes go, by name.
    """

    spindle_nose_mm: tuple[tuple[Length, Length, Length], ...] = ()
    table: tuple[BodyTable, ...] = ()
    fixture: tuple[BodyTable, ...] = ()
    max_feed: dict[str, Length] = Field(default_factory=dict)
    max_rapid: dict[str, Length] = Field(default_factory=dict)

    def build(self) -> Machine:
        """The machine. Raises InputError for limits and speeds of axes it has not, and impossible bodies."""
        machine = super().build()
        for key in ("max_feed", "max_rapid"):
            for name in getattr(self, key):
                if name not in machine.axes:
                    raise InputError(f"machine.{key}: no axis {name}; {machine.name} has {', '.join(machine.axes)}")
        self.bodies()
        return machine

    def bodies(self) -> dict[str, list[Solid]]:
        """Table and fixture, where they are given, in the frame of the machine's workpiece."""
        given = {"table": self.table, "fixture": self.fixture}
        return {name: [s for one in tables for s in one.build()] for name, tables in given.items() if tables}

    def speeds(self, machine: Machine) -> tuple[dict[str, float], dict[str, float]]:
        """``max_feed`` and ``max_rapid`` [mm/s, rad/s] of the machine's axes."""
        turned = {joint.name for joint in machine.joints if joint.is_rotary}
        feed, rapid = (
            {name: (radians(value) if name in turned else value) / 60.0 for name, value in given.items()}
            for given in (self.max_feed, self.max_rapid)
        )
        return feed, rapid


_TOOLS = {name.replace("_", "-"): make for name, make in CUTTERS.items()}
_MAKERS: dict[str, Callable[..., Any]] = {**_TOOLS, **MACHINES}


def _is_angle(name: str) -> bool:
    return name in _ANGLES or name.endswith("angle")


def _keys(make: Callable[..., Any]) -> dict[str, str]:
    """The table's key of every parameter of a catalogue function."""
    return {n: f"{n}_deg" if _is_angle(n) else f"{n}_mm" for n in signature(make).parameters if n != "name"}


def _table(kind: str, make: Callable[..., Any], base: type[CatalogueTable]) -> type[CatalogueTable]:
    fields: dict[str, Any] = {"kind": (Literal[kind], ...)}
    for name, key in _keys(make).items():
        default = signature(make).parameters[name].default
        if default is Parameter.empty:
            default = ...
        elif _is_angle(name):
            default = degrees(default)
        length = _Length if issubclass(base, MachineTable) else _ToolLength
        number = _Vector if isinstance(default, tuple) else _Angle if _is_angle(name) else length
        fields[key] = (number, default)
    return create_model(f"{kind}Table", __base__=base, **fields)


def _any_of(catalogue: Mapping[str, Callable[..., Any]], base: type[CatalogueTable]) -> Any:
    tables = tuple(_table(kind, make, base) for kind, make in catalogue.items())
    return Annotated[Union[tables], Field(discriminator="kind")]  # noqa: UP007


AnyCutter: Any = _any_of(_TOOLS, CatalogueTable)
AnyMill: Any = _any_of(_TOOLS, MillTable)
AnyMachine: Any = _any_of(MACHINES, MachineTable)
AnyRunMachine: Any = _any_of(MACHINES, RunMachineTable)


def read_cutter(words: Sequence[str]) -> Profile:
    """A cutter from its kind and ``key=value`` words; the height may be left out. Raises InputError."""
    kind, given = words[0], {}
    for word in words[1:]:
        key, equals, value = word.partition("=")
        if not equals:
            raise InputError(f"--cutter {kind} {word}: expected key=value, for instance diameter_mm=12")
        given[key] = value
    if kind not in _TOOLS:
        raise InputError(f"--cutter {kind}: no such kind; there are {', '.join(_TOOLS)}")
    keys = tuple(_keys(_TOOLS[kind]).values())
    if "height_mm" in keys and "height_mm" not in given:
        given["height_mm"] = repr(_TALL * max([_length(v) for k, v in given.items() if k.endswith("_mm")], default=1.0))
    try:
        table: Any = TypeAdapter(AnyCutter).validate_python({"kind": kind, **given}, strict=False)
    except ValidationError as error:
        first = error.errors()[0]
        field = ".".join(str(p) for p in first["loc"] if p != kind)
        what = _MESSAGES.get(first["type"], first["msg"].lower())
        raise InputError(f"--cutter {kind}: {field}: {what}; its keys are {', '.join(keys)}") from None
    cutter: Profile = table.build()
    return cutter


def _length(text: str) -> float:
    """The number in a text, 1 where there is none: what is wrong with it is told by the table."""
    try:
        return float(text)
    except ValueError:
        return 1.0


_MESSAGES = {"extra_forbidden": "unknown key", "missing": "missing"}
_TALL = 5.0  # times the largest length given, where no height is
