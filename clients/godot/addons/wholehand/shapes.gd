# Meshes of the shapes of a scene, and shapes of bodies to spawn, in Godot's axes [m].
extends Reference

const Axes = preload("axes.gd")
const Parts = preload("engine_parts.gd")
const Protocol = preload("protocol.gd")

const SEGMENTS = 16
const RINGS = 3


# Null for an unknown shape, or if triangles have invalid vertex indices.
static func mesh_of(shape: Dictionary) -> Mesh:
	match shape.type:
		Protocol.ShapeType.Box:
			var box = CubeMesh.new()
			box.size = 2.0 * Axes.to_godot(shape.half_extents_m).abs()
			return box
		Protocol.ShapeType.Sphere:
			var sphere = SphereMesh.new()
			sphere.radial_segments = SEGMENTS
			sphere.rings = 2 * RINGS + 1 # one of them at the equator
			sphere.radius = shape.radius_m
			sphere.height = 2.0 * shape.radius_m
			return sphere
		Protocol.ShapeType.Cylinder:
			var cylinder = CylinderMesh.new()
			cylinder.radial_segments = SEGMENTS
			cylinder.top_radius = shape.radius_m
			cylinder.bottom_radius = shape.radius_m
			cylinder.height = shape.length_m
			return cylinder
		Protocol.ShapeType.Capsule:
			return capsule(shape.radius_m, shape.length_m)
		Protocol.ShapeType.ConvexMesh:
			return _convex(shape)
	return null


# A capsule along the axis that capsule_turn() rotates; `length` is the distance between the centres of the caps.
static func capsule(radius: float, length: float) -> Mesh:
	var mesh = CapsuleMesh.new()
	# With Godot's 64 segments a hand takes a quarter of a second, and the program takes the controls from a game that
	# is silent for so long.
	mesh.radial_segments = SEGMENTS
	mesh.rings = RINGS
	Parts.set_capsule_size(mesh, radius, length)
	return mesh


# The rotation from a mesh's own axes to those of the shape: Wholehand's capsules lie along its z, which is Godot's y.
static func turn_of(shape: Dictionary) -> Basis:
	return capsule_turn(Vector3.UP) if shape.type == Protocol.ShapeType.Capsule else Basis()


# A rotation from the axis of a capsule's mesh to `along`.
static func capsule_turn(direction: Vector3) -> Basis:
	if direction.length() < 1e-9:
		return Basis()
	var along = direction.normalized()
	var side = along.cross(Vector3.UP if abs(along.y) < 0.9 else Vector3.RIGHT).normalized()
	return Parts.capsule_basis(along, side)


static func instance(mesh: Mesh, material: Material) -> MeshInstance:
	var node = MeshInstance.new()
	node.mesh = mesh
	node.material_override = material
	return node


# The game's own material, or one of this colour.
static func material_of(material: Material, color: Color) -> Material:
	if material != null:
		return material
	var made = SpatialMaterial.new()
	made.albedo_color = color
	return made


# Edges are sharp: every triangle has its own vertices. Godot needs them clockwise, seen from outside.
static func _convex(shape: Dictionary) -> Mesh:
	var corners = PoolVector3Array()
	for i in range(0, shape.triangles.size() - 2, 3):
		for corner in [2, 1, 0]:
			var point = shape.triangles[i + corner]
			if point >= shape.points_m.size():
				return null
			corners.append(Axes.to_godot(shape.points_m[point]))
	if corners.empty():
		return null
	var tool_of_mesh = SurfaceTool.new()
	Parts.begin_sharp(tool_of_mesh)
	for corner in corners:
		tool_of_mesh.add_vertex(corner)
	tool_of_mesh.generate_normals()
	return tool_of_mesh.commit()


# ---- pieces of bodies to spawn, for prepare_shapes(). Cylinders and capsules lie along Godot's y ----

static func box_piece(size: Vector3) -> Dictionary:
	return {"type": Protocol.ShapeType.Box, "half_extents_m": 0.5 * Axes.from_godot(size).abs()}


static func ball_piece(radius: float) -> Dictionary:
	return {"type": Protocol.ShapeType.Sphere, "radius_m": radius}


static func cylinder_piece(radius: float, height: float) -> Dictionary:
	return {"type": Protocol.ShapeType.Cylinder, "radius_m": radius, "length_m": height}


# `length` is the distance between the centres of the caps.
static func capsule_piece(radius: float, length: float) -> Dictionary:
	return {"type": Protocol.ShapeType.Capsule, "radius_m": radius, "length_m": length}


# A convex and closed piece. `triangles` are three indices of points for each, in either winding order.
static func convex_piece(points: Array, triangles: Array) -> Dictionary:
	var points_m = []
	for point in points:
		points_m.append(Axes.from_godot(point))
	return {"type": Protocol.ShapeType.ConvexMesh, "points_m": points_m, "triangles": triangles}


# The piece at another pose in the body's frame.
static func piece_at(piece: Dictionary, at: Transform) -> Dictionary:
	var placed = piece.duplicate()
	placed["position_m"] = Axes.from_godot(at.origin)
	placed["orientation"] = Axes.quat_from_godot(at.basis.get_rotation_quat())
	return placed
