#include "apps/tools/decompose/decompose_command.hpp"

#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/options.hpp"
#include "apps/wholehand/shared/result_files.hpp"
#include "apps/wholehand/shared/tools.hpp"
#include "files/mesh/convex_mesh.hpp"
#include "files/mesh/convex_pieces.hpp"
#include "files/mesh/mesh_file.hpp"
#include "files/mesh/solid.hpp"
#include "files/scene/scene_file.hpp"
#include "files/text/text_file.hpp"
#include "loop/core/expected.hpp"
#include "loop/core/printable.hpp"
#include "loop/model/scene_model.hpp"

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <system_error>
#include <unistd.h>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

/// Data of a mesh that `decompose` writes.
struct DecomposedMesh {
  std::string source;               ///< path of the mesh as given
  std::string name;                 ///< begin of every file name
  std::vector<MeshSurface> pieces;  ///< convex, in the mesh's frame [m]
  MassProperties mass;              ///< mass properties of the mesh
};

/// Name of a piece's file: "NAME_01.obj" and so on.
std::string pieceFile(const std::string& name, std::size_t index) {
  return fmt::format("{}_{:02}.obj", name, index + 1);
}

namespace fs = std::filesystem;
using Eigen::Vector3d;
using NamedTexts = std::vector<std::pair<std::string, std::string>>;

/// Mark in the first line of every file written here.
constexpr const char* kMark = "Written by wholehand decompose";

constexpr double kTableTop_m = -0.10;  ///< as in config/scenes/table.toml

/// A folder that its destructor removes.
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
  return keyFault(folder.string(), "--out", "", "cannot be written into: " + why,
                  "name a folder that you may write to");
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
  return keyFault(path.string(), "--out", "", "is there, and not written by this command",
                  "move it away, or name another folder");
}

/// True for NAME_NN.obj.
bool isPieceFile(const std::string& file, const std::string& name) {
  const std::string digits = file.size() == name.size() + 7 ? file.substr(name.size() + 1, 2) : "";
  return digits.size() == 2 && file.starts_with(name + "_") && file.ends_with(".obj") &&
         std::all_of(digits.begin(), digits.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

// First line of a TOML, OBJ or XML file, as a comment. "--" is replaced, so that no file name ends
// the comment.
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

/// Scene with the body on a table, as in config/scenes/table.toml.
std::string sceneText(const DecomposedMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const MeshSurface& piece : mesh.pieces) {
    for (const Vector3d& p : piece.points) box.extend(p);
  }
  const Vector3d size = box.sizes(), middle = box.center();
  const double x = 0.12 + size.x() / 2.0;  // beyond the hand's initial position
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

/// Prefix of a mesh's files: its file name without extension, where characters other than letters,
/// digits, - and _ become _.
std::string pieceName(const std::string& mesh_path) {
  std::string name = fs::path(mesh_path).stem().string();
  for (char& c : name) {
    const auto letter = static_cast<unsigned char>(c);
    if (letter >= 128 || (std::isalnum(letter) == 0 && c != '-' && c != '_')) c = '_';
  }
  return name.empty() ? "mesh" : name;
}

/// Checks before the computation that the folder can hold the files: it can be created or written
/// to, and no file of the same name has another origin.
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

/// Writes NAME_01.obj and so on, NAME.urdf and the scene NAME.toml. They are first written into a
/// temporary folder inside `folder`, loaded from there as a scene, and then moved, so that a
/// failure changes nothing. Pieces of an earlier computation that are not replaced are removed.
/// @return names of the written files
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
  // The user may choose any mass, so an unusual density is not a fault of the pieces.
  Diagnostics notices = scene->notices;
  std::erase_if(notices, [](const Diagnostic& d) { return d.code == DiagnosticCode::kRange; });
  if (!notices.empty()) return notices;  // e.g. a piece is not convex
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

using nlohmann::ordered_json;

constexpr double kConcavityShare = 0.01;  ///< share of the mesh's size
constexpr double kDensity_kg_m3 = 1000.0;
constexpr double kLeastMass_kg = 1e-4, kMostMass_kg = 1e3;         ///< mass of a body in a scene
constexpr double kLeastGameSize_m = 0.005, kMostGameSize_m = 0.5;  ///< size of a piece in a game
constexpr int kMostGamePieces = 16, kMostGameVertices = 64;

/// Progress line, rewritten in place on a terminal; silent elsewhere.
void showProgress(const char* doing, int count) {
  if (isatty(STDERR_FILENO) == 0) return;
  std::fprintf(stderr, "\r\033[K%s: %d", doing, count);
  std::fflush(stderr);
}
void endProgress() {
  if (isatty(STDERR_FILENO) != 0) std::fputs("\r\033[K", stderr);
}

Diagnostic meshFault(const std::string& path, Diagnostic fault) {
  fault.file = path;
  return fault;
}

/// Reads a closed surface.
/// @param notices parts of the file that are not applied
Expected<ClosedSurface> readSolid(const DecomposeOptions& o, std::vector<std::string>& notices) {
  std::error_code error;
  if (!fs::is_regular_file(o.mesh, error)) {
    return fileFault(o.mesh, "there is no such file", "check the name");
  }
  Expected<MeshFile> file = readMesh(o.mesh);
  if (!file) return file.errors();
  notices = file->notices;
  for (Eigen::Vector3d& p : file->surface.points) p *= o.scale;
  Expected<ClosedSurface> solid = closedSurface(file->surface.points, file->surface.triangles);
  if (!solid) {
    Diagnostic fault = meshFault(o.mesh, solid.errors().front());
    // A notice may name the cause, such as triangles that the file does not announce.
    for (const std::string& notice : notices) fault.problem += "; it " + notice;
    return fault;
  }
  return solid;
}

std::vector<Shape> shapesOf(const std::vector<MeshSurface>& pieces) {
  std::vector<Shape> shapes;
  for (const MeshSurface& piece : pieces) shapes.push_back(shapeOf(piece));
  return shapes;
}

/// Results of decomposing a mesh.
struct DecompositionResult {
  DecomposeOptions options;          ///< including the defaults that follow from the mesh
  std::vector<std::string> notices;  ///< parts of its file that are not applied
  ClosedSurface solid;
  ConvexPieces pieces;
  MassProperties mesh_mass, pieces_mass;
  std::string name;
  /// Relative difference between the volume of the pieces' union and the mesh's.
  [[nodiscard]] double difference() const {
    return (pieces.pieces_m3 - pieces.overlap_m3) / solid.volume_m3 - 1.0;
  }
};

Eigen::Vector3d sizeOf(const MeshSurface& surface) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : surface.points) box.extend(p);
  return box.sizes();
}

void printInertia(const char* what, const MassProperties& m) {
  const Eigen::Matrix3d& i = m.inertia_kg_m2;
  std::printf("  %s %10.4g %10.4g %10.4g kg m2 (x, y, z), centre (%.4g, %.4g, %.4g) m\n", what,
              i(0, 0), i(1, 1), i(2, 2), m.com_m.x(), m.com_m.y(), m.com_m.z());
}

void printTable(const DecompositionResult& d) {
  std::printf("%s: %zu triangles, %.4g m across\n", printable(d.options.mesh).c_str(),
              d.solid.surface.triangles.size(), d.solid.size_m);
  std::printf("  piece  vertices  volume cm3  size mm\n");
  for (std::size_t i = 0; i < d.pieces.pieces.size(); ++i) {
    const MeshSurface& piece = d.pieces.pieces[i];
    const Eigen::Vector3d size_mm = 1e3 * sizeOf(piece);
    std::printf("  %5zu  %8zu  %10.4g  %.1f x %.1f x %.1f\n", i + 1, piece.points.size(),
                1e6 * signedVolume(piece), size_mm.x(), size_mm.y(), size_mm.z());
  }
  std::printf("  volume   mesh %.4g cm3, pieces %.4g cm3 (%.3g cm3 of them overlap): %+.2f %%\n",
              1e6 * d.solid.volume_m3, 1e6 * d.pieces.pieces_m3, 1e6 * d.pieces.overlap_m3,
              100.0 * d.difference());
  std::printf(
      "  surface  pieces up to %.3g mm outside the mesh, mesh up to %.3g mm outside the pieces\n",
      1e3 * d.pieces.beyond_m, 1e3 * d.pieces.missing_m);
  std::printf("  mass     %.4g kg\n", d.mesh_mass.mass_kg);
  printInertia("mesh    ", d.mesh_mass);
  printInertia("pieces  ", d.pieces_mass);
}

/// Prints notes that are not faults.
void printNotes(const DecompositionResult& d) {
  for (const std::string& notice : d.notices) {
    std::printf("  note     the mesh %s\n", notice.c_str());
  }
  if (d.solid.turned != TurnedShells::kNone) {
    const char* const what =
        d.solid.turned == TurnedShells::kAll ? "the mesh" : "a part of the mesh";
    std::printf("  note     %s is inside out: its triangles were turned\n", what);
  }
  if (d.pieces.twice_share > 0.0) {
    std::printf(
        "  note     %.0f %% of the mesh's surface lies inside it: its volume counts some space "
        "twice; unite its parts in the modelling program\n",
        100.0 * d.pieces.twice_share);
  }
  if (d.pieces.beyond_m > d.options.concavity_m) {
    std::printf("  note     --concavity %.4g m is not reached: allow more than %d pieces\n",
                d.options.concavity_m, d.options.pieces);
  }
  for (std::size_t i = 0; i < d.pieces.pieces.size(); ++i) {
    const Eigen::Vector3d size_m = sizeOf(d.pieces.pieces[i]);
    if (size_m.minCoeff() >= kLeastGameSize_m && size_m.maxCoeff() <= kMostGameSize_m) continue;
    std::printf(
        "  note     piece %zu is not 0.005 to 0.5 m in each direction: for scenes only, not "
        "for PrepareShapes\n",
        i + 1);
  }
  if (d.pieces.pieces.size() > std::size_t{kMostGamePieces}) {
    std::printf("  note     more than %d pieces: for scenes only, not for PrepareShapes\n",
                kMostGamePieces);
  }
}

ordered_json massJson(const MassProperties& m) {
  const Eigen::Matrix3d& i = m.inertia_kg_m2;
  return {
      {"mass_kg", m.mass_kg},
      {"com_m", {m.com_m.x(), m.com_m.y(), m.com_m.z()}},
      {"inertia_kg_m2",
       {{i(0, 0), i(0, 1), i(0, 2)}, {i(1, 0), i(1, 1), i(1, 2)}, {i(2, 0), i(2, 1), i(2, 2)}}}};
}

ordered_json jsonOf(const DecompositionResult& d) {
  ordered_json pieces = ordered_json::array();
  for (std::size_t i = 0; i < d.pieces.pieces.size(); ++i) {
    const MeshSurface& piece = d.pieces.pieces[i];
    ordered_json points = ordered_json::array(), triangles = ordered_json::array();
    for (const auto& p : piece.points) points.push_back({p.x(), p.y(), p.z()});
    for (const auto& t : piece.triangles) triangles.push_back({t[0], t[1], t[2]});
    pieces.push_back({{"file", pieceFile(d.name, i)},
                      {"volume_m3", signedVolume(piece)},
                      {"points_m", std::move(points)},
                      {"triangles", std::move(triangles)}});
  }
  return {{"mesh",
           {{"file", d.options.mesh},
            {"scale", d.options.scale},
            {"triangles", d.solid.surface.triangles.size()},
            {"size_m", d.solid.size_m},
            {"volume_m3", d.solid.volume_m3},
            {"turned", d.solid.turned != TurnedShells::kNone},
            {"share_inside", d.pieces.twice_share},
            {"mass", massJson(d.mesh_mass)}}},
          {"concavity_m", d.options.concavity_m},
          {"volume_m3", d.pieces.pieces_m3},
          {"overlap_m3", d.pieces.overlap_m3},
          {"volume_difference", d.difference()},
          {"volume_bound", d.options.volume_bound},
          {"pieces_outside_mesh_m", d.pieces.beyond_m},
          {"mesh_outside_pieces_m", d.pieces.missing_m},
          {"mass", massJson(d.pieces_mass)},
          {"pieces", std::move(pieces)}};
}

Expected<DecompositionResult> decompose(const DecomposeOptions& options) {
  DecompositionResult d;
  d.options = options;
  d.name = pieceName(options.mesh);
  if (auto ready = checkFolder(options.out, d.name, options.pieces); !ready) return ready.errors();
  if (auto ready = checkFiles({options.json}, {options.mesh}); !ready) return ready.errors();
  Expected<ClosedSurface> solid = readSolid(options, d.notices);
  if (!solid) return solid.errors();
  d.solid = std::move(*solid);
  double& mass_kg = d.options.mass_kg;
  if (mass_kg == 0.0) mass_kg = kDensity_kg_m3 * d.solid.volume_m3;
  if (mass_kg < kLeastMass_kg || mass_kg > kMostMass_kg) {
    return keyFault(options.mesh, "--mass-kg", fmt::format("{:.4g}", mass_kg),
                    "is out of range (1000 kg/m3 where it is not given)",
                    "give one of 0.0001 to 1000 kg");
  }
  double& concavity_m = d.options.concavity_m;
  if (concavity_m == 0.0) concavity_m = kConcavityShare * d.solid.size_m;
  auto pieces =
      convexPieces(d.solid, {options.pieces, concavity_m, kMostGameVertices, showProgress});
  endProgress();
  if (!pieces) return meshFault(options.mesh, pieces.errors().front());
  d.pieces = std::move(*pieces);
  d.mesh_mass = uniformDensity({shapeOf(d.solid.surface)}, mass_kg);
  d.pieces_mass = uniformDensity(shapesOf(d.pieces.pieces), mass_kg);
  return d;
}

int refuseVolume(const DecompositionResult& d) {
  refuse({keyFault(
      d.options.mesh, "--volume-bound", fmt::format("{:.4g}", d.options.volume_bound),
      fmt::format("the pieces' volume differs by {:+.1f} % from the mesh's; nothing is written",
                  100.0 * d.difference()),
      "allow more --pieces, a smaller --concavity, or a larger bound")});
  return kExitNotAlike;
}

int decomposeCommand(const DecomposeOptions& options) {
  const auto d = decompose(options);
  if (!d) return refuse(d.errors());
  printTable(*d);
  printNotes(*d);
  if (std::abs(d->difference()) > options.volume_bound) return refuseVolume(*d);
  const auto written =
      writeDecomposed({options.mesh, d->name, d->pieces.pieces, d->mesh_mass}, options.out);
  if (!written) return refuse(written.errors());
  if (!options.json.empty()) {
    if (auto ready = prepareFiles({options.json}); !ready) return refuse(ready.errors());
    const auto done = writeText(options.json, jsonText(jsonOf(*d), 1));
    if (!done) return refuse(done.errors());
  }
  const fs::path folder(options.out);
  const std::size_t count = d->pieces.pieces.size();
  std::printf("  written  %zu piece%s, %s, and %s with the body on a table\n", count, plural(count),
              printable((folder / (d->name + ".urdf")).string()).c_str(),
              printable((folder / (d->name + ".toml")).string()).c_str());
  return kExitDone;
}

}  // namespace

void addDecompose(CLI::App& app, DecomposeOptions& o, int& code) {
  CLI::App* d = app.add_subcommand("decompose", toolHelp("decompose"));
  d->add_option("mesh", o.mesh, "Closed mesh: STL, OBJ, DAE or GLB")->required();
  d->add_option("--out", o.out, "Folder of the pieces, a URDF and a scene")->required();
  d->add_option("--pieces", o.pieces, "At most so many pieces")
      ->check(wholeBetween(1, 64))
      ->capture_default_str();
  d->add_option("--concavity", o.concavity_m,
                "Depth of hollows that a piece may fill [m] (default: 1 % of the mesh's diagonal)")
      ->check(finiteBetween(1e-5, 1.0, "m"));
  d->add_option("--scale", o.scale, "Metres for a unit of the file: 0.001 for millimetres")
      ->check(finiteBetween(1e-6, 1e4, ""))
      ->capture_default_str();
  d->add_option("--mass-kg", o.mass_kg, "Mass of the body (default: 1000 kg/m3)")
      ->check(finiteBetween(1e-4, 1e3, "kg"));
  d->add_option("--volume-bound", o.volume_bound,
                "Largest share by which the volumes of pieces and mesh may differ")
      ->check(finiteBetween(0.0, 100.0, ""))
      ->capture_default_str();
  d->add_option("--json", o.json, "Write table and pieces to this file");
  d->footer("Exit code 0: done; 1: the volumes differ too much, nothing written; 2: bad input.");
  d->callback([&o, &code] { code = decomposeCommand(o); });
}

}  // namespace wholehand
