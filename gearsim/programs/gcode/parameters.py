"""LinuxCNC's parameters: numbered and named ones, local to a subroutine or global."""

from __future__ import annotations

from dataclasses import dataclass, field

LOCAL_NUMBERS = 30
LAST_NUMBER = 5000  # the last one of the program
NUMBERS = range(1, 5602)  # those there are, the control's own among them
_OF_MODES = (
    "motion_mode plane ccomp metric imperial absolute incremental inverse_time units_per_minute units_per_rev "
    "coord_system tool_offset retract_r_plane retract_old_z spindle_rpm_mode spindle_css_mode ijk_absolute_mode "
    "lathe_diameter_mode lathe_radius_mode spindle_on spindle_cw mist flood speed_override feed_override "
    "adaptive_feed feed_hold feed rpm current_tool current_pocket selected_pocket selected_tool"
)
_OF_PLACES = "x y z a b c u v w abs_x abs_y abs_z abs_a abs_b abs_c"
_OF_THE_RUN = "vmajor vminor metric_machine line value value_returned task call_level remap_level"
CONTROLS_OWN = frozenset(f"_{name}" for name in f"{_OF_MODES} {_OF_PLACES} {_OF_THE_RUN}".split())

Key = int | str


@dataclass
class Parameters:
    """Values by number or name. #1 to #30 and names without a leading underscore are local to a subroutine.

    #1 to #30 of the caller come back at its end; ``result`` is what the last subroutine returned (None: nothing).
    """

    shared: dict[Key, float] = field(default_factory=dict)
    local: list[dict[Key, float]] = field(default_factory=lambda: [{}])
    result: float | None = None
    _pending: list[tuple[Key, float]] = field(default_factory=list)

    def get(self, key: Key) -> float | None:
        """The value of a parameter; None for a name without one (numbers start at 0)."""
        if key in CONTROLS_OWN:
            return self._own(key)
        return self._scope(key).get(key, 0.0 if isinstance(key, int) else None)

    def exists(self, name: str) -> bool:
        """Whether a name has a value."""
        return name in CONTROLS_OWN or name in self._scope(name)

    def declare(self, key: Key) -> None:
        """Begin a parameter."""
        self._scope(key).setdefault(key, 0.0)

    def set_later(self, key: Key, value: float) -> None:
        """Set a parameter once the whole line is read."""
        self._pending.append((key, value))

    def commit(self) -> None:
        """Make the pending settings."""
        for key, value in self._pending:
            self._scope(key)[key] = value
        self._pending.clear()

    def enter(self, arguments: list[float]) -> None:
        """Begin a subroutine: its arguments are #1, #2, ..."""
        self.local.append(dict(enumerate(arguments, 1)))

    def leave(self) -> None:
        """End a subroutine."""
        self.local.pop()

    def _own(self, key: Key) -> float | None:
        """What the control says about calls; what else it says of itself is not known here."""
        known = {
            "_value": self.result or 0.0,
            "_value_returned": float(self.result is not None),
            "_call_level": len(self.local) - 1.0,
        }
        return known.get(str(key))

    def _scope(self, key: Key) -> dict[Key, float]:
        local = key <= LOCAL_NUMBERS if isinstance(key, int) else not key.startswith("_")
        return self.local[-1] if local else self.shared
