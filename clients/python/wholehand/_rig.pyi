# The module _rig in C++ (clients/python/module); wholehand.rig has its classes with default files.
from typing import Any, Dict, Generic, List, Optional, Sequence, Tuple, TypeVar, Union

import numpy
import numpy.typing

_Reals = numpy.typing.NDArray[numpy.float64]
_Whole = numpy.typing.NDArray[numpy.integer[Any]]
_Aim = Optional[numpy.typing.ArrayLike]
_R = TypeVar("_R")  # one real number: float of a Rig, an array of a VectorRig
_I = TypeVar("_I")  # one whole number

class BadInput(ValueError):
    """A file or an option that the program refuses, in its words: file, key, value, remedy."""
    diagnostics: List[Dict[str, Any]]  # file, line, key, value, problem, remedy

class RunEnded(RuntimeError):
    """A step after a fault has ended the run."""

class _State(Generic[_R, _I]):
    """Facts of the rig, and the record of its last tick. Arrays are read-only views, overwritten by the next step() or
    reset(); what is one number is a number of a Rig, and an array of n of a VectorRig. Arrays of a VectorRig have a
    leading dimension n. docs/recording.md says what every field means.
    """
    @property
    def axis_names(self) -> List[str]: ...
    @property
    def axis_units(self) -> List[str]: ...  # "m" or "rad"
    @property
    def lower(self) -> _Reals: ...  # range of the axes [m or rad]
    @property
    def upper(self) -> _Reals: ...
    @property
    def speed_limit(self) -> _Reals: ...  # [m/s or rad/s]
    @property
    def effort_limit(self) -> _Reals: ...  # [N or N·m]
    @property
    def joint_names(self) -> List[str]: ...
    @property
    def body_names(self) -> List[str]: ...  # of the scene; `bodies` has the first 128
    @property
    def value_names(self) -> List[str]: ...  # of exercise_values, with their units
    @property
    def period_s(self) -> float: ...
    @property
    def engine(self) -> str: ...
    @property
    def tick(self) -> _I: ...  # 0 before and after the first tick
    @property
    def time_s(self) -> _R: ...
    @property
    def elapsed_periods(self) -> _I: ...  # 1 + periods skipped before the tick
    @property
    def faults(self) -> _I: ...  # bits of the last tick
    @property
    def moved_by(self) -> _I: ...  # 0 nobody, 1 a person, 2 the virtual patient, 3 a motion
    @property
    def help(self) -> _I: ...  # 0 unspecified, 1 full, 2 some, 3 none
    @property
    def command_count(self) -> _I: ...
    @property
    def safety_state(self) -> _I: ...  # 0 disarmed, 1 armed, 2 rendering, 3 faulted
    @property
    def fault_axis(self) -> _I: ...  # first axis beyond a limit; -1: none
    @property
    def parameters(self) -> _Reals: ...  # live parameters in force
    @property
    def authority(self) -> _R: ...
    @property
    def palm_distance_m(self) -> _R: ...
    @property
    def palm_body(self) -> _I: ...  # nearest target of the exercise; -1: none
    @property
    def palm_target_distance_m(self) -> _R: ...
    @property
    def coupling_error_rad(self) -> _R: ...
    @property
    def contact_count(self) -> _I: ...
    @property
    def contacts_dropped(self) -> _I: ...
    @property
    def body_count(self) -> _I: ...
    @property
    def event_count(self) -> _I: ...
    @property
    def q_m(self) -> _Reals: ...  # the device [m or rad]
    @property
    def qd_mf(self) -> _Reals: ...
    @property
    def intention(self) -> _Reals: ...
    @property
    def patient_effort(self) -> _Reals: ...
    @property
    def q_s(self) -> _Reals: ...  # the simulated hand, before the tick's step
    @property
    def qd_s(self) -> _Reals: ...
    @property
    def theta(self) -> _Reals: ...  # joints of the simulated hand
    @property
    def f_s(self) -> _Reals: ...
    @property
    def coupling(self) -> _Reals: ...
    @property
    def phi(self) -> _Reals: ...
    @property
    def damping(self) -> _Reals: ...
    @property
    def tank(self) -> _Reals: ...  # energy left in the tank of each axis [J]
    @property
    def tank_effort(self) -> _Reals: ...
    @property
    def rendered(self) -> _Reals: ...
    @property
    def sent(self) -> _Reals: ...  # effort that the device received [N or N·m]
    @property
    def exercise_effort(self) -> _Reals: ...
    @property
    def alpha(self) -> _R: ...  # of the transition
    @property
    def wall_active(self) -> numpy.typing.NDArray[numpy.bool_]: ...
    @property
    def wall(self) -> _Reals: ...
    @property
    def closure(self) -> _Reals: ...  # axis position at its first touch of the body in reach; NaN: none
    @property
    def exercise_values(self) -> _Reals: ...
    @property
    def bodies(self) -> numpy.typing.NDArray[numpy.void]: ...  # structured: position_m, orientation_xyzw, velocities
    @property
    def body_q(self) -> _Reals: ...  # positions of the joints of bodies, by ascending body [m or rad]
    @property
    def body_qd(self) -> _Reals: ...
    @property
    def contacts(self) -> numpy.typing.NDArray[numpy.void]: ...  # of the last step; VectorRig: valid up to contact_count

class Rig(_State[float, int]):
    def __init__(self, *, device: str, hand: str, scene: str, exercise: str, level: int, patient: str, rendering: str,
                 motion: str, engine: str, rate_hz: float, uncertified: bool, seed: int) -> None: ...
    def reset(self, seed: int = 0) -> None:
        """Begins anew: bodies, hand, exercise. seed: of the virtual patient who does the exercise."""
    def step(self, aim: _Aim = None, n: int = 1) -> int:
        """Runs n ticks; other Python threads run meanwhile.

        aim: the pose that the hand is steered to, one value for each axis [m or rad], as by the order Aim of a client;
        without one the virtual patient moves the hand. Returns the ticks that ran: fewer than n if a fault ended the
        run, after which a step raises RunEnded."""
    def close(self) -> None:
        """Ends the run and frees its world; arrays stay as they are. reset() begins anew."""
    def _history(self) -> Tuple[int, numpy.typing.NDArray[numpy.int64], _Reals]:
        """What was asked since reset(): its seed; ticks of each steered step, minus those of each stretch that was not;
        aims of the steered steps one after another."""
    def _run_again(self, seed: int, ticks: Union[Sequence[int], numpy.typing.NDArray[numpy.int64]], aims: _Reals) -> None: ...
    @property
    def running(self) -> bool: ...
    @property
    def ended_by(self) -> str: ...  # names of the faults that ended the run

class VectorRig(_State[_Reals, _Whole]):
    def __init__(self, n: int, *, threads: int, device: str, hand: str, scene: str, exercise: str, level: int, patient: str,
                 rendering: str, motion: str, engine: str, rate_hz: float, uncertified: bool, seed: int) -> None: ...
    def __len__(self) -> int: ...
    def reset(self, seeds: Union[Sequence[int], numpy.typing.NDArray[numpy.integer[Any]]]) -> None:
        """Begins all anew, with a seed for each."""
    def reset_one(self, rig: int, seed: int = 0) -> None: ...
    def step(self, aim: _Aim = None, n: int = 1) -> None:
        """Runs n ticks of every rig that runs. aim: (rigs, axes)."""
    @property
    def threads(self) -> int: ...
    @property
    def running(self) -> numpy.typing.NDArray[numpy.bool_]: ...
    @property
    def ended_by(self) -> List[str]: ...
