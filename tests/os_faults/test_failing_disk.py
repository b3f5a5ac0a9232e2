"""A disk that refuses writes of a recording: full, over its quota, read-only, broken, gone. The loop continues, the
loss is reported while it lasts and at the end, and every written tick can be read."""
import errno
import re
import signal
import unittest

from faulty_disk import LIBRARY, FaultyDisk
from app import FREE_RUN, HANG_S, INTERRUPTED, AppTest, loop_sleeps, main, read_recording

NEVER = 2**64 - 1  # docs/recording.md: a tick that never reached the disk
SOUND_TICKS = 1500  # ticks before the disk fails, and after a recovery
WRITES = ("pwrite", "fallocate", "fsync")


@unittest.skipUnless(LIBRARY, "without the library that makes a disk fail")
class FailingDisk(AppTest):
    def wait_for_ticks(self, run):
        before = loop_sleeps(run.pid)
        self.wait_until(run, lambda: loop_sleeps(run.pid) >= before + SOUND_TICKS)

    def run_over(self, error, ends):
        """Runs the program with a disk that fails during rendering. Returns its output and the ticks of its files."""
        kept = self.folder / errno.errorcode[error]
        kept.mkdir()
        disk = FaultyDisk(self.folder)
        run = self.start_app(*FREE_RUN, "--duration", 600, "--no-rehearsal", "--record", kept / "run.h5",
                             env=disk.environment(kept))
        self.wait_for_ticks(run)
        disk.fail(error, *WRITES)
        said = ""
        while "ticks are missing" not in said:  # reported while the disk fails
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
        ticks = set()  # the failed chunk may be both in the file and in its next part
        for name in self.names_in(kept):
            if name.endswith(".h5"):
                with read_recording(kept / name) as recording:
                    ticks.update(t for t in recording["ticks/tick"] if t != NEVER)
        return said + rest, ticks

    def check(self, error, ends):
        said, ticks = self.run_over(error, ends)
        self.assertIn("faults   none", said)
        self.assertRegex(said, r"dropped +\d+ records: the disk was full, refused them or was too slow")
        dropped = int(said.split("dropped ")[1].split()[0])
        ticks_due, missed = (int(n) for n in re.search(r"(\d+) ticks, (\d+) deadline", said).groups())
        self.assertGreaterEqual(len(ticks), ticks_due - missed - dropped, "a tick that was written is not read")
        self.assertGreater(len(ticks), 500)  # a chunk of 250 may wait in memory when the disk fails

    def test_every_disk_error_keeps_the_loop_running_and_every_written_tick_readable(self):
        for error, ends in ((errno.EIO, True), (errno.ENOSPC, True), (errno.EDQUOT, True), (errno.EROFS, False),
                            (errno.ENODEV, False)):
            with self.subTest(errno.errorcode[error], ends=ends):
                self.check(error, ends)


if __name__ == "__main__":
    main()
