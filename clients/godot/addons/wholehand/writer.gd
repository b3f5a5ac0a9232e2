# Writes one FlatBuffers message. A table is an array of fields [slot, kind, value]; kinds: "u8", "u16", "u32", "f32",
# "f64", "text", "table", "tables"; "struct" and "structs", whose value is an array of [kind, number] for each struct,
# and whose numbers have 4 bytes or fewer; "floats" and "u32s". It writes forwards: each table, then its children.
extends Reference

const SIZES = {"u8": 1, "u16": 2, "u32": 4, "f32": 4, "f64": 8, "text": 4, "floats": 4, "u32s": 4, "table": 4, "tables": 4,
		"structs": 4}
const OUTSIDE = ["text", "floats", "u32s", "table", "tables", "structs"]
const STRUCT_ALIGNMENT = 4

var _bytes


func write(identifier: String, fields: Array) -> PoolByteArray:
	_bytes = StreamPeerBuffer.new()
	_bytes.put_u32(0)
	_bytes.put_data(identifier.to_ascii())
	_put_at(0, _write_table(fields))
	return _bytes.data_array


# Offset of the table.
func _write_table(fields: Array) -> int:
	fields = fields.duplicate()
	fields.sort_custom(self, "_is_wider") # sorted by size, each field is aligned without gaps
	var slots = 4
	for field in fields:
		slots = int(max(slots, field[0] + 2))
	_align(8, slots + 4) # the first field behind the table's own offset is at a multiple of 8
	var vtable = _bytes.get_size()
	var offset = 4
	var offsets = {}
	for field in fields:
		offsets[field[0]] = offset
		offset += _struct_size(field[2]) if field[1] == "struct" else SIZES[field[1]]
	_bytes.put_u16(slots)
	_bytes.put_u16(offset)
	for slot in range(4, slots, 2):
		_bytes.put_u16(offsets.get(slot, 0))
	var table = _bytes.get_size()
	_bytes.put_32(table - vtable)
	var places = []
	for field in fields:
		places.append(_bytes.get_size())
		_put_scalar(field[1], field[2])
	for i in range(fields.size()):
		if fields[i][1] in OUTSIDE:
			_put_at(places[i], _write_child(fields[i][1], fields[i][2]) - places[i])
	return table


func _write_child(kind: String, value) -> int:
	if kind == "table":
		return _write_table(value)
	_align(4, 0)
	var place = _bytes.get_size()
	if kind == "text":
		var text = value.to_utf8()
		_bytes.put_u32(text.size())
		_bytes.put_data(text)
		_bytes.put_u8(0)
		return place
	_bytes.put_u32(value.size())
	match kind:
		"floats":
			for number in value:
				_bytes.put_float(number)
		"u32s":
			for number in value:
				_bytes.put_u32(number)
		"structs":
			for numbers in value:
				_put_struct(numbers)
		"tables":
			_write_tables(value)
	return place


# A vector of tables: their count, their offsets, then the tables.
func _write_tables(tables: Array) -> void:
	var first = _bytes.get_size()
	for _table in tables:
		_bytes.put_u32(0)
	for i in range(tables.size()):
		var place = first + 4 * i
		_put_at(place, _write_table(tables[i]) - place)


func _put_struct(numbers: Array) -> void:
	for number in numbers:
		_put_scalar(number[0], number[1])
	_align(STRUCT_ALIGNMENT, 0)


func _struct_size(numbers: Array) -> int:
	var size = 0
	for number in numbers:
		size += SIZES[number[0]]
	return size + (-size & (STRUCT_ALIGNMENT - 1))


func _put_scalar(kind: String, value) -> void:
	match kind:
		"u8":
			_bytes.put_u8(value)
		"u16":
			_bytes.put_u16(value)
		"u32":
			_bytes.put_u32(value)
		"f32":
			_bytes.put_float(value)
		"f64":
			_bytes.put_double(value)
		"struct":
			_put_struct(value)
		_:
			_bytes.put_u32(0) # an offset that is written later


func _is_wider(a, b) -> bool:
	return SIZES.get(a[1], STRUCT_ALIGNMENT) > SIZES.get(b[1], STRUCT_ALIGNMENT)


# Pads so that the data `ahead` bytes from here are at a multiple of `size`.
func _align(size: int, ahead: int) -> void:
	while (_bytes.get_size() + ahead) % size != 0:
		_bytes.put_u8(0)


func _put_at(place: int, value: int) -> void:
	_bytes.seek(place)
	_bytes.put_u32(value)
	_bytes.seek(_bytes.get_size())
