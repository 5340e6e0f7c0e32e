"""Where the program's zero is: work offsets, local and shifted zeros, tool length."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from gearsim.machines.chain import Machine
from gearsim.programs.gcode.settings import ReadSettings

Numbers = list[float]


@dataclass
class Offsets:
    """The offsets in force, lists in the machine's axis order [mm, rad].

    Axis value = programmed value + ``shift``: it counts from the workpiece's origin and is the tip's place.
    ``compensated`` is the length that G43 works with, ``length`` the one the tool has: without compensation the
    spindle nose is programmed, and the tip is lower by the tool's length. ``local`` is G52's zero, ``shifted``
    G92's; a control with one register for both uses ``shifted``, and ``saved`` is what G92.3 brings back.
    """

    machine: Machine
    settings: ReadSettings
    active: str = "G54"
    compensated: float = 0.0
    length: float = 0.0
    local: Numbers = field(default_factory=list)
    shifted: Numbers = field(default_factory=list)
    saved: Numbers = field(default_factory=list)

    def __post_init__(self) -> None:
        settings, machine = self.settings, self.machine
        self._none = [0.0] * len(machine.axes)
        self.local, self.shifted, self.saved = self._none[:], self._none[:], self._none[:]
        self._known = {name: settings.place(place, machine, name) for name, place in settings.offsets.items()}
        self._workpiece = self._known.get(settings.workpiece, self._none)[:]
        self._z = machine.axes.index("Z") if "Z" in machine.axes else None
        self.length = settings.tool_lengths.get(settings.start_tool, 0.0)

    @property
    def excess(self) -> float:
        """How far along its axis the tip stands above the place the control believes in [mm]."""
        return self.compensated - self.length

    def is_known(self) -> bool:
        """Whether the offset in force has a place: the settings or the program state it, or it is the workpiece's."""
        return self.active in self._known or self.active == self.settings.workpiece

    def of(self, name: str) -> Numbers:
        """A work offset by its name, machine coordinates; zeros where nobody has stated it."""
        return self._known.get(name, self._none)[:]

    def put(self, name: str, place: Numbers) -> None:
        """Give a work offset its place."""
        self._known[name] = place

    def shift(self) -> Numbers:
        """What is added to programmed axis values."""
        return self._along_z(self._origin(), self.excess)

    def tip_shift(self) -> Numbers:
        """What is added to tips and rotary values programmed under tool centre point control.

        Offsets are made by the slides with the rotary axes at zero, so a linear one is turned into the workpiece frame.
        """
        origin = self._origin()
        still: NDArray = np.zeros((1, len(origin)))
        slides = self.machine.slide_directions(still)[0]
        count = slides.shape[-1]
        return [*(slides @ origin[:count]).tolist(), *origin[count:]]

    def from_machine(self, position: Numbers) -> Numbers:
        """Axis values of a position of the spindle nose in machine coordinates."""
        return self._along_z([p - w for p, w in zip(position, self._workpiece, strict=True)], -self.length)

    def _origin(self) -> Numbers:
        parts = zip(self.of(self.active), self._workpiece, self.local, self.shifted, strict=True)
        return [a - w + local + shifted for a, w, local, shifted in parts]

    def _along_z(self, values: Numbers, amount: float) -> Numbers:
        if self._z is not None:
            values[self._z] += amount
        return values
