"""A disk whose power can be cut: an image behind /dev/fuse, on a loop device, with ext4. It keeps the writes since the
last flush separately, like the cache of a drive: cut() gives the image of the last flush with a random part of the
later writes. Needs root."""
import ctypes
import os
import pathlib
import struct
import subprocess
import threading

CLONE_NEWNS = 0x20000
MS_REC, MS_PRIVATE = 0x4000, 1 << 18
GETATTR, SETATTR, OPEN, READ, WRITE, STATFS, RELEASE, FSYNC, FLUSH, INIT, INTERRUPT, FORGET = \
    3, 4, 14, 15, 16, 17, 18, 20, 25, 26, 36, 2  # linux/fuse.h
ENOSYS = 38
LARGEST_WRITE = 1 << 17
BLOCK = 512

libc = ctypes.CDLL(None, use_errno=True)


def called(result, what):
    if result != 0:
        raise OSError(ctypes.get_errno(), f"{what}: {os.strerror(ctypes.get_errno())}")


def run(*command):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True)
    if done.returncode != 0:
        raise OSError(f"{' '.join(map(str, command))}: {done.stderr.strip()}")
    return done.stdout


def own_mounts():
    """Hides the mounts of this process from others; they end with the process."""
    called(libc.unshare(CLONE_NEWNS), "unshare")
    called(libc.mount(None, b"/", None, MS_REC | MS_PRIVATE, None), "mount --make-rprivate /")


class Disk:
    def __init__(self, folder, size):
        """Mounts a new ext4 at folder/disk. Raises OSError if this machine does not allow it. @pre own_mounts()"""
        self.image, self.files = folder / "image", folder / "disk"
        self.image.touch()
        self.files.mkdir()
        self.bytes, self.flushed, self.since = bytearray(size), bytearray(size), []
        self.lock = threading.Lock()
        self.flushes = 0
        self.kernel = os.open("/dev/fuse", os.O_RDWR)
        options = f"fd={self.kernel},rootmode=100600,user_id=0,group_id=0"
        called(libc.mount(b"power", bytes(self.image), b"fuse", 0, options.encode()), "mount of fuse")
        threading.Thread(target=self._serve, daemon=True).start()
        run("mkfs.ext4", "-q", "-F", self.image)
        run("mount", "-o", "loop", self.image, self.files)

    def remove(self):
        subprocess.run(["umount", self.files], capture_output=True)
        subprocess.run(["umount", "-l", self.image], capture_output=True)

    def cut(self, draw, to):
        """Writes the image that a power cut would leave at this moment to a file."""
        with self.lock:
            left, since = bytearray(self.flushed), list(self.since)
        kept = draw.choice((0.0, 0.1, 0.5, 0.9, 1.0))  # share of the sectors that the drive has written
        for at, data in since:
            for sector in range(0, len(data), BLOCK):
                if draw.random() < kept:
                    left[at + sector:at + sector + BLOCK] = data[sector:sector + BLOCK]
        to.write_bytes(left)

    def _serve(self):
        while True:
            try:
                asked = os.read(self.kernel, LARGEST_WRITE + 4096)
            except OSError:
                return  # the disk was unmounted
            _, what, unique = struct.unpack_from("<IIQ", asked)
            if what in (INTERRUPT, FORGET):
                continue
            error, said = self._answer(what, asked[40:])
            os.write(self.kernel, struct.pack("<IiQ", 16 + len(said), -error, unique) + said)

    def _answer(self, what, body):
        if what == INIT:
            return 0, struct.pack("<IIIIHHIIHHI28x", 7, 31, 0, 0, 16, 12, LARGEST_WRITE, 1, 0, 0, 0)
        if what in (GETATTR, SETATTR):
            attributes = struct.pack("<6Q3I7I", 1, len(self.bytes), len(self.bytes) // 512, 0, 0, 0, 0, 0, 0, 0o100600, 1,
                                     0, 0, 0, 4096, 0)
            return 0, struct.pack("<QII", 1000, 0, 0) + attributes
        if what == OPEN:
            return 0, struct.pack("<QII", 0, 0, 0)
        if what == READ:
            at, size = struct.unpack_from("<QI", body, 8)
            return 0, bytes(self.bytes[at:at + size])
        if what == WRITE:
            at, size = struct.unpack_from("<QI", body, 8)
            data = bytes(body[40:40 + size])
            with self.lock:
                self.bytes[at:at + size] = data
                self.since.append((at, data))
            return 0, struct.pack("<II", size, 0)
        if what == FSYNC:
            with self.lock:
                for at, data in self.since:
                    self.flushed[at:at + len(data)] = data
                self.since = []
                self.flushes += 1
            return 0, b""
        if what == STATFS:
            return 0, bytes(80)
        if what in (RELEASE, FLUSH):
            return 0, b""
        return ENOSYS, b""


class Found:
    """The files after a power cut: mounts the image, which replays ext4's journal."""

    def __init__(self, image, at):
        self.at = pathlib.Path(at)
        self.at.mkdir(exist_ok=True)
        run("mount", "-o", "loop", image, self.at)

    def __enter__(self):
        return self.at

    def __exit__(self, *_):
        run("umount", self.at)
