"""Limits of the machine, set for a while."""

import resource
from contextlib import contextmanager


@contextmanager
def files_no_larger_than(size):
    """Meanwhile no file of this process takes more than so many bytes; pytest's own output may be one, so be brief."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
