"""A disk that refuses what a recording writes: full, over its quota, read-only, broken, gone. The loop goes on, the loss
is told while it lasts and at the end, and every tick that was written is read."""
import errno
import re
import signal
import unittest

from faulty_disk import LIBRARY, FaultyDisk
from app import FREE_RUN, HANG_S, INTERRUPTED, AppTest, loop_sleeps, main, read_recording

NEVER = 2**64 - 1  # docs/recording.md: a tick that never reached the disk
SOUND_TICKS = 1500  # before the disk fails; and, where it mends, after that
WRITES = ("pwrite", "fallocate", "fsync")


@unittest.skipUnless(LIBRARY, "without the library that makes a disk fail")
class FailingDisk(AppTest):
    def wait_for_ticks(self, run):
        before = loop_sleeps(run.pid)
        self.wait_until(run, lambda: loop_sleeps(run.pid) >= before + SOUND_TICKS)

    def run_over(self, error, ends):
        """A run whose disk fails while it renders; all that it said, and the ticks of its files."""
        (self.folder / "rec").mkdir()
        disk = FaultyDisk(self.folder)
        run = self.start_app(*FREE_RUN, "--duration", 600, "--no-rehearsal", "--record", "rec/run.h5",
                             env=disk.environment(self.folder / "rec"))
        self.wait_for_ticks(run)
        disk.fail(error, *WRITES)
        said = ""
        while "ticks are missing" not in said:  # told while it lasts
            line = run.stdout.readline()
            self.assertTrue(line, said)
            said += line
        self.assertIsNone(run.poll(), said)
        if ends:
            disk.fail(0)
        self.wait_for_ticks(run)
        run.send_signal(signal.SIGTERM)
        rest, complained = run.communicate(timeout=HANG_S)
        self.assertEqual(run.returncode, INTERRUPTED, said + rest + complained)
        ticks = set()  # the chunk that failed may lie in the file and in its next part
        for name in self.names_in(self.folder / "rec"):
            if name.endswith(".h5"):
                with read_recording(self.folder / "rec" / name) as recording:
                    ticks.update(t for t in recording["ticks/tick"] if t != NEVER)
        return said + rest, ticks

    def check(self, error, ends=True):
        with self.subTest(errno.errorcode[error], ends=ends):
            said, ticks = self.run_over(error, ends)
            self.assertIn("faults   none", said)
            self.assertRegex(said, r"dropped +\d+ records: the disk was full, refused them or was too slow")
            dropped = int(said.split("dropped ")[1].split()[0])
            ticks_due, missed = (int(n) for n in re.search(r"(\d+) ticks, (\d+) deadline", said).groups())
            self.assertGreaterEqual(len(ticks), ticks_due - missed - dropped, "a tick that was written is not read")
            self.assertGreater(len(ticks), 500)  # a chunk of 250 may wait in memory when the disk fails

    def test_that_breaks_and_mends(self):
        self.check(errno.EIO)

    def test_that_is_full(self):
        self.check(errno.ENOSPC)

    def test_that_is_beyond_its_quota(self):
        self.check(errno.EDQUOT)

    def test_that_becomes_read_only_for_good(self):
        self.check(errno.EROFS, ends=False)

    def test_that_is_taken_away_for_good(self):
        self.check(errno.ENODEV, ends=False)


if __name__ == "__main__":
    main()
