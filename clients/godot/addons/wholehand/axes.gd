# Converts between Wholehand's axes (right-handed: x away from the person, y left, z up) and Godot's (right-handed: x
# right, y up, -z forward); metres in both. docs/axes.md of Wholehand.
extends Reference


# Positions, directions, forces and torques are converted alike, since both axes are right-handed.
static func to_godot(v: Vector3) -> Vector3:
	return Vector3(-v.y, v.z, -v.x)


static func from_godot(v: Vector3) -> Vector3:
	return Vector3(-v.z, -v.x, v.y)


static func quat_to_godot(q: Quat) -> Quat:
	return Quat(-q.y, q.z, -q.x, q.w)


static func quat_from_godot(q: Quat) -> Quat:
	return Quat(-q.z, -q.x, q.y, q.w)


static func pose_to_godot(position: Vector3, orientation: Quat) -> Transform:
	return Transform(Basis(quat_to_godot(orientation).normalized()), to_godot(position))
