#!/bin/sh
# Warp 1.19 compiles two CPU modules at once, in threads of one process, only if their LLVM options are equal.
#
# A small module is asked for, in a second thread, while a large one is being compiled. Warp compiles outside Python's
# lock, so the small one should be there long before the large one. It is if both modules have the same -mllvm options
# in "cpu_compiler_flags", whatever else the flags say; it waits for the large one to end if they differ, or if one has
# none. Warp's own default has -mllvm options, so that one module with options of its own waits for all those without.
#
# Why: the options are global in LLVM, so Warp lets in only those who want the same (native/clang/clang.cpp of the
# wheel, class ScopedLlvmOptions). The documents call them "a power-user feature with process-wide caveats" and do not
# say that compilations wait. Of our two modules of kernels (50 s of CPU time) it made 48 s of 28 s on two cores.
#
# Judged by which ends first, not by time. Exits 0 while this is so.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install -q warp-lang==1.19.0 numpy==2.4.6 >/dev/null 2>&1 ||
    { echo "the packages cannot be fetched"; exit 2; }
cat >look.py <<'END'
import importlib
import sys
import threading
import time
from pathlib import Path

import warp as wp

HEAD = """
import warp as wp
wp.set_module_options({"enable_backward": False, "cpu_compiler_flags": %r})
"""
KERNEL = """
@wp.kernel
def k%d(a: wp.array(dtype=wp.mat33d), b: wp.array(dtype=wp.vec3d)):
    m = a[wp.tid()]
    v = b[wp.tid()]
    for i in range(%d):
        m = m * m + wp.outer(v, v)
        v = wp.inverse(m) * v + wp.cross(v, m * v)
    b[wp.tid()] = v
"""


def module(name, kernels, flags):
    Path(name + ".py").write_text(HEAD % (flags,) + "".join(KERNEL % (k, 3 + k) for k in range(kernels)))
    return importlib.import_module(name)


def load(module, ended):
    wp.load_module(module, device="cpu")
    ended.append(module.__name__)


wp.config.quiet = True
wp.config.kernel_cache_dir = "cache " + " beside ".join(sys.argv[1:])
sys.path.insert(0, ".")
sys.dont_write_bytecode = True
wp.init()
ended = []
large, small = module("large", 5, sys.argv[1]), module("small", 1, sys.argv[2])
threads = [threading.Thread(target=load, args=(m, ended)) for m in (large, small)]
threads[0].start()
while not list(Path(wp.config.kernel_cache_dir).rglob("*large*.cpp")):
    time.sleep(0.01)  # its source is written just before it is compiled
time.sleep(0.5)
begun_in_time = not ended
threads[1].start()
for thread in threads:
    thread.join()
assert begun_in_time, "the large module was compiled before the small one was asked for: make it larger"
print("ended first:", ended[0])
END
own="-march=native -mllvm=-inline-threshold=300"
as_before=yes
look() {
    seen=$(venv/bin/python look.py "$1" "$2" 2>&1 | grep "ended first" || echo "failed")
    echo "large '$1', small '$2': expected 'ended first: $3', seen '$seen'"
    [ "$seen" = "ended first: $3" ] || as_before=no
}
echo "warp-lang $(venv/bin/python -c 'from importlib.metadata import version; print(version("warp-lang"))')"
look "$own" "$own" small
look "$own" "-mllvm=-inline-threshold=300 -fno-vectorize" small
look "$own" "-march=native -mllvm=-inline-threshold=301" large
look "$own" "-march=native" large
[ "$as_before" = yes ] && echo "as before" || { echo "CHANGED"; exit 1; }
