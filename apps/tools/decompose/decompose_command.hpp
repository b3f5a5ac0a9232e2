#pragma once

#include <CLI/CLI.hpp>

#include <string>

namespace wholehand {

struct DecomposeOptions {
  std::string mesh;
  std::string out;             ///< folder for the files
  int pieces = 16;             ///< largest number of pieces
  double concavity_m = 0.0;    ///< 0: 1 % of the mesh's size
  double scale = 1.0;          ///< metres per unit of the file
  double mass_kg = 0.0;        ///< 0: computed with 1000 kg/m³
  double volume_bound = 0.25;  ///< largest relative difference of the volumes
  std::string json;            ///< JSON file; empty: none
};

/// Adds `wholehand decompose`, which writes a mesh as convex pieces, a URDF and a scene. Exit
/// codes: kExitDone; kExitNotAlike, nothing written; kExitBadInput.
void addDecompose(CLI::App& app, DecomposeOptions& options, int& code);

}  // namespace wholehand
