"""Wholehand from Python.

    import wholehand
    run = wholehand.open("run.h5")                  # numpy, pandas, xarray: wholehand.recording

    from wholehand.client import Client             # a running program: blocking
    from wholehand.connection import connect        # the same with asyncio

    from wholehand.rig import Rig, VectorRig        # the renderer inside this process, simulated

SI units, radians. World frame: right-handed, x away from the person, y left, z up.
"""
from wholehand.recording import Recording


def open(path):
    """A recording, for reading; one that is still written or was cut off, too."""
    return Recording(path)
