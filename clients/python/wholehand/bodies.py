"""Bodies of a game: the arguments of its orders (docs/protocol.md, "Bodies of a game").

SI units. Positions are those of the centre of mass, in the world; quaternions are x, y, z, w.
"""
from __future__ import annotations

import dataclasses
import typing

import flatbuffers
import numpy
import numpy.typing

from wholehand.messages import made
# Imported at start-up: no heartbeat is sent while an order is being made.
from wholehand.protocol import BodyHandover, BodyName, BodyPlace, BodyTargets, Pose, Remove, SetOwner, SpawnBody, Teleport, Vec3
from wholehand.protocol import Shape as ShapeTable

LOOP, GAME, FIXED = range(3)  # SpawnBody.owner
BOX, SPHERE, CYLINDER, CAPSULE, CONVEX_MESH = range(5)
UPRIGHT = (0.0, 0.0, 0.0, 1.0)
Vector = typing.Union[typing.Sequence[float], numpy.typing.NDArray[typing.Any]]
Vectors = typing.Union[typing.Sequence[Vector], numpy.typing.NDArray[typing.Any]]
Put = typing.Callable[[flatbuffers.Builder], typing.Any]  # writes a part of an order; returns its offset in the message
EVENTS = ("appeared", "solid", "letting_go", "left", "quarantined", "refused", "touched")


@dataclasses.dataclass(frozen=True)
class Shape:
    """A piece of a body, made by box(), ball(), cylinder(), capsule() or mesh(). Cylinder and capsule lie along z."""
    type: int
    half_extents_m: Vector = (0.0, 0.0, 0.0)
    radius_m: float = 0.0
    length_m: float = 0.0
    points_m: Vectors = ()
    triangles: typing.Union[typing.Sequence[typing.Sequence[int]], numpy.typing.NDArray[typing.Any]] = ()
    position_m: Vector = (0.0, 0.0, 0.0)  # in the body's frame
    orientation_xyzw: Vector = UPRIGHT


def box(size_m: Vector, **place: typing.Any) -> Shape:
    return Shape(BOX, half_extents_m=tuple(0.5 * numpy.asarray(size_m, float)), **place)


def ball(radius_m: float, **place: typing.Any) -> Shape:
    return Shape(SPHERE, radius_m=radius_m, **place)


def cylinder(radius_m: float, height_m: float, **place: typing.Any) -> Shape:
    return Shape(CYLINDER, radius_m=radius_m, length_m=height_m, **place)


def capsule(radius_m: float, length_m: float, **place: typing.Any) -> Shape:
    """@param length_m distance between the centres of its caps"""
    return Shape(CAPSULE, radius_m=radius_m, length_m=length_m, **place)


def mesh(points_m: Vectors, triangles: typing.Sequence[typing.Sequence[int]], **place: typing.Any) -> Shape:
    """A convex and closed mesh. @param points_m (n, 3) @param triangles (m, 3) indices of points"""
    return Shape(CONVEX_MESH, points_m=points_m, triangles=triangles, **place)


@dataclasses.dataclass(frozen=True)
class Body:
    """A body to spawn. `generation` distinguishes successive bodies of the slot."""
    slot: int
    shape_set: int
    position_m: Vector
    orientation_xyzw: Vector = UPRIGHT
    generation: int = 1
    owner: int = LOOP
    mass_kg: float = 0.1
    friction: float = 0.8
    velocity_m_s: Vector = (0.0, 0.0, 0.0)
    refuse_overlap: bool = False


@dataclasses.dataclass(frozen=True)
class BodyEvent:
    """An event of a body. `generation` is 0 for the name "refused", which has a `refusal`. "touched" has the impulse on
    the hand [N·s] of the first 10 ms of the contact. `body` is (slot, generation), or (number, generation) if the game
    named it by a number: such a body also appears and leaves when it gets a slot and gives it back."""
    name: str
    tick: int
    slot: int
    generation: int
    refusal: str = ""
    impulse_ns: float = 0.0
    body: typing.Tuple[int, ...] = ()


def event_of(name: str, event: typing.Any, refusals: dict[int, str], generations: dict[int, int],
             names: dict[int, tuple[int, int]]) -> BodyEvent:
    """@param refusals names of the schema's BodyRefusal @param generations generations by slot, which "touched" lacks
    @param names names of bodies beyond the slots, by their present or last slot"""
    slot, value = int(event["index"]), float(event["value"])
    generation = {"touched": generations.get(slot, 0), "refused": 0}.get(name, int(value))
    return BodyEvent(name, int(event["tick"]), slot, generation,
                     refusal=refusals.get(int(value), str(int(value))) if name == "refused" else "",
                     impulse_ns=value if name == "touched" else 0.0, body=names.get(slot, (slot, generation)))


# The name of a body in orders.
Name = typing.Tuple[int, int]
Place = typing.Union[typing.Tuple[int, int, Vector], typing.Tuple[int, int, Vector, Vector]]
Handover = typing.Tuple[int, int, int]

# Orders whose `bodies` are structs.
ORDERS = {"Remove": Remove, "Teleport": Teleport, "SetOwner": SetOwner, "BodyTargets": BodyTargets}


def _vector(builder: flatbuffers.Builder, order: str, items: typing.Sequence[typing.Any],
            put: typing.Callable[[typing.Any], typing.Any]) -> typing.Any:
    """A vector of structs: `put(item)` appends one."""
    getattr(ORDERS[order], f"{order}StartBodiesVector")(builder, len(items))
    for item in reversed(items):
        put(item)
    return builder.EndVector()


def _table_vector(builder: flatbuffers.Builder, tables: list[int]) -> typing.Any:
    builder.StartVector(4, len(tables), 4)
    for table in reversed(tables):
        builder.PrependUOffsetTRelative(table)
    return builder.EndVector()


def _triple(values: Vector) -> Put:
    return lambda builder: Vec3.CreateVec3(builder, *map(float, values))


def _placed(body: Shape | Body) -> Put:
    return lambda builder: Pose.CreatePose(builder, *map(float, body.position_m), *map(float, body.orientation_xyzw))


def _shape(builder: flatbuffers.Builder, shape: Shape) -> typing.Any:
    corners = {}
    if len(shape.points_m):
        points = numpy.asarray(shape.points_m, float).reshape(-1, 3)
        ShapeTable.ShapeStartPointsMVector(builder, len(points))
        for point in points[::-1]:
            _triple(point)(builder)
        corners = {"points_m": builder.EndVector(),
                   "triangles": builder.CreateNumpyVector(numpy.asarray(shape.triangles, "<u4").reshape(-1))}
    return made(builder, ShapeTable, type=shape.type, half_extents_m=_triple(shape.half_extents_m), radius_m=shape.radius_m,
                length_m=shape.length_m, **corners, in_body=_placed(shape))


def _spawned(builder: flatbuffers.Builder, body: Body) -> typing.Any:
    return made(builder, SpawnBody, slot=body.slot, generation=body.generation, shape_set=body.shape_set, owner=body.owner,
                mass_kg=body.mass_kg, friction=body.friction, pose=_placed(body),
                velocity_m_s=_triple(body.velocity_m_s), refuse_overlap=body.refuse_overlap)


# Each of these makes a vector of an order, for messages.encode(): a function of the builder.


def pieces(shapes: typing.Sequence[Shape]) -> Put:
    return lambda builder: _table_vector(builder, [_shape(builder, shape) for shape in shapes])


def spawned(bodies: typing.Sequence[Body]) -> Put:
    return lambda builder: _table_vector(builder, [_spawned(builder, body) for body in bodies])


def named(order: str, bodies: typing.Sequence[Name]) -> Put:
    """@param bodies (slot, generation), ..."""
    return lambda builder: _vector(
        builder, order, bodies, lambda body: BodyName.CreateBodyName(builder, *body))


def placed(order: str, bodies: typing.Sequence[Place]) -> Put:
    """@param bodies (slot, generation, position_m[, orientation_xyzw]), ..."""
    def put(builder: flatbuffers.Builder, slot: int, generation: int, position_m: Vector,
            orientation_xyzw: Vector = UPRIGHT) -> None:
        BodyPlace.CreateBodyPlace(builder, slot, generation, *map(float, position_m), *map(float, orientation_xyzw))
    return lambda builder: _vector(builder, order, bodies, lambda body: put(builder, *body))


def handed_over(order: str, bodies: typing.Sequence[Handover]) -> Put:
    """@param bodies (slot, generation, owner), ..."""
    return lambda builder: _vector(
        builder, order, bodies, lambda body: BodyHandover.CreateBodyHandover(builder, *body))
