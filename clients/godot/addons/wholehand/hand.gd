# Draws the hand at the program's pose, from scene.links and the joint angles of the newest state. Each link is a child:
# add meshes of a game below link("thumb_ip_flexion"). They stay there while scenes change, as long as the hand has a
# link of that name. This node's own transform places the program's world in the game's; leave its scale at 1.
extends Spatial

# The links of a new scene are built, which happens with every arming.
signal built

const Axes = preload("axes.gd")
const Protocol = preload("protocol.gd")
const Shapes = preload("shapes.gd")

# Path of the node with connection.gd; empty: the parent.
export(NodePath) var connection_path = NodePath("..")
export var draw_capsules = true
# For a program on another machine: draws the hand at its present pose, predicted from the last states, in every frame.
export var predict_motion = false
export(Material) var material
export var color = Color(0.85, 0.68, 0.56)

var connection = null
var drawn_tick = -1 # tick of the drawn state; -1: nothing is drawn
var links = []      # Spatial, in the order of scene.links

var _capsules = []  # MeshInstance, below the links
var _names = []
var _parents = []
var _joints = []
var _types = []
var _axes = []      # in Godot's axes
var _at_zero = []   # Transform at joint angle 0 in the parent's frame, in Godot's axes
var _joint_count = 0


func _ready() -> void:
	connection = get_node_or_null(connection_path)
	if connection == null or not connection.has_signal("scene_changed"):
		push_error("Wholehand hand %s has no connection: set connection_path, or put it below one" % name)
		return
	connection.connect("scene_changed", self, "_build")
	connection.connect("state_changed", self, "_draw_state")
	if connection.scene != null:
		_build(connection.scene)


# A link by its name; null if the hand has no such link.
func link(link_name: String) -> Spatial:
	var i = _names.find(link_name)
	return null if i < 0 else links[i]


func _process(_delta: float) -> void:
	if not predict_motion or connection == null or connection.state == null or connection.state.tick != drawn_tick:
		return
	var theta = connection.motion.joints(1000 * OS.get_ticks_usec())
	if not links.empty() and theta.size() == _joint_count:
		_draw(theta)


func _draw_state(state) -> void:
	if links.empty() or state.theta.size() != _joint_count:
		return
	_draw(state.theta)
	drawn_tick = state.tick


func _draw(theta: PoolRealArray) -> void:
	var poses = []
	for i in range(links.size()):
		var pose = _at_zero[i]
		if _joints[i] >= 0:
			var moved = theta[_joints[i]]
			if _types[i] == Protocol.JointType.Revolute:
				pose = pose * Transform(Basis(_axes[i], moved), Vector3())
			elif _types[i] == Protocol.JointType.Prismatic:
				pose = pose * Transform(Basis(), _axes[i] * moved)
		if _parents[i] >= 0:
			pose = poses[_parents[i]] * pose
		poses.append(pose)
		links[i].transform = pose


func _build(scene) -> void:
	var fault = _fault_of(scene)
	if fault != "":
		push_error("Wholehand hand %s is not drawn: %s. Bring the addon and the program to the same version" % [name, fault])
		_joint_count = -1 # equals the number of no state
		return
	var before = {}
	for i in range(links.size()):
		if is_instance_valid(links[i]):
			before[_names[i]] = links[i]
	_clear()
	_joint_count = scene.joint_names.size()
	for described in scene.links:
		_names.append(described.name)
		_parents.append(described.parent)
		_joints.append(described.joint)
		_types.append(described.type)
		_axes.append(Axes.to_godot(described.axis).normalized())
		_at_zero.append(Axes.pose_to_godot(described.position_m, described.orientation))
		links.append(_link_of(described.name, before))
	for left in before:
		push_warning("Wholehand hand %s: this scene's hand has no link %s; what hangs below it is removed with it" % [name, left])
		before[left].queue_free()
	if draw_capsules:
		var skin = Shapes.material_of(material, color)
		for capsule in scene.capsules:
			_add_capsule(capsule, skin)
	emit_signal("built")


# An existing link is kept, with the game's objects below it.
func _link_of(link_name: String, before: Dictionary) -> Spatial:
	if before.has(link_name):
		var kept = before[link_name]
		before.erase(link_name)
		return kept
	var node = Spatial.new()
	add_child(node)
	return node


func _fault_of(scene) -> String:
	if scene.links.empty():
		return "the scene says nothing of links"
	for i in range(scene.links.size()):
		if scene.links[i].parent >= i:
			return "link %d stands before its parent" % i
		if scene.links[i].joint >= scene.joint_names.size():
			return "link %d moves with a joint that the scene does not have" % i
	return ""


func _add_capsule(capsule: Dictionary, skin: Material) -> void:
	if capsule.link < 0 or capsule.link >= links.size():
		return
	var a = Axes.to_godot(capsule.a_m)
	var b = Axes.to_godot(capsule.b_m)
	var node = Shapes.instance(Shapes.capsule(capsule.radius_m, a.distance_to(b)), skin)
	node.transform = Transform(Shapes.capsule_turn(b - a), 0.5 * (a + b))
	links[capsule.link].add_child(node)
	_capsules.append(node)


func _clear() -> void:
	for node in _capsules:
		if is_instance_valid(node):
			node.get_parent().remove_child(node)
			node.free()
	_capsules = []
	links = []
	_names = []
	_parents = []
	_joints = []
	_types = []
	_axes = []
	_at_zero = []
	drawn_tick = -1
