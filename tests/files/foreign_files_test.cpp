// Object files as other programs write them.
#include "files/foreign/foreign_file.hpp"
#include "files/mesh/convex_mesh.hpp"
#include "files/mesh/mesh_file.hpp"
#include "files/mesh/solid.hpp"
#include "files/mesh_samples.hpp"
#include "files/scene/scene_file.hpp"
#include "files/scene_text.hpp"
#include "files/toml/toml_file.hpp"
#include "files/urdf/urdf.hpp"
#include "loop/model/scene_model.hpp"
#include "support/contains.hpp"
#include "support/figure.hpp"
#include "support/file_bytes.hpp"
#include "support/folder.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

namespace wholehand::test {
namespace {

using Eigen::Affine3d;
using Eigen::Vector3d;
using std::numbers::pi;

// A box of 60 x 40 x 20 mm: 48 cm3, with a corner at the origin. Corners count z first, then y, x.
const Vector3d kBox_m(0.06, 0.04, 0.02);
constexpr double kBox_m3 = 48e-6;
const std::vector<Eigen::Vector3i> kBoxFaces = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5},
                                                {0, 4, 5}, {0, 5, 1}, {2, 3, 7}, {2, 7, 6},
                                                {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};

std::vector<Vector3d> boxCorners(const Vector3d& low = Vector3d::Zero(),
                                 const Vector3d& high = kBox_m) {
  std::vector<Vector3d> corners;
  for (int i = 0; i < 8; ++i) {
    corners.emplace_back((i & 4) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                         (i & 1) != 0 ? high.z() : low.z());
  }
  return corners;
}

std::string objCorners(const std::vector<Vector3d>& corners) {
  std::string text;
  for (const Vector3d& p : corners) text += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
  return text;
}

std::string objFaces(int first = 1) {
  std::string text;
  for (const Eigen::Vector3i& t : kBoxFaces) {
    text += fmt::format("f {} {} {}\n", t[0] + first, t[1] + first, t[2] + first);
  }
  return text;
}

const std::string kBoxObj = objCorners(boxCorners()) + objFaces();

Expected<MeshCollider> load(const Folder& folder, const std::string& name,
                            const std::string& bytes) {
  return loadMeshCollider(folder.write(name, bytes), Vector3d::Ones());
}

std::string refusalOf(const Folder& folder, const std::string& name, const std::string& bytes) {
  const Expected<MeshCollider> mesh = load(folder, name, bytes);
  return mesh ? "" : format(mesh.errors());
}

/// A DAE file whose visual scene contains `nodes`; its geometry is the box.
std::string dae(const std::string& nodes, const std::string& more = "") {
  std::string corners, faces;
  for (const Vector3d& p : boxCorners()) corners += fmt::format("{} {} {} ", p.x(), p.y(), p.z());
  for (const Eigen::Vector3i& t : kBoxFaces) faces += fmt::format("{} {} {} ", t[0], t[1], t[2]);
  return R"(<?xml version="1.0" encoding="utf-8"?><COLLADA version="1.4.1"><asset><unit meter="1"/>
<up_axis>Z_UP</up_axis></asset>)" +
         more + R"(<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a"
count="24">)" +
         corners + R"(</float_array><technique_common><accessor source="#a" count="8" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/>
</vertices><triangles count="12"><input semantic="VERTEX" source="#v" offset="0"/><p>)" +
         faces + R"(</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>
<visual_scene id="s">)" +
         nodes + R"(</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/>
</scene></COLLADA>)";
}

const std::string kInstance = "<instance_geometry url=\"#g\"/>";

std::string glbOf(std::string json, const std::string& data) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto chunk = [](const std::string& body, const char* type) {
    return littleEndian(static_cast<std::uint32_t>(body.size())) + std::string(type, 4) + body;
  };
  const std::string chunks = chunk(json, "JSON") + chunk(data, "BIN\0");
  return "glTF" + littleEndian(std::uint32_t{2}) +
         littleEndian(static_cast<std::uint32_t>(12 + chunks.size())) + chunks;
}

/// A GLB file whose scene is node 0 and whose mesh 0 is the box.
std::string glb(const std::string& nodes) {
  std::string data;
  for (const Vector3d& p : boxCorners()) {
    for (const double x : p) data += littleEndian(static_cast<float>(x));
  }
  for (const Eigen::Vector3i& t : kBoxFaces) {
    for (const int i : t) data += littleEndian(static_cast<std::uint16_t>(i));
  }
  return glbOf(R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[)" + nodes +
                   R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
"buffers":[{"byteLength":168}],"bufferViews":[{"buffer":0,"byteLength":96},
{"buffer":0,"byteOffset":96,"byteLength":72}],"accessors":[{"bufferView":0,"count":8,
"componentType":5126,"type":"VEC3"},{"bufferView":1,"count":36,"componentType":5123,
"type":"SCALAR"}]})",
               data);
}

/// Checks that the collider is the box placed by `map`: its volume times the determinant, its
/// centre moved. The surface is wound outward as in the file.
void expectBox(const std::string& path, const Affine3d& map, double tolerance) {
  const MeshCollider mesh = orThrow(loadMeshCollider(path, Vector3d::Ones()));
  ASSERT_EQ(mesh.shapes.size(), 1U);
  const ShapeMoments m = moments(mesh.shapes[0]);
  const double volume_m3 = kBox_m3 * std::abs(map.linear().determinant());
  EXPECT_NEAR(m.volume_m3 / volume_m3, 1.0, tolerance);
  EXPECT_LT((m.center_m - map * (kBox_m / 2.0)).norm(), tolerance * kBox_m.norm());
  const MeshSurface surface = orThrow(readMesh(path)).surface;
  EXPECT_NEAR(signedVolume(surface) / volume_m3, 1.0, tolerance);
}

TEST(ForeignMesh, NodesOfDaeAndGlb_AreAppliedHoweverSmall) {
  const Folder folder;
  const double half_degree = pi / 360.0;
  Affine3d mirrored = Affine3d::Identity(), nested = Affine3d::Identity();
  mirrored.scale(Vector3d(-1.0, 1.0, 1.0));
  nested.translate(Vector3d(0.0, 0.0, 0.005))
      .rotate(Eigen::AngleAxisd(half_degree, Vector3d::UnitX()));
  nested.scale(Vector3d(1.0, 2.0, 0.995));
  nested.translate(Vector3d(0.001, 0.0, 0.0));
  const struct {
    const char *name, *dae, *glb;
    Affine3d map;
  } cases[] = {
      {"shift", "<translate>0 0.009 0</translate>", R"("translation":[0,0.009,0])",
       Affine3d(Eigen::Translation3d(0.0, 0.009, 0.0))},
      {"scale", "<scale>0.991 0.991 0.991</scale>", R"("scale":[0.991,0.991,0.991])",
       Affine3d(Eigen::Scaling(0.991))},
      {"turn", "<rotate>0 0 1 0.5</rotate>", R"("rotation":[0,0,0.0043633093,0.9999904807])",
       Affine3d(Eigen::AngleAxisd(half_degree, Vector3d::UnitZ()))},
      {"mirror", "<scale>-1 1 1</scale>", R"("scale":[-1,1,1])", mirrored},
      {"matrix", "<matrix>1 0 0 0.001 0 1 0 0.002 0 0 1 0.003 0 0 0 1</matrix>",
       R"("matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0.001,0.002,0.003,1])",
       Affine3d(Eigen::Translation3d(0.001, 0.002, 0.003))},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.name);
    expectBox(folder.write("n.dae", dae(std::string("<node>") + c.dae + kInstance + "</node>")),
              c.map, 1e-9);
    expectBox(folder.write("n.glb", glb(std::string("{\"mesh\":0,") + c.glb + "}")), c.map, 1e-6);
  }
  // In homogeneous coordinates w = 2 would halve the size.
  const char* const kNotAffine = "has a node whose matrix does not end in 0 0 0 1";
  EXPECT_TRUE(contains(refusalOf(folder, "n.dae",
                                 dae("<node><matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 2</matrix>" +
                                     kInstance + "</node>")),
                       kNotAffine));
  EXPECT_TRUE(contains(
      refusalOf(folder, "n.glb", glb(R"({"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,2]})")),
      kNotAffine));
  expectBox(folder.write("n.dae", dae("<node><translate>0 0 0.005</translate><rotate>1 0 0 0.5"
                                      "</rotate><node><scale>1 2 0.995</scale><node><translate>"
                                      "0.001 0 0</translate>" +
                                      kInstance + "</node></node></node>")),
            nested, 1e-9);
  expectBox(folder.write("n.glb", glb(R"({"children":[1],"translation":[0,0,0.005],
"rotation":[0.0043633093,0,0,0.9999904807]},{"children":[2],"scale":[1,2,0.995]},
{"mesh":0,"translation":[0.001,0,0]})")),
            nested, 1e-6);
}

TEST(ForeignMesh, OneGeometryPlacedTwice_GivesTwoPieces) {
  const Folder folder;
  const std::string twice = "<node>" + kInstance + "</node><node><translate>0 0.049 0</translate>" +
                            "<instance_node url=\"#n\"/></node>";
  const std::string library =
      "<library_nodes><node id=\"n\">" + kInstance + "</node></library_nodes>";
  const MeshCollider mesh = orThrow(load(folder, "two.dae", dae(twice, library)));
  ASSERT_EQ(mesh.shapes.size(), 2U);  // 9 mm apart
  EXPECT_NEAR(moments(mesh.shapes[1]).center_m.y(), 0.049 + 0.02, 1e-12);
  EXPECT_NEAR(moments(mesh.shapes[0]).volume_m3 + moments(mesh.shapes[1]).volume_m3, 2.0 * kBox_m3,
              1e-15);
  EXPECT_TRUE(mesh.notices.empty());
  // Nodes that contain each other would never end.
  EXPECT_TRUE(contains(
      refusalOf(folder, "loop.dae", dae("<node id=\"n\"><instance_node url=\"#n\"/></node>")),
      "nodes that hold one another"));
  EXPECT_TRUE(contains(refusalOf(folder, "loop.glb", glb(R"({"children":[0]})")),
                       "nodes that hold one another"));
}

TEST(ForeignMesh, UpAxis_IsReportedAsIgnored) {
  const Folder folder;
  std::string y_up = dae("<node>" + kInstance + "</node>");
  y_up.replace(y_up.find("Z_UP"), 4, "Y_UP");
  const MeshCollider mesh = orThrow(load(folder, "y.dae", y_up));
  ASSERT_EQ(mesh.notices.size(), 1U);
  EXPECT_TRUE(contains(format(mesh.notices), "y.dae has <up_axis> Y_UP, which is ignored"));
  const auto noticed = [&](const std::string& element) {
    return format(
        orThrow(load(folder, "u.dae", replaced(y_up, "<up_axis>Y_UP</up_axis>", element))).notices);
  };
  EXPECT_TRUE(contains(noticed(""), "has <up_axis> Y_UP"));  // the default of COLLADA 1.4.1
  EXPECT_EQ(noticed("<up_axis>\n  Z_UP </up_axis>"), "");
  EXPECT_TRUE(contains(format(orThrow(load(folder, "y.glb", glb(R"({"mesh":0})"))).notices),
                       "y.glb is of glTF, whose y axis points up, which is ignored"));
}

TEST(ForeignMesh, UnreadableTexture_IsNoFault) {
  const Folder folder;
  const std::string images =
      "<library_images><image id=\"i\"><init_from></init_from></image>"
      "<image id=\"j\"><init_from>gone.png</init_from></image></library_images>";
  expectBox(folder.write("t.dae", dae("<node>" + kInstance + "</node>", images)),
            Affine3d::Identity(), 1e-9);
}

TEST(ForeignMesh, DaeVariantsOfOtherWriters_AreRead) {
  const Folder folder;
  const std::string plain = dae("<node>" + kInstance + "</node>");
  std::string comments = plain, unit = plain, names = plain;
  for (const std::string_view element : {"<p>", "count=\"24\">"}) {
    const std::size_t begin = comments.find(element) + element.size();
    comments.insert(comments.find(' ', begin + 4) + 1, "<!-- a remark -->");
  }
  expectBox(folder.write("c.dae", comments), Affine3d::Identity(), 1e-9);
  unit.replace(unit.find("meter=\"1\""), 9, "meter=\"0,5\"");  // a decimal comma
  expectBox(folder.write("c.dae", unit), Affine3d(Eigen::Scaling(0.5)), 1e-9);
  names.replace(names.find("\"X\""), 3, "\"Y\"").replace(names.rfind("\"Y\""), 3, "\"X\"");
  Affine3d swapped = Affine3d::Identity();
  swapped.linear() << 0, 1, 0, 1, 0, 0, 0, 0, 1;  // this turns the box inside out
  EXPECT_TRUE(contains(refusalOf(folder, "c.dae", replaced(plain, "<p>0 1 3", "<p>0 1 2.7")),
                       "has a face with the corner 2.7; there are 8, in line"));
  const ShapeMoments m = moments(orThrow(load(folder, "c.dae", names)).shapes[0]);
  EXPECT_NEAR(m.volume_m3, kBox_m3, 1e-15);
  EXPECT_LT((m.center_m - swapped * (kBox_m / 2.0)).norm(), 1e-12);
}

TEST(ForeignMesh, EveryValidObjLine_IsRead) {
  const Folder folder;
  std::string crlf, blanks, colours, weights, no_zero, comments, joined;
  for (const char c : kBoxObj) crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
  for (const Vector3d& p : boxCorners()) {
    const std::string xyz = fmt::format("{} {} {}", p.x(), p.y(), p.z());
    blanks += "  \tv   " + xyz + "  \n";
    colours += "v " + xyz + " 0.5 0.5 1\n";
    weights += "v " + xyz + " 1.0\n";
    comments += "v " + xyz + " # a corner\n";
    joined += fmt::format("v {} \\\n{} {}\n", p.x(), p.y(), p.z());
    std::string bare = "v";
    for (const double x : p) bare += fmt::format(" {:.2f}", x).erase(1, 1);
    no_zero += bare + "\n";
  }
  std::string negative = objCorners(boxCorners()), slashes = negative + "vt 0 0\nvn 0 0 1\n", quads;
  for (const Eigen::Vector3i& t : kBoxFaces) {
    negative += fmt::format("f {} {} {}\n", t[0] - 8, t[1] - 8, t[2] - 8);
    slashes += fmt::format("f {}/1/1 {}//1 {}/1\n", t[0] + 1, t[1] + 1, t[2] + 1);
  }
  quads = objCorners(boxCorners()) +
          "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n";
  const std::string spare = "v 0.03 0.02 0.01\n";
  const struct {
    const char* name;
    std::string text;
  } cases[] = {
      {"byte order mark", "\xEF\xBB\xBF" + objCorners(boxCorners()) + spare + objFaces()},
      {"byte order mark and CRLF", "\xEF\xBB\xBF" + crlf},
      {"CR alone",
       [&] {
         std::string cr = kBoxObj;
         std::replace(cr.begin(), cr.end(), '\n', '\r');
         return cr;
       }()},
      {".06", no_zero + objFaces()},
      {"blanks", blanks + objFaces()},
      {"colours", colours + objFaces()},
      {"weights", weights + objFaces()},
      {"comments", comments + spare + objFaces()},
      {"joined", joined + objFaces()},
      {"name with a backslash",
       "usemtl C:\\looks\\\n" + objCorners(boxCorners()) + spare + objFaces()},
      {"negative", negative},
      {"slashes", slashes},
      {"quads", quads},
      {"faces first", objFaces() + objCorners(boxCorners())},
      {"extensions", "t crease 2/1/0 1 2 4.7\n" + kBoxObj + "vw 0 0 0.25 1 0.75\n"},
      {"no line end", kBoxObj.substr(0, kBoxObj.size() - 1)},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.name);
    expectBox(folder.write("c.obj", c.text), Affine3d::Identity(), 1e-9);
  }
}

TEST(ForeignMesh, InvalidObjLine_IsNamed) {
  const Folder folder;
  const struct {
    const char *lines, *expected;
  } cases[] = {
      {"v 1 2\n", "its line 1 has a corner of 2 numbers"},
      {"\nv 1 2 x\n", "its line 2 has \"x\" where a number belongs"},
      {"v 1 2 3 0.5\n", "its line 1 has a corner of weight 0.5"},
      {"v 1,0 2 3\n", "its line 1 has \"1,0\""},
      {"v +-1 2 3\n", "its line 1 has \"+-1\""},
      {"call box.obj\n", "its line 1 starts with \"call\", which names another file"},
      {"vertex 1 2 3\n", "its line 1 starts with \"vertex\", which is no word of OBJ"},
      {"# a\nsurf 0 1 0 1\n", "its line 2 starts with \"surf\", of curved surfaces"},
      {"f 1 2 99\n", "its line 1 names the corner 99; there are 8"},
      {"f 1 2 0\n", "its line 1 has \"0\" where the number of a corner belongs"},
      {"f -1 -2 -3\n", "its line 1 names the corner -1; there are 0"},
      {"f 1 2\n", "its line 1 has a face of 2 corners"},
  };
  for (const auto& c : cases) {
    const std::string said = refusalOf(folder, "c.obj", c.lines + kBoxObj);
    EXPECT_TRUE(contains(said, c.expected));
  }
}

// A U of three boxes: 24 + 20 + 20 cm3; its hull is the bounding box, 144 cm3.
std::string letterU(const std::string& between, bool shared) {
  const Vector3d low[] = {{0, 0, 0}, {0, 0, 0.01}, {0.05, 0, 0.01}};
  const Vector3d high[] = {{0.06, 0.04, 0.01}, {0.01, 0.04, 0.06}, {0.06, 0.04, 0.06}};
  std::string corners, faces, both;
  for (int i = 0; i < 3; ++i) {
    const std::string own = objCorners(boxCorners(low[i], high[i]));
    const std::string name = fmt::format(fmt::runtime(between), i);
    corners += own;
    faces += name + objFaces(8 * i + 1);
    both += name + own + objFaces(8 * i + 1);
  }
  return shared ? corners + faces : both;
}

TEST(ForeignMesh, ConvexObjectsOrGroupsOfAnObj_BecomePieces) {
  const Folder folder;
  for (const char* between : {"o convex_{}\n", "g convex_{}\n", "o all\ng piece{}\n"}) {
    for (const bool shared : {false, true}) {
      const MeshCollider mesh = orThrow(load(folder, "u.obj", letterU(between, shared)));
      ASSERT_EQ(mesh.shapes.size(), 3U) << between;
      double volume_m3 = 0.0;
      for (const Shape& shape : mesh.shapes) volume_m3 += moments(shape).volume_m3;
      EXPECT_NEAR(volume_m3, 64e-6, 1e-15);
      EXPECT_TRUE(mesh.notices.empty()) << format(mesh.notices);
    }
  }
  // Boxes of one object that touch are pieces, too.
  const MeshCollider one = orThrow(load(folder, "u.obj", letterU("o all\n", false)));
  EXPECT_EQ(one.shapes.size(), 3U);
  EXPECT_TRUE(one.notices.empty()) << format(one.notices);
  // A box whose faces are separate groups is the box; two separate boxes in one object are two.
  std::string looks = objCorners(boxCorners());
  for (std::size_t i = 0; i < kBoxFaces.size(); ++i) {
    const Eigen::Vector3i& t = kBoxFaces[i];
    looks += fmt::format("g side{}\nf {} {} {}\n", i, t[0] + 1, t[1] + 1, t[2] + 1);
  }
  EXPECT_EQ(orThrow(load(folder, "looks.obj", looks)).shapes.size(), 1U);
  const std::string apart = kBoxObj + objCorners(boxCorners({0.1, 0, 0}, {0.16, 0.04, 0.02}));
  const MeshCollider two = orThrow(load(folder, "apart.obj", apart + objFaces(9)));
  EXPECT_EQ(two.shapes.size(), 2U);
}

// A box beside one whose top is a hollow pyramid: of 48 cm3, a third of its base times its depth is
// missing.
TEST(ForeignMesh, NearlyConvexParts_BecomePieces) {
  const Folder folder;
  const auto dented = [&](double depth_m) {
    std::string faces;
    for (const Eigen::Vector3i& t : kBoxFaces) {
      const bool top = t[0] % 2 + t[1] % 2 + t[2] % 2 == 3;
      if (!top) faces += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    }
    const std::string beside = objCorners(boxCorners({0.1, 0, 0}, {0.16, 0.04, 0.02}));
    return orThrow(load(folder, "d.obj",
                        "o dented\n" + objCorners(boxCorners()) + faces +
                            fmt::format("v 0.03 0.02 {}\n", 0.02 - depth_m) +
                            "f 2 6 9\nf 6 8 9\nf 8 4 9\nf 4 2 9\no box\n" + beside + objFaces(10)));
  };
  const MeshCollider two = dented(1.8e-3);  // 1.44 cm3 of it: its hull is 3.1 % larger
  ASSERT_EQ(two.shapes.size(), 2U);
  EXPECT_NEAR(moments(two.shapes[0]).volume_m3, kBox_m3, 1e-15);
  EXPECT_TRUE(
      contains(format(two.notices), "has 2 parts whose convex hulls take their place, 1.52 %"));
  EXPECT_EQ(dented(3.6e-3).shapes.size(), 1U);  // 6.4 %
}

TEST(ForeignMesh, FlatPartAmongPieces_IsLeftOutAndNamed) {
  const Folder folder;
  const std::string flat = "o flat\nv 0 0 1\nv 0.1 0 1\nv 0 0.1 1\nf -3 -2 -1\n";
  const MeshCollider mesh = orThrow(load(folder, "u.obj", letterU("o {}\n", false) + flat));
  EXPECT_EQ(mesh.shapes.size(), 3U);
  EXPECT_TRUE(contains(format(mesh.notices), "has 1 part without volume"));
}

TEST(ForeignMesh, SurfaceWithBothSides_IsReadOnce) {
  const Folder folder;
  std::string both = kBoxObj;
  for (const Eigen::Vector3i& t : kBoxFaces) {
    both += fmt::format("f {} {} {}\n", t[2] + 1, t[1] + 1, t[0] + 1);
  }
  const MeshCollider mesh = orThrow(load(folder, "both.obj", both));
  EXPECT_NEAR(moments(mesh.shapes[0]).volume_m3, kBox_m3, 1e-15);
  EXPECT_TRUE(mesh.notices.empty()) << format(mesh.notices);
  const MeshCollider bent = orThrow(load(
      folder, "bent.obj", both + "v 0.03 0.02 0.01\nf 1 2 9\nf 9 2 1\n"));  // a fin with both sides
  EXPECT_TRUE(contains(format(bent.notices), "of 48 cm3"));
}

TEST(ForeignMesh, StlVariantsOfOtherWriters_AreRead) {
  const Folder folder;
  std::string facets, binary(80, ' ');
  binary += littleEndian(std::uint32_t{12});
  const std::vector<Vector3d> corners = boxCorners();
  for (const Eigen::Vector3i& t : kBoxFaces) {
    facets += "FACET NORMAL nan nan nan\n  OUTER LOOP\n";
    for (int i = 0; i < 3; ++i) binary += littleEndian(0.0F);
    for (const int corner : t) {
      const Vector3d& p = corners[corner];
      facets += fmt::format("    VERTEX {} {} {}\n", p.x(), p.y(), p.z());
      for (const double x : p) binary += littleEndian(static_cast<float>(x));
    }
    facets += "  ENDLOOP\nENDFACET\n";
    binary += littleEndian(std::uint16_t{0});
  }
  std::string named = binary, uncounted = binary;
  named.replace(0, 5, "solid");
  uncounted.replace(80, 4, std::string(4, '\0'));
  expectBox(folder.write("c.stl", "SOLID facet vertex\n" + facets + "ENDSOLID\n"),
            Affine3d::Identity(), 1e-9);
  expectBox(folder.write("c.stl", binary), Affine3d::Identity(), 1e-6);
  expectBox(folder.write("c.stl", binary + "by some program\n"), Affine3d::Identity(), 1e-6);
  expectBox(folder.write("c.stl", named), Affine3d::Identity(), 1e-6);
  expectBox(folder.write("c.stl", uncounted), Affine3d::Identity(), 1e-6);
  std::string bare = "SOLID facet vertex\n" + facets + "ENDSOLID\n";
  expectBox(folder.write("c.stl", bare + std::string(16, '\0')), Affine3d::Identity(), 1e-9);
  std::replace(bare.begin(), bare.end(), '\n', '\r');
  expectBox(folder.write("c.stl", bare), Affine3d::Identity(), 1e-9);
  std::replace(bare.begin(), bare.end(), '\r', ' ');  // all in one line
  expectBox(folder.write("c.stl", bare), Affine3d::Identity(), 1e-9);
  expectBox(folder.write("c.stl", bare + "solid facets" + bare.substr(bare.find("ENDSOLID"))),
            Affine3d::Identity(), 1e-9);
  const std::string twice = folder.write("c.stl", binary + binary);
  expectBox(twice, Affine3d::Identity(), 1e-6);
  EXPECT_TRUE(contains(format(orThrow(loadMeshCollider(twice, Vector3d::Ones())).notices),
                       "has 684 bytes behind the 12 triangles"));  // 84 + 12 x 50
  EXPECT_TRUE(contains(refusalOf(folder, "c.stl", "# made by me\n" + bare),
                       "is a text that starts with \"#\", not with \"solid\"; take out"));
  EXPECT_TRUE(contains(refusalOf(folder, "c.stl", binary.substr(0, binary.size() - 60)),
                       "announces 12 triangles and holds 10"));
}

TEST(ForeignMesh, PlyWithMoreValuesThanItsHeaderNames_IsReadByLines) {
  const Folder folder;
  std::string rows;
  for (const Vector3d& p : boxCorners()) rows += fmt::format("{} {} {} 255\n", p.x(), p.y(), p.z());
  for (const Eigen::Vector3i& t : kBoxFaces) {
    rows += fmt::format("3 {} {} {} 2 1 1\n", t[0], t[1], t[2]);
  }
  const std::string path = folder.write(
      "c.ply",
      "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
      "property float z\nelement face 12\nproperty list uchar int vertex_index\nend_header\n" +
          rows);
  expectBox(path, Affine3d::Identity(), 1e-9);
  EXPECT_TRUE(contains(format(orThrow(loadMeshCollider(path, Vector3d::Ones())).notices),
                       "has more values in line 10 than its head names"));
}

std::string plyHead(const std::string& remark, const std::string& end = "\n") {
  std::string head = "ply\nformat ascii 1.0\n" + remark +
                     "element vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
                     "element face 12\nproperty list uchar int vertex_index\nend_header\n";
  for (std::size_t at = head.find('\n'); at != head.npos; at = head.find('\n', at + end.size())) {
    head.replace(at, 1, end);
  }
  return head;
}

TEST(ForeignMesh, PlyVariantsOfOtherWriters_AreRead) {
  const Folder folder;
  std::string rows, values;
  for (const Vector3d& p : boxCorners()) {
    rows += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
    for (const double x : p) values += littleEndian(static_cast<float>(x));
  }
  for (const Eigen::Vector3i& t : kBoxFaces) {
    rows += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
    values += '\x03';
    for (const int i : t) values += littleEndian(std::int32_t{i});
  }
  std::string bare = rows;
  std::replace(bare.begin(), bare.end(), '\n', '\r');
  std::string binary = plyHead("");
  binary.replace(binary.find("ascii"), 5, "binary_little_endian");
  std::string blank = binary;
  blank.insert(blank.size() - 1, " ");
  const struct {
    const char* name;
    std::string bytes;
  } cases[] = {
      {"byte order mark", "\xEF\xBB\xBF" + plyHead("") + rows},
      {"CR alone", plyHead("", "\r") + bare},
      {"blank behind the head", blank + values},
      {"remark without \"comment\"", plyHead("Created by a program\n") + rows},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.name);
    expectBox(folder.write("c.ply", c.bytes), Affine3d::Identity(), 1e-6);
  }
  const MeshCollider remark = orThrow(load(folder, "c.ply", cases[3].bytes));
  EXPECT_TRUE(
      contains(format(remark.notices), "has \"Created\" in line 3 of its head, which is ignored"));
  const std::string twice = folder.write("c.ply", blank + values + values);
  expectBox(twice, Affine3d::Identity(), 1e-6);
  EXPECT_TRUE(contains(format(orThrow(loadMeshCollider(twice, Vector3d::Ones())).notices),
                       "goes on behind the values of its head"));
  const std::string half = replaced(plyHead("") + rows, "3 0 1 3", "3 0 1 2.7");
  EXPECT_TRUE(
      contains(refusalOf(folder, "c.ply", half), "has a face with the corner 2.7; there are 8"));
  const std::string capital = replaced(plyHead("") + rows, "float x", "float X");
  EXPECT_TRUE(
      contains(refusalOf(folder, "c.ply", capital), "has vertices without a property \"x\""));
  std::string other = plyHead("") + rows;
  other.replace(other.find("vertex_index"), 12, "corners");
  EXPECT_TRUE(
      contains(refusalOf(folder, "c.ply", other), "faces without a list \"vertex_indices\""));
  std::string cloud = plyHead("") + rows;
  cloud.replace(cloud.find("face 12"), 7, "face 0");
  EXPECT_TRUE(contains(refusalOf(folder, "c.ply", cloud), "holds 8 points and no triangle"));
}

TEST(ForeignMesh, UnusedCorners_AreIgnored) {
  const Folder folder;
  for (const char* spare : {"v 99 0 0\n", "v nan nan nan\n"}) {
    const std::string path = folder.write("c.obj", kBoxObj + spare);
    expectBox(path, Affine3d::Identity(), 1e-9);
    EXPECT_TRUE(orThrow(loadMeshCollider(path, Vector3d::Ones())).notices.empty());
  }
}

// A box inside a box, half as wide: 48 and 6 cm3.
TEST(ForeignMesh, PartInsideAnother_IsLeftOutAndAHollowIsFilled) {
  const Folder folder;
  const std::string inner = objCorners(boxCorners(kBox_m / 4.0, 0.75 * kBox_m));
  const MeshCollider solid =
      orThrow(load(folder, "in.obj", "o a\n" + kBoxObj + "o b\n" + inner + objFaces(9)));
  ASSERT_EQ(solid.shapes.size(), 1U);
  EXPECT_NEAR(moments(solid.shapes[0]).volume_m3, kBox_m3, 1e-15);
  EXPECT_TRUE(contains(format(solid.notices), "has 1 part inside another"));
  std::string hollow = kBoxObj + inner;
  for (const Eigen::Vector3i& t : kBoxFaces) {
    hollow += fmt::format("f {} {} {}\n", t[2] + 9, t[1] + 9, t[0] + 9);
  }
  const MeshCollider filled = orThrow(load(folder, "hollow.obj", hollow));
  ASSERT_EQ(filled.shapes.size(), 1U);
  EXPECT_NEAR(moments(filled.shapes[0]).volume_m3, kBox_m3, 1e-15);
  EXPECT_TRUE(contains(format(filled.notices), "14.3 % larger in volume"));  // 48 / (48 - 6)
}

TEST(ForeignMesh, SurfaceClosedUpToRounding_HasAVolume) {
  const Folder folder;
  // The U as one object in an STL of doubles: the corners of each triangle are rounded separately.
  std::string stl = "solid u\n";
  const MeshSurface u = orThrow(readMesh(folder.write("u.obj", letterU("o all\n", false)))).surface;
  double apart_m = 1e-9;
  for (const Eigen::Vector3i& t : u.triangles) {
    stl += "facet normal 0 0 0 outer loop\n";
    for (const int corner : t) {
      const Vector3d p = u.points[corner].array() + (apart_m = -apart_m);
      stl += fmt::format("vertex {} {} {}\n", p.x(), p.y(), p.z());
    }
    stl += "endloop endfacet\n";
  }
  const MeshCollider mesh = orThrow(load(folder, "u.stl", stl + "endsolid\n"));
  double volume_m3 = 0.0;
  for (const Shape& shape : mesh.shapes) volume_m3 += moments(shape).volume_m3;
  EXPECT_EQ(mesh.shapes.size(), 3U);
  EXPECT_NEAR(volume_m3, 64e-6, 1e-6 * 64e-6);
}

TEST(ForeignMesh, Polygons_AreSplitIntoFansOrEars) {
  const Folder folder;
  // An arrow head as a prism of 10 mm: the square of 40 mm less a triangle of 40 x 20 mm.
  const std::string corners =
      "v 0 0 {0}\nv 0.02 0.02 {0}\nv 0.04 0 {0}\nv 0.04 0.04 {0}\nv 0 0.04 {0}\n";
  const std::string arrow =
      fmt::format(fmt::runtime(corners), 0.0) + fmt::format(fmt::runtime(corners), 0.01) +
      "f 5 4 3 2 1\nf 6 7 8 9 10\nf 1 2 7 6\nf 2 3 8 7\nf 3 4 9 8\nf 4 5 10 9\n"
      "f 5 1 6 10\n";
  const MeshSurface prism = orThrow(readMesh(folder.write("a.obj", arrow))).surface;
  EXPECT_NEAR(signedVolume(prism), (0.04 * 0.04 - 0.04 * 0.02 / 2.0) * 0.01, 1e-15);
  for (const Eigen::Vector3i& t : prism.triangles) {  // no triangle is outside or folded
    const Vector3d middle = (prism.points[t[0]] + prism.points[t[1]] + prism.points[t[2]]) / 3.0;
    EXPECT_GE(middle.y() + 1e-12, std::min(middle.x(), 0.04 - middle.x()));
  }
  // Four corners that are not in one plane: the fan from the first corner.
  const MeshSurface bent =
      orThrow(readMesh(folder.write("b.obj", "v 0 0 0\nv 1 0 0\nv 1 1 1\nv 0 1 0\nf 1 2 3 4\n")))
          .surface;
  EXPECT_EQ(bent.triangles, (std::vector<Eigen::Vector3i>{{0, 1, 2}, {0, 2, 3}}));
}

TEST(ForeignMesh, GlbWithMoreThanItsGeometry_IsReadAndReported) {
  const Folder folder;
  const std::string plain = glb(R"({"mesh":0})");
  expectBox(folder.write("t.glb", plain + "a tail"), Affine3d::Identity(), 1e-6);
  EXPECT_TRUE(
      contains(refusalOf(folder, "t.glb", plain.substr(0, plain.size() - 4)),
               fmt::format("announces {} bytes and holds {}", plain.size(), plain.size() - 4)));
  const auto with = [&](std::string_view before, std::string_view more) {
    std::string json = plain.substr(20, plain.find("BIN") - 24);
    json.insert(json.find(before) + before.size(), more);
    return glbOf(json, plain.substr(plain.find("BIN") + 4));
  };
  const std::string extended =
      with("{", R"("extensionsRequired":["KHR_materials_unlit","EXT_bent_space"],)");
  const std::string said = format(orThrow(load(folder, "e.glb", extended)).notices);
  EXPECT_TRUE(contains(said, "requires the extension EXT_bent_space, which is not known"));
  EXPECT_FALSE(contains(said, "KHR_materials_unlit")) << said;
  const std::string text = with(R"("buffers":[{)", R"("uri":"data:;base64,AAAA",)");
  EXPECT_TRUE(contains(refusalOf(folder, "d.glb", text), "keeps its geometry as text in its JSON"));
}

TEST(ForeignMesh, QuantisedGlb_IsRead) {
  // Corners are unsigned shorts that the node scales to metres, as in KHR_mesh_quantization.
  const auto quantised = [](const char* normalized, double scale) {
    std::string data;
    for (const Vector3d& p : boxCorners()) {
      for (const double x : p) data += littleEndian(static_cast<std::uint16_t>(x * 1e5 + 0.5));
      data += std::string(2, '\0');  // rows of 8 bytes
    }
    for (const Eigen::Vector3i& t : kBoxFaces) {
      for (const int i : t) data += static_cast<char>(i);
    }
    return glbOf(
        fmt::format(R"({{"asset":{{"version":"2.0"}},"extensionsRequired":["KHR_mesh_quantization"],
"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0,"scale":[{0},{0},{0}]}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
"buffers":[{{"byteLength":100}}],"bufferViews":[{{"buffer":0,"byteLength":64,"byteStride":8}},
{{"buffer":0,"byteOffset":64,"byteLength":36}}],"accessors":[{{"bufferView":0,"count":8,{1}
"componentType":5123,"type":"VEC3"}},{{"bufferView":1,"count":36,"componentType":5121,
"type":"SCALAR"}}]}})",
                    scale, normalized),
        data);
  };
  const Folder folder;
  expectBox(folder.write("q.glb", quantised("", 1e-5)), Affine3d::Identity(), 1e-9);
  expectBox(folder.write("q.glb", quantised("\"normalized\":true,", 65535e-5)),
            Affine3d::Identity(), 1e-9);
}

TEST(ForeignMesh, SizeOutOfRange_NamesAScaleThatFits) {
  const Folder folder;
  const auto said = [&](double scale) {
    const auto mesh = loadMeshCollider(folder.write("c.obj", kBoxObj), Vector3d::Constant(scale));
    return mesh ? "" : format(mesh.errors());
  };
  EXPECT_TRUE(contains(said(1000.0), "with its scale times 0.001 it is 0.07483 m across"));
  EXPECT_TRUE(contains(said(0.001), "with its scale times 1000 it is 0.07483 m across"));
}

// 48 cm3 times 0.0012 and 22.6 g/cm3 are 0.0576 g and 1.0848 kg; metres read as centimetres give
// 0.1 kg in 48 m3.
TEST(ForeignMesh, ImpossibleDensity_IsReported) {
  const Folder folder;
  folder.write("box.obj", kBoxObj);
  const auto noticed = [&](const std::string& keys) {
    const SceneModel scene = orThrow(loadSceneFile(
        folder.write("s.toml", kSceneHead + fileBody("t", "mesh", "box.obj", 0.3) + keys)));
    return format(scene.notices);
  };
  EXPECT_EQ(noticed("mass_kg = 1.084\n"), "");
  EXPECT_EQ(noticed("mass_kg = 1e-4\n"), "");
  EXPECT_TRUE(contains(noticed("mass_kg = 1.086\n"),
                       "s.toml:8: bodies[t].file: makes 't' heavier than any matter"));
  EXPECT_TRUE(contains(noticed("scale = 100.0\nmass_kg = 0.1\n"),
                       "lighter than air (0.00208 kg/m³: 0.1 kg in 4.8e+07 cm³); check its size"));
  EXPECT_EQ(noticed("scale = 100.0\nfixed = true\n"), "");
}

const std::string kBoxLink =
    R"(<link name="b"><inertial><mass value="0.1"/><inertia ixx="1.667e-5" iyy="3.333e-5"
izz="4.333e-5"/></inertial><collision><geometry><box size="0.06 0.04 0.02"/></geometry></collision>
</link>)";

/// The scene with one body from that URDF.
Expected<SceneModel> sceneOf(const Folder& folder, const std::string& links) {
  folder.write("r.urdf", "<robot name=\"r\">" + links + "</robot>");
  return loadSceneFile(folder.write("s.toml", kSceneHead + fileBody("t", "urdf", "r.urdf", 0.3)));
}

std::string fixedJoint(const char* parent, const char* child) {
  return fmt::format(R"(<joint name="{1}" type="fixed"><parent link="{0}"/><child link="{1}"/>
<origin xyz="0 0 0.05"/></joint>)",
                     parent, child);
}

TEST(ForeignUrdf, FramesAndBallast_BecomeLinksWithoutColliders) {
  const Folder folder;
  EXPECT_EQ(orThrow(sceneOf(folder, kBoxLink + "<link name=\"f\"/>" + fixedJoint("b", "f")))
                .bodies[0]
                .mass_kg,
            0.1);
  EXPECT_TRUE(sceneOf(folder, kBoxLink + R"(<link name="f"><inertial><mass value="0"/>
<inertia ixx="0" iyy="0" izz="0"/></inertial></link>)" +
                                  fixedJoint("b", "f"))
                  .ok());
  const SceneModel root =
      orThrow(sceneOf(folder, "<link name=\"f\"/>" + kBoxLink + fixedJoint("f", "b")));
  EXPECT_NEAR(root.bodies[0].com_m.z(), 0.05, 1e-15);
  // 0.1 kg at the box's centre, 0.3 kg 50 mm above it.
  const SceneModel heavy = orThrow(
      sceneOf(folder, kBoxLink + R"(<link name="w"><inertial><mass value="0.3"/><inertia ixx="1e-5"
iyy="1e-5" izz="1e-5"/></inertial></link>)" +
                          fixedJoint("b", "w")));
  EXPECT_NEAR(heavy.bodies[0].mass_kg, 0.4, 1e-15);
  EXPECT_NEAR(heavy.bodies[0].com_m.z(), 0.3 / 0.4 * 0.05, 1e-15);
  EXPECT_TRUE(contains(format(sceneOf(folder, "<link name=\"f\"/>").errors()),
                       "link[f]: has no collider, nor has any other link"));
}

TEST(ForeignUrdf, AnchorsOfOtherPrograms_AreReportedUntilTheSceneFixesTheBody) {
  const Folder folder;
  const struct {
    std::string links, said;
  } cases[] = {
      {"<link name=\"world\"/>" + kBoxLink + fixedJoint("world", "b"),
       "link[world]: does not hold the body, which moves"},
      {kBoxLink + "<gazebo><static>true</static></gazebo>", "gazebo.static = true: is not applied"},
      {kBoxLink + "<gazebo reference=\"b\"><turnGravityOff>1</turnGravityOff></gazebo>",
       "gazebo.turnGravityOff = 1: is not applied"},
      {kBoxLink + "<gazebo reference=\"b\"><gravity>0</gravity></gazebo>", "gazebo.gravity = 0"},
  };
  for (const auto& c : cases) {
    const std::string said = format(orThrow(sceneOf(folder, c.links)).notices);
    EXPECT_TRUE(contains(said, c.said));
    EXPECT_TRUE(contains(said, "set fixed = true in the scene if it shall stand"));
    const SceneModel stands = orThrow(loadSceneFile(folder.write(
        "f.toml", kSceneHead + fileBody("t", "urdf", "r.urdf", 0.3) + "fixed = true\n")));
    EXPECT_TRUE(stands.notices.empty()) << format(stands.notices);
  }
  EXPECT_TRUE(
      orThrow(sceneOf(folder, kBoxLink + "<gazebo><static>0</static></gazebo>")).notices.empty());
}

TEST(ForeignUrdf, FlatMesh_IsLeftOutOfABodyWithOtherShapes) {
  const Folder folder;
  folder.write("flat.obj", "v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nf 1 2 3\n");
  const std::string flat =
      "<collision><geometry><mesh filename=\"flat.obj\"/></geometry></collision>";
  std::string both = kBoxLink;
  both.insert(both.find("<collision>"), flat);
  const SceneModel scene = orThrow(sceneOf(folder, both));
  EXPECT_EQ(scene.bodies[0].shapes.size(), 1U);
  ASSERT_EQ(scene.notices.size(), 1U);
  EXPECT_TRUE(contains(format(scene.notices), "it encloses no volume; it is left out"));
  EXPECT_TRUE(contains(format(sceneOf(folder, "<link name=\"b\">" + flat + "</link>").errors()),
                       "encloses no volume"));
}

TEST(ForeignUrdf, Origins_AreReadInRadiansOrQuaternions) {
  const Folder folder;
  const auto turned = [&](const std::string& origin) {
    return loadUrdf(folder.write(
        "t.urdf",
        R"(<robot name="r"><link name="a"><collision><origin )" + origin +
            R"(/><geometry><box size="0.1 0.1 0.2"/></geometry></collision></link></robot>)"));
  };
  // A quarter turn about x, then 60 degrees about z: half angles of 45 and 30 degrees.
  const UrdfBody by_angles = orThrow(turned(R"(rpy="1.5707963267948966 0 1.0471975511965976")"));
  const UrdfBody by_quaternion = orThrow(turned(
      R"(quat_xyzw="0.6123724356957945 0.3535533905932738 0.3535533905932738 0.6123724356957945")"));
  EXPECT_LT((by_angles.shapes.at(0).in_body.rotation - by_quaternion.shapes.at(0).in_body.rotation)
                .norm(),
            1e-12);
  EXPECT_TRUE(contains(format(turned(R"(rpy="0 0 90")").errors()),
                       "origin.rpy = 0 0 90: is beyond two turns (4π rad); must be in rad"));
}

/// An ASCII text with characters of `bytes` bytes.
std::string widened(const std::string& text, std::size_t bytes, bool little_end_first) {
  std::string wide;
  for (const char c : text) {
    if (little_end_first) wide += c;
    wide.append(bytes - 1, '\0');
    if (!little_end_first) wide += c;
  }
  return wide;
}

TEST(ForeignFile, TextOfWideCharacters_IsReported) {
  using namespace std::string_literals;
  const std::pair<const char*, std::string> texts[] = {
      {"u.urdf", "<robot name=\"r\">" + kBoxLink + "</robot>"},
      {"u.obj", kBoxObj},
      {"u.stl", "solid box\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"},
      {"u.ply", "ply\nformat ascii 1.0\n"},
      {"u.dae", "<?xml version=\"1.0\"?><COLLADA/>"},
      {"u.toml", kSceneHead}};
  const Folder folder;
  for (const auto& [name, text] : texts) {
    const struct {
      std::string bytes, kind;
    } forms[] = {{"\xFF\xFE" + widened(text, 2, true), "UTF-16"},
                 {"\xFE\xFF" + widened(text, 2, false), "UTF-16"},
                 {widened(text, 2, true), "UTF-16"},
                 {widened(text, 2, false), "UTF-16"},
                 {"\xFF\xFE\0\0"s + widened(text, 4, true), "UTF-32"},
                 {widened(text, 4, false), "UTF-32"}};
    for (const auto& form : forms) {
      const std::string path = folder.write(name, form.bytes);
      const std::string ending = path.substr(path.rfind('.') + 1);
      const Diagnostics faults = ending == "urdf" ? loadUrdf(path).errors()
                                 : ending == "toml"
                                     ? loadSceneFile(path).errors()
                                     : loadMeshCollider(path, Vector3d::Ones()).errors();
      EXPECT_TRUE(contains(format(faults), "is a text in " + form.kind + "; save it as UTF-8"));
    }
  }
}

TEST(ForeignUrdf, DuplicateElementOfALink_IsReported) {
  const Folder folder;
  const std::string once =
      R"(<mass value="0.1"/><inertia ixx="1.667e-5" iyy="3.333e-5" izz="4.333e-5"/>)";
  const std::string box = R"(<geometry><box size="0.06 0.04 0.02"/></geometry>)";
  const auto said = [&](const std::string& inertials, const std::string& collision) {
    const auto scene = sceneOf(folder, "<link name=\"b\">\n" + inertials + "<collision>" +
                                           collision + "</collision></link>");
    return scene.ok() ? "" : format(scene.errors());
  };
  const auto inertial = [](const std::string& inner) {
    return "<inertial>" + inner + "</inertial>\n";
  };
  EXPECT_EQ(said(inertial(once), box), "");
  EXPECT_TRUE(
      contains(said(inertial(once) + inertial(once), box),
               "r.urdf:3: link[b].inertial: stands there twice, first in line 2; keep one"));
  EXPECT_TRUE(contains(said(inertial(once + "<mass value=\"3\"/>"), box),
                       "r.urdf:2: link[b].inertial.mass: stands there twice"));
  EXPECT_TRUE(contains(said(inertial(once + "<inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/>"), box),
                       "link[b].inertial.inertia: stands there twice"));
  const std::string origin = "<origin xyz=\"0 0 0\"/>";
  EXPECT_TRUE(
      contains(said(inertial(origin + origin + once), box), "link[b].inertial.origin: stands"));
  EXPECT_TRUE(contains(said(inertial(once), box + box), "link[b].collision[0].geometry: stands"));
  // Unused elements are not checked.
  folder.write("r.urdf", "<robot name=\"r\"><link name=\"b\">" + inertial(once) + inertial(once) +
                             "<collision>" + box + "</collision></link></robot>");
  EXPECT_TRUE(
      loadSceneFile(folder.write("f.toml", kSceneHead + fileBody("t", "urdf", "r.urdf", 0.3) +
                                               "fixed = true\n"))
          .ok());
}

TEST(ForeignUrdf, FrictionThatIsNotApplied_IsReportedUntilTheSceneGivesOne) {
  const std::string ode = "<surface><friction><ode><mu>0.1</mu></ode></friction></surface>";
  const struct {
    std::string in_collision, in_link, in_robot, said;
  } cases[] = {
      {"<contact><lateral_friction value=\"0.1\"/></contact>", "", "", "lateral_friction = 0.1"},
      {ode, "", "", "mu = 0.1"},
      {"<drake:proximity_properties><drake:mu_static value=\"0.1\"/></drake:proximity_properties>",
       "", "", "drake:mu_static = 0.1"},
      {"", "<contact_coefficients mu=\"0.1\" kp=\"1\"/>", "", "contact_coefficients = 0.1"},
      {"", "", "<gazebo><mu1>0.1</mu1></gazebo>", "mu1 = 0.1"},
      {"", "", "<gazebo reference=\"none\"><mu1>0.1</mu1></gazebo>", "mu1 = 0.1"},
      {"", "", "<gazebo reference=\"b\"><collision>" + ode + "</collision></gazebo>", "mu = 0.1"},
      {"", "", "<mujoco><default><geom friction=\"0.1 0.005\"/></default></mujoco>",
       "geom = 0.1 0.005"},
  };
  const Folder folder;
  for (const auto& c : cases) {
    std::string link = kBoxLink;
    link.insert(link.find("</collision>"), c.in_collision);
    link.insert(link.find("</link>"), c.in_link);
    const SceneModel scene = orThrow(sceneOf(folder, link + c.in_robot));
    EXPECT_EQ(scene.bodies[0].friction, 0.8);  // a body's default
    ASSERT_EQ(scene.notices.size(), 1U) << c.said << format(scene.notices);
    EXPECT_TRUE(contains(format(scene.notices), c.said + ": is friction where none is read"));
    EXPECT_TRUE(contains(format(scene.notices), "give the body of the scene friction = 0 to 2"));
    const SceneModel own = orThrow(loadSceneFile(folder.write(
        "own.toml", kSceneHead + fileBody("t", "urdf", "r.urdf", 0.3) + "friction = 0.1\n")));
    EXPECT_EQ(own.bodies[0].friction, 0.1);
    EXPECT_TRUE(own.notices.empty()) << format(own.notices);
  }
}

TEST(ForeignUrdf, DensityOfALink_GivesTheMassOfItsColliders) {
  const Folder folder;
  const auto dense = [&](const std::string& value) {
    return loadUrdf(
        folder.write("cube.urdf",
                     R"(<robot name="r"><link name="a"><collision><origin xyz="0.3 0 0"/><geometry>
<box size="0.1 0.1 0.2"/></geometry></collision><inertial><density value=")" +
                         value + R"("/></inertial></link></robot>)"));
  };
  const MassProperties m = orThrow(dense("500")).inertial.value().sum;
  EXPECT_NEAR(m.mass_kg, 1.0, 1e-12);  // 500 kg/m3 x 2 l
  EXPECT_LT((m.com_m - Vector3d(0.3, 0.0, 0.0)).norm(), 1e-12);
  // A twelfth of the mass times the squares of two edges.
  const Vector3d diagonal_kg_m2 = Vector3d(0.01 + 0.04, 0.01 + 0.04, 0.01 + 0.01) / 12.0;
  EXPECT_LT((m.inertia_kg_m2 - Eigen::Matrix3d(diagonal_kg_m2.asDiagonal())).norm(), 1e-12);
  EXPECT_TRUE(
      contains(format(dense("0").errors()), "link[a].inertial.density.value = 0: gives no mass"));
}

TEST(ForeignUrdf, MeshNamesOfEveryForm_AreResolved) {
  const Folder folder;
  folder.write("my cups/meshes/a cup.obj", kBoxObj);
  folder.write("my cups/urdf/cup.obj", kBoxObj);
  for (const char* name : {"../meshes/a%20cup.obj", "../meshes/a cup.obj", "..\\meshes\\a cup.obj",
                           "..\\meshes\\a%20cup.obj", "package://my cups/meshes/a%20cup.obj",
                           "package://my%20cups/meshes/a%20cup.obj",
                           "model://my cups/meshes/a cup.obj", "my cups/meshes/a cup.obj",
                           "meshes/a cup.obj", "package://cup.obj", "package:///cup.obj"}) {
    const UrdfBody body = orThrow(loadUrdf(folder.write(
        "my cups/urdf/c.urdf",
        R"(<robot name="r"><link name="a"><collision><geometry><mesh filename=")" +
            std::string(name) + R"(" scale="2"/></geometry></collision></link></robot>)")));
    EXPECT_NEAR(moments(body.shapes.at(0)).volume_m3, 8.0 * kBox_m3, 1e-14) << name;
  }
}

// A scene that mentions OpenSim's marker in a comment is not an OpenSim file.
TEST(ForeignFile, OpenSimMarkerInAComment_IsNoOpenSimMotion) {
  EXPECT_FALSE(
      foreignFile("# made from the .mot behind its endheader\nkind = \"scene\"\n", "toml"));
  EXPECT_FALSE(foreignFile("# endheader\nkind = \"scene\"\n", "toml"));
  EXPECT_FALSE(foreignFile("name = \"endheaders\"\n", "toml"));
  EXPECT_TRUE(foreignFile("name\nnRows=2\nendheader\ntime\tx\n", "mot"));
  EXPECT_TRUE(foreignFile("name\r\nendheader \r\ntime\tx\r\n", "txt"));
}

TEST(ForeignFile, KnownKinds_AreNamedWithTheCommandThatConvertsThem) {
  const struct {
    const char *name, *text, *is, *remedy;
  } cases[] = {
      {"m.xml", "<?xml version=\"1.0\"?>\n<!-- a hand -->\n<mujoco><worldbody/></mujoco>",
       "is MJCF", "mjcf2urdf"},
      {"part.xml", "<mujocoinclude>\n<body name=\"cup\"/></mujocoinclude>", "is a part of an MJCF",
       "the model that includes it"},
      {"body.xml", "<body name=\"cup\"><geom type=\"box\"/></body>", "is a part of an MJCF",
       "mjcf2urdf"},
      {"model.config", "<?xml version=\"1.0\"?>\n<model><name>cup</name></model>",
       "a model of Gazebo", "the .sdf beside it"},
      {"m.off", "OFF\n8 12 0\n0 0 0\n", "is a mesh (OFF)", "meshlabserver"},
      {"m.h5", "\x89HDF\r\n\x1A\n", "is HDF5", "wholehand replay IN"},
      {"m.usdc", "PXR-USDC", "is USD", "as GLB"},
      {"m.sdf", "<sdf version=\"1.6\"><model name=\"m\"/></sdf>", "is SDF", "sdf2urdf"},
      {"m.xacro",
       "<robot xmlns:xacro=\"http://ros.org/wiki/xacro\"><xacro:box/><link name=\"a\"/></robot>",
       "is xacro", "xacro IN > out.urdf"},
      {"m.gltf", "{\"asset\":{\"version\":\"2.0\"}}", "is glTF", "npx @gltf-transform/cli copy"},
      {"m.usda", "#usda 1.0\ndef Xform \"cup\"\n", "is USD", "as GLB"},
      {"m.wbt", "#VRML_SIM R2023b utf8\nWorldInfo {\n}\n", "of Webots", "as URDF"},
      {"m.gz", "\x1F\x8B\x08", "is compressed (gzip)", "gunzip"},
      {"m.zip", "PK\x03\x04", "is a ZIP archive", "unzip"},
      {"m.step", "ISO-10303-21;\nHEADER;\n", "is STEP", "gmsh"},
      {"m.c3d", "\x02\x50\x08{{{{{{{{{{{{{{{{{{{{{{{{{{{{{{{{{{{", "is C3D", "c3d2csv"},
      {"m.bvh", "HIERARCHY\nROOT Hips\n", "is BVH", "bvh2csv"},
      {"m.trc", "PathFileType\t4\t(X/Y/Z)\tm.trc\n", "is TRC", "tr '\\t' ','"},
      {"m.txt", "version https://git-lfs.github.com/spec/v1\noid sha256:0\n",
       "is a pointer of Git LFS", "git lfs pull"},
  };
  const Folder folder;
  for (const auto& c : cases) {
    const std::string path = folder.write(c.name, c.text);
    const std::string as_toml = format(fileKind(path).errors());
    EXPECT_EQ(as_toml.find(path + ": is "), 0U) << as_toml;
    for (const std::string& said : {as_toml, format(loadUrdf(path).errors()),
                                    format(loadMeshCollider(path, Vector3d::Ones()).errors())}) {
      EXPECT_TRUE(contains(said, c.is));
      EXPECT_TRUE(contains(said, c.remedy));
    }
  }
  const std::string urdf = folder.write("r.urdf", "<robot name=\"r\">" + kBoxLink + "</robot>");
  EXPECT_TRUE(contains(format(fileKind(urdf).errors()), "r.urdf: is a URDF; use it as a scene"));
  const std::string csv = folder.write("m.txt", "# a motion\ntime_s,x_m\n0,0\n0.01,0\n");
  EXPECT_TRUE(contains(format(fileKind(csv).errors()), "is a table (CSV); a motion is given with"));
  EXPECT_TRUE(
      contains(format(fileKind(folder.write("box.obj", kBoxObj)).errors()), "is a mesh (OBJ)"));
}

}  // namespace
}  // namespace wholehand::test
