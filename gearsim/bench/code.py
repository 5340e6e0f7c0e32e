"""Benchmark suite `code`: what the kernels become on a GPU that need not be there, compiled for its architecture."""

from __future__ import annotations

import re
import shutil
import struct
import subprocess
import tempfile
from importlib import metadata
from pathlib import Path
from typing import Any

import warp as wp

from gearsim.errors import InputError, NumericalError
from gearsim.kernels import envelope, nurbs, removal, ring_removal

ARCHITECTURE = 90
KERNELS = {"removal": removal, "ring_removal": ring_removal, "envelope": envelope, "nurbs": nurbs}
_COLUMNS = ("module", "kernel", "PTX KB", "code KB", "registers", "stack B", "spilled B", "reloaded B")
_EXECUTABLE = 0x4
_REMEDY = "pip install --upgrade nvidia-cuda-nvcc"


def code(device: str, size: str) -> dict[str, Any]:
    """Machine code, registers, stack and spills of every kernel for sm_90 (H100, H200); ``device`` plays no part.

    Raises InputError where NVIDIA's assembler ``ptxas`` is not installed, NumericalError where it fails.
    """
    ptxas = find_ptxas()
    with tempfile.TemporaryDirectory() as folder:
        rows = [_row(ptxas, name, module, Path(folder)) for name, module in KERNELS.items()]
    return {"columns": list(_COLUMNS), "rows": rows, "notes": [_note(ptxas)]}


def find_ptxas() -> Path:
    """The assembler of the installed package nvidia-cuda-nvcc, else the one on the path."""
    try:
        files = metadata.files("nvidia-cuda-nvcc") or []
    except metadata.PackageNotFoundError:
        files = []
    for file in files:
        if file.name == "ptxas":
            return Path(str(file.locate()))
    if found := shutil.which("ptxas"):
        return Path(found)
    raise InputError(f"no ptxas to assemble the kernels with: {_REMEDY}, or put CUDA's on the path")


def _row(ptxas: Path, name: str, module: Any, folder: Path) -> dict[str, Any]:
    text = next(p for p in _compiled(module, folder) if p.suffix == ".ptx").read_bytes().rstrip(b"\0")
    ptx, cubin = folder / f"{name}.ptx", folder / f"{name}.cubin"
    ptx.write_bytes(text)
    command = [str(ptxas), "-v", f"-arch=sm_{ARCHITECTURE}", "-o", str(cubin), str(ptx)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise NumericalError(f"{ptxas} cannot assemble {name}: {done.stderr.splitlines()[0]}; a newer one: {_REMEDY}")
    return {
        "module": name,
        "PTX KB": round(len(text) / 1024),
        "code KB": round(executable_bytes(cubin.read_bytes()) / 1024),
        **assembled(done.stderr),
    }


def _compiled(module: Any, folder: Path) -> list[Path]:
    return list(wp.compile_aot_module(module, device=None, arch=ARCHITECTURE, module_dir=folder, use_ptx=True))


def assembled(told: str) -> dict[str, Any]:
    """A module's kernel by what ``ptxas -v`` told of it."""

    def number(pattern: str) -> int:
        found = re.search(pattern, told)
        return int(found[1]) if found else 0

    kernel = re.search(r"entry function '(\w+?)_[0-9a-f]+_cuda_kernel_forward'", told)
    return {
        "kernel": kernel[1] if kernel else "-",
        "registers": number(r"Used (\d+) registers"),
        "stack B": number(r"(\d+) bytes stack frame"),
        "spilled B": number(r"(\d+) bytes spill stores"),
        "reloaded B": number(r"(\d+) bytes spill loads"),
    }


def executable_bytes(elf: bytes) -> int:
    """Bytes of the executable sections of a 64-bit ELF file."""
    (table,) = struct.unpack_from("<Q", elf, 0x28)
    entry, count = struct.unpack_from("<HH", elf, 0x3A)
    sections = (struct.unpack_from("<IIQQQQ", elf, table + i * entry) for i in range(count))
    return sum(size for _, _, flags, _, _, size in sections if flags & _EXECUTABLE)


def _note(ptxas: Path) -> str:
    version = subprocess.run([str(ptxas), "--version"], capture_output=True, text=True).stdout.strip().splitlines()[-1]
    return (
        f"PTX by Warp {wp.__version__} for sm_{ARCHITECTURE}, assembled by ptxas ({version}). At most 255 registers a "
        "thread; what does not fit is spilled to the stack, which lies in local memory."
    )
