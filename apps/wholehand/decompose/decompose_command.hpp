#pragma once

#include <CLI/CLI.hpp>

#include <string>

namespace wholehand {

struct DecomposeOptions {
  std::string mesh;
  std::string out;             ///< folder
  int pieces = 16;             ///< at most
  double concavity_m = 0.0;    ///< 0: 1 % of the mesh's size
  double scale = 1.0;          ///< metres for a unit of the file
  double mass_kg = 0.0;        ///< 0: of 1000 kg/m³
  double volume_bound = 0.25;  ///< largest share by which the volumes may differ
  std::string json;            ///< empty: none
};

/// Adds `wholehand decompose`, which writes a mesh as convex pieces, a URDF and a scene. Exit
/// codes: kExitDone; kExitNotAlike, nothing written; kExitBadInput.
void addDecompose(CLI::App& app, DecomposeOptions& options, int& code);

}  // namespace wholehand
