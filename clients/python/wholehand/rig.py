"""Rigs with a simulated device inside this process, stepped on the simulated clock.

    from wholehand.rig import Rig
    rig = Rig()                          # the six-axis device, four shapes, a recorded reach
    rig.step(n=100)                      # 0.1 s; the virtual patient plays the motion
    aim = rig.q_s.copy()
    aim[rig.axis_names.index("z")] -= 0.02
    rig.step(aim, n=200)                 # steered, as by the order Aim of a client

Needs the module _rig: the package python3-wholehand, or a build with pybind11-dev and python3-dev.
"""
from __future__ import annotations

import hashlib
import os
import pathlib
import struct
import types
import typing

import numpy
import numpy.typing

try:
    from wholehand._rig import BadInput, RunEnded
    from wholehand._rig import Rig as _Rig
    from wholehand._rig import VectorRig as _VectorRig
except ImportError as error:
    raise ImportError(f"{error}; wholehand.rig needs the module _rig, which a build makes where pybind11-dev and python3-dev "
                      "are installed, for Debian's /usr/bin/python3") from error

__all__ = ["BadInput", "Rig", "RunEnded", "VectorRig", "shipped"]

Path = typing.Union[str, "os.PathLike[str]"]


def shipped(relative: str) -> str:
    """Path of a shipped file ("config/scenes/table.toml"): relative to the working directory, else to the folders above this
    package. The name itself where there is none, so that the error names it."""
    if os.path.exists(relative):
        return relative
    for folder in pathlib.Path(__file__).resolve().parents:
        for share in (folder, folder / "share/wholehand"):
            if os.path.exists(share / relative):
                return str(share / relative)
    return relative


def _text(name: str, value: typing.Any) -> str:
    """A path as a text; None is an empty one."""
    if isinstance(value, os.PathLike):
        value = os.fspath(value)
    if isinstance(value, bytes):
        value = os.fsdecode(value)
    if value is not None and not isinstance(value, str):
        raise TypeError(f"{name} = {value!r:.100}: must be a path, or the name of a shipped file")
    return value or ""


def _file(name: str, value: Path | None, folder: str, suffix: str = ".toml") -> str:
    """A path as it is; a name alone is that of a shipped file."""
    text = _text(name, value)
    if not text and name in ("device", "hand", "patient"):
        raise ValueError(f"{name} = {value!r}: must be a path, or the name of a shipped file")
    if not text or "/" in text or text.endswith(suffix):
        return text
    return shipped(f"{folder}/{text}{suffix}")


def _gains(device: str) -> str:
    """The file of the device's name in the folder `rendering` beside the device's, else the shipped one."""
    beside = pathlib.Path(device).parent.parent / "rendering" / pathlib.Path(device).name
    return str(beside) if os.path.exists(beside) else shipped(f"config/rendering/{beside.name}")


def _files(device: Path, hand: Path, scene: Path | None, exercise: Path | None, patient: Path, rendering: Path | None,
           motion: Path | None) -> dict[str, str]:
    if exercise is not None and (scene is not None or motion is not None):
        raise ValueError(f"exercise = {_text('exercise', exercise)!r}: cannot go with scene or motion: it names its own scene; "
                         "leave one of them out")
    device_file = _file("device", device, "config/devices")
    scene_file = _file("scene", _text("scene", scene) or "four-shapes", "config/scenes")
    if exercise is None and motion is None and scene_file == shipped("config/scenes/four-shapes.toml"):
        motion = "reach-grasp-00"  # a hand at rest would begin within a body of that scene
    return {"device": device_file, "hand": _file("hand", hand, "config/hands"),
            "scene": scene_file, "exercise": _file("exercise", exercise, "config/exercises"),
            "patient": _file("patient", patient, "config/patients"),
            "rendering": _file("rendering", rendering, "config/rendering") if rendering is not None else _gains(device_file),
            "motion": _file("motion", motion, "data/human-motion", ".csv")}


# A saved state: these bytes, the digest of all after it, its counts, and what _history() and _end() say.
_MARK = b"wholehand rig 1\n"
_COUNTS = struct.Struct("<QQQ")  # seed, steps, aims


class Rig(_Rig):
    """A rig: simulated device, hand, scene, physics. Files are paths, or names of shipped ones.

    Arrays are read-only views of memory that the rig owns: valid as long as one of them lives, and overwritten by the next
    step() or reset(); copy what is kept. Positions in m or rad by axis, efforts in N or N·m.

    It can be pickled and copied (copy.deepcopy): as by save() and restore().
    """

    def __init__(self, device: Path = "lambda-pride", *, hand: Path = "adult-median-right", scene: Path | None = None,
                 exercise: Path | None = None, level: int = 1, patient: Path = "relaxed-adult",
                 rendering: Path | None = None, motion: Path | None = None, engine: str = "", rate_hz: float = 1000.0,
                 uncertified: bool = False, seed: int = 0) -> None:
        """Without scene and exercise: four-shapes. That scene's motion is reach-grasp-00 where none is named.
        @param exercise names its own scene @param motion recorded motion that the virtual patient plays; None: rests
        @param rendering gains (default: those of the device's name) @param engine "": the default one
        @param uncertified allow gains that are not certified @param seed as of reset()"""
        self._arguments: dict[str, typing.Any] = {
            "device": device, "hand": hand, "scene": scene, "exercise": exercise, "level": level, "patient": patient,
            "rendering": rendering, "motion": motion, "engine": engine, "rate_hz": rate_hz, "uncertified": uncertified}
        super().__init__(**_files(device, hand, scene, exercise, patient, rendering, motion), level=level, engine=engine,
                         rate_hz=rate_hz, uncertified=uncertified, seed=seed)

    # Methods of Python, since one of pybind11 answers wrong names and numbers of arguments with its signature.

    def reset(self, seed: int = 0) -> None:
        """Begins anew: bodies, hand, exercise. @param seed of the virtual patient who does the exercise"""
        super().reset(seed)

    def step(self, aim: numpy.typing.ArrayLike | None = None, n: int = 1) -> int:
        """Runs n ticks; other Python threads run meanwhile. Returns the ticks that ran: fewer than n if a fault ended the run,
        after which a step raises RunEnded.
        @param aim pose that the hand is steered to, one value for each axis [m or rad], as by the order Aim of a client; None:
        the virtual patient moves the hand"""
        return super().step(aim, n)

    def close(self) -> None:
        """Ends the run and frees its world; arrays stay as they are. reset() begins anew."""
        super().close()

    def save(self) -> bytes:
        """The state: what was asked of the rig since reset(), and a digest of where that led. Raises RunEnded once closed,
        and RuntimeError after more than a million steps with aims."""
        seed, ticks, aims = self._history()
        said = _COUNTS.pack(seed, len(ticks), len(aims)) + ticks.tobytes() + aims.tobytes() + self._end()
        return _MARK + hashlib.sha256(said).digest() + said

    def restore(self, state: bytes) -> None:
        """Goes to a state that save() returned, to the bit, by running again: as long as the run took. Raises ValueError for
        a state that is damaged, or of other files or another program; then the rig has begun anew."""
        if not isinstance(state, (bytes, bytearray, memoryview)):
            raise TypeError(f"state = {state!r:.100}: must be the bytes that Rig.save() returned")
        state = bytes(state)
        said = state[len(_MARK) + 32:]
        if not state.startswith(_MARK) or len(said) < _COUNTS.size or _MARK + hashlib.sha256(said).digest() + said != state:
            raise ValueError("the state is damaged, or none that Rig.save() returned")
        seed, steps, numbers = _COUNTS.unpack_from(said)
        ticks = numpy.frombuffer(said, numpy.int64, steps, _COUNTS.size)
        aims = numpy.frombuffer(said, numpy.float64, numbers, _COUNTS.size + ticks.nbytes)
        self._run_again(seed, ticks, aims)
        if self._end() != said[_COUNTS.size + ticks.nbytes + aims.nbytes:]:
            ran = self.tick
            self.reset(seed)
            raise ValueError(f"the state was saved with other files or by another program: tick {ran} differs")

    def __enter__(self) -> Rig:
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | types.TracebackType | None) -> None:
        self.close()

    def __reduce__(self) -> tuple[typing.Any, ...]:
        return _again, (type(self), self._arguments, self.save())

    def __repr__(self) -> str:
        named = {name: value for name, value in self._arguments.items() if value not in (None, "", False)}
        running = "runs" if self.running else self.ended_by or "closed"
        return f"<Rig {', '.join(f'{name}={value!s}' for name, value in named.items())}: {self.time_s:.3f} s, {running}>"

    def _end(self) -> bytes:
        """A digest of the last tick."""
        last = (numpy.uint64(self.tick), self.q_m, self.q_s, self.qd_s, self.theta, self.sent, self.bodies, self.exercise_values)
        return hashlib.sha256(b"".join(array.tobytes() for array in last)).digest()


def _again(kind: type[Rig], arguments: dict[str, typing.Any], state: bytes) -> Rig:
    rig = kind(**arguments)
    rig.restore(state)
    return rig


class VectorRig(_VectorRig):
    """n rigs of the same files, stepped side by side on threads. Arrays have a leading dimension n.

    A rig whose run has ended stands still, and `running` is False, until it is reset. Results do not depend on `threads`.
    """

    def __init__(self, n: int, device: Path = "lambda-pride", *, threads: int | None = None,
                 hand: Path = "adult-median-right", scene: Path | None = None, exercise: Path | None = None, level: int = 1,
                 patient: Path = "relaxed-adult", rendering: Path | None = None, motion: Path | None = None, engine: str = "",
                 rate_hz: float = 1000.0, uncertified: bool = False, seed: int = 0) -> None:
        """As Rig. @param threads default: as many as this process may use processors @param seed of rig 0; rig i begins
        with seed + i"""
        super().__init__(n, threads=threads if threads is not None else len(os.sched_getaffinity(0)),
                         **_files(device, hand, scene, exercise, patient, rendering, motion), level=level, engine=engine,
                         rate_hz=rate_hz, uncertified=uncertified, seed=seed)

    def reset(self, seeds: typing.Sequence[int] | numpy.typing.NDArray[numpy.integer[typing.Any]]) -> None:
        """Begins all anew, with a seed for each."""
        super().reset(seeds)

    def reset_one(self, rig: int, seed: int = 0) -> None:
        """Begins one rig anew."""
        super().reset_one(rig, seed)

    def step(self, aim: numpy.typing.ArrayLike | None = None, n: int = 1) -> None:
        """Runs n ticks of every rig that runs. @param aim (rigs, axes); None: virtual patients move the hands"""
        super().step(aim, n)
