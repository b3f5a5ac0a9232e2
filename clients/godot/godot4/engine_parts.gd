# Parts of Godot 4 that Godot 3 has otherwise than by another name: clients/godot/addons/wholehand/engine_parts.gd is the
# same for it.
extends RefCounted


# Of CapsuleMesh, whose axis is y, and whose height is that of the whole. `length` is between the centres of the caps.
static func set_capsule_size(mesh: CapsuleMesh, radius: float, length: float) -> void:
	mesh.radius = radius # first: it raises the height where that is less than twice itself
	mesh.height = length + 2.0 * radius


# A rotation that leads the axis of a CapsuleMesh to `along`. @param side a unit vector at right angles to it
static func capsule_basis(along: Vector3, side: Vector3) -> Basis:
	return Basis(side, along, side.cross(along))


# Begins triangles whose normals are their own.
static func begin_sharp(surface: SurfaceTool) -> void:
	surface.begin(Mesh.PRIMITIVE_TRIANGLES)
	surface.set_smooth_group(-1) # flat; group 0, the default, is smooth


# From the first byte to the last one, both included.
static func part_of(bytes: PackedByteArray, first: int, last: int) -> PackedByteArray:
	return bytes.slice(first, last + 1)
