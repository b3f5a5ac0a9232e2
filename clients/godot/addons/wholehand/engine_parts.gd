# Parts of Godot 3 that Godot 4 has otherwise than by another name: clients/godot/godot4/engine_parts.gd is the same for it.
extends Reference


# Of CapsuleMesh, whose axis is z. `length` is between the centres of the caps.
static func set_capsule_size(mesh: CapsuleMesh, radius: float, length: float) -> void:
	mesh.radius = radius
	mesh.mid_height = length


# A rotation that leads the axis of a CapsuleMesh to `along`. @param side a unit vector at right angles to it
static func capsule_basis(along: Vector3, side: Vector3) -> Basis:
	return Basis(side, along.cross(side), along)


# Begins triangles whose normals are their own.
static func begin_sharp(surface: SurfaceTool) -> void:
	surface.begin(Mesh.PRIMITIVE_TRIANGLES)


# From the first byte to the last one, both included.
static func part_of(bytes: PoolByteArray, first: int, last: int) -> PoolByteArray:
	return bytes.subarray(first, last)
