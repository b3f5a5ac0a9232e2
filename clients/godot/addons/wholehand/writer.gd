# Writes one FlatBuffers message. A table is an array of fields [slot, kind, value]; kinds: "u8", "u16", "u32", "f64",
# "text", "floats", "table". Forwards: each table, then what it refers to.
extends Reference

const SIZES = {"u8": 1, "u16": 2, "u32": 4, "f64": 8, "text": 4, "floats": 4, "table": 4}

var _bytes


func write(identifier: String, fields: Array) -> PoolByteArray:
	_bytes = StreamPeerBuffer.new()
	_bytes.put_u32(0)
	_bytes.put_data(identifier.to_ascii())
	_put_at(0, _write_table(fields))
	return _bytes.data_array


# Where the table is.
func _write_table(fields: Array) -> int:
	fields = fields.duplicate()
	fields.sort_custom(self, "_is_wider") # then each is aligned without gaps
	var slots = 4
	for field in fields:
		slots = int(max(slots, field[0] + 2))
	_align(8, slots + 4) # the first field behind the table's own offset stands at a multiple of 8
	var vtable = _bytes.get_size()
	var offset = 4
	var offsets = {}
	for field in fields:
		offsets[field[0]] = offset
		offset += SIZES[field[1]]
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
		if fields[i][1] in ["text", "floats", "table"]:
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
	else:
		_bytes.put_u32(value.size())
		for number in value:
			_bytes.put_float(number)
	return place


func _put_scalar(kind: String, value) -> void:
	match kind:
		"u8":
			_bytes.put_u8(value)
		"u16":
			_bytes.put_u16(value)
		"u32":
			_bytes.put_u32(value)
		"f64":
			_bytes.put_double(value)
		_:
			_bytes.put_u32(0) # an offset: written when it is known


func _is_wider(a, b) -> bool:
	return SIZES[a[1]] > SIZES[b[1]]


# So that what begins `ahead` bytes from here stands at a multiple of `size`.
func _align(size: int, ahead: int) -> void:
	while (_bytes.get_size() + ahead) % size != 0:
		_bytes.put_u8(0)


func _put_at(place: int, value: int) -> void:
	_bytes.seek(place)
	_bytes.put_u32(value)
	_bytes.seek(_bytes.get_size())
