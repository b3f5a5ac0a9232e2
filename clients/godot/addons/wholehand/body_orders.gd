# Fields of orders to bodies, for writer.gd. The program's axes and units.
extends Reference

const Protocol = preload("protocol.gd")


# @param pieces dictionaries like those of a body of the scene: type (Protocol.ShapeType), half_extents_m, radius_m,
# length_m, points_m, triangles, position_m, orientation; missing entries are 0, or no rotation.
static func pieces(pieces: Array) -> Array:
	var tables = []
	for piece in pieces:
		tables.append(_piece(piece))
	return tables


# @param bodies dictionaries: slot, generation, shape_set, owner (Protocol.BodyOwner), mass_kg, friction, position_m,
# orientation, velocity_m_s, refuse_overlap; defaults: generation 1, owner Loop, 0.1 kg, friction 0.8.
static func spawned(bodies: Array) -> Array:
	var tables = []
	for body in bodies:
		tables.append(_spawned(body))
	return tables


# @param bodies [slot, generation], ...
static func named(bodies: Array) -> Array:
	var structs = []
	for body in bodies:
		structs.append([["u32", body[0]], ["u32", body[1]]])
	return structs


# @param bodies [slot, generation, position, orientation], ...; the orientation is optional
static func placed(bodies: Array) -> Array:
	var structs = []
	for body in bodies:
		structs.append([["u32", body[0]], ["u32", body[1]]] + _pose(body[2], body[3] if body.size() > 3 else Quat()))
	return structs


# @param bodies [slot, generation, owner], ...
static func handed_over(bodies: Array) -> Array:
	var structs = []
	for body in bodies:
		structs.append([["u32", body[0]], ["u32", body[1]], ["u8", body[2]]])
	return structs


static func _piece(piece: Dictionary) -> Array:
	var f = Protocol.Shape
	var fields = [
		[f.type, "u8", piece.type],
		[f.half_extents_m, "struct", _triple(piece.get("half_extents_m", Vector3()))],
		[f.radius_m, "f32", piece.get("radius_m", 0.0)],
		[f.length_m, "f32", piece.get("length_m", 0.0)],
		[f.in_body, "struct", _pose(piece.get("position_m", Vector3()), piece.get("orientation", Quat()))],
	]
	if piece.has("points_m"):
		var points = []
		for point in piece.points_m:
			points.append(_triple(point))
		fields.append([f.points_m, "structs", points])
		fields.append([f.triangles, "u32s", piece.get("triangles", [])])
	return fields


static func _spawned(body: Dictionary) -> Array:
	var f = Protocol.SpawnBody
	return [
		[f.slot, "u16", body.slot],
		[f.generation, "u32", body.get("generation", 1)],
		[f.shape_set, "u16", body.shape_set],
		[f.owner, "u8", body.get("owner", Protocol.BodyOwner.Loop)],
		[f.mass_kg, "f32", body.get("mass_kg", 0.1)],
		[f.friction, "f32", body.get("friction", 0.8)],
		[f.pose, "struct", _pose(body.position_m, body.get("orientation", Quat()))],
		[f.velocity_m_s, "struct", _triple(body.get("velocity_m_s", Vector3()))],
		[f.refuse_overlap, "u8", int(body.get("refuse_overlap", false))],
	]


static func _triple(v: Vector3) -> Array:
	return [["f32", v.x], ["f32", v.y], ["f32", v.z]]


static func _pose(position: Vector3, q: Quat) -> Array:
	return _triple(position) + [["f32", q.x], ["f32", q.y], ["f32", q.z], ["f32", q.w]]
