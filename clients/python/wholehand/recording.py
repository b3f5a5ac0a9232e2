"""Reads recordings of Wholehand: a subclass of h5py's File, with conversion to tables.

    f = wholehand.open("run.h5")
    time_s, sent = f["ticks/time_s"][:], f["ticks/sent"][:]
    frame, data = f.to_pandas("q_m", "sent"), f.to_xarray("bodies")
"""
from __future__ import annotations

import os
import typing

import h5py

from wholehand import tables

if typing.TYPE_CHECKING:
    import pandas
    import xarray

SCHEMAS = (9, 10, 11)


class Recording(h5py.File):  # type: ignore[misc]
    """A recording, opened for reading, also one that is still being written or was cut off."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        super().__init__(path, "r", libver="latest", swmr=True)
        self.meta = self["meta"].attrs
        version = self.meta["schema_version"]
        if version not in SCHEMAS:
            self.close()
            remedy = "update it" if version > SCHEMAS[-1] else "read it with a package of its time"
            raise ValueError(f"{path}: schema_version = {version}: this package reads versions "
                             f"{SCHEMAS[0]} to {SCHEMAS[-1]}: {remedy}")
        self.ticks = self["ticks"]

    def rows(self) -> int:
        """Number of ticks that every dataset of /ticks has; after a killed program some datasets are longer."""
        return min(len(dataset) for dataset in self.ticks.values())

    def to_pandas(self, *names: str) -> pandas.DataFrame:
        """A DataFrame of datasets of /ticks, by default of all: see tables.to_pandas."""
        return tables.to_pandas(self, *names)

    def to_xarray(self, *names: str) -> xarray.Dataset:
        """A Dataset of datasets of /ticks, by default of all: see tables.to_xarray."""
        return tables.to_xarray(self, *names)
