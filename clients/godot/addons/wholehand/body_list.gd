# The bodies of a game in the world, assembled from the lists of the program (bodies.gd): each list contains all slots,
# and the bodies beyond the slots that changed.
extends Reference

const Protocol = preload("protocol.gd")

const FIRST_NUMBER = 1000 # smallest number that replaces a slot
const LAST_NUMBER = 32767

var newest = null   # list; null before the first
var shapes = {}     # id -> {id, com_m, pieces}
var registered = {} # number -> {number, generation, shapes, slot, whereabouts, position_m, orientation}
var numbers = {}    # slot -> number of the registered body that has it, or is on its way there

# Names by slot, also of bodies that have left it: their last event may come after the list without them.
var _names = {}       # [number, generation] of registered bodies
var _generations = {} # generations in the loop


func take(reported) -> void:
	newest = reported
	for body in reported.registered:
		if body.whereabouts == Protocol.Whereabouts.Gone:
			registered.erase(body.number)
		elif body.number >= FIRST_NUMBER and body.number <= LAST_NUMBER:
			registered[body.number] = body
	var known = shapes
	for made in reported.new_shapes:
		known[made.id] = made
	shapes = {}
	numbers = {}
	for number in registered:
		_keep(registered[number].shapes, known)
		if registered[number].slot >= 0:
			numbers[registered[number].slot] = number
			_names[registered[number].slot] = [number, registered[number].generation]
	for body in reported.bodies:
		_keep(body.shapes, known)
		_generations[body.slot] = body.generation
		if not numbers.has(body.slot):
			_names.erase(body.slot)


func clear() -> void:
	newest = null
	shapes = {}
	registered = {}
	numbers = {}


func note_appeared(slot: int, generation: int) -> void:
	_generations[slot] = generation


# The loop's generation of the body in a slot.
func generation_in(slot: int) -> int:
	return _generations.get(slot, 0)


# The name that the game gave the body in a slot: [slot, generation] or [number, generation].
func name_in(slot: int) -> Array:
	return _names.get(slot, [slot, generation_in(slot)])


func _keep(id: int, known: Dictionary) -> void:
	if known.has(id):
		shapes[id] = known[id]
