# Runs one test of test_godot.py in the game's own frames: WHOLEHAND_TEST names it, WHOLEHAND_PORT is the program's
# port. Exit code 0: passed. Lines that begin with "figure:" are measurements.
extends SceneTree

const Axes = preload("res://addons/wholehand/axes.gd")
const Connection = preload("res://addons/wholehand/connection.gd")
const Hand = preload("res://addons/wholehand/hand.gd")
const Protocol = preload("res://addons/wholehand/protocol.gd")
const Reader = preload("res://addons/wholehand/reader.gd")
const Scene = preload("res://addons/wholehand/scene.gd")
const Shapes = preload("res://addons/wholehand/shapes.gd")
const State = preload("res://addons/wholehand/state.gd")
const World = preload("res://addons/wholehand/world.gd")

const PATIENCE_MS = 90000
# Conditions for until(), whose expressions evaluate both sides of an `and`.
const NO_BODIES = "connection.bodies.bodies.empty() and world.game_bodies.empty()"
const HAS_STATE = "connection.state != null and connection.scene != null"
const DRAWN = "hand.drawn_tick >= 0 and world.drawn_tick >= 0"
const STOPPED = "_run_state() == Protocol.RunState.Stopped"
const RENDERS = "_run_state() == Protocol.RunState.Rendering"

# Godot's manual: a camera looks along Vector3.FORWARD. Columns: away from the person, left, up.
const FROM_PROGRAM = Basis(Vector3.FORWARD, Vector3.LEFT, Vector3.UP)

var connection = Connection.new()
var hand = Hand.new()
var world = World.new()
var failed = false
var replies = {} # command -> [accepted, reason]
var ring


func _init():
	call_deferred("_run")


func _run():
	connection.port = int(OS.get_environment("WHOLEHAND_PORT"))
	connection.connect("replied", self, "_on_replied")
	connection.add_child(hand)
	connection.add_child(world)
	# The pose of the program's world in the game's world must not matter.
	hand.transform = Transform(Basis(Vector3(1, 2, 3).normalized(), 0.7), Vector3(1, 2, -3))
	var test = call(OS.get_environment("WHOLEHAND_TEST"))
	if test is GDScriptFunctionState:
		yield(test, "completed")
	yield(self, "idle_frame") # a test may end inside a signal of the connection
	connection.free()
	quit(1 if failed else 0)


func _on_replied(command, accepted, reason):
	replies[command] = [accepted, reason]


func check(condition, what):
	if not condition:
		print("FAILED: ", what)
		failed = true
	return condition


# Runs frames until an expression of this script is true; at most 90 s, however slow the machine.
func until(condition, what):
	var expression = Expression.new()
	check(expression.parse(condition) == OK, condition)
	yield(self, "idle_frame")
	var end = OS.get_ticks_msec() + PATIENCE_MS
	while not expression.execute([], self):
		if OS.get_ticks_msec() > end or expression.has_execute_failed():
			check(false, "not within 90 s: " + what)
			break
		yield(self, "idle_frame")


func frames_for(ms):
	var end = OS.get_ticks_msec() + ms
	while OS.get_ticks_msec() < end:
		yield(self, "idle_frame")


func start():
	root.add_child(connection)
	yield(until(HAS_STATE, "a state"), "completed")


# ---- drawn poses compared with the program's poses in the same message ----

var worst_link = 0.0
var worst_body = 0.0
var worst_turn = 0.0
var compared = 0
var compared_tick = -1
var not_drawn = 0
var lowest = Vector3(1e9, 1e9, 1e9)
var highest = -Vector3(1e9, 1e9, 1e9)


func drawn_where_the_program_says():
	yield(start(), "completed")
	yield(until("_has_compared()", "200 states"), "completed")
	check(hand.links.size() == connection.scene.links.size() and hand.links.size() == 19, "links of the hand")
	check(world.bodies.size() == connection.scene.bodies.size() and world.bodies.size() == 4, "bodies of the bar")
	check(not_drawn < 20, "states that are not drawn: %d" % not_drawn)
	check(worst_link < 0.002, "links are off by %f m" % worst_link)
	check(worst_body < 0.002, "bodies are off by %f m" % worst_body)
	check(worst_turn < 1e-4, "turned by %f" % worst_turn)
	var moved = (highest - lowest).length()
	check(moved > 0.01, "the hand moves, %f m" % moved)
	check(connection.ignored == 0, "messages were ignored")
	print("figure: Godot 3.2.3 headless, the bar, %d states: links off by %.6f mm at worst, bodies by %.6f mm, directions by %.7f; the hand moved %.0f mm"
			% [compared, 1e3 * worst_link, 1e3 * worst_body, worst_turn, 1e3 * moved])


# One frame later, the connection's reader still has the message if it was the last.
func _has_compared():
	if connection.state.tick != compared_tick and connection._payload_type() == Protocol.Payload.WorldState:
		compared_tick = connection.state.tick
		_compare()
	return compared >= 200


func _compare():
	if hand.drawn_tick != compared_tick or world.drawn_tick != compared_tick:
		not_drawn += 1 # during arming, the scene belongs to another session than the states
		return
	var reader = connection._reader
	var table = reader.table(reader.root(), Protocol.Message.payload)
	var first = reader.vector(table, Protocol.WorldState.links, Protocol.Pose.SIZE)
	if reader.count_of(first) != hand.links.size():
		return
	for i in range(hand.links.size()):
		worst_link = max(worst_link, _difference(reader, first + i * Protocol.Pose.SIZE, hand, hand.links[i]))
	first = reader.vector(table, Protocol.WorldState.bodies, Protocol.Pose.SIZE)
	for i in range(world.bodies.size()):
		worst_body = max(worst_body, _difference(reader, first + i * Protocol.Pose.SIZE, world, world.bodies[i]))
	var at = hand.links[3].transform.origin
	lowest = Vector3(min(lowest.x, at.x), min(lowest.y, at.y), min(lowest.z, at.z))
	highest = Vector3(max(highest.x, at.x), max(highest.y, at.y), max(highest.z, at.z))
	compared += 1


func _difference(reader, place, frame, node):
	var at = FROM_PROGRAM.xform(reader.vector3(place))
	var turn = FROM_PROGRAM * Basis(reader.quat(place + 12).normalized()) * FROM_PROGRAM.transposed()
	var drawn = frame.global_transform.affine_inverse() * node.global_transform
	for axis in range(3):
		worst_turn = max(worst_turn, (drawn.basis[axis] - turn[axis]).length())
	return (drawn.origin - at).length()


# ---- commands ----

func answered(command, what):
	check(command != 0, what + " is sent")
	yield(until("replies.has(%d)" % command, what + " is answered"), "completed")
	yield(self, "idle_frame")
	return replies.get(command, [false, ""])


func accepted(command, what):
	var answer = yield(answered(command, what), "completed")
	check(answer[0], "%s: %s" % [what, answer[1]])


func refused(command, what, text):
	var answer = yield(answered(command, what), "completed")
	check(not answer[0] and text in answer[1], "%s: refused with \"%s\"" % [what, answer[1]])


func _run_state():
	return connection.state.run_state if connection.state != null else -1


func commands_are_obeyed_or_refused_with_the_reason():
	check(connection.stop() == 0, "without a connection nothing is sent")
	yield(start(), "completed")
	yield(refused(connection.arm(connection.state.endings, connection.state.basis), "arm", "controls"), "completed")
	yield(accepted(connection.take_controls(), "take the controls"), "completed")
	yield(until("connection.holds_controls", "the controls"), "completed")
	yield(refused(connection.arm(connection.state.endings + 7, connection.state.basis), "arm after an unseen stop", "stopped after"), "completed")
	yield(refused(connection.load_exercise("chess"), "load", "chess"), "completed")
	yield(refused(connection.set_parameter("no_such", 1.0), "set", "no_such"), "completed")
	ring = Spatial.new()
	hand.link("ring_pip_flexion").add_child(ring)
	yield(accepted(connection.arm(connection.state.endings, connection.state.basis), "arm"), "completed")
	yield(until(RENDERS, "rendering"), "completed")
	yield(until(DRAWN, "the new scene"), "completed")
	check(is_instance_valid(ring) and ring.get_parent() == hand.link("ring_pip_flexion"), "what hangs on a link stays")
	check(hand.link("ring_pip_flexion").get_child_count() == 2, "beside the one capsule of the new scene")
	var parameter = connection.scene.parameters[0]
	yield(accepted(connection.set_parameter(parameter.name, 0.5 * (parameter.lower + parameter.upper), connection.state.basis), "set"), "completed")
	yield(refused(connection.set_parameter(parameter.name, parameter.upper + 1e6), "set", parameter.name), "completed")
	yield(accepted(connection.steer(Protocol.Steering.Person), "steer"), "completed")
	yield(_aim_3_cm_to_the_left(), "completed")
	yield(accepted(connection.act(Protocol.Act.Pause), "pause"), "completed")
	yield(accepted(connection.stop(), "stop"), "completed")
	yield(until(STOPPED, "stopped"), "completed")
	yield(accepted(connection.load_exercise("free-grasping", 1), "load"), "completed")
	yield(accepted(connection.arm(connection.state.endings, connection.state.basis), "arm again"), "completed")
	yield(until(RENDERS, "rendering"), "completed")
	yield(accepted(connection.release_controls(), "release"), "completed")
	yield(accepted(connection.emergency_stop(), "emergency stop without the controls"), "completed")
	yield(until(STOPPED, "stopped"), "completed")
	check(world.body("glass") == null and world.bodies.size() == connection.scene.bodies.size(), "bodies of the new scene")
	check(connection.ignored == 0, "messages were ignored")


func _aim_3_cm_to_the_left():
	var before = connection.state.q_s[1]
	var q = Array(connection.state.q_s)
	q[1] += 0.03
	var end = OS.get_ticks_msec() + PATIENCE_MS
	while abs(connection.state.q_s[1] - before - 0.03) > 0.01 and OS.get_ticks_msec() < end:
		connection.aim(q)
		yield(self, "idle_frame")
	check(abs(connection.state.q_s[1] - before - 0.03) <= 0.01, "the hand goes where it is aimed")


func a_game_that_hangs_loses_the_controls():
	yield(start(), "completed")
	yield(accepted(connection.take_controls(), "take the controls"), "completed")
	yield(until("connection.holds_controls", "the controls"), "completed")
	yield(frames_for(600), "completed")
	check(connection.holds_controls, "frames keep them")
	OS.delay_msec(600)
	yield(until("not connection.holds_controls", "the controls are lost"), "completed")
	check(connection.connected, "it is connected all the same")
	yield(accepted(connection.take_controls(), "take them anew"), "completed")


# ---- bodies of a game: game_table.toml, whose table's top is at 0.02 m beside the hand ----

const RADIUS = 0.03
const ABOVE = Vector3(0.5, 0.3, 0.17) # position in the program's axes
const RESTS = Vector3(0.5, 0.3, 0.05)
const OVER_THE_HAND = Vector3(0.034, 0.0, 0.15) # at the device's zero position

var body_events = []
var touches = []
var refused_items = []
var goal = Vector3()
var resting = 0


func start_with_controls():
	# The pose of the program's world in the game's world must not matter.
	world.transform = Transform(Basis(Vector3(1, 2, 3).normalized(), 0.7), Vector3(1, 2, -3))
	connection.connect("body_event", self, "_on_body_event")
	connection.connect("bodies_refused", self, "_on_bodies_refused")
	yield(start(), "completed")
	yield(accepted(connection.take_controls(), "take the controls"), "completed")
	yield(accepted(connection.arm(connection.state.endings, connection.state.basis), "arm"), "completed")
	yield(until(RENDERS, "rendering"), "completed")
	yield(until(DRAWN, "the new scene"), "completed")
	if not connection.holds_controls: # a slow machine takes more than 200 ms to build the scene
		yield(accepted(connection.take_controls(), "take the controls again"), "completed")
	check(connection.scene.budget.slots == 64 and world.bodies.size() == 2, "the scene: %s" % [connection.scene.budget])


func _on_body_event(what, slot, generation, refusal):
	body_events.append([what, slot, generation, refusal])


func _on_bodies_refused(_command, items):
	refused_items = items


# Waits for the next event of this kind that was not returned before.
func becomes(what, slot):
	yield(self, "idle_frame")
	var end = OS.get_ticks_msec() + PATIENCE_MS
	while OS.get_ticks_msec() < end:
		for event in body_events:
			if event[0] == what and event[1] == slot:
				body_events.erase(event)
				return event
		yield(self, "idle_frame")
	check(false, "not within 90 s: slot %d: %s; there were %s" % [slot, what, body_events])
	return [what, slot, 0, 0]


# Converts a pose from the program's axes to the game's world.
func placed(position, turn = Basis()):
	return world.global_transform * Transform(FROM_PROGRAM * turn * FROM_PROGRAM.transposed(), FROM_PROGRAM.xform(position))


func _off(slot, position):
	return (world.game_bodies[slot].global_transform.origin - placed(position).origin).length()


func a_ball_falls_rests_and_is_removed():
	yield(start_with_controls(), "completed")
	yield(accepted(world.prepare_shapes(3, [Shapes.ball_piece(RADIUS)]), "shapes"), "completed")
	yield(accepted(world.spawn({"slot": 2, "generation": 7, "shape_set": 3}, placed(ABOVE)), "spawn"), "completed")
	var solid = yield(becomes("solid", 2), "completed")
	check(solid[2] == 7, "generation: %s" % [solid])
	yield(until("world.game_bodies.has(2) and connection.state.body_positions.size() == 5", "the ball is drawn"), "completed")
	var ball = world.game_bodies[2]
	check(ball.get_child_count() == 1 and abs(ball.get_child(0).mesh.radius - RADIUS) < 1e-6, "as a ball")
	yield(until("_rests()", "it rests on the table for 30 states"), "completed")
	var listed = connection.bodies.bodies[0]
	check(connection.bodies.bodies.size() == 1 and listed.slot == 2 and listed.generation == 7
			and listed.state == Protocol.SlotState.Solid, "listed: %s" % [connection.bodies.bodies])
	yield(accepted(world.remove_body(2, 7), "remove"), "completed")
	var left = yield(becomes("left", 2), "completed")
	check(left[2] == 7, "what left: %s" % [left])
	yield(until(NO_BODIES, "no body is left"), "completed")
	yield(self, "idle_frame")
	check(not is_instance_valid(ball) and connection.shapes.empty(), "nothing is left of it")
	check(connection.ignored == 0, "messages were ignored")


func a_ball_that_falls_on_the_hand_tells_its_touch():
	connection.connect("body_touched", self, "_on_body_touched")
	yield(start_with_controls(), "completed")
	yield(accepted(world.prepare_shapes(0, [Shapes.ball_piece(RADIUS)]), "shapes"), "completed")
	yield(accepted(world.spawn({"slot": 1, "generation": 9, "shape_set": 0, "mass_kg": 0.2}, placed(OVER_THE_HAND)), "spawn"), "completed")
	yield(until("not touches.empty()", "the ball touches the hand"), "completed")
	# It falls 0.15 m at most: 1.7 m/s.
	check(touches[0][0] == 1 and touches[0][1] == 9 and touches[0][2] > 0.005 and touches[0][2] < 0.2 * 1.7, "touch: %s" % [touches])


func _on_body_touched(slot, generation, impulse_ns):
	touches.append([slot, generation, impulse_ns])


# manual.gd contains the code of clients/godot/README.md, with a ring and a world.
func the_manuals_pieces_are_played():
	connection.free()
	var manual = load("res://manual.gd").new()
	connection = manual.connection
	hand = manual.hand
	world = manual.world
	connection.port = int(OS.get_environment("WHOLEHAND_PORT"))
	connection.add_child(world)
	connection.connect("replied", self, "_on_replied")
	connection.connect("body_event", self, "_on_body_event")
	connection.connect("body_touched", self, "_on_body_touched")
	root.add_child(manual)
	yield(until(HAS_STATE, "a state"), "completed")
	yield(until("hand.link('ring_pip_flexion') != null and hand.link('ring_pip_flexion').has_node('Ring')", "the ring is on"), "completed")
	manual._on_start_pressed()
	yield(until(RENDERS, "rendering"), "completed")
	yield(until("hand.drawn_tick >= 0", "the new scene, which has no bodies of its own"), "completed")
	if not connection.holds_controls: # a slow machine takes more than 200 ms to build the scene
		yield(accepted(connection.take_controls(), "take the controls again"), "completed")
	manual._drop()
	var solid = yield(becomes("solid", 0), "completed")
	check(solid[2] == 1, "generation: %s" % [solid])
	yield(until("not touches.empty()", "the ball touches the hand"), "completed")
	# It falls 0.15 m at most: 1.7 m/s.
	check(touches[0][0] == 0 and touches[0][2] > 0.005 and touches[0][2] < 0.2 * 1.7, "touch: %s" % [touches])


func _rests():
	if compared_tick != connection.state.tick:
		compared_tick = connection.state.tick
		resting = resting + 1 if _off(2, RESTS) < 0.002 else 0
	return resting >= 30


func a_driven_body_follows_its_target():
	var own = Spatial.new()
	own.set_meta("wholehand_body", [5, 1])
	world.add_child(own)
	yield(start_with_controls(), "completed")
	# The shape is wider to the right than high, so its axes matter.
	var pieces = [Shapes.box_piece(Vector3(0.04, 0.02, 0.03)), Shapes.piece_at(Shapes.convex_piece(
			[Vector3(0, 0, 0), Vector3(0.03, 0, 0), Vector3(0, 0.03, 0), Vector3(0, 0, 0.03)],
			[0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]), Transform(Basis(), Vector3(0, 0.02, 0)))]
	yield(accepted(world.prepare_shapes(0, pieces), "shapes"), "completed")
	yield(accepted(world.spawn({"slot": 5, "shape_set": 0, "owner": Protocol.BodyOwner.Game}, placed(ABOVE)), "spawn"), "completed")
	yield(becomes("solid", 5), "completed")
	yield(until("world.game_bodies.has(5)", "the game's own node"), "completed")
	check(world.game_bodies[5] == own and own.get_child_count() == 0, "is moved, and not drawn over")
	var made = connection.shapes.values()[0].pieces
	check((made[0].half_extents_m - Vector3(0.015, 0.02, 0.01)).length() < 1e-6, "half extents: %s" % made[0].half_extents_m)
	check(made[1].points_m.size() == 4 and made[1].triangles.size() == 12, "the mesh: %s" % [made[1]])
	goal = ABOVE + Vector3(0, 0.08, 0.03)
	world.set_target(5, placed(goal, Basis(Vector3(0, 0, 1), 1.0)))
	yield(until("_is_at_goal()", "the target is reached"), "completed")
	world.clear_target(5)
	yield(accepted(world.set_body_owner(5, 1, Protocol.BodyOwner.Fixed), "hand over"), "completed")
	goal = ABOVE
	yield(accepted(world.teleport_body(5, 1, placed(goal, Basis(Vector3(0, 0, 1), 1.0))), "teleport"), "completed")
	yield(until("_is_at_goal()", "it is put elsewhere"), "completed")
	yield(accepted(connection.stop(), "stop"), "completed")
	yield(until(NO_BODIES, "bodies end with their session"), "completed")
	check(is_instance_valid(own), "the game's own node stays")
	check(connection.ignored == 0, "messages were ignored")


func _is_at_goal():
	var turned = placed(goal, Basis(Vector3(0, 0, 1), 1.0)).basis
	return _off(5, goal) < 0.002 and (world.game_bodies[5].global_transform.basis.x - turned.x).length() < 0.01


const NEAR = Vector3(0.1, 0.25, 0.2) # a place in reach beside the hand
const BESIDE = Vector3(0.1, 0.25, 0.4)
const FAR = Vector3(3.0, 0.5, 0.0)
const ELSEWHERE = Vector3(2.0, -0.5, 1.0)

var named_events = [] # [what, [slot or number, generation]]


func bodies_beyond_the_slots_are_one_node_in_and_out_of_reach():
	connection.connect("body_event", self, "_on_named_body_event")
	yield(start_with_controls(), "completed")
	yield(accepted(world.prepare_shapes(0, [Shapes.ball_piece(RADIUS)]), "shapes"), "completed")
	var orders = [{"slot": 1000, "generation": 6, "shape_set": 0, "owner": Protocol.BodyOwner.Fixed, "position_m": NEAR},
			{"slot": 2000, "generation": 7, "shape_set": 0, "owner": Protocol.BodyOwner.Game, "position_m": FAR}]
	yield(accepted(connection.spawn_bodies(orders), "spawn"), "completed")
	yield(until("_are_both_drawn()", "both are drawn"), "completed")
	var node = world.game_bodies[2000]
	check(connection.body_list.registered[2000].whereabouts == Protocol.Whereabouts.OutOfReach, "out of reach")
	yield(until("[\"solid\", 1000, 6] in named_events", "the event of the near one, by the game's name"), "completed")
	goal = ELSEWHERE
	world.set_target(2000, placed(goal))
	yield(until("_is_2000_at_goal()", "out of reach it is at its target at once"), "completed")
	world.clear_target(2000)
	goal = BESIDE
	yield(accepted(world.teleport_body(2000, 7, placed(goal)), "teleport"), "completed")
	yield(until("world._slots.has(2000) and _is_2000_at_goal()", "it has come near, and has a slot"), "completed")
	check(world.game_bodies[2000] == node and world.game_bodies.size() == 2, "the same node")
	goal = FAR
	yield(accepted(world.teleport_body(2000, 7, placed(goal)), "teleport"), "completed")
	yield(until("not world._slots.has(2000) and _is_2000_at_goal()", "and is far again"), "completed")
	check(world.game_bodies[2000] == node, "still the same node")
	yield(accepted(connection.remove_bodies([[1000, 6], [2000, 7]]), "remove"), "completed")
	yield(until(NO_BODIES, "they are gone"), "completed")
	yield(self, "idle_frame")
	check(not is_instance_valid(node) and connection.shapes.empty(), "nothing is left of them")
	check(connection.ignored == 0, "messages were ignored")


func _on_named_body_event(what, slot, _generation, _refusal):
	named_events.append([what] + connection.body_list.name_in(slot))


func _are_both_drawn():
	return world.game_bodies.size() == 2 and _off(1000, NEAR) < 1e-4 and _off(2000, FAR) < 1e-4 and world._slots.has(1000)


func _is_2000_at_goal():
	return _off(2000, goal) < 1e-4


# All bodies move in every frame: each list reports 1,000 bodies, 20 times a second.
func a_thousand_bodies_are_cheap():
	yield(start_with_controls(), "completed")
	yield(accepted(world.prepare_shapes(0, [Shapes.ball_piece(RADIUS)]), "shapes"), "completed")
	for first in range(1000, 2000, 50):
		var orders = []
		for number in range(first, first + 50):
			orders.append({"slot": number, "shape_set": 0, "owner": Protocol.BodyOwner.Game,
					"position_m": Vector3(3, 0.003 * (number - 1500), 0)})
		var answer = yield(answered(connection.spawn_bodies(orders), "spawn"), "completed")
		while not answer[0] and "controls" in answer[1]: # on a slow machine the controls are lost and taken again
			yield(answered(connection.take_controls(), "take the controls again"), "completed")
			answer = yield(answered(connection.spawn_bodies(orders), "spawn"), "completed")
		check(answer[0], "spawn: %s" % answer[1])
	yield(until("world.game_bodies.size() == 1000", "1,000 are drawn"), "completed")
	yield(until("_have_followed()", "100 frames, and all have followed"), "completed")
	print("figure: Godot 3.2.3 headless, 1,000 bodies of a game follow their targets beyond the slots: %d frames, the longest %d ms"
			% [frames, longest_ms])


var frames = 0
var longest_ms = 0
var frame_ms = 0
var taken_ms = 0


func _have_followed():
	var now_ms = OS.get_ticks_msec()
	if frames > 0:
		longest_ms = max(longest_ms, now_ms - frame_ms)
	frame_ms = now_ms
	if world.game_bodies.size() < 1000:
		return false
	if not connection.holds_controls and now_ms - taken_ms > 500:
		taken_ms = now_ms
		connection.take_controls()
	if frames < 100:
		frames += 1
		for number in range(1000, 2000):
			world.set_target(number, placed(_place_of(number, frames)))
		return false
	for number in [1000, 1500, 1999]:
		if _off(number, _place_of(number, frames)) > 1e-4:
			return false
	return true


func _place_of(number, frame):
	return Vector3(3, 0.003 * (number - 1500), 0.001 * frame)


func refused_orders_say_why():
	yield(start_with_controls(), "completed")
	yield(refused(world.spawn({"slot": 0, "shape_set": 9}, placed(ABOVE)), "spawn without shapes", "not prepared"), "completed")
	check(refused_items.size() == 1 and refused_items[0].refusal == Protocol.BodyRefusal.NoSuchShapes
			and refused_items[0].reason != "", "shapes: %s" % [refused_items])
	yield(accepted(world.prepare_shapes(0, [Shapes.capsule_piece(0.01, 0.05)]), "shapes"), "completed")
	var far = {"slot": 1, "shape_set": 0, "position_m": Vector3(9, 0, 0)}
	yield(refused(connection.spawn_bodies([{"slot": 0, "shape_set": 0, "position_m": ABOVE}, far,
			{"slot": 64, "shape_set": 0, "position_m": ABOVE}]), "two of three", "within 5 m"), "completed")
	check(refused_items.size() == 2 and refused_items[0].item == 1 and refused_items[0].refusal == Protocol.BodyRefusal.BadPose
			and refused_items[1].slot == 64 and refused_items[1].refusal == Protocol.BodyRefusal.NoSuchSlot, "items: %s" % [refused_items])
	yield(becomes("solid", 0), "completed") # the valid order
	yield(accepted(world.remove_body(0, 3), "remove another"), "completed")
	var event = yield(becomes("refused", 0), "completed")
	check(event[3] == Protocol.BodyRefusal.WrongGeneration, "by the loop: %s" % [event])
	yield(accepted(connection.release_controls(), "release"), "completed")
	yield(refused(world.remove_body(0, 1), "remove without the controls", "controls"), "completed")


# ---- a program that ends and is restarted ----

var news = []


func a_program_that_is_restarted_is_found_again():
	connection.connect("connection_changed", self, "_on_connection_changed")
	yield(start(), "completed")
	print("connected") # test_godot.py ends the program now, and starts another
	yield(until("not connection.connected", "the program is gone"), "completed")
	check(connection.state == null and not connection.holds_controls, "nothing is left of it")
	yield(until(HAS_STATE, "found again"), "completed")
	check(news[0][0] and not news[1][0] and news[-1][0], "reported: %s" % [news])
	check("connected to Wholehand" in news[0][1] and "lost" in news[1][1], "in words: %s" % [news])


func _on_connection_changed(connected, why):
	news.append([connected, why])


func a_token_opens_the_program():
	var right = connection.token
	connection.token = "another-secret-of-24-bytes"
	root.add_child(connection)
	yield(until("\"no connection\" in connection.message", "refused"), "completed")
	check("another token" in connection.message and not connection.connected, connection.message)
	connection.token = right
	yield(until(HAS_STATE, "a state"), "completed")


func nobody_there_is_told_once():
	connection.connect("connection_changed", self, "_on_connection_changed")
	root.add_child(connection)
	yield(frames_for(1500), "completed")
	check(news.size() == 1 and not news[0][0] and "no connection to 127.0.0.1" in news[0][1], "reported: %s" % [news])


# ---- damaged messages ----

func damaged_messages_are_ignored():
	yield(start(), "completed")
	yield(until(DRAWN, "a whole state"), "completed")
	var kept = [] # a complete scene and a complete state
	for payload in [Protocol.Payload.WorldState, Protocol.Payload.Scene]:
		kept.append(yield(_next_message(payload), "completed"))
	seed(int(OS.get_environment("WHOLEHAND_SEED")))
	var changed = connection.ignored
	for i in range(int(OS.get_environment("WHOLEHAND_MUTATIONS"))):
		var message = kept[1] if i % 20 == 0 else kept[0]
		if i % 3 == 0:
			message = message.subarray(0, randi() % message.size())
		else:
			message[randi() % message.size()] = randi() % 256
		# It is read but not shown: a changed number is still a valid number.
		var reader = Reader.new()
		reader.open(message)
		var table = reader.table(reader.root(), Protocol.Message.payload)
		var read = Scene.new() if i % 20 == 0 else State.new()
		read.read(reader, table)
		if i % 3 == 0 and message.size() < 40:
			check(reader.broken, "a message of %d bytes is taken for whole" % message.size())
		if reader.broken:
			changed += 1
	check(changed > 0, "some were found to be damaged")
	print("figure: %d damaged messages, %d found so" % [int(OS.get_environment("WHOLEHAND_MUTATIONS")), changed])
	# Damaged messages that reach the connection are counted.
	connection._reader.open(PoolByteArray([1, 2, 3]))
	connection._hear()
	check(connection.ignored == 1, "counted")


func _next_message(payload):
	var reader = connection._reader
	if payload == Protocol.Payload.Scene:
		yield(accepted(connection.take_controls(), "take the controls"), "completed")
		connection.load_exercise("free-grasping")
		yield(connection, "scene_changed")
	else:
		yield(connection, "state_changed")
	return reader._bytes.data_array


# ---- meshes of a scene ----

func every_shape_has_its_mesh():
	var mine = Spatial.new()
	mine.set_meta("wholehand_body", "mug")
	world.add_child(mine)
	yield(start(), "completed")
	check(world.body("mug") == mine and mine.get_child_count() == 0, "the game's own mug is moved, and not drawn over")
	check(world.body("nothing") == null, "no such body")
	var types = {}
	for described in connection.scene.bodies:
		for i in range(described.shapes.size()):
			var shape = described.shapes[i]
			types[shape.type] = true
			var mesh = Shapes.mesh_of(shape)
			check(_extents_fit(shape, mesh, Shapes.turn_of(shape)), "%s: extents of shape %d" % [described.name, shape.type])
	check(types.has(Protocol.ShapeType.ConvexMesh) and types.has(Protocol.ShapeType.Box)
			and types.has(Protocol.ShapeType.Cylinder) and types.has(Protocol.ShapeType.Sphere), "shapes: %s" % [types.keys()])
	var capsule = {"type": Protocol.ShapeType.Capsule, "radius_m": 0.02, "length_m": 0.1}
	check(_extents_fit(capsule, Shapes.mesh_of(capsule), Shapes.turn_of(capsule)), "extents of a capsule")
	for i in range(connection.scene.capsules.size()):
		_check_capsule(connection.scene.capsules[i])
	check(hand.link("thumb_ip_flexion") == hand.links[18] and hand.link("tail") == null, "links by name")


# Half extents of a shape along the program's x, y, z; round shapes lie along z.
func _half_extents(shape):
	match shape.type:
		Protocol.ShapeType.Box:
			return shape.half_extents_m
		Protocol.ShapeType.Sphere:
			return Vector3(1, 1, 1) * shape.radius_m
		Protocol.ShapeType.Cylinder:
			return Vector3(shape.radius_m, shape.radius_m, 0.5 * shape.length_m)
		Protocol.ShapeType.Capsule:
			return Vector3(shape.radius_m, shape.radius_m, 0.5 * shape.length_m + shape.radius_m)
	var lower = shape.points_m[0]
	var upper = lower
	for p in shape.points_m:
		lower = Vector3(min(lower.x, p.x), min(lower.y, p.y), min(lower.z, p.z))
		upper = Vector3(max(upper.x, p.x), max(upper.y, p.y), max(upper.z, p.z))
	return 0.5 * (upper - lower)


func _extents_fit(shape, mesh, turn):
	if mesh == null:
		return false
	var expected = FROM_PROGRAM.xform(_half_extents(shape)).abs()
	var box = Transform(turn, Vector3()).xform(mesh.get_aabb())
	return (0.5 * box.size - expected).length() < 0.02 * expected.length() # round shapes are approximated by corners


func _check_capsule(capsule):
	for node in hand.links[capsule.link].get_children():
		var half = 0.5 * node.mesh.mid_height * node.transform.basis.z
		var off = (node.transform.origin - half - FROM_PROGRAM.xform(capsule.a_m)).length()
		off = max(off, (node.transform.origin + half - FROM_PROGRAM.xform(capsule.b_m)).length())
		if off < 1e-5 and abs(node.mesh.radius - capsule.radius_m) < 1e-6:
			return
	check(false, "capsule %s is not drawn" % capsule.name)


# ---- prediction (tests/clients/prediction has its figures) ----

var ahead_frames = 0   # frames in which the hand is drawn ahead of the newest state
var last_tick = -1
var furthest_ahead = 0.0


func a_predicted_hand_is_ahead_of_the_state():
	hand.predict_motion = true
	yield(start(), "completed")
	yield(until("_is_often_ahead()", "frames in which the hand is ahead"), "completed")
	check(furthest_ahead < 0.1, "%f m ahead of the newest state" % furthest_ahead)
	hand.predict_motion = false
	yield(until("_is_another_tick()", "another state"), "completed")
	yield(self, "idle_frame")
	yield(until("_is_another_tick()", "and one that is drawn as it comes"), "completed")
	check(hand.drawn_tick == connection.state.tick and _ahead() < 1e-6, "it is drawn where the state says")


# Distance from the position where the state itself would be drawn.
func _ahead():
	var at = hand.links[3].transform.origin
	hand._draw(connection.state.theta)
	return (hand.links[3].transform.origin - at).length()


func _is_another_tick():
	var other = connection.state.tick != last_tick
	last_tick = connection.state.tick
	return other


func _is_often_ahead():
	if hand.drawn_tick == connection.state.tick:
		var ahead = _ahead()
		furthest_ahead = max(furthest_ahead, ahead)
		if ahead > 1e-5:
			ahead_frames += 1
	return ahead_frames >= 50


# ---- axes ----

func axes_are_godots():
	var faulty = Scene.new()
	check("nothing of links" in hand._fault_of(faulty), "a scene without links")
	faulty.joint_names = ["x"]
	faulty.links = [{"parent": -1, "joint": 0}, {"parent": 1, "joint": -1}]
	check("link 1 stands before its parent" in hand._fault_of(faulty), "a link that carries itself")
	faulty.links[1] = {"parent": 0, "joint": 1}
	check("link 1 moves with a joint" in hand._fault_of(faulty), "a joint that is not there")
	faulty.links[1].joint = 0
	check(hand._fault_of(faulty) == "", "a sound one")
	check(load("res://addons/wholehand/plugin.gd") != null, "the plugin's script can be read")
	check(Axes.to_godot(Vector3(1, 0, 0)) == Vector3.FORWARD and Axes.to_godot(Vector3(0, 1, 0)) == Vector3.LEFT
			and Axes.to_godot(Vector3(0, 0, 1)) == Vector3.UP, "directions")
	for i in range(200):
		var v = Vector3(rand_range(-1, 1), rand_range(-1, 1), rand_range(-1, 1))
		var q = Quat(rand_range(-1, 1), rand_range(-1, 1), rand_range(-1, 1), rand_range(0.1, 1)).normalized()
		check((FROM_PROGRAM.xform(v) - Axes.to_godot(v)).length() < 1e-6, "a vector")
		check((Axes.from_godot(Axes.to_godot(v)) - v).length() < 1e-6, "and back")
		# Rotating and then converting gives the same as converting and then rotating.
		check((Axes.quat_to_godot(q).xform(Axes.to_godot(v)) - Axes.to_godot(q.xform(v))).length() < 1e-5, "a rotation")
		check((Axes.quat_from_godot(Axes.quat_to_godot(q)).xform(v) - q.xform(v)).length() < 1e-5, "and back")


# ---- cost ----

func states_are_cheap():
	yield(start(), "completed")
	yield(until(DRAWN, "a whole state"), "completed")
	var built = OS.get_ticks_usec()
	hand._build(connection.scene)
	world._build(connection.scene)
	built = (OS.get_ticks_usec() - built) * 1e-3
	var message = yield(_next_message(Protocol.Payload.WorldState), "completed")
	var reader = Reader.new()
	var began = OS.get_ticks_usec()
	for _i in range(500):
		reader.open(message)
		var read = State.new()
		read.read(reader, reader.table(reader.root(), Protocol.Message.payload))
		hand._draw_state(read)
		world._draw_state(read)
	var each_ms = (OS.get_ticks_usec() - began) / 500.0 * 1e-3
	print("figure: Godot 3.2.3 headless, a state of %d bytes read, the hand and %d bodies drawn: %.2f ms; a scene built: %.0f ms"
			% [message.size(), world.bodies.size(), each_ms, built])


func a_hand_without_connection_says_what_to_do():
	var lost = Hand.new()
	lost.name = "LostHand"
	root.add_child(lost)
	var lost_world = World.new()
	lost_world.name = "LostWorld"
	root.add_child(lost_world)
	lost.free()
	lost_world.free()
