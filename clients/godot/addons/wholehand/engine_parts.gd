# Functions that Godot 4 has in another form: clients/godot/godot4/engine_parts.gd has the same ones for Godot 4.
extends Reference


# A CapsuleMesh, whose axis is z. `length` is the distance between the centres of the caps.
static func set_capsule_size(mesh: CapsuleMesh, radius: float, length: float) -> void:
	mesh.radius = radius
	mesh.mid_height = length


# A rotation from the axis of a CapsuleMesh to `along`. @param side a unit vector perpendicular to it
static func capsule_basis(along: Vector3, side: Vector3) -> Basis:
	return Basis(side, along.cross(side), along)


# Begins triangles with flat normals.
static func begin_sharp(surface: SurfaceTool) -> void:
	surface.begin(Mesh.PRIMITIVE_TRIANGLES)


# Part of a byte array, from the first to the last index, both included.
static func part_of(bytes: PoolByteArray, first: int, last: int) -> PoolByteArray:
	return bytes.subarray(first, last)
