"""Start Warp and load kernels; Warp keeps what it compiles on disk, which may be full or closed to us."""

import os
import re
import tempfile
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Lock
from types import ModuleType

import warp as wp

from gearsim.errors import InputError

_ONE_AT_A_TIME: defaultdict[str, Lock] = defaultdict(Lock)  # threads would each compile it
ROOM = 8 << 20  # bytes; the compiled kernels of one module take less than 1 MB


def start_warp() -> None:
    """Start Warp. Raises InputError where its cache cannot be made."""
    with _cache():
        wp.init()


def load_kernels(module: ModuleType, device: str) -> None:
    """Compile and load a module's kernels. Raises InputError where what is compiled cannot be kept."""
    start_warp()
    with _ONE_AT_A_TIME[module.__name__], _cache():
        _make_sure_of_room(module)
        wp.load_module(module, device=device)


def _make_sure_of_room(module: ModuleType) -> None:
    """Take and give back the room that compiling needs: a compiler that finds none ends the process."""
    cache = Path(wp.config.kernel_cache_dir)
    compiled = re.compile(rf"wp_{re.escape(module.__name__)}_[0-9a-f]+")
    if not any(compiled.fullmatch(folder.name) for folder in cache.iterdir()):
        with tempfile.TemporaryFile(dir=cache) as file:
            os.posix_fallocate(file.fileno(), 0, ROOM)


@contextmanager
def _cache() -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise InputError(
            f"cannot keep compiled kernels in {wp.config.kernel_cache_dir}: {error.strerror}; let WARP_CACHE_PATH name "
            "a folder that can be written and has room"
        ) from error
