# A WorldState: SI, radians, the program's axes (axes.gd converts). Arrays per axis are in the order of scene.axes,
# joints in that of scene.joint_names, bodies in that of scene.bodies.
extends Reference

const Protocol = preload("protocol.gd")

var session = 0          # increases by one with every arming, from 1
var tick = 0
var time_s = 0.0
var sent_monotonic_ns = 0
var run_state = 0        # Protocol.RunState
var steering = 0         # Protocol.Steering
var silent = false       # the robot does not answer: show it, with the device's own emergency stop
var faults = 0
var latched_faults = 0
var authority = 0.0      # 1 while rendering, 0 at neutral
var alpha = 0.0          # blend factor of the exercise's transition
var endings = 0          # number of stops, faults and ends of sessions; arm() needs the last one that was shown
var basis = 0            # number of the person, hand, level and limits shown; arm() needs it
var q_m = PoolRealArray() # coordinates of the device
var q_s = PoolRealArray() # coordinates of the avatar
var theta = PoolRealArray() # joints of the avatar
var sent = PoolRealArray()  # efforts that the device received [N or N m]
var values = []          # values of the exercise
var body_positions = []  # Vector3 [m], centre of mass
var body_orientations = [] # Quat
var contacts = []        # {capsule, body, point_m, force_n}; the force is on the hand


# False if the message is damaged; then its fields must not be used.
func read(reader, table: int) -> bool:
	var f = Protocol.WorldState
	session = reader.u32_of(table, f.session)
	tick = reader.i64_of(table, f.tick)
	time_s = reader.double_of(table, f.time_s)
	sent_monotonic_ns = reader.i64_of(table, f.sent_monotonic_ns)
	run_state = reader.u8_of(table, f.run_state)
	steering = reader.u8_of(table, f.steering)
	silent = reader.u8_of(table, f.silent) != 0
	faults = reader.u32_of(table, f.faults)
	latched_faults = reader.u32_of(table, f.latched_faults)
	authority = reader.float_of(table, f.authority)
	alpha = reader.float_of(table, f.alpha)
	endings = reader.u32_of(table, f.endings)
	basis = reader.u32_of(table, f.basis)
	q_m = reader.floats_of(table, f.q_m)
	q_s = reader.floats_of(table, f.q_s)
	theta = reader.floats_of(table, f.theta)
	sent = reader.floats_of(table, f.sent)
	values = reader.doubles_of(table, f.values)
	_read_bodies(reader, table)
	_read_contacts(reader, table)
	return not reader.broken


func _read_bodies(reader, table: int) -> void:
	var pose = Protocol.Pose
	var first = reader.vector(table, Protocol.WorldState.bodies, pose.SIZE)
	for i in range(reader.count_of(first)):
		var place = first + i * pose.SIZE
		body_positions.append(reader.vector3(place + pose.position_m))
		body_orientations.append(reader.quat(place + pose.orientation_xyzw))


func _read_contacts(reader, table: int) -> void:
	var contact = Protocol.ContactPoint
	var first = reader.vector(table, Protocol.WorldState.contacts, contact.SIZE)
	for i in range(reader.count_of(first)):
		var place = first + i * contact.SIZE
		contacts.append({
			"capsule": reader.i16(place + contact.capsule),
			"body": reader.i16(place + contact.body),
			"point_m": reader.vector3(place + contact.point_m),
			"force_n": reader.vector3(place + contact.force_n),
		})
