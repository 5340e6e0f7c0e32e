"""What the errors of a scene's tool, settings and mounting do to its job."""

from __future__ import annotations

from typing import overload

from gearsim.motion.sources import CLMotion, MotionSource, MovedMotion
from gearsim.scene.error_table import ErrorTable
from gearsim.scene.tool_errors import MountingErrorsTable


@overload
def mounted(source: CLMotion, errors: MountingErrorsTable) -> CLMotion: ...
@overload
def mounted(source: MotionSource, errors: MountingErrorsTable) -> MotionSource: ...
def mounted(source: MotionSource, errors: MountingErrorsTable) -> MotionSource:
    """A motion in the frame of the gear as it is mounted, CL data as such; itself where nothing is wrong with that."""
    shift = errors.mounting
    if shift is None:
        return source
    if isinstance(source, CLMotion):
        return CLMotion(shift.point(source.tips), shift.direction(source.axes))
    return MovedMotion(source, shift)


def error_notes(errors: ErrorTable) -> tuple[str, ...]:
    """What a reader must be told of them: those that act."""
    acting = errors.acting()
    return (f"errors act: {', '.join(acting)}; what is intended is as without them",) if acting else ()
