# Reads tables by their fields, and the shapes of bodies. The program's axes and units.
extends Reference

const Protocol = preload("protocol.gd")

# The function of reader.gd that reads each field.
const SHAPE = {"type": "u8_of", "half_extents_m": "vector3_of", "radius_m": "float_of", "length_m": "float_of"}


func _fields(reader, table: int, slots: Dictionary, how: Dictionary) -> Dictionary:
	var values = {}
	for name in how:
		values[name] = reader.call(how[name], table, slots[name])
	return values


func _read_all(reader, table: int, slot: int, how: String) -> Array:
	var all = []
	var first = reader.vector(table, slot, 4)
	for i in range(reader.count_of(first)):
		all.append(call(how, reader, reader.follow(first + 4 * i)))
		if reader.broken:
			break
	return all


func _read_shape(reader, table: int) -> Dictionary:
	var f = Protocol.Shape
	var shape = _fields(reader, table, f, SHAPE)
	shape["points_m"] = []
	var first = reader.vector(table, f.points_m, Protocol.Vec3.SIZE)
	for i in range(reader.count_of(first)):
		shape["points_m"].append(reader.vector3(first + i * Protocol.Vec3.SIZE))
	shape["triangles"] = []
	first = reader.vector(table, f.triangles, 4)
	for i in range(reader.count_of(first)):
		shape["triangles"].append(reader.u32(first + 4 * i))
	_add_pose(reader, reader.field(table, f.in_body), shape)
	return shape


# `position_m` and `orientation` of a Pose; an absent one is at the origin, without rotation.
func _add_pose(reader, pose: int, to: Dictionary) -> void:
	to["position_m"] = Vector3() if pose == 0 else reader.vector3(pose + Protocol.Pose.position_m)
	to["orientation"] = Quat() if pose == 0 else reader.quat(pose + Protocol.Pose.orientation_xyzw)
