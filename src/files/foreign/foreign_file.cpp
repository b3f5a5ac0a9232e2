#include "files/foreign/foreign_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>

namespace wholehand {
namespace {

struct ForeignKind {
  std::string_view name;  ///< name of the first XML element, or file name extension
  const char *problem, *remedy;
};

constexpr const char* kToStl = "convert it: gmsh IN -2 -format stl -o out.stl (lengths in mm)";
constexpr const char* kToGlb = "convert it: assimp export IN out.glb";

constexpr const char* kToUrdf =
    "convert it to URDF: mjcf2urdf IN --out OUT (pip install mjcf2urdf)";
constexpr const char* kPartToUrdf =
    "convert the model that includes it to URDF: mjcf2urdf IN --out OUT (pip install mjcf2urdf)";
constexpr const char* kNameMesh = "name it in a scene: shape = \"mesh\", file = \"...\"";
constexpr const char* kMjcfPart = "is a part of an MJCF, a model of MuJoCo";

constexpr std::array<ForeignKind, 12> kXml = {{
    {"mujoco", "is MJCF, a model of MuJoCo", kToUrdf},
    {"mujocoinclude", kMjcfPart, kPartToUrdf},
    {"worldbody", kMjcfPart, kPartToUrdf},
    {"body", kMjcfPart, kPartToUrdf},
    {"sdf", "is SDF, a model of Gazebo",
     "convert it to URDF: rosrun pysdf sdf2urdf.py in.sdf out.urdf"},
    {"model", "is the description of a model of Gazebo",
     "convert the .sdf beside it to URDF: rosrun pysdf sdf2urdf.py in.sdf out.urdf"},
    {"robot", "is a URDF",
     "use it as a scene (--scene), or name it in one: shape = \"urdf\", file = \"...\""},
    {"COLLADA", "is a mesh (DAE)", kNameMesh},
    {"OpenSimDocument", "is a model of OpenSim", "use a hand of config/hands"},
    {"svg", "is a picture (SVG)", "name the file that it shows"},
    {"html", "is a web page, not the file that it shows", "download the file itself (raw)"},
    {"HTML", "is a web page, not the file that it shows", "download the file itself (raw)"},
}};

constexpr ForeignKind kXacro = {"xacro", "is xacro, which makes a URDF",
                                "convert it: xacro IN > out.urdf"};
constexpr ForeignKind kStep = {"step", "is STEP, a solid without triangles", kToStl};
constexpr ForeignKind kGltf = {"gltf", "is glTF in several files",
                               "make it one: npx @gltf-transform/cli copy in.gltf out.glb"};
constexpr ForeignKind kBvh = {"bvh", "is BVH, a motion of a skeleton",
                              "convert it: bvh2csv IN (pip install bvhtoolbox), then name the "
                              "columns time_s, x_m, ..."};
constexpr ForeignKind kTrc = {"trc", "is TRC, a motion of markers",
                              "convert it: tail -n +4 IN | tr '\\t' ',' > out.csv, then name the "
                              "columns time_s, x_m, ..."};
constexpr ForeignKind kC3d = {"c3d", "is C3D, a motion of markers",
                              "convert it: c3d2csv IN (pip install c3d), then name the columns "
                              "time_s, x_m, ..."};
constexpr ForeignKind kOpenSim = {"mot", "is a motion of OpenSim",
                                  "convert it: sed '1,/endheader/d' IN | tr '\\t' ',' > out.csv, "
                                  "then name the columns time_s, x_m, ..."};
constexpr ForeignKind kWide = {"", "is a text in UTF-16", "save it as UTF-8"};
constexpr ForeignKind kWidest = {"", "is a text in UTF-32", kWide.remedy};
constexpr ForeignKind kLfs = {"", "is a pointer of Git LFS, not the file itself",
                              "fetch the file: git lfs pull"};

constexpr ForeignKind kZip = {"", "is a ZIP archive", "unpack it: unzip IN"};
constexpr ForeignKind kGzip = {"", "is compressed (gzip)", "unpack it: gunzip IN.gz"};
constexpr ForeignKind kUsd = {"usd", "is USD", "export it from Blender as GLB"};
constexpr ForeignKind kHdf5 = {"h5", "is HDF5, as recordings and results of sweeps are",
                               "show a recording: wholehand replay IN"};
constexpr ForeignKind kOff = {"off", "is a mesh (OFF)",
                              "convert it: meshlabserver -i IN -o out.ply"};
constexpr ForeignKind kWebots = {"wbt", "is a world or a robot of Webots",
                                 "export the robot from Webots as URDF"};

constexpr std::array<ForeignKind, 24> kEndings = {{
    kXacro,
    kStep,
    {"stp", kStep.problem, kToStl},
    {"iges", "is IGES, a solid without triangles", kToStl},
    {"igs", "is IGES, a solid without triangles", kToStl},
    kGltf,
    kBvh,
    kTrc,
    kC3d,
    kOpenSim,
    {"sto", kOpenSim.problem, kOpenSim.remedy},
    {"fbx", "is FBX", kToGlb},
    {"3ds", "is 3DS", kToGlb},
    {"x3d", "is X3D", kToGlb},
    kOff,
    kUsd,
    {"usda", kUsd.problem, kUsd.remedy},
    {"usdc", kUsd.problem, kUsd.remedy},
    {"usdz", kUsd.problem, kUsd.remedy},
    kWebots,
    {"proto", kWebots.problem, kWebots.remedy},
    {"stl", "is a mesh (STL)", kNameMesh},
    {"obj", "is a mesh (OBJ)", kNameMesh},
    {"ply", "is a mesh (PLY)", kNameMesh},
}};

Diagnostic asFault(const ForeignKind& kind) {
  return fileFault("", kind.problem, kind.remedy);
}

/// Name of the first element of an XML text; empty when the text is not XML.
std::string_view firstElement(std::string_view text) {
  for (std::size_t at = text.find_first_not_of(" \t\r\n"); at < text.size() && text[at] == '<';
       at = text.find_first_not_of(" \t\r\n", at)) {
    const std::string_view rest = text.substr(at);
    const bool comment = rest.starts_with("<!--");
    if (!comment && !rest.starts_with("<?") && !rest.starts_with("<!")) {
      return rest.substr(1, rest.find_first_of(" \t\r\n/>") - 1);
    }
    if (rest.starts_with("<!DOCTYPE html") || rest.starts_with("<!doctype html")) return "html";
    const std::size_t end = rest.find(comment ? "-->" : ">");
    if (end == rest.npos) return {};
    at += end + (comment ? 3 : 1);
  }
  return {};
}

/// True when a line of the text consists of that word only, blanks aside.
bool hasLine(std::string_view text, std::string_view word) {
  for (std::size_t at = text.find(word); at != text.npos; at = text.find(word, at + 1)) {
    const std::size_t before = text.substr(0, at).find_last_not_of(" \t");
    const std::size_t after = text.find_first_not_of(" \t", at + word.size());
    const bool begins = before == text.npos || text[before] == '\n' || text[before] == '\r';
    const bool ends = after == text.npos || text[after] == '\n' || text[after] == '\r';
    if (begins && ends) return true;
  }
  return false;
}

}  // namespace

std::optional<Diagnostic> wideText(std::string_view head) {
  using namespace std::string_view_literals;
  if (head.starts_with("\xFF\xFE\0\0"sv) || head.starts_with("\0\0\xFE\xFF"sv)) {
    return asFault(kWidest);
  }
  if (head.starts_with("\xFF\xFE") || head.starts_with("\xFE\xFF")) return asFault(kWide);
  constexpr std::size_t kLooked = 4;  // characters
  const auto is_wide = [&](std::size_t bytes, std::size_t letter) {
    if (head.size() < kLooked * bytes) return false;
    for (std::size_t i = 0; i < kLooked * bytes; ++i) {
      const auto c = static_cast<unsigned char>(head[i]);
      const bool text = std::isprint(c) != 0 || std::isspace(c) != 0;
      if (i % bytes == letter ? !text : c != 0) return false;
    }
    return true;
  };
  if (is_wide(2, 0) || is_wide(2, 1)) return asFault(kWide);
  if (is_wide(4, 0) || is_wide(4, 3)) return asFault(kWidest);
  return std::nullopt;
}

std::optional<Diagnostic> foreignFile(std::string_view head, std::string_view ending) {
  if (auto wide = wideText(head)) return wide;
  if (head.starts_with("\xEF\xBB\xBF")) head.remove_prefix(3);
  if (head.starts_with("version https://git-lfs")) return asFault(kLfs);
  const std::string_view element = firstElement(head);
  const bool macros = head.find("xmlns:xacro") != head.npos;
  for (const ForeignKind& kind : kXml) {
    if (element == kind.name) return asFault(element == "robot" && macros ? kXacro : kind);
  }
  if (head.starts_with("glTF")) return asFault({"glb", "is a mesh (GLB)", kNameMesh});
  if (head.starts_with("ISO-10303-21")) return asFault(kStep);
  if (head.starts_with("\x89HDF\r\n\x1A\n")) return asFault(kHdf5);
  if (hasLine(head.substr(0, head.find('\n')), "OFF") || head.starts_with("COFF") ||
      head.starts_with("NOFF")) {
    return asFault(kOff);
  }
  if (head.starts_with("HIERARCHY")) return asFault(kBvh);
  if (head.starts_with("#usda") || head.starts_with("PXR-USDC")) return asFault(kUsd);
  if (head.starts_with("#VRML_SIM")) return asFault(kWebots);
  if (head.starts_with("PathFileType")) return asFault(kTrc);
  if (hasLine(head, "endheader")) return asFault(kOpenSim);
  // C3D: the number of the parameter block, then the byte 0x50.
  if (head.size() > 2 && head[0] > 0 && head[0] < '\t' && head[1] == 0x50) return asFault(kC3d);
  const std::size_t brace = head.find_first_not_of(" \t\r\n");
  if (brace != head.npos && head[brace] == '{' && head.find("\"asset\"") != head.npos) {
    return asFault(kGltf);
  }
  std::string lower(ending);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const ForeignKind& kind : kEndings) {
    if (kind.name == lower) return asFault(kind);
  }
  if (head.starts_with("PK\x03\x04")) return asFault(kZip);
  if (head.starts_with("\x1F\x8B")) return asFault(kGzip);
  return std::nullopt;
}

std::optional<Diagnostic> foreignFileAt(const std::string& path) {
  constexpr std::streamsize kHead_bytes = 4096;
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return std::nullopt;
  std::string head(kHead_bytes, '\0');
  std::ifstream in(path, std::ios::binary);
  in.read(head.data(), kHead_bytes);
  head.resize(in.gcount());
  std::string ending = std::filesystem::path(path).extension().string();
  if (!ending.empty()) ending.erase(0, 1);
  return foreignFile(head, ending);
}

}  // namespace wholehand
