"""`wholehand decompose`: a mesh becomes convex pieces that a scene accepts, and its hollow can be entered."""
import json
import math
import os
import re
import struct
import xml.dom.minidom

import numpy

from app import BAD_INPUT, DONE, AppTest, main, read_recording

NOT_ALIKE = 1


def obj(points, faces):
    return ("".join(f"v {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in points)
            + "".join("f " + " ".join(str(i + 1) for i in face) + "\n" for face in faces))


def prism(outline, height):
    """A prism over a counterclockwise polygon whose corner 0 sees every other corner."""
    n = len(outline)
    faces = [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)]
    faces += [(0, i + 1, i) for i in range(1, n - 1)] + [(n, n + i, n + i + 1) for i in range(1, n - 1)]
    return [(x, y, z) for z in (0.0, height) for x, y in outline], faces


def revolved(profile, around):
    points = [(r * math.cos(2 * math.pi * i / around), r * math.sin(2 * math.pi * i / around), z)
              for i in range(around) for r, z in profile]
    n = len(profile)
    faces = [(i * n + k, (i + 1) % around * n + k, (i + 1) % around * n + (k + 1) % n, i * n + (k + 1) % n)
             for i in range(around) for k in range(n)]
    return points, faces


L = prism([(.02, .02), (.02, .06), (0, .06), (0, 0), (.06, 0), (.06, .02)], .02)  # 40 cm3
CUBE = prism([(0, 0), (.05, 0), (.05, .05), (0, .05)], .05)
CUP = revolved([(0, 0), (.035, 0), (.035, .09), (.031, .09), (.031, .004), (0, .004)], 24)

SCENE = """kind = "scene"
version = 1
name = "A ball above a cup"
gravity_m_s2 = [0.0, 0.0, -9.81]

[[bodies]]
name = "cup"
{shape}
fixed = true
position_m = [0.6, 0.0, -0.1]

[[bodies]]
name = "ball"
shape = "sphere"
radius_m = 0.01
mass_kg = 0.05
position_m = [0.6, 0.0, 0.02]
"""


class Decompose(AppTest):
    def mesh(self, solid, name="part.obj"):
        return self.write(name, obj(*solid))

    def decompose(self, mesh, *arguments, out="out"):
        return self.run_app("decompose", mesh, "--out", out, *arguments)

    def bytes_of(self, folder):
        return {name: (self.folder / folder / name).read_bytes() for name in self.names_in(self.folder / folder)}

    def test_l_shape_is_two_boxes_in_table_json_and_files(self):
        done = self.expect(self.decompose(self.mesh(L), "--json", "l.json"), DONE, "mesh 40 cm3, pieces 40 cm3",
                           "written  2 pieces")
        self.assertNotIn("note", done.out)
        reported = json.loads((self.folder / "l.json").read_text())
        self.assertEqual([p["file"] for p in reported["pieces"]], ["part_01.obj", "part_02.obj"])
        self.assertAlmostEqual(reported["volume_m3"], 40e-6, delta=40e-12)
        self.assertAlmostEqual(sum(p["volume_m3"] for p in reported["pieces"]), reported["volume_m3"], delta=1e-15)
        self.assertLess(abs(reported["volume_difference"]), 1e-6)
        # The two boxes have 24 and 16 cm3, with their centres at (30, 10, 10) and (10, 40, 10) mm.
        for mass in (reported["mass"], reported["mesh"]["mass"]):
            self.assertAlmostEqual(mass["mass_kg"], 0.04, delta=1e-8)
            for found, expected in zip(mass["com_m"], (0.022, 0.022, 0.01)):
                self.assertAlmostEqual(found, expected, delta=1e-8)
        self.assertEqual(self.names_in(self.folder / "out"), ["part.toml", "part.urdf", "part_01.obj", "part_02.obj"])
        for piece in reported["pieces"]:
            text = (self.folder / "out" / piece["file"]).read_text()
            written = [[float(x) for x in line.split()[1:]] for line in text.splitlines() if line[0] == "v"]
            self.assertEqual(numpy.float32(written).tolist(), piece["points_m"])
            self.assertLessEqual(len(piece["points_m"]), 64)
        valid = self.expect(self.run_app("validate", "out/part.toml"), DONE, "ok")
        self.assertNotIn("convex", valid.out)

    def test_the_same_mesh_gives_the_same_bytes(self):
        mesh = self.mesh(CUP)
        self.expect(self.decompose(mesh, out="a"), DONE)
        self.expect(self.decompose(mesh, out="b"), DONE)
        self.assertEqual(self.bytes_of("a"), self.bytes_of("b"))

    def test_scale_and_mass_apply_to_a_convex_mesh(self):
        in_mm = [(1e3 * x, 1e3 * y, 1e3 * z) for x, y, z in CUBE[0]], CUBE[1]
        self.expect(self.decompose(self.mesh(in_mm), "--scale", "0.001", "--mass-kg", "0.3", "--json", "c.json"), DONE,
                    "written  1 piece,")
        reported = json.loads((self.folder / "c.json").read_text())
        self.assertAlmostEqual(reported["volume_m3"], 125e-6, delta=1e-11)
        moment = 0.3 * 0.05 ** 2 / 6  # moment of inertia of a cube
        for k in range(3):
            self.assertAlmostEqual(reported["mass"]["inertia_kg_m2"][k][k], moment, delta=1e-6 * moment)
        self.assertIn("mass_kg = 0.3\n", (self.folder / "out/part.toml").read_text())

    def test_ball_falls_into_the_cup_and_rests_on_its_floor(self):
        self.expect(self.decompose(self.mesh(CUP, "cup.obj"), "--json", "cup.json", out="."), DONE)
        filled = json.loads((self.folder / "cup.json").read_text())["pieces_outside_mesh_m"]
        self.assertLess(filled, 0.0025)
        self.write("pieces.toml", SCENE.format(shape='shape = "urdf"\nfile = "cup.urdf"'))
        self.write("hull.toml", SCENE.format(shape='shape = "mesh"\nfile = "cup.obj"'))
        heights = {}
        for scene in ("pieces", "hull"):
            recording = self.record(f"{scene}.h5", "--scene", f"{scene}.toml", "--no-web", duration=2)
            with read_recording(recording) as file:
                bodies = file["ticks/bodies"][:]
            names = [text.decode() for text in file_names(recording)]
            self.assertEqual(names, ["cup", "ball"])
            ball = bodies[:, 1] if bodies.ndim == 3 else bodies[:, 13:]
            heights[scene] = ball[-1, 2]
            self.assertLess(math.hypot(ball[-1, 0] - 0.6, ball[-1, 1]), 0.022)
            self.assertLess(max(abs(ball[-1, 7:10])), 1e-2)
        inside = -0.1 + 0.004 + 0.01  # on the floor, which a piece may raise by the reported amount
        self.assertGreater(heights["pieces"], inside - 1e-4)
        self.assertLess(heights["pieces"], inside + filled + 1e-4)
        self.assertAlmostEqual(heights["hull"], -0.1 + 0.09 + 0.01, delta=1e-4)  # on the opening, which the hull closes

    def test_thin_walls_and_one_piece_are_refused_unless_allowed(self):
        mesh = self.mesh(CUP)
        refused = self.expect(self.decompose(mesh, "--pieces", "1"), NOT_ALIKE, "--volume-bound = 0.25",
                              "nothing is written", "--pieces")
        self.assertIn("--concavity", refused.out)
        self.assertFalse((self.folder / "out").exists())
        # The hull of the cup is compared with its wall and floor: 24 sectors of a cylinder.
        self.expect(self.decompose(mesh, "--pieces", "1", "--volume-bound", "4"), DONE, "written  1 piece,")

    def test_ignored_parts_of_a_file_are_reported(self):
        points, faces = CUBE
        rows = "".join(f"{x} {y} {z}\n" for x, y, z in points)
        rows += "".join(f"{len(face)} " + " ".join(map(str, face)) + "\n" for face in faces)
        ply = self.write("cube.ply", "ply\nformat ascii 1.0\nMade by hand\nelement vertex 8\nproperty float x\n"
                         "property float y\nproperty float z\n" f"element face {len(faces)}\n"
                         "property list uchar int vertex_indices\nend_header\n" + rows)
        self.expect(self.decompose(ply), DONE, 'note     the mesh has "Made" in line 3 of its head, which is ignored')

    def test_bad_meshes_are_named_with_the_remedy(self):
        points, faces = CUBE
        self.expect_refused(self.decompose(self.write("open.obj", obj(points, faces[1:]))), "open.obj", "not closed",
                            "close its holes", lines=1)
        self.expect_refused(self.decompose("none.obj"), "none.obj", "no such file", lines=1)
        self.assertFalse((self.folder / "out").exists())

    def test_inward_mesh_is_turned_and_reported(self):
        points, faces = L
        self.expect(self.decompose(self.mesh((points, [face[::-1] for face in faces]))), DONE, "inside out",
                    "pieces 40 cm3")

    def test_part_wound_inward_is_turned_and_reported(self):
        points = CUBE[0] + [(x + .1, y, z) for x, y, z in CUBE[0]]
        inward = (points, CUBE[1] + [tuple(i + 8 for i in face[::-1]) for face in CUBE[1]])
        self.expect(self.decompose(self.mesh(inward)), DONE, "mesh 250 cm3, pieces 250 cm3",
                    "a part of the mesh is inside out: its triangles were turned")

    def test_unannounced_triangles_are_mentioned_if_the_mesh_is_not_closed(self):
        points, faces = CUBE
        triangles = [(face[0], face[i], face[i + 1]) for face in faces for i in range(1, len(face) - 1)]
        half = bytes(80) + struct.pack("<I", len(triangles) // 2)
        for triangle in triangles:
            half += struct.pack("<12fH", 0, 0, 0, *(c for corner in triangle for c in points[corner]), 0)
        self.expect_refused(self.decompose(self.write("half.stl", half)), "half.stl", "is not closed",
                            "has 300 bytes behind the 6 triangles that it announces", "close its holes", lines=1)

    def test_options_out_of_range_are_refused(self):
        mesh = self.mesh(CUBE)
        for arguments in (["--pieces", "0"], ["--pieces", "65"], ["--concavity", "nan"], ["--concavity", "-1"],
                          ["--scale", "0"], ["--mass-kg", "-1"], ["--volume-bound", "nan"]):
            self.expect(self.decompose(mesh, *arguments), BAD_INPUT, arguments[0])
        self.expect(self.run_app("decompose", mesh), BAD_INPUT, "--out")
        self.expect(self.run_app("decompose"), BAD_INPUT, "mesh")

    def test_foreign_files_are_kept_and_old_pieces_removed(self):
        self.expect(self.decompose(self.mesh(L)), DONE)
        self.write("out/notes.txt", "mine")
        before = self.bytes_of("out")
        self.expect(self.decompose(self.mesh(L)), DONE)
        self.assertEqual(self.bytes_of("out"), before)
        self.expect(self.decompose(self.mesh(CUBE)), DONE)  # the same name with one piece less
        self.assertEqual(self.names_in(self.folder / "out"), ["notes.txt", "part.toml", "part.urdf", "part_01.obj"])
        self.write("out/part.urdf", "<robot/>")
        before = self.bytes_of("out")
        self.expect_refused(self.decompose(self.mesh(L)), "out/part.urdf", "not written by this command", lines=1)
        self.assertEqual(self.bytes_of("out"), before)

    def test_unwritable_folder_is_refused(self):
        mesh = self.mesh(CUBE)
        self.write("file", "")
        self.expect_refused(self.decompose(mesh, out="file"), "file", "--out", lines=1)
        self.expect_refused(self.decompose(mesh, out="file/inside"), "--out", lines=1)
        self.expect_refused(self.decompose(mesh, out="/proc/none"), "--out", lines=1)
        if os.getuid() != 0:
            (self.folder / "locked").mkdir(mode=0o500)
            self.expect_refused(self.decompose(mesh, out="locked"), "locked", lines=1)
        self.expect_refused(self.decompose(mesh, "--json", mesh), "part.obj", lines=1)

    def test_unusual_characters_in_names_are_replaced(self):
        self.expect(self.decompose(self.mesh(CUBE, 'a "b" & <ü>.obj')), DONE)
        names = self.names_in(self.folder / "out")
        self.assertTrue(all(re.fullmatch(r"[A-Za-z0-9_-]+\.(obj|toml|urdf)", name) for name in names), names)
        self.expect(self.run_app("validate", *(f"out/{name}" for name in names if name.endswith(".toml"))), DONE)

    def test_file_name_cannot_end_a_comment(self):
        for i, name in enumerate(("a\nkind = 1 --> <evil.obj", "c---->.obj", os.fsdecode(b"b\xff\xfe.obj"))):
            with self.subTest(name):
                self.expect(self.decompose(self.mesh(CUBE, name), out=f"out{i}"), DONE)
                for made in (self.folder / f"out{i}").glob("*"):
                    text = made.read_text()
                    self.assertFalse([line for line in text.splitlines() if line.startswith("kind = 1")], made)
                    if made.suffix == ".urdf":
                        xml.dom.minidom.parseString(text)


def file_names(recording):
    with read_recording(recording) as file:
        return list(file["meta"].attrs["body_names"])


if __name__ == "__main__":
    main()
