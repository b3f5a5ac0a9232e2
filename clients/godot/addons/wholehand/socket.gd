# The WebSocket of connection.gd, in Godot 3. For Godot 4: clients/godot/godot4/socket.gd, with the same functions.
extends Reference

enum {CONNECTING, OPEN, REFUSED, LOST}

const BUFFER_KB = 4096 # size of the largest scene

var state = CONNECTING # changes only within poll()

var _client = WebSocketClient.new()


# False if `address` is invalid. `token` is empty if the program requires none.
func open(address: String, token: String) -> bool:
	_client.set_buffers(BUFFER_KB, 1024, 64, 1024)
	_client.connect("connection_established", self, "_on_opened")
	_client.connect("connection_error", self, "_on_refused")
	_client.connect("connection_closed", self, "_on_lost")
	var headers = PoolStringArray()
	if token != "":
		headers.append("Authorization: Bearer " + token)
	return _client.connect_to_url(address, PoolStringArray(), false, headers) == OK


func poll() -> void:
	_client.poll()


func packet_count() -> int:
	return _client.get_peer(1).get_available_packet_count() if state == OPEN else 0


func take_packet() -> PoolByteArray:
	return _client.get_peer(1).get_packet()


# Call it only while the socket is open.
func send(message: PoolByteArray) -> void:
	var peer = _client.get_peer(1)
	peer.set_write_mode(WebSocketPeer.WRITE_MODE_BINARY)
	peer.put_packet(message)


# A closed socket is not opened again.
func close() -> void:
	_client.disconnect_from_host()


func _on_opened(_protocol: String) -> void:
	state = OPEN


func _on_refused() -> void:
	state = REFUSED


func _on_lost(_clean: bool) -> void:
	state = LOST
