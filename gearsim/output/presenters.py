"""How measurements are told and drawn: one module for each of their classes, found here by the class's name.

A presenter module may have any of these functions; ``found`` are a result's measurements of its class:

| function | gives |
| --- | --- |
| ``figures(measurement)`` | plain values for report.json |
| ``sections(result, found)`` | Markdown by the report's slots (``SLOTS``) |
| ``charts(result, found)`` | flat pictures that can be drawn, as ``Chart`` |
| ``layers(result, found)`` | arrays for the 3D pictures, which are listed in ``output.drawer`` |
| ``maps(result, found)`` | parts of EXR files: channels by part, by file name |
| ``rows(result, found)`` | columns of samples.parquet, one table a surface |
| ``data(result, found)`` | what writes each data file of its own, by file name |
| ``columns(result, found)`` | more columns of these tables, by surface |
| ``screen(result, found, console)`` | prints what a user wants first |
| ``files(job, asked)`` | names of the files that may come of a job's inspections, known before it is run |
"""

from __future__ import annotations

from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

if TYPE_CHECKING:
    from gearsim.metrology.job import Job
    from gearsim.result import Result

SLOTS = ("first", "costs", "trust", "findings", "notes", "beside", "convergence", "details")

_MODULES = {
    "GearMeasurement": "gear.inspection",
    "ReachMeasurement": "gear.reach",
    "SectionMeasurement": "gear.whole",
    "GougingMeasurement": "gouging.cuts",
    "GridMeasurement": "grids",
    "ProfileMeasurement": "mean_profile",
    "ConvergenceMeasurement": "convergence",
    "DexelMeasurement": "dexels",
    "StockMeasurement": "stock",
    "BodyMeasurement": "bodies",
    "AxisMeasurement": "axes",
    "ToothMeasurement": "tooth",
    "BudgetMeasurement": "gear.budget",
    "RoughnessMeasurement": "gear.rough",
    "ProgramMeasurement": "programs",
    "MillMeasurement": "gouging.mills",
    "ContactMeasurement": "gouging.contact",
    "WorkedMeasurement": "gouging.worked",
}
_GIVEN = {  # by inspections, where the measurements have other names
    "GearProbing": ("GearMeasurement",),
    "GridInspection": ("GridMeasurement", "ConvergenceMeasurement"),
    "RootInspection": ("GridMeasurement",),
    "GougingInspection": ("GridMeasurement", "GougingMeasurement"),
    "SpaceInspection": ("DexelMeasurement",),
    "RapidInspection": (),
    "HolderInspection": (),
    "SpacesInspection": (),
}
_OF_THE_JOB = "motions"


def presented(result: Result) -> list[tuple[ModuleType, list[Any]]]:
    """The presenters of a result's measurements with what each presents, in the order of the list."""
    by_class: dict[str, list[Any]] = {}
    for measurement in result.measurements.values():
        by_class.setdefault(type(measurement).__name__, []).append(measurement)
    unknown = set(by_class) - set(_MODULES)
    if unknown:
        raise LookupError(f"no presenter for {', '.join(sorted(unknown))}")
    own = [(_module(name), by_class[name]) for name in _MODULES if name in by_class]
    return [*own, (import_module(f"gearsim.output.{_OF_THE_JOB}"), [])]


def presenters_of(inspection: str) -> list[str]:
    """The presenters of what an inspection, given by its class's name, measures. Raises KeyError for an unknown one."""
    return [_MODULES[name] for name in _GIVEN.get(inspection, (inspection.replace("Inspection", "Measurement"),))]


def promised(job: Job) -> list[str]:
    """The names of the files that may come of a job's inspections, and of the job itself, each once."""
    asked: dict[str, list[Any]] = {}
    for inspection in job.inspections:
        for name in presenters_of(type(inspection).__name__):
            asked.setdefault(name, []).append(inspection)
    modules = [(import_module(f"gearsim.output.{name}"), found) for name, found in (asked | {_OF_THE_JOB: []}).items()]
    names = [module.files(job, found) for module, found in modules if hasattr(module, "files")]
    return list(dict.fromkeys(name for some in names for name in some))


def presenter(measurement: Any) -> ModuleType:
    """The module that presents a measurement."""
    return _module(type(measurement).__name__)


def flat_figures(measurement: Any) -> dict[str, Any]:
    """A measurement's figures with their names joined by dots."""
    return _flat(presenter(measurement).figures(measurement))


def _flat(values: dict[str, Any], name: str = "") -> dict[str, Any]:
    out: dict[str, Any] = {}
    for key, value in values.items():
        full = f"{name}.{key}" if name else str(key)
        out |= _flat(value, full) if isinstance(value, dict) else {full: value}
    return out


def collected(result: Result, function: str, *arguments: Any) -> list[Any]:
    """What a function of all presenters that have it gives, in their order."""
    return [
        getattr(module, function)(result, found, *arguments)
        for module, found in presented(result)
        if hasattr(module, function)
    ]


def arrays(result: Result) -> dict[str, NDArray]:
    """All that the 3D pictures and tooth.vtp are made of, by name."""
    data: dict[str, NDArray] = {}
    for given in collected(result, "layers"):
        data |= given
    return data


def slug(name: str) -> str:
    """A name as it stands in keys, columns and channels: ``own pass`` is ``own_pass``."""
    return "_".join(name.replace("=", " ").split())


def _module(name: str) -> ModuleType:
    return import_module(f"gearsim.output.{_MODULES[name]}")
