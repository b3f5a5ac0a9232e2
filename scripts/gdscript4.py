"""Writes GDScript of Godot 3 as GDScript of Godot 4: the notation and the names that the addon of clients/godot uses.

Godot's own converter has a table of the same kind (editor/renames_map_3_to_4.cpp of its repository); the tables here
were compared with a part of it only. What has another meaning and not just another name stands in
clients/godot/godot4."""
import re

# Classes and types: whole words, in code, in texts and in comments.
TYPES = {
    "Quat": "Quaternion",
    "Transform": "Transform3D",
    "PoolByteArray": "PackedByteArray",
    "PoolRealArray": "PackedFloat32Array",
    "PoolVector3Array": "PackedVector3Array",
    "Spatial": "Node3D",
    "MeshInstance": "MeshInstance3D",
    "CubeMesh": "BoxMesh",
    "SpatialMaterial": "StandardMaterial3D",
}
# Methods: behind a dot.
METHODS = {
    "empty": "is_empty",
    "get_rotation_quat": "get_rotation_quaternion",
    "to_ascii": "to_ascii_buffer",
    "to_utf8": "to_utf8_buffer",
}
# Constants of protocol.gd that are named like a class of Godot 4, which Godot 4 does not allow.
CONSTANTS = {"Panel": "PanelTable"}
# Notation of Godot 3, and its replacement in Godot 4.
NOTATION = [
    (r"^extends Reference$", r"extends RefCounted"),
    (r"^tool$", r"@tool"),
    (r"^export\((\w+)\) var (\w+)", r"@export var \2: \1"),
    (r"^export var ", r"@export var "),
    (r"\bOS\.(get_ticks_[mu]sec)\(", r"Time.\1("),
    (r"\b(\w+)\.connect\(\"(\w+)\", self, \"(\w+)\"\)", r"\1.\2.connect(\3)"),
    (r"\bemit_signal\(\"(\w+)\"\)", r"\1.emit()"),
    (r"\bemit_signal\(\"(\w+)\", ", r"\1.emit("),
    (r"\.sort_custom\(self, \"(\w+)\"\)", r".sort_custom(\1)"),
]


def rules():
    """Patterns of Godot 3, each with its replacement."""
    yield from NOTATION
    yield from ((rf"\b{old}\b", new) for old, new in TYPES.items())
    yield from ((rf"(?<=\.){old}(?=\()", new) for old, new in METHODS.items())
    yield from ((rf"(^const |\bProtocol\.){old}\b", rf"\1{new}") for old, new in CONSTANTS.items())


def godot4_of(text):
    """The script in GDScript of Godot 4, and the patterns that were found in it."""
    found = set()
    for pattern, new in rules():
        text, times = re.subn(pattern, new, text, flags=re.M)
        if times:
            found.add(pattern)
    return text, found
