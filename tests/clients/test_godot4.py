"""The addon in GDScript of Godot 4: what scripts/godot_addon.py translates from that of Godot 3.

test_godot4.py <folder to build in> [Class.test]. Debian has no Godot 4, so the addon is not run: every name of
the output is compared with the names of Godot 4."""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import zipfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SCRIPTS = SOURCE / "scripts"
sys.path.insert(0, str(SCRIPTS))
import gdscript4  # noqa: E402

# Names of Godot 3 that Godot 4 does not have, and their replacements. Godot's converter has such a table
# (editor/renames_map_3_to_4.cpp); this table was compared with a part of it only.
GONE = {
    "Area": "Area3D", "Camera": "Camera3D", "CubeMesh": "BoxMesh", "Directory": "DirAccess", "File": "FileAccess",
    "GDScriptFunctionState": "await", "ImmediateGeometry": "ImmediateMesh", "KinematicBody": "CharacterBody3D",
    "MeshInstance": "MeshInstance3D", "NetworkedMultiplayerPeer": "MultiplayerPeer", "PoolByteArray": "PackedByteArray",
    "PoolColorArray": "PackedColorArray", "PoolIntArray": "PackedInt32Array", "PoolRealArray": "PackedFloat32Array",
    "PoolStringArray": "PackedStringArray", "PoolVector2Array": "PackedVector2Array",
    "PoolVector3Array": "PackedVector3Array", "Position3D": "Marker3D", "Quat": "Quaternion", "Reference": "RefCounted",
    "RigidBody": "RigidBody3D", "Spatial": "Node3D", "SpatialMaterial": "StandardMaterial3D", "StaticBody": "StaticBody3D",
    "Transform": "Transform3D", "VisualServer": "RenderingServer", "WebSocketClient": "WebSocketPeer",
    "WebSocketServer": "TCPServer and WebSocketPeer", "bytes2var": "bytes_to_var", "db2linear": "db_to_linear",
    "deg2rad": "deg_to_rad", "disconnect_from_host": "close", "empty": "is_empty", "funcref": "a Callable",
    "get_rotation_quat": "get_rotation_quaternion", "idle_frame": "process_frame",
    "iterations_per_second": "physics_ticks_per_second", "linear2db": "linear_to_db", "mid_height": "height",
    "parse_json": "JSON.parse_string", "rad2deg": "rad_to_deg", "rand_range": "randf_range", "range_lerp": "remap",
    "setget": "a property's set and get", "stepify": "snapped", "str2var": "str_to_var", "subarray": "slice",
    "to_ascii": "to_ascii_buffer", "to_json": "JSON.stringify", "to_utf8": "to_utf8_buffer", "translation": "position",
    "var2bytes": "var_to_bytes", "var2str": "var_to_str", "xform": "*", "xform_inv": "*", "yield": "await",
}
# Syntax of Godot 3 that Godot 4 does not accept.
GONE_NOTATION = {
    r"^tool\b": "@tool", r"^export\b": "@export", r"^onready\b": "@onready", r"\bOS\.get_ticks_[mu]sec\b": "Time",
    r"\bconnect\([^()]*\bself\b": "SIGNAL.connect(METHOD)", r"\bsort_custom\(self\b": "sort_custom(METHOD)",
    r"\.instance\(\)": "instantiate()",
}
# All names that the addon uses of Godot 4, as in Godot 4.6: words of GDScript, functions, types and their members.
GODOT4 = set("""
    and break const continue elif else enum export extends false for func if in is match not null or pass return signal static
    tool true var void while _
    abs clamp is_instance_valid max min preload push_error push_warning range
    Array Basis Color Dictionary NodePath PackedByteArray PackedFloat32Array PackedStringArray PackedVector3Array Quaternion
    String Transform3D Vector3 bool float int
    BoxMesh CapsuleMesh CylinderMesh EditorPlugin Material Mesh MeshInstance3D Node Node3D OK OS RefCounted SphereMesh
    StandardMaterial3D StreamPeerBuffer SurfaceTool Time WebSocketPeer
    PRIMITIVE_TRIANGLES RIGHT STATE_CLOSED STATE_OPEN UP WRITE_MODE_BINARY
    add_child add_custom_type add_vertex affine_inverse albedo_color append begin bottom_radius call commit connect
    connect_to_url cross data_array distance_to duplicate emit erase find free generate_normals get get_16 get_32 get_64
    get_available_packet_count get_children get_double get_environment get_float get_meta get_node_or_null get_packet
    get_parent get_ready_state get_rotation_quaternion get_size get_string_from_ascii get_ticks_msec get_ticks_usec get_u16
    get_u32 get_u8 get_utf8_string global_transform handshake_headers has has_meta has_signal height inbound_buffer_size
    is_empty is_valid_html_color keys length material_override max_queued_packets mesh name new normalized origin poll
    pop_back pop_front push_front put_32 put_data put_double put_float put_u16 put_u32 put_u8 queue_free radial_segments radius
    remove_child remove_custom_type resize rings seek send set set_smooth_group size slice sort_custom to_ascii_buffer
    to_utf8_buffer top_radius transform w x y z _enter_tree _exit_tree _process _ready close basis""".split())


def code_of(text):
    """The code without comments and texts, except texts that are a single name."""
    return re.sub(r'"[^"\n]*"|#[^\n]*', lambda match: match[0] if re.fullmatch(r'"\w+"', match[0]) else " ", text)


def own_names(code):
    """Names that the scripts define: functions, variables, signals, parameters, keys and members of enums."""
    names = set(re.findall(r"\b(?:func|var|const|signal|for)\s+(\w+)", code)) | set(re.findall(r'"(\w+)"', code))
    for parameters in re.findall(r"\b(?:func|signal) \w+\(([^)]*)\)", code):
        names |= set(re.findall(r"(\w+)\s*(?:[:=,]|$)", parameters))
    for members in re.findall(r"\benum \{([^}]*)\}", code):
        names |= set(re.findall(r"\w+", members))
    return names


def gone_in(text):
    """Remaining names of Godot 3, each with its replacement in Godot 4."""
    code = code_of(text)
    words = set(re.findall(r"[A-Za-z_]\w*", code))
    left = {name: new for name, new in GONE.items() if name in words}
    left.update((pattern, new) for pattern, new in GONE_NOTATION.items() if re.search(pattern, code, re.M))
    return left


def setUpModule():
    made = subprocess.run([sys.executable, "-B", SCRIPTS / "godot_addon.py", "make", PROJECT], text=True, capture_output=True)
    if made.returncode != 0:
        raise AssertionError(made.stderr)


def scripts_of(folder):
    return {path.name: path.read_text(encoding="utf-8") for path in (PROJECT / folder / "addons/wholehand").glob("*.gd")}


class Names(unittest.TestCase):
    def test_no_name_of_godot_3_is_left(self):
        for name, text in scripts_of("godot4").items():
            self.assertEqual(gone_in(text), {}, f"{name}: translate it in scripts/gdscript4.py")

    def test_the_table_finds_what_the_translation_replaces(self):
        found = set()
        for text in scripts_of(".").values():
            found |= set(gone_in(text))
        self.assertLessEqual(set(gdscript4.TYPES) | set(gdscript4.METHODS), found)
        self.assertLessEqual({r"^tool\b", r"^export\b", r"\bOS\.get_ticks_[mu]sec\b", r"\bconnect\([^()]*\bself\b"}, found)

    def test_every_name_is_defined_by_the_addon_or_godot_4(self):
        code = {name: code_of(text) for name, text in scripts_of("godot4").items()}
        own = own_names("\n".join(code.values()))
        used = {name: set(re.findall(r"(?<![\w.])[A-Za-z_]\w*|(?<=\.)[A-Za-z_]\w*", text)) for name, text in code.items()}
        for name, words in used.items():
            self.assertEqual(sorted(words - own - GODOT4), [],
                             f"{name}: is it in Godot 4? Name it in GODOT4 here, or translate it in scripts/gdscript4.py")
        self.assertEqual(sorted(GODOT4 - own - set().union(*used.values())), [], "in GODOT4, and not used")

    def test_replacement_scripts_have_the_same_functions(self):
        for file in (SOURCE / "clients/godot/godot4").glob("*.gd"):
            functions = [sorted(re.findall(r"^(?:static )?func ([a-z]\w*)\(", text, re.M)) for text in
                         (file.read_text(encoding="utf-8"), scripts_of(".")[file.name])]
            self.assertEqual(functions[0], functions[1], file)
            self.assertNotEqual(functions[0], [])


class Addon(unittest.TestCase):
    def test_addon_states_that_it_was_never_opened_in_the_editor(self):
        addon = PROJECT / "godot4/addons/wholehand"
        for name in ("plugin.cfg", "README.md"):
            self.assertRegex((addon / name).read_text(encoding="utf-8"), r"never opened in (its|Godot 4's) editor", name)
        self.assertNotIn("Godot 4", (PROJECT / "addons/wholehand/plugin.cfg").read_text(encoding="utf-8"))

    def test_archives_contain_the_addon(self):
        """Also for Godot 3."""
        names = {}
        for version, tree in (("", PROJECT), ("4", PROJECT / "godot4")):
            archive, = PROJECT.glob(f"wholehand-godot{version}-*.zip")
            with zipfile.ZipFile(archive) as files:
                names[version] = set(files.namelist())
            made = {path.relative_to(tree).as_posix() for path in (tree / "addons").rglob("*") if path.is_file()}
            self.assertEqual(names[version], made)
        self.assertLessEqual({f"addons/wholehand/{name}" for name in ("plugin.cfg", "protocol.gd", "LICENSE")}, names[""])
        self.assertEqual(names["4"], names[""] | {"addons/wholehand/README.md"})

    def test_unused_rule_is_refused(self):
        with tempfile.TemporaryDirectory(prefix="wholehand-test-") as folder:
            tree = pathlib.Path(folder)
            for name in ("scripts", "clients/godot", "protocol"):
                shutil.copytree(SOURCE / name, tree / name)
            for name in ("CMakeLists.txt", "LICENSE"):
                shutil.copyfile(SOURCE / name, tree / name)
            rules = tree / "scripts/gdscript4.py"
            rules.write_text(rules.read_text().replace('"empty": ', '"no_such": "no_other",\n    "empty": '))
            made = subprocess.run([sys.executable, "-B", tree / "scripts/godot_addon.py", "make", tree / "made"], text=True,
                                  capture_output=True)
        self.assertEqual(made.returncode, 1)
        self.assertRegex(made.stderr, r"scripts/gdscript4.py: no script of .* has .*no_such.*; remove the rule")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    PROJECT = pathlib.Path(sys.argv[1]).resolve()
    shutil.rmtree(PROJECT, ignore_errors=True)
    PROJECT.mkdir(parents=True)
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
