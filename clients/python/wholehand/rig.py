"""Rigs with a simulated device inside this process, stepped on the simulated clock.

    from wholehand.rig import Rig
    rig = Rig()                          # the six-axis device, four shapes, a recorded reach
    rig.step(n=100)                      # 0.1 s; the virtual patient plays the motion
    aim = rig.q_s.copy()
    aim[rig.axis_names.index("z")] -= 0.02
    rig.step(aim, n=200)                 # steered, as by the order Aim of a client

Needs the module _rig: the package python3-wholehand, or a build with pybind11-dev and python3-dev.
"""
import os
import pathlib

try:
    from wholehand._rig import BadInput, RunEnded
    from wholehand._rig import Rig as _Rig
    from wholehand._rig import VectorRig as _VectorRig
except ImportError as error:
    raise ImportError(f"{error}; wholehand.rig needs the module _rig, which a build makes where pybind11-dev and python3-dev "
                      "are installed, for Debian's /usr/bin/python3") from error

__all__ = ["BadInput", "Rig", "RunEnded", "VectorRig", "shipped"]


def shipped(relative: str) -> str:
    """Path of a shipped file ("config/scenes/table.toml"): relative to the working directory, else to the folders above this
    package. The name itself where there is none, so that the error names it."""
    if os.path.exists(relative):
        return relative
    for folder in pathlib.Path(__file__).resolve().parents:
        for share in (folder, folder / "share/wholehand"):
            if (share / relative).exists():
                return str(share / relative)
    return relative


def _file(value: "str | os.PathLike[str] | None", folder: str, suffix: str = ".toml") -> str:
    """A path as it is; a name alone is that of a shipped file."""
    text = os.fspath(value) if value is not None else ""
    if not text or "/" in text or text.endswith(suffix):
        return text
    return shipped(f"{folder}/{text}{suffix}")


def _gains(device: str) -> str:
    """The file of the device's name in the folder `rendering` beside the device's, else the shipped one."""
    beside = pathlib.Path(device).parent.parent / "rendering" / pathlib.Path(device).name
    return str(beside) if beside.exists() else shipped(f"config/rendering/{beside.name}")


def _files(device: "str | os.PathLike[str]", hand: "str | os.PathLike[str]", scene: "str | os.PathLike[str] | None",
           exercise: "str | os.PathLike[str] | None", patient: "str | os.PathLike[str]",
           rendering: "str | os.PathLike[str] | None", motion: "str | os.PathLike[str] | None") -> "dict[str, str]":
    if exercise is not None and (scene is not None or motion is not None):
        raise ValueError(f"exercise = {os.fspath(exercise)!r}: cannot go with scene or motion: it names its own scene; "
                         "leave one of them out")
    device_file = _file(device, "config/devices")
    if scene is None and exercise is None and motion is None:
        motion = "reach-grasp-00"
    return {"device": device_file, "hand": _file(hand, "config/hands"),
            "scene": _file(scene or "four-shapes", "config/scenes"), "exercise": _file(exercise, "config/exercises"),
            "patient": _file(patient, "config/patients"),
            "rendering": _file(rendering, "config/rendering") if rendering is not None else _gains(device_file),
            "motion": _file(motion, "data/human-motion", ".csv")}


class Rig(_Rig):
    """A rig: simulated device, hand, scene, physics. Files are paths, or names of shipped ones.

    Arrays are read-only views of memory that the rig owns: valid as long as one of them lives, and overwritten by the next
    step() or reset(); copy what is kept. Positions in m or rad by axis, efforts in N or N·m.
    """

    def __init__(self, device: "str | os.PathLike[str]" = "lambda-pride", *,
                 hand: "str | os.PathLike[str]" = "adult-median-right", scene: "str | os.PathLike[str] | None" = None,
                 exercise: "str | os.PathLike[str] | None" = None, level: int = 1,
                 patient: "str | os.PathLike[str]" = "relaxed-adult", rendering: "str | os.PathLike[str] | None" = None,
                 motion: "str | os.PathLike[str] | None" = None, engine: str = "", rate_hz: float = 1000.0,
                 uncertified: bool = False, seed: int = 0) -> None:
        """Without scene, exercise and motion: four-shapes with the motion reach-grasp-00.
        @param exercise names its own scene @param motion recorded motion that the virtual patient plays; None: rests
        @param rendering gains (default: those of the device's name) @param engine "": the default one
        @param uncertified allow gains that are not certified @param seed as of reset()"""
        super().__init__(**_files(device, hand, scene, exercise, patient, rendering, motion), level=level, engine=engine,
                         rate_hz=rate_hz, uncertified=uncertified, seed=seed)


class VectorRig(_VectorRig):
    """n rigs of the same files, stepped side by side on threads. Arrays have a leading dimension n.

    A rig whose run has ended stands still, and `running` is False, until it is reset. Results do not depend on `threads`.
    """

    def __init__(self, n: int, device: "str | os.PathLike[str]" = "lambda-pride", *, threads: "int | None" = None,
                 hand: "str | os.PathLike[str]" = "adult-median-right", scene: "str | os.PathLike[str] | None" = None,
                 exercise: "str | os.PathLike[str] | None" = None, level: int = 1,
                 patient: "str | os.PathLike[str]" = "relaxed-adult", rendering: "str | os.PathLike[str] | None" = None,
                 motion: "str | os.PathLike[str] | None" = None, engine: str = "", rate_hz: float = 1000.0,
                 uncertified: bool = False, seed: int = 0) -> None:
        """As Rig. @param threads default: as many as this process may use processors @param seed of rig 0; rig i begins
        with seed + i"""
        super().__init__(n, threads=threads if threads is not None else len(os.sched_getaffinity(0)),
                         **_files(device, hand, scene, exercise, patient, rendering, motion), level=level, engine=engine,
                         rate_hz=rate_hz, uncertified=uncertified, seed=seed)
