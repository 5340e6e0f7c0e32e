"""What is read out of the assembler's words and files; the assembler itself where it is installed."""

import sys

import pytest

from gearsim.bench import code
from gearsim.errors import InputError, NumericalError

TOLD = """ptxas info    : 0 bytes gmem
ptxas info    : Compiling entry function 'cut_rays_by_ring_52ad09f1_cuda_kernel_forward' for 'sm_90'
ptxas info    : Function properties for cut_rays_by_ring_52ad09f1_cuda_kernel_forward
    472 bytes stack frame, 764 bytes spill stores, 852 bytes spill loads
ptxas info    : Used 255 registers, used 0 barriers, 472 bytes cumulative stack size, 33792 bytes smem
"""


def test_the_assemblers_words_are_read():
    assert code.assembled(TOLD) == {
        "kernel": "cut_rays_by_ring", "registers": 255, "stack B": 472, "spilled B": 764, "reloaded B": 852,
    }  # fmt: skip


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs an ELF file at hand: Python itself")
def test_executable_sections_are_part_of_the_file():
    with open(sys.executable, "rb") as file:
        elf = file.read()
    assert 0 < code.executable_bytes(elf) < len(elf)


def test_a_missing_assembler_is_told(monkeypatch):
    monkeypatch.setattr(code.shutil, "which", lambda name: None)
    monkeypatch.setattr(code.metadata, "files", lambda name: [])
    with pytest.raises(InputError, match="pip install --upgrade nvidia-cuda-nvcc"):
        code.find_ptxas()


def test_every_kernel_assembles_for_the_architecture():
    try:
        rows = code.code("cpu", "small")["rows"]
    except (InputError, NumericalError) as error:  # no assembler here, or too old a one
        pytest.skip(str(error))
    assert [row["module"] for row in rows] == list(code.KERNELS)
    assert all(row["code KB"] > 0 and 0 < row["registers"] <= 255 for row in rows)
