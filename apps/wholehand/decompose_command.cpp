#include "decompose_command.hpp"

#include "core/printable.hpp"
#include "decompose_files.hpp"
#include "exit_code.hpp"
#include "files/text_file.hpp"
#include "json_text.hpp"
#include "model/mass_properties.hpp"
#include "model/mesh/convex_pieces.hpp"
#include "model/mesh/mesh_file.hpp"
#include "model/mesh/solid.hpp"
#include "model/scene/scene_model.hpp"
#include "number_option.hpp"

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>
#include <unistd.h>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr double kConcavityShare = 0.01;  ///< of the mesh's size
constexpr double kDensity_kg_m3 = 1000.0;
constexpr double kLeastMass_kg = 1e-4, kMostMass_kg = 1e3;         ///< of a scene's body
constexpr double kLeastGameSize_m = 0.005, kMostGameSize_m = 0.5;  ///< of a game's piece
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

Expected<ClosedSurface> readSolid(const DecomposeOptions& o) {
  std::error_code error;
  if (!fs::is_regular_file(o.mesh, error)) {
    return Diagnostic{o.mesh, 0, "", "", "there is no such file", "check the name"};
  }
  Expected<MeshSurface> surface = readMesh(o.mesh);
  if (!surface) return surface.errors();
  for (Eigen::Vector3d& p : surface->points) p *= o.scale;
  Expected<ClosedSurface> solid = closedSurface(surface->points, surface->triangles);
  if (!solid) return meshFault(o.mesh, solid.errors().front());
  return solid;
}

Shape shapeOf(const MeshSurface& surface) {
  Shape shape;
  shape.type = ShapeType::kConvexMesh;
  shape.points_m = surface.points;
  shape.triangles = surface.triangles;
  return shape;
}

std::vector<Shape> shapesOf(const std::vector<MeshSurface>& pieces) {
  std::vector<Shape> shapes;
  for (const MeshSurface& piece : pieces) shapes.push_back(shapeOf(piece));
  return shapes;
}

/// What is computed of a mesh.
struct Decomposed {
  DecomposeOptions options;  ///< with the defaults that follow from the mesh
  ClosedSurface solid;
  ConvexPieces pieces;
  MassProperties mesh_mass, pieces_mass;
  std::string name;
  /// Share by which the volume of the pieces' union differs from the mesh's.
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

void printTable(const Decomposed& d) {
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

/// Prints what the user should know though it is no fault.
void printNotes(const Decomposed& d) {
  if (d.solid.turned) {
    std::printf("  note     the mesh is inside out: its triangles were turned\n");
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

ordered_json jsonOf(const Decomposed& d) {
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
            {"turned", d.solid.turned},
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

Expected<Decomposed> decompose(const DecomposeOptions& options) {
  Decomposed d;
  d.options = options;
  d.name = pieceName(options.mesh);
  if (auto ready = checkFolder(options.out, d.name, options.pieces); !ready) return ready.errors();
  if (auto ready = checkFiles({options.json}, {options.mesh}); !ready) return ready.errors();
  Expected<ClosedSurface> solid = readSolid(options);
  if (!solid) return solid.errors();
  d.solid = std::move(*solid);
  double& mass_kg = d.options.mass_kg;
  if (mass_kg == 0.0) mass_kg = kDensity_kg_m3 * d.solid.volume_m3;
  if (mass_kg < kLeastMass_kg || mass_kg > kMostMass_kg) {
    return Diagnostic{options.mesh,
                      0,
                      "--mass-kg",
                      fmt::format("{:.4g}", mass_kg),
                      "is out of range (1000 kg/m3 where it is not given)",
                      "give one of 0.0001 to 1000 kg"};
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

int refuseVolume(const Decomposed& d) {
  refuse(
      {{d.options.mesh, 0, "--volume-bound", fmt::format("{:.4g}", d.options.volume_bound),
        fmt::format("the pieces' volume differs by {:+.1f} % from the mesh's; nothing is written",
                    100.0 * d.difference()),
        "allow more --pieces, a smaller --concavity, or a larger bound"}});
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
  CLI::App* d = app.add_subcommand("decompose", "Divide a mesh into convex pieces for a scene");
  d->add_option("mesh", o.mesh, "Closed mesh: STL, OBJ, DAE or GLB")->required();
  d->add_option("--out", o.out, "Folder of the pieces, a URDF and a scene")->required();
  d->add_option("--pieces", o.pieces, "At most so many pieces")
      ->check(CLI::Range(1, 64))
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
