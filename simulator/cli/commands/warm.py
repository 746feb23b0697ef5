"""`utak warm`: compile the geometry kernels, so that no run has to wait for them."""

import argparse

from utak.geometry.kernels.jit import kernel_status
from utak.simulator.run.warming import count_cached_kernels, warm_all
from utak.simulator.terminal import exits


def execute(options: argparse.Namespace) -> int:
    """Compile all kernels and print their number."""
    warm_all()
    count, cache_is_writable = kernel_status()
    if not count:
        print("nothing to compile: NUMBA_DISABLE_JIT is set")
    elif cache_is_writable:
        print(f"{count_cached_kernels()} kernels are compiled, and kept for the next runs")
    else:
        print(f"{count} kernels are compiled, but not kept: set NUMBA_CACHE_DIR to a folder that can be written")
    return exits.SUCCESS
