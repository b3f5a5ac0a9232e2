"""Poses of the hand's links from Scene.links and joint positions."""
from __future__ import annotations

import numpy
import numpy.typing

from wholehand.messages import Reals, Structs, Table

PRISMATIC, REVOLUTE, FIXED = 0, 1, 2


def rotations(xyzw: numpy.typing.ArrayLike) -> Reals:
    """Unit quaternions (..., 4) as rotation matrices (..., 3, 3)."""
    x, y, z, w = numpy.moveaxis(numpy.asarray(xyzw, float), -1, 0)
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    return numpy.moveaxis(numpy.array(rows), (0, 1), (-2, -1))


def matrices(poses: Structs) -> Reals:
    """Poses of a state (state.links, state.bodies) as homogeneous matrices (n, 4, 4)."""
    out = numpy.zeros((len(poses), 4, 4))
    out[:, :3, :3] = rotations(poses["orientation_xyzw"])
    out[:, :3, 3] = poses["position_m"]
    out[:, 3, 3] = 1.0
    return out


class Hand:
    """The tree of links that a scene describes."""

    def __init__(self, scene: Table) -> None:
        self.links = scene.links
        self.names = [link.name for link in self.links]
        self.joint_names = scene.joint_names
        self._parents = [link.parent for link in self.links]
        self._joints = [link.joint for link in self.links]
        self._types = [link.type for link in self.links]
        self._axes = [numpy.array(link.axis, float) for link in self.links]
        self._at_zero = matrices(numpy.array([link.at_zero for link in self.links]))

    def link_poses(self, theta: numpy.typing.ArrayLike) -> Reals:
        """Poses in the world. @param theta joint positions [rad or m], (..., joints) @return (..., links, 4, 4)"""
        theta = numpy.asarray(theta, float)
        if theta.shape[-1] != len(self.joint_names):
            raise ValueError(f"theta has {theta.shape[-1]} joints; this hand has {len(self.joint_names)}")
        poses = numpy.zeros((*theta.shape[:-1], len(self.links), 4, 4))
        for i, parent in enumerate(self._parents):
            pose = self._at_zero[i] if parent < 0 else poses[..., parent, :, :] @ self._at_zero[i]
            if self._joints[i] >= 0:
                pose = pose @ self._motion(i, theta[..., self._joints[i]])
            poses[..., i, :, :] = pose
        return poses

    def _motion(self, link: int, theta: Reals) -> Reals:
        """The rotation of a link by its joint, in its own frame."""
        motion = numpy.zeros((*theta.shape, 4, 4))
        motion[..., :, :] = numpy.eye(4)
        if self._types[link] == PRISMATIC:
            motion[..., :3, 3] = theta[..., None] * self._axes[link]
        if self._types[link] == REVOLUTE:
            half = 0.5 * theta[..., None]
            motion[..., :3, :3] = rotations(numpy.concatenate([numpy.sin(half) * self._axes[link], numpy.cos(half)], -1))
        return motion
