#!/bin/sh
# Warp 1.19: a cast of a wp.constant changes the constant, for the rest of the function.
#
# After wp.float64(N) with N = wp.constant(3), range(N) and k // N in the same function do not compile any more: "Couldn't
# find function overload for 'range' that matched inputs with types: [float64]". The other way round, N used as an
# integer first and cast afterwards, all is well; so is the same with a variable n = int(3).
#
# Expected: a cast makes a new value, as with a variable, and the order of two lines that do not touch each other does not
# matter (docs: constants can be used in kernels like Python's; nothing is said of casts). Exits 0 while this is so.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install -q warp-lang==1.19.0 numpy==2.4.6 >/dev/null 2>&1 ||
    { echo "the packages cannot be fetched"; exit 2; }
cat >look.py <<'END'
import sys

import warp as wp

wp.config.quiet = True
wp.config.kernel_cache_dir = "cache"
N = wp.constant(3)


@wp.kernel(module="unique")
def range_then_cast(out: wp.array(dtype=wp.float64)):
    s = wp.float64(0.0)
    for i in range(N):
        s += wp.float64(1.0)
    out[0] = s / wp.float64(N)


@wp.kernel(module="unique")
def cast_then_range(out: wp.array(dtype=wp.float64)):
    part = wp.float64(1.0) / wp.float64(N)
    s = wp.float64(0.0)
    for i in range(N):
        s += part
    out[0] = s


@wp.kernel(module="unique")
def cast_then_divide(out: wp.array(dtype=wp.float64)):
    part = wp.float64(1.0) / wp.float64(N)
    k = int(9)
    out[0] = part * wp.float64(k // N)


@wp.kernel(module="unique")
def variable(out: wp.array(dtype=wp.float64)):
    n = int(3)
    part = wp.float64(1.0) / wp.float64(n)
    s = wp.float64(0.0)
    for i in range(n):
        s += part
    out[0] = s


def seen(kernel):
    out = wp.zeros(1, dtype=wp.float64, device="cpu")
    try:
        wp.launch(kernel, 1, outputs=[out], device="cpu")
    except Exception as error:
        return str(error).strip().splitlines()[-1].lstrip(";")
    return float(out.numpy()[0])


print("warp-lang", wp.__version__)
found = {k: seen(k) for k in (range_then_cast, cast_then_range, cast_then_divide, variable)}
for kernel, what in found.items():
    print(f"{kernel.func.__name__}: expected 1.0, seen {what}")
as_before = found[range_then_cast] == found[variable] == 1.0
as_before &= all("float64" in str(found[k]) for k in (cast_then_range, cast_then_divide))
print("as before" if as_before else "CHANGED")
sys.exit(not as_before)
END
venv/bin/python look.py 2>&1 | grep -v -i -e cuda -e nvrtc >answer || true
cat answer
tail -n 1 answer | grep -q -x "as before"
