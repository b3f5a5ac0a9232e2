# A Scene: the description that states refer to until the next scene. The program's axes and units.
extends "shape_reader.gd"

var session = 0
var program_version = ""
var scene_name = ""
var hand_name = ""
var exercise_name = ""
var exercise_json = ""   # the exercise's description for front ends
var joint_names = []
var value_names = []
var event_names = []
var fault_names = []
var axes = []            # {name, unit, lower, upper, effort_limit}
var links = []           # {name, parent, joint, type, axis, position_m, orientation}; parents come first
var capsules = []        # {name, link, a_m, b_m, radius_m}
var bodies = []          # {name, fixed, color, shapes}
var parameters = []      # {name, unit, lower, upper, initial}
var budget = {}          # {slots, awake, shape_sets, pieces, vertices, least_kg, ...}; empty: no bodies of a game


# The function of reader.gd that reads each field.
const FIELDS = {"session": "u32_of", "program_version": "text_of", "scene_name": "text_of", "hand_name": "text_of",
		"exercise_name": "text_of", "exercise_json": "text_of", "joint_names": "texts_of", "value_names": "texts_of",
		"event_names": "texts_of", "fault_names": "texts_of"}
const AXIS = {"name": "text_of", "unit": "text_of", "lower": "float_of", "upper": "float_of", "effort_limit": "float_of"}
const LINK = {"name": "text_of", "parent": "i16_of", "joint": "i16_of", "type": "u8_of", "axis": "vector3_of"}
const CAPSULE = {"name": "text_of", "link": "i16_of", "a_m": "vector3_of", "b_m": "vector3_of", "radius_m": "float_of"}
const BODY = {"name": "text_of", "fixed": "bool_of", "color": "text_of"}
const BUDGET = {"slots": "u16_of", "awake": "u16_of", "shape_sets": "u16_of", "pieces": "u16_of", "vertices": "u16_of",
		"least_kg": "float_of", "most_kg": "float_of", "least_m": "float_of", "most_m": "float_of"}
const PARAMETER = {"name": "text_of", "unit": "text_of", "lower": "float_of", "upper": "float_of", "initial": "float_of"}


# False if the message is damaged; then its fields must not be used.
func read(reader, table: int) -> bool:
	var f = Protocol.Scene
	var own = _fields(reader, table, f, FIELDS)
	for name in own:
		set(name, own[name])
	axes = _read_all(reader, table, f.axes, "_read_axis")
	links = _read_all(reader, table, f.links, "_read_link")
	capsules = _read_all(reader, table, f.capsules, "_read_capsule")
	bodies = _read_all(reader, table, f.bodies, "_read_body")
	parameters = _read_all(reader, table, f.parameters, "_read_parameter")
	var room = reader.table(table, f.budget)
	if room != 0:
		budget = _fields(reader, room, Protocol.BodyBudget, BUDGET)
	return not reader.broken


func _read_axis(reader, table: int) -> Dictionary:
	return _fields(reader, table, Protocol.Axis, AXIS)


func _read_link(reader, table: int) -> Dictionary:
	var link = _fields(reader, table, Protocol.Link, LINK)
	_add_pose(reader, reader.field(table, Protocol.Link.at_zero), link)
	return link


func _read_capsule(reader, table: int) -> Dictionary:
	return _fields(reader, table, Protocol.Capsule, CAPSULE)


func _read_body(reader, table: int) -> Dictionary:
	var body = _fields(reader, table, Protocol.Body, BODY)
	body["shapes"] = _read_all(reader, table, Protocol.Body.shapes, "_read_shape")
	return body


func _read_parameter(reader, table: int) -> Dictionary:
	return _fields(reader, table, Protocol.Parameter, PARAMETER)
