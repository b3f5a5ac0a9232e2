# Reads one FlatBuffers message. GDScript has no verifier: every offset is checked before it is read, and the first one
# outside the message sets `broken`; everything that is read from then on is 0 or empty.
extends Reference

const Parts = preload("engine_parts.gd")

const IDENTIFIER = "WHND"

var broken = false

var _bytes = StreamPeerBuffer.new()
var _size = 0


func open(message: PoolByteArray) -> void:
	_bytes.data_array = message
	_size = message.size()
	broken = _size < 8 or Parts.part_of(message, 4, 7).get_string_from_ascii() != IDENTIFIER


# Offset of the root table.
func root() -> int:
	return u32(0)


# Offset of a table's field; 0: absent, with its default value.
func field(table: int, slot: int) -> int:
	var vtable = table - i32(table)
	if broken or slot >= u16(vtable):
		return 0
	var offset = u16(vtable + slot)
	return 0 if broken or offset == 0 else table + offset


# Target of the offset at `place`; 0 if the field is absent.
func follow(place: int) -> int:
	return 0 if place == 0 else place + u32(place)


func table(of: int, slot: int) -> int:
	return follow(field(of, slot))


# Offset of a vector's first element; its length is in `count_of`. 0 if it is absent or longer than the message.
func vector(of: int, slot: int, size: int) -> int:
	var place = follow(field(of, slot))
	if place == 0:
		return 0
	return place + 4 if _inside(place + 4, u32(place) * size) else 0


func count_of(vector: int) -> int:
	return 0 if vector == 0 else u32(vector - 4)


func u8_of(table: int, slot: int) -> int:
	var place = field(table, slot)
	return 0 if place == 0 else u8(place)


func bool_of(table: int, slot: int) -> bool:
	return u8_of(table, slot) != 0


func i16_of(table: int, slot: int, default: int = 0) -> int:
	var place = field(table, slot)
	return default if place == 0 else i16(place)


func u16_of(table: int, slot: int) -> int:
	var place = field(table, slot)
	return 0 if place == 0 else u16(place)


func u32_of(table: int, slot: int) -> int:
	var place = field(table, slot)
	return 0 if place == 0 else u32(place)


func i32_of(table: int, slot: int) -> int:
	var place = field(table, slot)
	return 0 if place == 0 else i32(place)


func i64_of(table: int, slot: int) -> int:
	var place = field(table, slot)
	return 0 if place == 0 else i64(place)


func float_of(table: int, slot: int) -> float:
	var place = field(table, slot)
	return 0.0 if place == 0 else f32(place)


func double_of(table: int, slot: int) -> float:
	var place = field(table, slot)
	return 0.0 if place == 0 else f64(place)


func vector3_of(table: int, slot: int) -> Vector3:
	return vector3(field(table, slot))


func text_of(table: int, slot: int) -> String:
	return text(follow(field(table, slot)))


# A string at the offset of its length.
func text(place: int) -> String:
	if place == 0:
		return ""
	var length = u32(place)
	if length == 0 or not _inside(place + 4, length):
		return ""
	_bytes.seek(place + 4)
	return _bytes.get_utf8_string(length)


func texts_of(table: int, slot: int) -> Array:
	var all = []
	var first = vector(table, slot, 4)
	for i in range(count_of(first)):
		all.append(text(follow(first + 4 * i)))
	return all


func floats_of(table: int, slot: int) -> PoolRealArray:
	var all = PoolRealArray()
	var first = vector(table, slot, 4)
	if first == 0:
		return all
	var count = count_of(first)
	all.resize(count)
	_bytes.seek(first)
	for i in range(count):
		all[i] = _bytes.get_float()
	return all


func doubles_of(table: int, slot: int) -> Array:
	var all = []
	var first = vector(table, slot, 8)
	for i in range(count_of(first)):
		all.append(f64(first + 8 * i))
	return all


# Three numbers without conversion, in the program's axes.
func vector3(place: int) -> Vector3:
	if place == 0 or not _inside(place, 12):
		return Vector3()
	_bytes.seek(place)
	var x = _bytes.get_float()
	var y = _bytes.get_float()
	return Vector3(x, y, _bytes.get_float())


func quat(place: int) -> Quat:
	if place == 0 or not _inside(place, 16):
		return Quat()
	_bytes.seek(place)
	var x = _bytes.get_float()
	var y = _bytes.get_float()
	var z = _bytes.get_float()
	return Quat(x, y, z, _bytes.get_float())


func u8(place: int) -> int:
	return _bytes.get_u8() if _goes(place, 1) else 0


func i16(place: int) -> int:
	return _bytes.get_16() if _goes(place, 2) else 0


func u16(place: int) -> int:
	return _bytes.get_u16() if _goes(place, 2) else 0


func i32(place: int) -> int:
	return _bytes.get_32() if _goes(place, 4) else 0


func u32(place: int) -> int:
	return _bytes.get_u32() if _goes(place, 4) else 0


func i64(place: int) -> int:
	return _bytes.get_64() if _goes(place, 8) else 0


func f32(place: int) -> float:
	return _bytes.get_float() if _goes(place, 4) else 0.0


func f64(place: int) -> float:
	return _bytes.get_double() if _goes(place, 8) else 0.0


func _goes(place: int, size: int) -> bool:
	if not _inside(place, size):
		return false
	_bytes.seek(place)
	return true


func _inside(place: int, size: int) -> bool:
	if broken or place < 0 or size < 0 or place + size > _size:
		broken = true
		return false
	return true
