"""Recorded datasets as tables of pandas and xarray, which are imported only here."""
from __future__ import annotations

import typing

import numpy

if typing.TYPE_CHECKING:
    import pandas
    import xarray

    from wholehand.recording import Recording


def _texts(values: typing.Any) -> list[str]:
    return [value.decode() for value in numpy.atleast_1d(values)]


def _names(recording: Recording, names: tuple[str, ...]) -> typing.Sequence[str]:
    """Datasets of /ticks, by default all that have numbers for every row."""
    chosen = names or sorted(recording.ticks)
    for name in chosen:
        if f"ticks/{name}" not in recording:
            raise KeyError(f"{name}: there is no such dataset in /ticks; there are {', '.join(sorted(recording.ticks))}")
    return chosen


def _units(dataset: typing.Any) -> str | list[str]:
    """One text for each column, or one for all."""
    units = _texts(dataset.attrs["units"])
    return units[0] if len(units) == 1 else units


def to_pandas(recording: Recording, *names: str) -> pandas.DataFrame:
    """A DataFrame of datasets of /ticks: rows by time_s, columns (dataset, label); `attrs["units"]` has their units.
    Bodies have the label "cube px"."""
    import pandas
    columns, units, rows = {}, {}, recording.rows()
    for name in _names(recording, names):
        dataset = recording[f"ticks/{name}"]
        values = dataset[:rows].reshape(rows, -1)
        labels = _texts(dataset.attrs["labels"]) if "labels" in dataset.attrs else [""]
        if "columns" in dataset.attrs:
            labels = [f"{label} {column}" for label in labels for column in _texts(dataset.attrs["columns"])]
        unit = numpy.resize(numpy.atleast_1d(_units(dataset)), len(labels))
        for i, label in enumerate(labels):
            columns[name, label] = values[:, i]
            units[name, label] = str(unit[i])
    index = pandas.Index(recording["ticks/time_s"][:rows], name="time_s")
    frame = pandas.DataFrame(columns, index=index)
    frame.attrs["units"] = units
    return frame


def to_xarray(recording: Recording, *names: str) -> xarray.Dataset:
    """A Dataset of datasets of /ticks, over time_s and their column dimension (axis, joint, body, ...)."""
    import xarray
    meta = recording.meta
    known = {tuple(_texts(meta[key])): key.split("_")[0] for key in ("axis_names", "joint_names", "body_names")
             if len(numpy.atleast_1d(meta[key]))}
    variables, rows = {}, recording.rows()
    coordinates: dict[str, typing.Any] = {"time_s": ("time_s", recording["ticks/time_s"][:rows], {"units": "s"})}
    for name in _names(recording, names):
        if name == "time_s":
            continue
        dataset, dims = recording[f"ticks/{name}"], ["time_s"]
        for key in ("labels", "columns"):
            if key in dataset.attrs:
                labels = _texts(dataset.attrs[key])
                dims.append(known.get(tuple(labels), f"{name}_{key}"))
                coordinates[dims[-1]] = labels
        variables[name] = (dims, dataset[:rows], {"units": _units(dataset)})
    return xarray.Dataset(variables, coordinates, {"title": _texts(meta["title"])[0], "period_s": float(meta["period_s"])})
