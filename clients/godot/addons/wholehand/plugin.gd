# Adds the nodes of Wholehand to the editor's list of nodes.
tool
extends EditorPlugin


func _enter_tree():
	add_custom_type("WholehandConnection", "Node", preload("connection.gd"), null)
	add_custom_type("WholehandHand", "Spatial", preload("hand.gd"), null)
	add_custom_type("WholehandWorld", "Spatial", preload("world.gd"), null)


func _exit_tree():
	for type in ["WholehandConnection", "WholehandHand", "WholehandWorld"]:
		remove_custom_type(type)
