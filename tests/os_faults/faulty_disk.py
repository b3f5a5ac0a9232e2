"""A disk that hangs or fails under a program, by disk_faults.cpp. Importing this makes the modules of tests/apps
importable."""
import mmap
import os
import pathlib
import shutil
import struct
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "apps"))

LIBRARY = os.environ.get("WHOLEHAND_DISK_FAULTS")  # built beside the program
CALLS = ("open", "read", "pwrite", "stat", "fsync", "fallocate")  # in the order of disk_faults.cpp


class FaultyDisk:
    """Controls disk_faults.cpp."""

    def __init__(self, folder, ms=0):
        self.path = folder / "faults"
        self.path.write_bytes(bytes(4096))
        with open(self.path, "r+b") as file:
            self.memory = mmap.mmap(file.fileno(), 4096)
        library = shutil.copy(LIBRARY, folder)  # LD_PRELOAD accepts no path with a space
        self.preload = {"LD_PRELOAD": library, "DISK_CONTROL": str(self.path), "DISK_MS": str(ms)}

    def environment(self, *folders):
        """Environment of a program for which these folders are on the faulty disk."""
        return dict(os.environ, **self.preload, DISK_FOLDERS=":".join(map(str, folders)))

    def hang(self, *calls):
        self.fail(0, *calls)

    def fail(self, error, *calls):
        """Makes these calls fail with this errno; without calls the disk works again."""
        struct.pack_into("<I", self.memory, 16, error)
        struct.pack_into("<I", self.memory, 0, sum(1 << CALLS.index(c) for c in calls))

    def _word(self, index):
        return struct.unpack_from("<I", self.memory, 4 * index)[0]

    @property
    def hanging(self):
        return self._word(1)

    @property
    def ever(self):
        return self._word(2)

    @property
    def loaded(self):
        """Number of processes that have loaded the library."""
        return self._word(3)
