# A Scene: what states are about until the next one. The program's axes and units.
extends Reference

const Protocol = preload("protocol.gd")

var session = 0
var program_version = ""
var scene_name = ""
var hand_name = ""
var exercise_name = ""
var exercise_json = ""   # what the exercise tells its front end
var joint_names = []
var value_names = []
var event_names = []
var fault_names = []
var axes = []            # {name, unit, lower, upper, effort_limit}
var links = []           # {name, parent, joint, type, axis, position_m, orientation}; parents come first
var capsules = []        # {name, link, a_m, b_m, radius_m}
var bodies = []          # {name, fixed, color, shapes}
var parameters = []      # {name, unit, lower, upper, initial}


# False where the message is damaged; then nothing of it is to be used.
func read(reader, table: int) -> bool:
	var f = Protocol.Scene
	session = reader.u32_of(table, f.session)
	program_version = reader.text_of(table, f.program_version)
	scene_name = reader.text_of(table, f.scene_name)
	hand_name = reader.text_of(table, f.hand_name)
	exercise_name = reader.text_of(table, f.exercise_name)
	exercise_json = reader.text_of(table, f.exercise_json)
	joint_names = reader.texts_of(table, f.joint_names)
	value_names = reader.texts_of(table, f.value_names)
	event_names = reader.texts_of(table, f.event_names)
	fault_names = reader.texts_of(table, f.fault_names)
	axes = _read_all(reader, table, f.axes, "_read_axis")
	links = _read_all(reader, table, f.links, "_read_link")
	capsules = _read_all(reader, table, f.capsules, "_read_capsule")
	bodies = _read_all(reader, table, f.bodies, "_read_body")
	parameters = _read_all(reader, table, f.parameters, "_read_parameter")
	return not reader.broken


func _read_all(reader, table: int, slot: int, how: String) -> Array:
	var all = []
	var first = reader.vector(table, slot, 4)
	for i in range(reader.count_of(first)):
		all.append(call(how, reader, reader.follow(first + 4 * i)))
		if reader.broken:
			break
	return all


func _read_axis(reader, table: int) -> Dictionary:
	var f = Protocol.Axis
	return {
		"name": reader.text_of(table, f.name),
		"unit": reader.text_of(table, f.unit),
		"lower": reader.float_of(table, f.lower),
		"upper": reader.float_of(table, f.upper),
		"effort_limit": reader.float_of(table, f.effort_limit),
	}


func _read_link(reader, table: int) -> Dictionary:
	var f = Protocol.Link
	var at_zero = reader.field(table, f.at_zero)
	return {
		"name": reader.text_of(table, f.name),
		"parent": reader.i16_of(table, f.parent),
		"joint": reader.i16_of(table, f.joint),
		"type": reader.u8_of(table, f.type),
		"axis": reader.vector3(reader.field(table, f.axis)),
		"position_m": _position(reader, at_zero),
		"orientation": _orientation(reader, at_zero),
	}


func _read_capsule(reader, table: int) -> Dictionary:
	var f = Protocol.Capsule
	return {
		"name": reader.text_of(table, f.name),
		"link": reader.i16_of(table, f.link),
		"a_m": reader.vector3(reader.field(table, f.a_m)),
		"b_m": reader.vector3(reader.field(table, f.b_m)),
		"radius_m": reader.float_of(table, f.radius_m),
	}


func _read_body(reader, table: int) -> Dictionary:
	var f = Protocol.Body
	return {
		"name": reader.text_of(table, f.name),
		"fixed": reader.u8_of(table, f.fixed) != 0,
		"color": reader.text_of(table, f.color),
		"shapes": _read_all(reader, table, f.shapes, "_read_shape"),
	}


func _read_shape(reader, table: int) -> Dictionary:
	var f = Protocol.Shape
	var in_body = reader.field(table, f.in_body)
	var points = []
	var first = reader.vector(table, f.points_m, Protocol.Vec3.SIZE)
	for i in range(reader.count_of(first)):
		points.append(reader.vector3(first + i * Protocol.Vec3.SIZE))
	var triangles = []
	first = reader.vector(table, f.triangles, 4)
	for i in range(reader.count_of(first)):
		triangles.append(reader.u32(first + 4 * i))
	return {
		"type": reader.u8_of(table, f.type),
		"half_extents_m": reader.vector3(reader.field(table, f.half_extents_m)),
		"radius_m": reader.float_of(table, f.radius_m),
		"length_m": reader.float_of(table, f.length_m),
		"points_m": points,
		"triangles": triangles,
		"position_m": _position(reader, in_body),
		"orientation": _orientation(reader, in_body),
	}


func _read_parameter(reader, table: int) -> Dictionary:
	var f = Protocol.Parameter
	return {
		"name": reader.text_of(table, f.name),
		"unit": reader.text_of(table, f.unit),
		"lower": reader.float_of(table, f.lower),
		"upper": reader.float_of(table, f.upper),
		"initial": reader.float_of(table, f.initial),
	}


func _position(reader, pose: int) -> Vector3:
	return Vector3() if pose == 0 else reader.vector3(pose + Protocol.Pose.position_m)


func _orientation(reader, pose: int) -> Quat:
	return Quat() if pose == 0 else reader.quat(pose + Protocol.Pose.orientation_xyzw)
