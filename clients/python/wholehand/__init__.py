"""Wholehand from Python.

    import wholehand
    run = wholehand.open("run.h5")                  # numpy, pandas, xarray: wholehand.recording

    from wholehand.client import Client             # a running program: blocking
    from wholehand.connection import connect        # the same with asyncio

    from wholehand.rig import Rig, VectorRig        # the renderer inside this process, simulated

Each module imports its own dependencies; this one has none. SI units, radians. World frame: right-handed, x away
from the person, y left, z up.
"""
from __future__ import annotations

import os
import typing

if typing.TYPE_CHECKING:
    from wholehand.recording import Recording

__version__ = "0.1.0"


def open(path: str | os.PathLike[str]) -> Recording:
    """Opens a recording for reading, also one that is still being written or was cut off. Needs h5py."""
    from wholehand.recording import Recording
    return Recording(path)
