"""The page of a study says what the study found: counts, limits, what matters, worst jobs, errors, commands."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest

from gearsim.scene import load_scene
from gearsim.studies.records import Parameter, Study, SurfaceMap
from gearsim.studies.summary import write_summary
from gearsim.studies.summary_figures import Told, headlines, worst_jobs
from gearsim.studies.summary_frame import Frame
from gearsim.studies.summary_texts import command, share_interval
from gearsim.surfaces.part import Tolerance

JOBS = 64
FRAME = Frame({"convex": Tolerance(5.0, 10.0)}, {}, {"F_alpha": 9.0}, 6)


def a_study(method="monte-carlo", jobs=JOBS, name="wear & tear <i>"):
    rng = np.random.default_rng(1)
    keys = {"errors.tool_radius_um": rng.normal(0.0, 2.0, jobs), "errors.squareness_urad": rng.normal(0.0, 5.0, jobs)}
    parameters = (*(Parameter(k, tuple(v.tolist())) for k, v in keys.items()),
                  Parameter("toolpath.mode", tuple(rng.choice(["cl", "axes"], jobs).tolist())))  # fmt: skip
    source = {"study": {"scene": "helical-external", "set": {"metrology.rows": 5, "metrology": {"columns": 9}}}}
    return Study(name, "two | *errors*", {}, Path(), parameters, method, 4, source=source)


def its_columns(study, bad=(3, 17)):
    """Overcut follows the radius alone, the profile's total the squareness and the mode."""
    radius, square = (np.array(p.values) for p in study.parameters[:2])
    mode = np.array(study.parameters[2].values) == "axes"
    columns = {
        "convex.min_um": -1.5 * np.abs(radius) - 0.5,
        "convex.max_um": 2.0 + 0.0 * radius,
        "convex.rms_um": np.abs(radius),
        "convex.uncut": np.zeros(len(study)),
        "convex.through": np.zeros(len(study)),
        "iso.F_alpha.left_um": 6.0 + 0.4 * square + 3.0 * mode,
        "iso.F_alpha.right_um": 6.0 + 0.1 * square,
    }
    for values in columns.values():
        values[list(bad)] = np.nan
    verdict = np.where(columns["convex.min_um"] < -5.0, "fail", "pass").astype(object)
    error = np.full(len(study), "", dtype=object)
    verdict[list(bad)], error[list(bad)] = "error", "scene: the <cutter> does not fit\n  - bottom_radius_mm"
    within = np.where(verdict == "pass", 1.0, 0.0)
    return {"job": np.arange(len(study)), "verdict": verdict, "error": error, "within_tolerance": within,
            "cross_checked": verdict != "error", **columns}  # fmt: skip


def maps_of(columns):
    def read(job):
        u, v = np.linspace(0.0, 1.0, 5), np.linspace(0.0, 1.0, 9)
        um = columns["convex.min_um"][job] * np.outer(u, v)
        return {"convex": SurfaceMap(um, np.zeros((5, 9), np.uint8), u, v, np.zeros((5, 9, 3)), np.zeros((5, 9, 3)))}

    return read


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    study, file = a_study(), tmp_path_factory.mktemp("page") / "summary.html"
    columns = its_columns(study)
    write_summary(study, columns, maps_of(columns), file, FRAME)
    return study, columns, file.read_text(encoding="utf-8")


def words(html):
    """The page's text without pictures and tags."""
    return re.sub(r"[ \n]+", " ", re.sub(r"<[^>]*>", " ", re.sub(r"<(style|title)>.*?</\1>", "", html, flags=re.S)))


def test_the_head_counts_and_a_user_s_text_stays_text(page):
    _, columns, html = page
    said, failed = words(html), int((columns["verdict"] == "fail").sum())
    assert failed
    assert f"64 jobs : {62 - failed} pass, {failed} fail, 2 error." in said
    assert "wear &amp; tear &lt;i&gt;" in said
    assert "two | *errors*" in said
    assert "monte-carlo, seed 4" in said
    assert "positive is material left" in said


def test_the_page_needs_nothing_else(page):
    html = page[2]
    assert not re.search(r'(src|href)="(?!data:)', html)
    assert html.count("data:image/png;base64,") == html.count("<img") >= 7
    assert "<script" not in html


def test_shares_beyond_the_tolerance_have_their_interval(page):
    _, columns, html = page
    beyond = int((columns["convex.min_um"] < -5.0).sum())
    low, high = share_interval(beyond, 62)
    assert f"{beyond} of 62 ({100 * low:.2g} to {100 * high:.2g} %)" in words(html)
    assert share_interval(0, 20) == (0.0, pytest.approx(0.168433, abs=1e-6))  # 1 - 0.025^(1/20)
    assert share_interval(20, 20) == (pytest.approx(1.0 - 0.168433, abs=1e-6), 1.0)


def test_what_matters_is_named_first(page):
    said = words(page[2])
    profile = said[said.index("F_alpha left Standard deviation") :]
    assert profile.index("toolpath.mode") > profile.index("errors.squareness_urad") > 0
    assert "0.4\u00a0(0.4\u00a0to\u00a00.4) µm per µrad" in profile
    assert "Vary by no more than 1 nm: convex max." in said
    assert "2 of 64 jobs have no value and are left out" in profile
    assert "A linear regression does not explain the figure" in said  # |radius| is no line


def test_errors_are_told_with_the_command_that_shows_them(page):
    study, _, html = page
    said = words(html)
    assert "Jobs that could not be done: 2" in said
    assert "2 jobs (3, 17): scene: the &lt;cutter&gt; does not fit - bottom_radius_mm" in said
    assert f"errors.tool_radius_um={study.parameters[0].values[3]!r}" in said


def test_a_command_gives_back_every_value():
    study = a_study()
    text = command(study, 5).removeprefix("```sh\n").removesuffix("```\n")
    given = [w for w in shlex.split(text.replace("\\\n", " ")) if "=" in w]
    mode = study.parameters[2].values[5]
    assert given[:2] == ["metrology.rows=5", "metrology.columns=9"]
    assert given[-1] == f'toolpath.mode="{mode}"'
    assert float(given[2].partition("=")[2]) == study.parameters[0].values[5]


def test_a_command_sets_a_list_whole_so_that_gearsim_run_reads_it():
    places = (Parameter("errors.pivot_um.2", (1.5, -0.25)), Parameter("errors.tool_radius_um", (2.0, 3.0)))
    tables = {"errors": {"pivot_um": [0.0, 7.0, 0.0]}}
    study = Study("s", "", tables, Path(), places, "list", 1, source={"study": {"scene": "helical-external"}})
    given = [w for w in shlex.split(command(study, 1).replace("\\\n", " ").replace("```", "")) if "=" in w]
    assert given == ["errors.pivot_um=[0.0, 7.0, -0.25]", "errors.tool_radius_um=3.0"]
    scene, _ = load_scene("helical-external", given)
    assert scene.errors.pivot_um == (0.0, 7.0, -0.25)


def test_the_worst_jobs_come_first_and_those_with_unmeasured_samples_before():
    study = a_study()
    columns = its_columns(study)
    told = Told(study, columns, FRAME)
    use = np.max([np.nan_to_num(told.use(f)) for f in told.figures if np.isfinite(FRAME.limits(f)).any()], axis=0)
    assert worst_jobs(told, 3) == np.argsort(-use, kind="stable")[:3].tolist()
    columns["convex.through"][40] = 2.0
    assert worst_jobs(told, 1) == [40]
    assert "convex.max_um" not in headlines(told, 9)  # it does not vary


def test_two_writings_are_alike(page, tmp_path):
    study, columns, html = page
    write_summary(study, columns, maps_of(columns), tmp_path / "again.html", FRAME)
    assert (tmp_path / "again.html").read_text(encoding="utf-8") == html


def test_a_study_without_any_figure_has_a_page(tmp_path):
    study = a_study("grid", 6)
    nothing = its_columns(study, range(6))
    write_summary(study, nothing, maps_of(nothing), tmp_path / "c.html")
    said = words((tmp_path / "c.html").read_text(encoding="utf-8"))
    assert "6 jobs : 6 error." in said
    assert "No job has figures" in said
