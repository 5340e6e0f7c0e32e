"""Every inspection has its presenters: what it measures is written, and its files are promised before the cut."""

import dataclasses
import importlib
import pkgutil

import pytest

import gearsim.gouging
import gearsim.metrology
from gearsim.cli import main
from gearsim.output.presenters import presenters_of
from tests.output.conftest import SMALL


def inspections():
    """Names of all classes whose objects ask questions as part of a job."""
    for room in (gearsim.metrology, gearsim.gouging):
        for module in pkgutil.walk_packages(room.__path__, f"{room.__name__}."):
            for kind in vars(importlib.import_module(module.name)).values():
                if dataclasses.is_dataclass(kind) and hasattr(kind, "steps") and kind.__name__ != "Job":
                    yield kind.__name__


@pytest.mark.parametrize("name", sorted(set(inspections())))
def test_every_inspection_has_presenters(name):
    names = presenters_of(name)
    assert names or name in ("RapidInspection", "HolderInspection", "SpacesInspection")  # these only find
    assert all(importlib.import_module(f"gearsim.output.{module}") for module in names)


def test_a_run_with_a_holder_leaves_its_report(tmp_path, capsys):
    given = (*SMALL, "holder.shank_diameter_mm=6", "holder.shank_length_mm=20")
    sets = [word for one in given for word in ("--set", one)]
    assert main(["run", "spiral-bevel-flank", *sets, "--no-pictures", "--out", str(tmp_path)]) == 0
    assert (tmp_path / "report.json").exists()
    assert "Traceback" not in capsys.readouterr().err
