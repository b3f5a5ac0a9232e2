# A connection that stores messages instead of sending them.
extends "res://addons/wholehand/connection.gd"

var kept = PoolByteArray()


func _put(message_bytes: PoolByteArray) -> void:
	kept = message_bytes
