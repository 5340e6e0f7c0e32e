"""summary.html: a study on one page, told to a gear engineer; the same data set gives the same page, bit by bit."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

from gearsim.errors import written
from gearsim.output.files import into
from gearsim.output.heat import NOISE_UM
from gearsim.output.markdown import as_html, pictures
from gearsim.output.saving import Save
from gearsim.studies.importance import importance
from gearsim.studies.records import Study, SurfaceMap
from gearsim.studies.summary_charts import draw_effects, draw_iso, draw_responses, draw_surfaces
from gearsim.studies.summary_effects import effects, overview
from gearsim.studies.summary_figures import Columns, Told, headlines, label, worst_jobs
from gearsim.studies.summary_frame import Frame
from gearsim.studies.summary_maps import draw_job, scales
from gearsim.studies.summary_texts import distributions, failures, head, plain, worst

SUMMARY = "summary.html"
_MOST_FIGURES = 6
_MOST_WORST = 3

Maps = Callable[[int], Mapping[str, SurfaceMap]]


def write_summary(study: Study, columns: Columns, maps: Maps, out: Path, frame: Frame | None = None) -> None:
    """Write the page of a study.

    ``columns``: its table by column, shape (jobs,), nan where a figure is missing. ``maps`` gives a job's maps by
    surface. ``frame``: tolerances (default: none are known). Raises InputError where it cannot be written.
    """
    told = Told(study, columns, frame or Frame())
    with into(out.parent), TemporaryDirectory() as folder:
        save = Save(Path(folder))
        parts = [
            head(told),
            _spread(told, save),
            _matters(told, save),
            _worst(told, maps, save),
            failures(told),
            _ends(),
        ]
        page = as_html("\n".join(p for p in parts if p), Path(folder), plain(study.name))
    with written(out, "the summary") as scratch:
        scratch.write_text(page, encoding="utf-8")


def _spread(told: Told, save: Save) -> str:
    """How the figures are distributed over the jobs."""
    if not told.figures:
        return "## No job has figures\n"
    captions = {}
    if told.surfaces:
        draw_surfaces(told, save, "surfaces.png")
        captions["surfaces.png"] = (
            "Jobs by the min (hollow), max (filled) and RMS of each surface: blue is overcut, red material left; "
            "green and dashed: tolerance"
        )
    if told.iso:
        draw_iso(told, save, "iso.png")
        captions["iso.png"] = (
            f"Parameters of ISO 1328-1 over the jobs; dashed: tolerance of class {told.frame.iso_class}"
        )
    return f"## How the figures are distributed\n\n{distributions(told)}{pictures(captions)}"


def _matters(told: Told, save: Save) -> str:
    """Which parameter matters for the figures that vary most."""
    chosen = headlines(told, _MOST_FIGURES)
    if not told.study.parameters or not chosen:
        return "## Which parameter matters\n\nNone: no figure varies by more than 1 nm.\n" * bool(told.figures)
    study = told.study
    found = [importance(f, told[f], told.parameters, study.method, study.seed, NOISE_UM) for f in chosen]
    still = ", ".join(map(label, told.still))
    out = [
        f"## Which parameter matters\n\n{overview(found)}" + f"\nVary by no more than 1 nm: {still}.\n" * bool(still)
    ]
    for k, one in enumerate(found):
        captions = {}
        if any(e.size > 0.0 for e in one.effects):
            draw_effects(one, save, f"effects-{k}.png")
            captions[f"effects-{k}.png"] = f"{label(one.figure)}: parameters, with 95 % intervals"
        if one.effects:
            draw_responses(told, one, save, f"responses-{k}.png")
            captions[f"responses-{k}.png"] = f"{label(one.figure)} over the parameters that matter most"
        out.append(f"### {label(one.figure)}\n\n{effects(one, study)}{pictures(captions)}")
    return "\n".join(out)


def _worst(told: Told, maps: Maps, save: Save) -> str:
    """The worst jobs with their maps, and the commands that run them alone."""
    jobs = worst_jobs(told, _MOST_WORST)
    if not jobs:
        return ""
    found = {job: maps(job) for job in jobs}
    limits = scales(found)
    out = ["## Worst cases\n"]
    for job in jobs:
        captions = {}
        if found[job]:
            draw_job(found[job], limits, told.frame, save, f"job-{job}.png")
            captions[f"job-{job}.png"] = f"Job {job}: deviation [µm]; each surface has one scale in all these jobs"
        out.append(worst(told, job) + pictures(captions))
    return "\n".join(out)


def _ends() -> str:
    return (
        "## What the numbers mean\n\n"
        "- All figures are in `jobs.parquet`, all maps in `maps.zarr`. A job that could not be done "
        "has a row that says why, and is in no figure.\n"
        "- Intervals hold 95 %. Those of Sobol indices come from jobs drawn anew from the jobs, with the expansion's "
        "terms held; Q² is the share of the variance that it predicts in jobs left out, one by one. Indices take the "
        "parameters as independent.\n"
        '- "Alone": the share of the variance that would be gone if the parameter were fixed; in µm the standard '
        'deviation that it would make alone. "With others": with what it makes together with other parameters.\n'
        "- Standardised: by how many standard deviations the figure moves with one of the parameter's, others held; "
        "slope: the same in units.\n"
        "- Shares hold for the ranges and distributions of this study, not for others.\n"
    )
