# Draws the bodies of the program's scene, which are what the hand feels. A child whose metadata "wholehand_body" is the
# name of a body is moved instead, and keeps the look that the game gave it. This node's transform places the program's
# world in the game's; leave its scale at 1, and put it where the hand's is.
extends Spatial

# The bodies of a new scene stand.
signal built

const Axes = preload("axes.gd")
const Shapes = preload("shapes.gd")

const NAME = "wholehand_body"

# Of the node with connection.gd; empty: the parent.
export(NodePath) var connection_path = NodePath("..")
export(Material) var material

var connection = null
var drawn_tick = -1 # of the state that is drawn; -1: nothing is
var bodies = []     # Spatial, in the order of scene.bodies

var _made = []
var _names = []
var _session = 0


func _ready() -> void:
	connection = get_node_or_null(connection_path)
	if connection == null or not connection.has_signal("scene_changed"):
		push_error("Wholehand world %s has no connection: set connection_path, or put it below one" % name)
		return
	connection.connect("scene_changed", self, "_build")
	connection.connect("state_changed", self, "_draw_state")
	if connection.scene != null:
		_build(connection.scene)


# Null where the scene has no such body.
func body(body_name: String) -> Spatial:
	var i = _names.find(body_name)
	return null if i < 0 else bodies[i]


# A program tells where the first 128 bodies of a scene are.
func _draw_state(state) -> void:
	if state.session != _session or state.body_positions.empty():
		return
	for i in range(min(bodies.size(), state.body_positions.size())):
		bodies[i].transform = Axes.pose_to_godot(state.body_positions[i], state.body_orientations[i])
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
	var placed = {}
	for child in get_children():
		if child.has_meta(NAME):
			placed[child.get_meta(NAME)] = child
	for described in scene.bodies:
		_names.append(described.name)
		bodies.append(placed[described.name] if placed.has(described.name) else _make(described))
	emit_signal("built")


func _make(described: Dictionary) -> Spatial:
	var node = Spatial.new()
	var color = Color(described.color) if described.color.is_valid_html_color() else Color(0.5, 0.5, 0.5)
	var surface = Shapes.material_of(material, color)
	for shape in described.shapes:
		var mesh = Shapes.mesh_of(shape)
		if mesh == null:
			push_warning("Wholehand: a shape of body %s is not drawn: type %d is unknown, or its corners are damaged"
					% [described.name, shape.type])
			continue
		var part = Shapes.instance(mesh, surface)
		part.transform = Axes.pose_to_godot(shape.position_m, shape.orientation) * Transform(Shapes.turn_of(shape), Vector3())
		node.add_child(part)
	add_child(node)
	_made.append(node)
	return node
