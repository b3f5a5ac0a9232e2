# Draws the bodies of the program's scene and those that a game has spawned, which are those that the hand can touch. A
# child whose metadata "wholehand_body" is the name of a body, or [slot, generation] of one of the game, is moved
# instead, and keeps its appearance. This node also sends orders for bodies of a game, in the game's world; instead of a
# slot a body may have a number from 1000 on. This node's transform places the program's world in the game's; leave its
# scale at 1, and use the same pose as the hand's.
extends Spatial

# The bodies of a new scene are built.
signal built

const Axes = preload("axes.gd")
const Protocol = preload("protocol.gd")
const Shapes = preload("shapes.gd")

const NAME = "wholehand_body"
# A body halts after 100 ms without a target. The program takes 400 messages a second, of 64 targets each.
const TARGETS_MS = 15
const TARGETS_MS_OF_64 = 5
const MOST_TARGETS = 64
const EMPTY_BELOW_M = -8.0 # empty slots are below this; a body of the game is within 5 m

# Path of the node with connection.gd; empty: the parent.
export(NodePath) var connection_path = NodePath("..")
export(Material) var material
export var game_body_color = Color(0.23, 0.44, 0.82)

var connection = null
var drawn_tick = -1 # tick of the drawn state; -1: nothing is drawn
var bodies = []     # Spatial, in the order of scene.bodies
var game_bodies = {} # slot or number -> Spatial

var _made = []
var _names = []
var _session = 0
var _generations = {} # generations of game_bodies
var _slots = {}       # for those of game_bodies that the loop has: slot or number -> slot
var _made_of_game = {} # those of game_bodies that this node made
var _targets = {}     # slot or number -> Transform in the program's world, in Godot's axes
var _targets_ms = 0


func _ready() -> void:
	connection = get_node_or_null(connection_path)
	if connection == null or not connection.has_signal("scene_changed"):
		push_error("Wholehand world %s has no connection: set connection_path, or put it below one" % name)
		return
	connection.connect("scene_changed", self, "_build")
	connection.connect("state_changed", self, "_draw_state")
	connection.connect("bodies_changed", self, "_build_game_bodies")
	if connection.scene != null:
		_build(connection.scene)


func _process(_delta: float) -> void:
	var now_ms = OS.get_ticks_msec()
	var pause_ms = max(TARGETS_MS, TARGETS_MS_OF_64 * (1 + _targets.size() / MOST_TARGETS))
	if _targets.empty() or connection == null or not connection.holds_controls or now_ms - _targets_ms < pause_ms:
		return
	_targets_ms = now_ms
	var some = []
	for slot in _targets:
		some.append([slot, _generations[slot]] + _pose_in_program(_targets[slot]))
		if some.size() == MOST_TARGETS:
			connection.set_body_targets(some)
			some = []
	if not some.empty():
		connection.set_body_targets(some)


# ---- bodies of a game; `at` is the position of the centre of mass in the game's world. Each order returns its number
# for the connection's `replied`, or 0 without a connection ----

# Defines the pieces of later bodies: shapes.gd makes them in Godot's axes.
func prepare_shapes(shape_set: int, pieces: Array) -> int:
	return connection.prepare_shapes(shape_set, pieces)


# @param body like for connection.gd, without its pose: slot, shape_set, generation, owner, mass_kg, ...
func spawn(body: Dictionary, at: Transform) -> int:
	var placed = body.duplicate()
	var pose = _pose_in_program(_from_game(at))
	placed["position_m"] = pose[0]
	placed["orientation"] = pose[1]
	return connection.spawn_bodies([placed])


func remove_body(slot: int, generation: int = 1) -> int:
	return connection.remove_bodies([[slot, generation]])


func teleport_body(slot: int, generation: int, at: Transform) -> int:
	return connection.teleport_bodies([[slot, generation] + _pose_in_program(_from_game(at))])


# Changes the owner that moves it: Protocol.BodyOwner.
func set_body_owner(slot: int, generation: int, owner: int) -> int:
	return connection.set_body_owners([[slot, generation, owner]])


# Sets the target of a body of owner Game in the world; beyond the slots it is there at once. The target holds until
# another one is set, as long as frames run.
func set_target(slot: int, at: Transform) -> void:
	if game_bodies.has(slot):
		_targets[slot] = _from_game(at)


# Clears the target; the body halts within 0.1 s.
func clear_target(slot: int) -> void:
	_targets.erase(slot)


func _from_game(at: Transform) -> Transform:
	return global_transform.affine_inverse() * at


func _pose_in_program(at: Transform) -> Array:
	return [Axes.from_godot(at.origin), Axes.quat_from_godot(at.basis.get_rotation_quat())]


# A body by its name; null if the scene has none of that name.
func body(body_name: String) -> Spatial:
	var i = _names.find(body_name)
	return null if i < 0 else bodies[i]


# A program reports the poses of a scene's first 128 bodies.
func _draw_state(state) -> void:
	if state.session != _session or state.body_positions.empty():
		return
	for i in range(min(bodies.size(), state.body_positions.size())):
		bodies[i].transform = Axes.pose_to_godot(state.body_positions[i], state.body_orientations[i])
	for slot in _slots:
		var i = bodies.size() + _slots[slot]
		if i < state.body_positions.size() and state.body_positions[i].z > EMPTY_BELOW_M and game_bodies.has(slot):
			game_bodies[slot].transform = Axes.pose_to_godot(state.body_positions[i], state.body_orientations[i])
	drawn_tick = state.tick


func _build(scene) -> void:
	for node in _made:
		node.queue_free()
		remove_child(node)
	_made = []
	_names = []
	bodies = []
	drawn_tick = -1
	_session = scene.session
	_clear_game_bodies()
	var placed = {}
	for child in get_children():
		if child.has_meta(NAME):
			placed[child.get_meta(NAME)] = child
	for described in scene.bodies:
		_names.append(described.name)
		bodies.append(placed[described.name] if placed.has(described.name) else _make(described))
	if connection.bodies != null:
		_build_game_bodies(connection.bodies)
	emit_signal("built")


func _make(described: Dictionary) -> Spatial:
	var color = Color(described.color) if described.color.is_valid_html_color() else Color(0.5, 0.5, 0.5)
	var node = _make_of(described.name, described.shapes, color)
	_made.append(node)
	return node


func _make_of(called: String, shapes: Array, color: Color) -> Spatial:
	var node = Spatial.new()
	var surface = Shapes.material_of(material, color)
	for shape in shapes:
		var mesh = Shapes.mesh_of(shape)
		if mesh == null:
			push_warning("Wholehand: a shape of body %s is not drawn: type %d is unknown, or its corners are damaged"
					% [called, shape.type])
			continue
		var part = Shapes.instance(mesh, surface)
		part.transform = Axes.pose_to_godot(shape.position_m, shape.orientation) * Transform(Shapes.turn_of(shape), Vector3())
		node.add_child(part)
	add_child(node)
	return node


func _build_game_bodies(reported) -> void:
	var registered = connection.body_list.registered
	var listed = registered.duplicate() # by slot, or number
	_slots = {}
	if reported.session == _session:
		for body in reported.bodies:
			var slot = connection.body_list.numbers.get(body.slot, body.slot)
			_slots[slot] = body.slot
			if slot == body.slot:
				listed[slot] = body
	for slot in game_bodies.keys():
		if not listed.has(slot) or listed[slot].generation != _generations[slot]:
			_drop_game_body(slot)
	for slot in listed:
		if not game_bodies.has(slot) and connection.shapes.has(listed[slot].shapes):
			_generations[slot] = listed[slot].generation
			game_bodies[slot] = _placed_or_made(slot, listed[slot])
			if registered.has(slot):
				_stand(registered[slot])
	for body in reported.registered:
		if registered.has(body.number):
			_stand(body)


# The pose of a body beyond the slots comes from the list, that of a body in a slot from states.
func _stand(body: Dictionary) -> void:
	if game_bodies.has(body.number) and not _slots.has(body.number):
		game_bodies[body.number].transform = Axes.pose_to_godot(body.position_m, body.orientation)


func _placed_or_made(slot: int, body: Dictionary) -> Spatial:
	for child in get_children():
		if child.has_meta(NAME) and child.get_meta(NAME) is Array and child.get_meta(NAME) == [slot, body.generation]:
			return child
	var node = _make_of("body %d" % slot, connection.shapes[body.shapes].pieces, game_body_color)
	_made_of_game[slot] = node
	return node


func _drop_game_body(slot: int) -> void:
	var node = game_bodies[slot]
	game_bodies.erase(slot)
	_generations.erase(slot)
	_targets.erase(slot)
	if _made_of_game.erase(slot):
		node.queue_free()
		remove_child(node)


func _clear_game_bodies() -> void:
	for slot in game_bodies.keys():
		_drop_game_body(slot)
