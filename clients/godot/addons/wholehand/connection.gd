# The connection to a running Wholehand program, by WebSocket: 60 states per second. It connects by itself, and
# reconnects after the program was absent. It keeps the controls only while the game's frames run: if the game hangs for
# 200 ms, the exercise fades out; after 1 s the controls are lost.
extends Node

# Whether it is connected, and a description of the reason.
signal connection_changed(connected, why)
signal scene_changed(scene)
signal state_changed(state)
signal controls_changed(held_by_this_game)
# The program's answer to the command of this number; `reason` of an accepted one: what it waits for, or empty.
signal replied(command, accepted, reason)
# `type` is an index into scene.event_names; `index` is the dispenser, liquid ..., or -1.
signal event_happened(type, tick, index, value)
# The list of a game's bodies in the world changed: bodies.gd.
signal bodies_changed(bodies)
# `what` happened to a body of a game, one of bodies.gd's EVENTS; `refusal` (Protocol.BodyRefusal) belongs to "refused",
# whose generation is 0. Slot and generation are the loop's: body_list.name_in(slot) is the game's name of the body.
signal body_event(what, slot, generation, refusal)
# A body of a game touches the hand, after 0.1 s or more without contact; the impulse on the hand within 10 ms [N·s].
signal body_touched(slot, generation, impulse_ns)
# For an order to bodies: {item, slot, refusal, reason} of each refused one; all others were obeyed. Emitted before
# `replied`.
signal bodies_refused(command, items)

const Protocol = preload("protocol.gd")
const Reader = preload("reader.gd")
const Writer = preload("writer.gd")
const BodyList = preload("body_list.gd")
const BodyOrders = preload("body_orders.gd")
const WholehandBodies = preload("bodies.gd")
const MotionPredictor = preload("motion_predictor.gd")
const Socket = preload("socket.gd")
const WholehandScene = preload("scene.gd")
const WholehandState = preload("state.gd")

const SCHEMA_VERSION = 1
const HEARTBEAT_MS = 50
const STOP_AGAIN_MS = 300
const RETRY_MS = 250
const GONE_MS = 2000
const LONGEST_FRAME_S = 1.0 / 30.0

export var host = "127.0.0.1"
export var port = 8080
# "therapist", "player", "watcher"; empty: none (docs/protocol.md of Wholehand).
export var role = ""

# The token that a program on another machine requires. It is not exported: a scene file must not contain a secret.
var token = OS.get_environment("WHOLEHAND_TOKEN")
var connected = false
var holds_controls = false
var message = "not connected yet"
var scene = null # the newest scene; null before the first one
var state = null # the newest state; null before the first one and without a connection
var bodies = null # the newest list of a game's bodies; null before the first one
var body_list = BodyList.new() # the bodies of a game that are in the world
var shapes = {}   # id -> {id, com_m, pieces}, of these bodies
var motion = MotionPredictor.new() # predicted joints at present
var ignored = 0  # number of messages that were damaged or not the program's

var _socket = null # a socket of socket.gd
var _reader = Reader.new()
var _writer = Writer.new()
var _why_closed = "" # empty: it is not closed
var _command = 0
var _heard_ms = 0
var _heartbeat_ms = 0
var _retry_ms = 0
var _late_us = 0    # half a frame: the average delay until a message is noticed
var _stop = 0       # number of an unanswered emergency stop; 0: none
var _stop_ms = 0


func _process(delta: float) -> void:
	var now_ms = OS.get_ticks_msec()
	_late_us = int(5e5 * min(delta, LONGEST_FRAME_S))
	if _socket == null:
		if now_ms >= _retry_ms:
			_open(now_ms)
		return
	_socket.poll()
	_receive(now_ms)
	if _socket.state == Socket.REFUSED:
		_why_closed = "no connection to %s:%d: no program is there, or it asks for another token" % [host, port]
	elif _socket.state == Socket.LOST:
		_why_closed = "the connection is lost"
	if _why_closed == "" and now_ms - _heard_ms > GONE_MS:
		_why_closed = "the program at %s:%d is not heard" % [host, port]
	if _why_closed != "":
		_end(_why_closed)
	if connected:
		_keep_alive(now_ms)


func _exit_tree() -> void:
	if _socket != null:
		_end("the node left the tree")


# ---- commands: each returns its number for `replied`, or 0 without a connection ----

# Requests the controls; refused while another client holds them.
func take_controls() -> int:
	return _order("TakeControls", [[Protocol.TakeControls.token, "text", token]])


func release_controls() -> int:
	return _order("ReleaseControls", [])


# Starts rendering. The arguments are state.endings and state.basis as they were shown to the person at the press.
func arm(endings_shown: int, basis_shown: int) -> int:
	var f = Protocol.Arm
	return _order("Arm", [[f.endings_seen, "u32", endings_shown], [f.basis_seen, "u32", basis_shown]])


# Fades the exercise out and ramps to neutral.
func stop() -> int:
	return _order("Stop", [])


# Ramps to neutral at once; it needs no controls. It is repeated until it is answered.
func emergency_stop() -> int:
	_stop = _order("EmergencyStop", [])
	_stop_ms = OS.get_ticks_msec()
	return _stop


# Loads an exercise, level and hand; empty texts and level 0 keep the present ones.
func load_exercise(exercise: String, level: int = 0, hand: String = "") -> int:
	var f = Protocol.LoadExercise
	return _order("LoadExercise", [[f.exercise, "text", exercise], [f.level, "u16", level], [f.hand, "text", hand]])


# Sets one of scene.parameters; the program ramps to the value. `basis_shown` is state.basis as it was shown to the
# person; only an order that raises an effort limit needs it.
func set_parameter(parameter: String, value: float, basis_shown: int = 0) -> int:
	var f = Protocol.SetParameter
	return _order("SetParameter", [[f.name, "text", parameter], [f.value, "f64", value],
			[f.basis_seen, "u32", basis_shown]])


# Sets who controls the hand's intended position: Protocol.Steering.
func steer(by: int) -> int:
	return _order("Steer", [[Protocol.Steer.by, "u8", by]])


# Sends an action to the exercise, Protocol.Act: next, restart, pause, resume. `basis_shown` is state.basis as it was
# shown to the person; a pause needs none. `chosen` with next, where the exercise compares: 1 the first was more, 2 the
# second.
func act(act: int, basis_shown: int = 0, chosen: int = 0) -> int:
	var f = Protocol.Action
	return _order("Action", [[f.act, "u8", act], [f.basis_seen, "u32", basis_shown], [f.chosen, "u8", chosen]])


# The person's intended position of the hand, per axis of scene.axes. Protocol.Help: the share of it that the game does
# for the person; recordings keep it.
func aim(q: Array, by: int = 0) -> int:
	return _order("Aim", [[Protocol.Aim.q, "floats", q], [Protocol.Aim.by, "u8", by]])


# ---- orders to bodies of a game, in the program's axes: arrays of body_orders.gd ----

# Defines the convex pieces of later bodies; they last for the session.
func prepare_shapes(shape_set: int, pieces: Array) -> int:
	var f = Protocol.PrepareShapes
	return _order("PrepareShapes", [[f.set, "u16", shape_set], [f.pieces, "tables", BodyOrders.pieces(pieces)]])


# Puts bodies into empty slots; each is a ghost until it overlaps nothing.
func spawn_bodies(all: Array) -> int:
	return _order("Spawn", [[Protocol.Spawn.bodies, "tables", BodyOrders.spawned(all)]])


func remove_bodies(all: Array) -> int:
	return _order("Remove", [[Protocol.Remove.bodies, "structs", BodyOrders.named(all)]])


func teleport_bodies(all: Array) -> int:
	return _order("Teleport", [[Protocol.Teleport.bodies, "structs", BodyOrders.placed(all)]])


func set_body_owners(all: Array) -> int:
	return _order("SetOwner", [[Protocol.SetOwner.bodies, "structs", BodyOrders.handed_over(all)]])


# Target poses of bodies of owner Game. Repeat them within 0.1 s, or the bodies halt.
func set_body_targets(all: Array) -> int:
	return _order("BodyTargets", [[Protocol.BodyTargets.bodies, "structs", BodyOrders.placed(all)]])


# ---- the connection ----

func _open(now_ms: int) -> void:
	_socket = Socket.new()
	var address = "ws://%s:%d/ws%s" % [host, port, "" if role == "" else "?role=" + role]
	_heard_ms = now_ms
	_why_closed = ""
	if not _socket.open(address, token):
		_end("%s is no address of a program; correct host and port" % address)


func _end(why: String) -> void:
	var was = connected
	var news = was or message != why
	_socket.close()
	_socket = null
	_retry_ms = OS.get_ticks_msec() + RETRY_MS
	connected = false
	state = null
	bodies = null
	body_list.clear()
	shapes = body_list.shapes
	motion.clear()
	_stop = 0
	message = why
	_set_controls(false)
	if news:
		emit_signal("connection_changed", false, why)


func _keep_alive(now_ms: int) -> void:
	if now_ms - _heartbeat_ms >= HEARTBEAT_MS:
		_heartbeat_ms = now_ms
		_send(0, "Heartbeat", [])
	if _stop != 0 and now_ms - _stop_ms >= STOP_AGAIN_MS:
		_stop_ms = now_ms
		_send(_stop, "EmergencyStop", [])


func _order(type: String, fields: Array) -> int:
	if not connected:
		return 0
	_command += 1
	_send(_command, type, fields)
	return _command


func _send(id: int, type: String, fields: Array) -> void:
	var command = [
		[Protocol.Command.id, "u32", id],
		[Protocol.Command.order_type, "u8", Protocol.Order[type]],
		[Protocol.Command.order, "table", fields],
	]
	_put(_writer.write(Reader.IDENTIFIER, [
		[Protocol.Message.schema_version, "u16", SCHEMA_VERSION],
		[Protocol.Message.payload_type, "u8", Protocol.Payload.Command],
		[Protocol.Message.payload, "table", command],
	]))


func _put(message_bytes: PoolByteArray) -> void:
	_socket.send(message_bytes)


# ---- messages of the program ----

func _receive(now_ms: int) -> void:
	var newest = null # only the last one of several states is decoded
	while _socket.packet_count() > 0:
		_heard_ms = now_ms
		var packet = _socket.take_packet()
		_reader.open(packet)
		if _payload_type() == Protocol.Payload.WorldState:
			newest = packet
		else:
			_hear()
	if newest != null:
		_reader.open(newest)
		_hear()


func _payload_type() -> int:
	return _reader.u8_of(_reader.root(), Protocol.Message.payload_type)


func _hear() -> void:
	var table = _reader.table(_reader.root(), Protocol.Message.payload)
	var version = _reader.u16_of(_reader.root(), Protocol.Message.schema_version)
	if _reader.broken or table == 0 or version != SCHEMA_VERSION:
		ignored += 1
		return
	match _payload_type():
		Protocol.Payload.WorldState:
			_hear_state(table)
		Protocol.Payload.Scene:
			_hear_scene(table)
		Protocol.Payload.Welcome:
			_hear_welcome(table)
		Protocol.Payload.Controls:
			var held = _reader.bool_of(table, Protocol.Controls.held_by_you)
			if not _is_broken():
				_set_controls(held)
		Protocol.Payload.Reply:
			_hear_reply(table)
		Protocol.Payload.Events:
			_hear_events(table)
		Protocol.Payload.GameBodies:
			_hear_bodies(table)
		Protocol.Payload.Commissioning:
			pass # a program that commissions a device moves no hand
		_:
			ignored += 1


func _is_broken() -> bool:
	if _reader.broken:
		ignored += 1
	return _reader.broken


func _hear_state(table: int) -> void:
	var read = WholehandState.new()
	if not read.read(_reader, table):
		ignored += 1
		return
	state = read
	motion.add(state, 1000 * (OS.get_ticks_usec() - _late_us))
	emit_signal("state_changed", state)


func _hear_scene(table: int) -> void:
	var read = WholehandScene.new()
	if not read.read(_reader, table):
		ignored += 1
		return
	scene = read
	emit_signal("scene_changed", scene)


func _hear_bodies(table: int) -> void:
	var read = WholehandBodies.new()
	if not read.read(_reader, table):
		ignored += 1
		return
	bodies = read
	body_list.take(read)
	shapes = body_list.shapes
	emit_signal("bodies_changed", bodies)


func _hear_welcome(table: int) -> void:
	var version = _reader.text_of(table, Protocol.Welcome.program_version)
	if _is_broken():
		return
	connected = true
	_command = 0
	message = "connected to Wholehand " + version
	emit_signal("connection_changed", true, message)


func _hear_reply(table: int) -> void:
	var command = _reader.u32_of(table, Protocol.Reply.command)
	var accepted = _reader.bool_of(table, Protocol.Reply.accepted)
	var reason = _reader.text_of(table, Protocol.Reply.reason)
	var items = _refused_items(table)
	if _is_broken():
		return
	if _stop != 0 and command >= _stop:
		_stop = 0
	if not items.empty():
		emit_signal("bodies_refused", command, items)
	emit_signal("replied", command, accepted, reason)


func _refused_items(reply: int) -> Array:
	var f = Protocol.RefusedItem
	var items = []
	var first = _reader.vector(reply, Protocol.Reply.items, 4)
	for i in range(_reader.count_of(first)):
		var item = _reader.follow(first + 4 * i)
		items.append({"item": _reader.u16_of(item, f.item), "slot": _reader.i32_of(item, f.slot),
				"refusal": _reader.u8_of(item, f.refusal), "reason": _reader.text_of(item, f.reason)})
		if _reader.broken:
			break
	return items


func _hear_events(table: int) -> void:
	var f = Protocol.Event
	var first = _reader.vector(table, Protocol.Events.events, f.SIZE)
	var events = []
	for i in range(_reader.count_of(first)):
		var place = first + i * f.SIZE
		events.append([_reader.u16(place + f.type), _reader.i64(place + f.tick), _reader.i16(place + f.index),
				_reader.f32(place + f.value)])
	if _is_broken():
		return
	for event in events:
		emit_signal("event_happened", event[0], event[1], event[2], event[3])
		_tell_body_event(event)


func _tell_body_event(event: Array) -> void:
	if scene == null or scene.budget.empty() or event[0] >= scene.event_names.size():
		return
	var what = scene.event_names[event[0]]
	if what == "appeared":
		body_list.note_appeared(event[2], int(event[3]))
	if what == "refused":
		emit_signal("body_event", what, event[2], 0, int(event[3]))
	elif what == "touched":
		emit_signal("body_touched", event[2], body_list.generation_in(event[2]), event[3])
	elif what in WholehandBodies.EVENTS:
		emit_signal("body_event", what, event[2], int(event[3]), Protocol.BodyRefusal.None)


func _set_controls(held: bool) -> void:
	if held == holds_controls:
		return
	holds_controls = held
	emit_signal("controls_changed", held)
