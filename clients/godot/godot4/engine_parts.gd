# Functions that Godot 3 has in another form: clients/godot/addons/wholehand/engine_parts.gd has the same
# ones for Godot 3.
extends RefCounted


# A CapsuleMesh, whose axis is y, and whose height is the total one. `length` is the distance between the centres of the
# caps.
static func set_capsule_size(mesh: CapsuleMesh, radius: float, length: float) -> void:
	mesh.radius = radius # set first: it raises the height if that is less than twice the radius
	mesh.height = length + 2.0 * radius


# A rotation from the axis of a CapsuleMesh to `along`. @param side a unit vector perpendicular to it
static func capsule_basis(along: Vector3, side: Vector3) -> Basis:
	return Basis(side, along, side.cross(along))


# Begins triangles with flat normals.
static func begin_sharp(surface: SurfaceTool) -> void:
	surface.begin(Mesh.PRIMITIVE_TRIANGLES)
	surface.set_smooth_group(-1) # flat; the default group 0 is smooth


# Part of a byte array, from the first to the last index, both included.
static func part_of(bytes: PackedByteArray, first: int, last: int) -> PackedByteArray:
	return bytes.slice(first, last + 1)
