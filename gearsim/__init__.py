"""gearsim: machines gears virtually and measures the machined tooth in micrometres."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from gearsim.errors import GearsimError, InputError, NumericalError

if TYPE_CHECKING:
    from gearsim.processes.run import run
    from gearsim.result import Result
    from gearsim.scene import Scene, load_scene, scene_names
    from gearsim.studies.run import StudyResult, study

__version__ = "0.1.0"
__all__ = [
    "GearsimError",
    "InputError",
    "NumericalError",
    "Result",
    "Scene",
    "StudyResult",
    "__version__",
    "load_scene",
    "run",
    "scene_names",
    "study",
]

_HOMES = {
    "Result": "result", "Scene": "scene", "StudyResult": "studies.run", "load_scene": "scene", "run": "processes.run",
    "scene_names": "scene", "study": "studies.run",
}  # fmt: skip


def __getattr__(name: str) -> Any:
    """Load the rooms behind the public names only when they are used: start-up counts."""
    if name not in _HOMES:
        raise AttributeError(f"module 'gearsim' has no attribute {name!r}")
    value = getattr(import_module(f"gearsim.{_HOMES[name]}"), name)
    globals()[name] = value
    return value
