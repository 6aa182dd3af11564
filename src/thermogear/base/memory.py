"""How much memory this machine has left."""

from __future__ import annotations

import os

SHARE = 0.7
"""A run may take this share of the free memory."""


def free_bytes() -> int:
    """Memory [bytes] that is free now; what is installed where the system does not say."""
    try:
        with open("/proc/meminfo", encoding="ascii") as file:
            for line in file:
                if line.startswith("MemAvailable:"):
                    return int(line.split()[1]) * 1024
    except OSError:
        pass  # no such file outside Linux
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
