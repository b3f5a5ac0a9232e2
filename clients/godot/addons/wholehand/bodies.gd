# A list of a game's bodies in the world (docs/protocol.md of Wholehand, "Bodies of a game"). The program's axes and
# units.
extends "shape_reader.gd"

# Events of a body; the names are those of scene.event_names.
const EVENTS = ["appeared", "solid", "letting_go", "left", "quarantined", "refused"]

var session = 0
var bodies = []      # {slot, generation, shapes, state}; shapes: id; state: Protocol.SlotState
var new_shapes = []  # {id, com_m, pieces}; shapes of these bodies that the list before did not use
# The bodies beyond the slots that changed since the list before: {number, generation, shapes, slot,
# whereabouts, position_m, orientation}; slot: -1 without one; whereabouts: Protocol.Whereabouts. body_list.gd has all.
var registered = []


# False if the message is damaged; then its fields must not be used.
func read(reader, table: int) -> bool:
	var f = Protocol.GameBodies
	var body = Protocol.GameBody
	session = reader.u32_of(table, f.session)
	var first = reader.vector(table, f.bodies, body.SIZE)
	for i in range(reader.count_of(first)):
		var place = first + i * body.SIZE
		bodies.append({"slot": reader.u32(place + body.slot), "generation": reader.u32(place + body.generation),
				"shapes": reader.u32(place + body.shapes), "state": reader.u8(place + body.state)})
	new_shapes = _read_all(reader, table, f.new_shapes, "_read_shapes")
	_read_registered(reader, reader.vector(table, f.registered, Protocol.RegisteredBody.SIZE))
	return not reader.broken


func _read_registered(reader, first: int) -> void:
	var body = Protocol.RegisteredBody
	for i in range(reader.count_of(first)):
		var place = first + i * body.SIZE
		var read = {"number": reader.u32(place + body.number), "generation": reader.u32(place + body.generation),
				"shapes": reader.u32(place + body.shapes), "slot": reader.i32(place + body.slot),
				"whereabouts": reader.u8(place + body.whereabouts)}
		_add_pose(reader, place + body.pose, read)
		registered.append(read)


func _read_shapes(reader, table: int) -> Dictionary:
	var f = Protocol.GameShapes
	return {"id": reader.u32_of(table, f.id), "com_m": reader.vector3_of(table, f.com_m),
			"pieces": _read_all(reader, table, f.pieces, "_read_shape")}
