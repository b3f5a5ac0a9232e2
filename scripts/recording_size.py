#!/usr/bin/python3
"""What each dataset of recordings costs [MB a minute of ticks], largest first. Needs python3-h5py.

    scripts/recording_size.py run.h5 ...
"""
import os
import sys

import h5py


def sizes(file):
    """{name: (stored bytes, bytes of its numbers)}"""
    found = {}

    def note(name, item):
        if isinstance(item, h5py.Dataset):
            found[name] = (item.id.get_storage_size(), item.size * item.dtype.itemsize)

    file.visititems(note)
    return found


def tell(path):
    with h5py.File(path, "r", libver="latest", swmr=True) as file:
        minutes = len(file["ticks/tick"]) * file["meta"].attrs["period_s"] / 60.0
        found = sizes(file)
        schema = file["meta"].attrs["schema_version"]
    if minutes == 0.0:
        sys.exit(f"{path}: holds no ticks; record a run that lasts a while")
    scale = 1e-6 / minutes
    print(f"{path}: schema {schema}, {60.0 * minutes:.1f} s")
    for name, (stored, numbers) in sorted(found.items(), key=lambda entry: -entry[1][0]):
        if stored > 0:
            print(f"{stored * scale:9.3f} MB/min  {100.0 * stored / numbers:5.1f} %  {name}")
    total, all_numbers = (sum(column) for column in zip(*found.values()))
    size = os.path.getsize(path)
    print(f"{total * scale:9.3f} MB/min  {100.0 * total / all_numbers:5.1f} %  all datasets")
    print(f"{(size - total) * scale:9.3f} MB/min           indices, texts, and room that rewritten chunks left")
    print(f"{size * scale:9.3f} MB/min           the file")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    for argument in sys.argv[1:]:
        tell(argument)
