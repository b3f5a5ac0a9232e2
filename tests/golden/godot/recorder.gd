# A connection that keeps what it would send.
extends "res://addons/wholehand/connection.gd"

var kept = PoolByteArray()


func _put(message_bytes: PoolByteArray) -> void:
	kept = message_bytes
