# mypy: disable-error-code="valid-type, no-untyped-def"
"""What a device can do at most: float64 multiply-adds and copied bytes per second, by two small kernels."""

from __future__ import annotations

from functools import cache
from statistics import median
from time import perf_counter, process_time
from typing import Any, NamedTuple

import warp as wp

wp.set_module_options({"enable_backward": False})

f64: Any = wp.float64  # types to Warp, values to mypy
vec8: Any = wp.types.vector(length=8, dtype=f64)

CHAINS = 64
STEPS = 200_000
ROUNDS = 5
COPIED = 1 << 23
CUDA_THREADS = 1 << 17


@wp.kernel
def multiply_add(
    # in
    steps: int,
    factor: f64,
    # out
    sum_out: wp.array(dtype=vec8),
):
    """64 independent chains a = a * factor + 1, which any processor can keep in flight together or side by side."""
    i = wp.tid()
    one = vec8(f64(1.0))
    a = vec8(f64(1.0))
    b = vec8(f64(2.0))
    c = vec8(f64(3.0))
    d = vec8(f64(4.0))
    e = vec8(f64(5.0))
    f = vec8(f64(6.0))
    g = vec8(f64(7.0))
    h = vec8(f64(8.0))
    for _ in range(steps):
        a = a * factor + one
        b = b * factor + one
        c = c * factor + one
        d = d * factor + one
        e = e * factor + one
        f = f * factor + one
        g = g * factor + one
        h = h * factor + one
    sum_out[i] = a + b + c + d + e + f + g + h


@wp.kernel
def copy(
    # in
    source: wp.array(dtype=f64),
    # out
    copy_out: wp.array(dtype=f64),
):
    """One stream read, one written."""
    i = wp.tid()
    copy_out[i] = source[i]


class Ceiling(NamedTuple):
    """Most float64 operations (a multiply-add counts two) and bytes (read plus written) per second.

    Of one thread on a CPU, of the whole device on CUDA.
    """

    flops: float
    bytes: float


@cache
def ceiling(device: str) -> Ceiling:
    """Measure both, once a process: medians of five rounds."""
    on_cpu = wp.get_device(device).is_cpu
    threads, steps = (1, STEPS) if on_cpu else (CUDA_THREADS, STEPS // 100)
    sums = wp.zeros(threads, dtype=vec8, device=device)
    source, target = (wp.ones(COPIED, dtype=f64, device=device) for _ in range(2))
    add_s = _seconds(device, multiply_add, threads, [steps, f64(0.5)], [sums])
    copy_s = _seconds(device, copy, COPIED, [source], [target])
    return Ceiling(2.0 * CHAINS * steps * threads / add_s, 16.0 * COPIED / copy_s)


def _seconds(device: str, kernel: Any, dim: int, inputs: list[Any], outputs: list[Any]) -> float:
    """Median time of a launch: CPU time of the thread, wall time on CUDA; the first launch only warms up."""
    clock = process_time if wp.get_device(device).is_cpu else perf_counter
    times = []
    for _ in range(ROUNDS + 1):
        started = clock()
        wp.launch(kernel, dim=dim, inputs=inputs, outputs=outputs, device=device)
        wp.synchronize_device(device)
        times.append(clock() - started)
    return median(times[1:])
