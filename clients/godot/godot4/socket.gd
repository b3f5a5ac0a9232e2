# The WebSocket of connection.gd, in Godot 4. For Godot 3: clients/godot/addons/wholehand/socket.gd, with the same
# functions.
extends RefCounted

enum {CONNECTING, OPEN, REFUSED, LOST}

const BUFFER_BYTES = 4194304 # size of the largest scene

var state = CONNECTING # changes only within poll()

var _peer = WebSocketPeer.new()


# False if `address` is invalid. `token` is empty if the program requires none. A game exported for browsers
# cannot send a token: browsers do not allow headers.
func open(address: String, token: String) -> bool:
	_peer.inbound_buffer_size = BUFFER_BYTES
	_peer.max_queued_packets = 1024
	if token != "":
		_peer.handshake_headers = PackedStringArray(["Authorization: Bearer " + token])
	return _peer.connect_to_url(address) == OK


func poll() -> void:
	_peer.poll()
	match _peer.get_ready_state():
		WebSocketPeer.STATE_OPEN:
			state = OPEN
		WebSocketPeer.STATE_CLOSED:
			if state == CONNECTING:
				state = REFUSED
			elif state == OPEN:
				state = LOST


func packet_count() -> int:
	return _peer.get_available_packet_count()


func take_packet() -> PackedByteArray:
	return _peer.get_packet()


# Call it only while the socket is open.
func send(message: PackedByteArray) -> void:
	_peer.send(message, WebSocketPeer.WRITE_MODE_BINARY)


# A closed socket is not opened again.
func close() -> void:
	_peer.close()
