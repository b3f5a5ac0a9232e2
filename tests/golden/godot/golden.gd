# The addon reads and writes golden messages (tests/golden/run.py): WHOLEHAND_JOB names the job, WHOLEHAND_ANSWER the
# file to write. Messages enter where a socket's messages do; orders are the methods that a game calls.
extends SceneTree

const Recorder = preload("res://recorder.gd")

const SCRIPT_VARIABLE = 8192 # PROPERTY_USAGE_SCRIPT_VARIABLE
const POSES = {"Shape": "in_body", "RegisteredBody": "pose"} # fields with position_m and orientation; else at_zero
const METHODS = {"Action": "act", "Spawn": "spawn_bodies", "Remove": "remove_bodies", "Teleport": "teleport_bodies",
		"SetOwner": "set_body_owners", "BodyTargets": "set_body_targets"}

var objects
var heard # payload -> form, of the message being read
var buffer = StreamPeerBuffer.new()


func _init():
	var file = File.new()
	file.open(OS.get_environment("WHOLEHAND_JOB"), File.READ)
	var job = parse_json(file.get_as_text())
	file.close()
	objects = job.layout.objects
	var answer = {"read": {}, "write": {}, "longest_s": 0.0}
	for entry in job.read:
		var bytes = Marshalls.base64_to_raw(entry.bytes)
		var began_us = OS.get_ticks_usec()
		answer.read[entry.name] = read(bytes) # null if a script failed
		answer.longest_s = max(answer.longest_s, 1e-6 * (OS.get_ticks_usec() - began_us))
	for entry in job.write:
		answer.write[entry.name] = write(entry)
	file.open(OS.get_environment("WHOLEHAND_ANSWER"), File.WRITE)
	# Godot writes a vertical tab, which damaged texts may contain, in a way that no JSON reader accepts.
	file.store_string(to_json(answer).replace("\\v", "\\u000b"))
	file.close()
	quit()


# ---- messages of the program ----

func read(bytes):
	var connection = Recorder.new()
	heard = {}
	connection.connect("state_changed", self, "_on_state")
	connection.connect("scene_changed", self, "_on_scene")
	connection.connect("replied", self, "_on_reply")
	connection.connect("event_happened", self, "_on_event")
	connection.connect("bodies_changed", self, "_on_bodies")
	connection.connect("bodies_refused", self, "_on_bodies_refused")
	connection.connect("connection_changed", self, "_on_connection")
	connection._reader.open(bytes)
	var kind = connection._payload_type()
	connection._hear()
	var ignored = connection.ignored
	var held = connection.holds_controls
	connection.free()
	if ignored > 0:
		return {"refused": ""}
	# The addon reports nothing for these messages if they contain nothing new.
	if kind == Recorder.Protocol.Payload.Controls:
		heard = {"Controls": {"held_by_you": held}}
	elif kind == Recorder.Protocol.Payload.Events and heard.empty():
		heard = {"Events": {}}
	return {"unread": true} if heard.empty() else {"payload": heard}


func _on_state(state):
	var form = variables_of(state, "WorldState")
	form["bodies"] = []
	for i in range(state.body_positions.size()):
		form["bodies"].append(pose(state.body_positions[i], state.body_orientations[i]))
	heard["WorldState"] = form


func _on_scene(scene):
	heard["Scene"] = variables_of(scene, "Scene")


func _on_reply(command, accepted, reason):
	var items = heard["Reply"].items if heard.has("Reply") else []
	heard["Reply"] = {"command": command, "accepted": accepted, "reason": reason, "items": items}


func _on_bodies_refused(_command, items):
	heard["Reply"] = {"items": value_of(fields_of("Reply").items, items)}


func _on_bodies(bodies):
	heard["GameBodies"] = variables_of(bodies, "GameBodies")


func _on_event(type, tick, index, value):
	if not heard.has("Events"):
		heard["Events"] = {"events": []}
	heard["Events"].events.append({"type": type, "tick": bits("u64", tick), "index": index, "value": bits("f32", value)})


func _on_connection(_connected, why):
	heard["Welcome"] = {"program_version": why.trim_prefix("connected to Wholehand ")}


func fields_of(table):
	var fields = {}
	for field in objects[table].fields:
		fields[field.name] = field
	return fields


# Every variable of the object that is a field of the table. Other variables fail, unless they are handled elsewhere.
func variables_of(object, table):
	var form = {}
	var fields = fields_of(table)
	for property in object.get_property_list():
		if not (property.usage & SCRIPT_VARIABLE):
			continue
		if fields.has(property.name):
			form[property.name] = value_of(fields[property.name], object.get(property.name))
		elif not property.name in ["body_positions", "body_orientations"]:
			form[property.name] = "a variable that is no field of %s" % table
	return form


func value_of(field, value):
	if field.kind != "vector":
		return element(field.kind, field, value)
	var all = []
	for item in value:
		all.append(element(field.element, field, item))
	return all


func element(kind, field, value):
	if value is Vector3:
		return vector(value)
	if value is Dictionary:
		return members(value, field.of)
	return bits(kind, value) if kind in ["f32", "f64", "i64", "u64"] else value


func members(dictionary, table):
	var form = {}
	var fields = fields_of(table)
	for name in dictionary:
		if name == "position_m":
			form[POSES.get(table, "at_zero")] = pose(dictionary.position_m, dictionary.orientation)
		elif fields.has(name):
			form[name] = value_of(fields[name], dictionary[name])
		elif name != "orientation":
			form[name] = "a member that is no field of %s" % table
	return form


func pose(position, orientation):
	return {"position_m": vector(position), "orientation_xyzw": {"x": bits("f32", orientation.x),
			"y": bits("f32", orientation.y), "z": bits("f32", orientation.z), "w": bits("f32", orientation.w)}}


func vector(v):
	return {"x": bits("f32", v.x), "y": bits("f32", v.y), "z": bits("f32", v.z)}


func bits(kind, value):
	buffer.clear()
	match kind:
		"f32":
			buffer.put_float(value)
		"f64":
			buffer.put_double(value)
		_:
			buffer.put_64(value)
	var digits = ""
	for byte in buffer.data_array:
		digits = "%02x" % byte + digits
	return digits


# ---- orders ----

# Null if the addon has no such order.
func write(entry):
	var method = METHODS.get(entry.order, entry.order.capitalize().to_lower().replace(" ", "_"))
	var connection = Recorder.new()
	var bytes = null
	if connection.has_method(method):
		connection.connected = true
		connection._command = int(entry.id) - 1
		connection.token = entry.fields.get("token", "")
		var arguments = []
		for field in objects[entry.order].fields:
			if field.name != "token":
				arguments.append(given(field, entry.fields))
		connection.callv(method, arguments)
		bytes = Marshalls.raw_to_base64(connection.kept)
	connection.free()
	return bytes


func given(field, fields):
	if field.kind == "vector":
		var all = []
		for item in fields.get(field.name, []):
			all.append(number("f32", item) if field.element == "f32" else body_or_piece(field.of, item))
		return all
	if field.kind == "string":
		return fields.get(field.name, "")
	var value = fields.get(field.name, field.get("default"))
	return number(field.kind, value) if field.kind == "f64" else int(value)


func number(kind, digits):
	buffer.clear()
	for i in range(digits.length() - 2, -1, -2):
		buffer.put_u8(("0x" + digits.substr(i, 2)).hex_to_int())
	buffer.seek(0)
	return buffer.get_float() if kind == "f32" else buffer.get_double()


# An item of an order to bodies, as a game passes it.
func body_or_piece(table, form):
	match table:
		"BodyName":
			return [int(form.slot), int(form.generation)]
		"BodyPlace":
			return [int(form.slot), int(form.generation), triple(form.pose.position_m), turn(form.pose.orientation_xyzw)]
		"BodyHandover":
			return [int(form.slot), int(form.generation), int(form.owner)]
	var item = {}
	for field in objects[table].fields:
		if not form.has(field.name):
			continue
		var value = form[field.name]
		match field.kind:
			"struct":
				if field.of == "Pose":
					item["position_m"] = triple(value.position_m)
					item["orientation"] = turn(value.orientation_xyzw)
				else:
					item[field.name] = triple(value)
			"vector":
				item[field.name] = []
				for element in value:
					item[field.name].append(triple(element) if field.element == "struct" else int(element))
			"f32":
				item[field.name] = number("f32", value)
			_:
				item[field.name] = value if value is bool else int(value)
	return item


func triple(form):
	return Vector3(number("f32", form.x), number("f32", form.y), number("f32", form.z))


func turn(form):
	return Quat(number("f32", form.x), number("f32", form.y), number("f32", form.z), number("f32", form.w))
