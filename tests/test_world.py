"""What the machine may refuse: room on the disk, a place for kernels, standard output."""

import os
import resource
import subprocess
import sys

import pytest

from gearsim.errors import InputError, written
from tests.limits import files_no_larger_than

GOUGE = ("gouge", "khan-9-1-free-form", "--cutter", "bull", "diameter_mm=40", "corner_radius_mm=15", "--grid", "8")


def gearsim(*arguments, environment=None, **options):
    command = [sys.executable, "-m", "gearsim.cli", *map(str, arguments)]
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options}
    return subprocess.run(command, text=True, check=False, env={**os.environ, **(environment or {})}, **streams)


def small_files(size):
    """Let a process write no file larger than so many bytes."""
    return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


def refused(done):
    """The one message of a command that ended with 2."""
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert done.stderr.startswith("gearsim: ")
    return done.stderr


@pytest.mark.parametrize(("command", "code"), [(("scenes",), 0), (GOUGE, 1), (("run", "nosuch"), 2)])
def test_a_reader_that_leaves_changes_no_exit_code(command, code):
    reader, writer = os.pipe()
    os.close(reader)
    done = gearsim(*command, stdout=writer)
    os.close(writer)
    assert done.returncode == code
    assert "Traceback" not in done.stderr


def test_errors_nobody_reads_change_no_exit_code():
    reader, writer = os.pipe()
    os.close(reader)
    assert gearsim("run", "nosuch", stderr=writer).returncode == 2
    os.close(writer)


@pytest.mark.parametrize("command", [("scenes",), ("--help",), GOUGE])
def test_standard_output_that_takes_no_more_is_told(command):
    with open("/dev/full", "w") as full:
        assert "cannot write to standard output: No space left on device" in refused(gearsim(*command, stdout=full))


def test_what_is_printed_to_closed_streams_lands_in_no_file(tmp_path):
    def closed():
        for number in (0, 1, 2):
            os.close(number)

    done = gearsim("new", "mine", cwd=tmp_path, stdin=None, stdout=None, stderr=None, preexec_fn=closed)
    assert done.returncode == 0
    (tmp_path / "open").mkdir()
    gearsim("new", "mine", cwd=tmp_path / "open")
    assert (tmp_path / "mine.toml").read_text() == (tmp_path / "open" / "mine.toml").read_text()


def test_a_scene_that_finds_no_room_is_not_begun(tmp_path):
    assert "cannot write mine.toml: File too large" in refused(
        gearsim("new", "mine", cwd=tmp_path, preexec_fn=small_files(1000))
    )
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("cache", ["/dev/null", "/proc/nosuch"])
def test_kernels_that_cannot_be_kept_are_told(cache, tmp_path):
    done = gearsim(*GOUGE, "--out", tmp_path / "out", environment={"WARP_CACHE_PATH": cache})
    message = refused(done)
    assert f"cannot keep compiled kernels in {cache}" in message
    assert "WARP_CACHE_PATH" in message
    assert list(tmp_path.iterdir()) == []


def test_kernels_that_find_no_room_are_not_begun(tmp_path):
    done = gearsim(*GOUGE, environment={"WARP_CACHE_PATH": str(tmp_path)}, preexec_fn=small_files(1 << 20))
    assert "cannot keep compiled kernels in" in refused(done)
    assert not [f for f in tmp_path.rglob("*") if f.is_file()]


def test_a_file_that_finds_no_room_leaves_the_older_one(tmp_path):
    file = tmp_path / "points.csv"
    file.write_text("older")
    with pytest.raises(InputError, match=r"cannot write point list .*points\.csv: File too large"), \
            files_no_larger_than(1000), written(file, "point list") as scratch:  # fmt: skip
        scratch.write_text("x" * 2000)
    assert file.read_text() == "older"
    assert list(tmp_path.iterdir()) == [file]
    with written(file) as scratch:
        scratch.write_text("newer")
    assert file.read_text() == "newer"


def test_a_device_is_written_to_and_stays_one(tmp_path):
    (tmp_path / "link").symlink_to("/dev/null")
    with written(tmp_path / "link") as scratch:
        scratch.write_text("nothing")
    assert (tmp_path / "link").is_symlink()
    assert not (tmp_path / "link").is_file()
