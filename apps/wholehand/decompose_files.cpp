#include "decompose_files.hpp"

#include "core/printable.hpp"
#include "files/text_file.hpp"
#include "model/scene/scene_model.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace wholehand {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using NamedTexts = std::vector<std::pair<std::string, std::string>>;

/// Words in the first line of every file written here.
constexpr const char* kMark = "Written by wholehand decompose";

constexpr double kTableTop_m = -0.10;  ///< as in config/scenes/table.toml

/// Removes the folder at the end.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(fs::path path) : path_(std::move(path)) {}
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }

 private:
  fs::path path_;
};

Diagnostic folderFault(const fs::path& folder, const std::string& why) {
  return {folder.string(),
          0,
          "--out",
          "",
          "cannot be written into: " + why,
          "name a folder that you may write to"};
}

bool isOwn(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::array<char, 256> start{};
  in.read(start.data(), start.size());
  const std::string text(start.data(), static_cast<std::size_t>(in.gcount()));
  return text.substr(0, text.find('\n')).find(kMark) != std::string::npos;
}

std::optional<Diagnostic> foreignFault(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(fs::symlink_status(path, error))) return std::nullopt;
  if (fs::is_regular_file(fs::symlink_status(path, error)) && isOwn(path)) return std::nullopt;
  return Diagnostic{path.string(),
                    0,
                    "--out",
                    "",
                    "is there, and not written by this command",
                    "move it away, or name another folder"};
}

/// True for NAME_NN.obj.
bool isPieceFile(const std::string& file, const std::string& name) {
  const std::string digits = file.size() == name.size() + 7 ? file.substr(name.size() + 1, 2) : "";
  return digits.size() == 2 && file.starts_with(name + "_") && file.ends_with(".obj") &&
         std::all_of(digits.begin(), digits.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

// Of a comment in TOML, OBJ and XML, which no name of a file ends.
std::string firstLine(const DecomposedMesh& mesh) {
  std::string name = printable(fs::path(mesh.source).filename().string());
  for (std::size_t at = name.find("--"); at != std::string::npos; at = name.find("--", at)) {
    name.replace(at, 2, "- -");
  }
  return fmt::format("{}: convex pieces of {}", kMark, name);
}

std::string objText(const DecomposedMesh& mesh, std::size_t index) {
  std::string text =
      fmt::format("# {}, {} of {}. Metres.\n", firstLine(mesh), index + 1, mesh.pieces.size());
  for (const Vector3d& p : mesh.pieces[index].points) {
    text += fmt::format("v {:.9g} {:.9g} {:.9g}\n", p.x(), p.y(), p.z());
  }
  for (const Eigen::Vector3i& t : mesh.pieces[index].triangles) {
    text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  }
  return text;
}

std::string urdfText(const DecomposedMesh& mesh) {
  const Eigen::Matrix3d& i = mesh.mass.inertia_kg_m2;
  const Vector3d& com = mesh.mass.com_m;
  std::string text = fmt::format(
      "<!-- {}. Metres, kilograms; mass and\n     inertia are those of the mesh at uniform "
      "density. "
      "-->\n<robot name=\"{}\">\n  <link name=\"body\">\n    <inertial>\n"
      "      <origin xyz=\"{:.9g} {:.9g} {:.9g}\"/>\n      <mass value=\"{:.9g}\"/>\n"
      "      <inertia ixx=\"{:.9g}\" iyy=\"{:.9g}\" izz=\"{:.9g}\" ixy=\"{:.9g}\" ixz=\"{:.9g}\" "
      "iyz=\"{:.9g}\"/>\n    </inertial>\n",
      firstLine(mesh), mesh.name, com.x(), com.y(), com.z(), mesh.mass.mass_kg, i(0, 0), i(1, 1),
      i(2, 2), i(0, 1), i(0, 2), i(1, 2));
  for (std::size_t k = 0; k < mesh.pieces.size(); ++k) {
    text += fmt::format("    <collision><geometry><mesh filename=\"{}\"/></geometry></collision>\n",
                        pieceFile(mesh.name, k));
  }
  return text + "  </link>\n</robot>\n";
}

/// The body on a table, as in config/scenes/table.toml.
std::string sceneText(const DecomposedMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const MeshSurface& piece : mesh.pieces) {
    for (const Vector3d& p : piece.points) box.extend(p);
  }
  const Vector3d size = box.sizes(), middle = box.center();
  const double x = 0.12 + size.x() / 2.0;  // beyond the hand's start
  const double width = std::min(0.6 + 2.0 * std::max(size.x(), size.y()), 10.0);
  return fmt::format(
      "# {}.\n# Shows the body on a table; copy [[bodies]] of \"{}\" into a scene of yours.\n"
      "kind = \"scene\"\nversion = 1\nname = \"{}\"\n"
      "gravity_m_s2 = [0.0, 0.0, -9.81]  # world frame, z up\n\n"
      "[[bodies]]\nname = \"table\"\nshape = \"box\"\nsize_m = [{:.6g}, {:.6g}, 0.04]\n"
      "fixed = true\nposition_m = [{:.6g}, 0.0, {:.6g}]\ncolor = \"#765443\"\n\n"
      "[[bodies]]\nname = \"{}\"\nshape = \"urdf\"\nfile = \"{}.urdf\"  # relative to the scene\n"
      "mass_kg = {:.9g}\nposition_m = [{:.6f}, {:.6f}, {:.6f}]\ncolor = \"#FBF4E6\"\n",
      firstLine(mesh), mesh.name, mesh.name, width, width, x, kTableTop_m - 0.02, mesh.name,
      mesh.name, mesh.mass.mass_kg, x - middle.x(), -middle.y(), kTableTop_m - box.min().z());
}

NamedTexts textsOf(const DecomposedMesh& mesh) {
  NamedTexts texts;
  for (std::size_t i = 0; i < mesh.pieces.size(); ++i) {
    texts.emplace_back(pieceFile(mesh.name, i), objText(mesh, i));
  }
  texts.emplace_back(mesh.name + ".urdf", urdfText(mesh));
  texts.emplace_back(mesh.name + ".toml", sceneText(mesh));
  return texts;
}

}  // namespace

std::string pieceName(const std::string& mesh_path) {
  std::string name = fs::path(mesh_path).stem().string();
  for (char& c : name) {
    const auto letter = static_cast<unsigned char>(c);
    if (letter >= 128 || (std::isalnum(letter) == 0 && c != '-' && c != '_')) c = '_';
  }
  return name.empty() ? "mesh" : name;
}

std::string pieceFile(const std::string& name, std::size_t index) {
  return fmt::format("{}_{:02}.obj", name, index + 1);
}

Expected<Done> checkFolder(const std::string& folder, const std::string& name, int pieces) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
    return folderFault(folder, "it is a file");
  }
  if (auto ready = checkFiles({(fs::path(folder) / (name + ".urdf")).string()}); !ready) {
    return folderFault(folder, ready.errors().front().problem);
  }
  Diagnostics faults;
  const auto note = [&](const std::string& file) {
    if (auto fault = foreignFault(fs::path(folder) / file)) faults.push_back(std::move(*fault));
  };
  for (int i = 0; i < pieces; ++i) note(pieceFile(name, static_cast<std::size_t>(i)));
  note(name + ".urdf");
  note(name + ".toml");
  if (!faults.empty()) return firstFaults(std::move(faults), folder);
  return Done{};
}

Expected<std::vector<std::string>> writeDecomposed(const DecomposedMesh& mesh,
                                                   const std::string& folder) {
  const fs::path target(folder);
  const fs::path making = target / fmt::format(".{}.{}.tmp", mesh.name, getpid());
  std::error_code error;
  fs::create_directories(making, error);
  if (error) return folderFault(folder, error.message());
  const TemporaryFolder removed(making);
  const NamedTexts texts = textsOf(mesh);
  for (const auto& [file, text] : texts) {
    if (auto done = writeText((making / file).string(), text); !done) return done.errors();
  }
  const auto scene = loadSceneFile((making / (mesh.name + ".toml")).string());
  if (!scene) return scene.errors();
  if (!scene->notices.empty()) return scene->notices;  // a piece is not convex
  std::vector<std::string> written;
  for (const auto& [file, text] : texts) {
    fs::rename(making / file, target / file, error);
    if (error) return folderFault(target / file, error.message());
    written.push_back(file);
  }
  for (const auto& entry : fs::directory_iterator(target, error)) {
    const std::string file = entry.path().filename().string();
    const bool stale = isPieceFile(file, mesh.name) &&
                       std::find(written.begin(), written.end(), file) == written.end();
    if (stale && isOwn(entry.path())) fs::remove(entry.path(), error);
  }
  return written;
}

}  // namespace wholehand
