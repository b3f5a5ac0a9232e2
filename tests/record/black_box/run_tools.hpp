#pragma once

#include "rig/models.hpp"
#include "rig/rig.hpp"
#include "rig/run/run.hpp"
#include "support/rig_tools.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <sys/wait.h>
#include <vector>

namespace wholehand::test {

/// The cocktail bar, whose virtual patient moves and grasps from the first second on.
inline Models bar() {
  ModelFiles files = shippedFiles();
  files.exercise = std::string(WHOLEHAND_SOURCE_DIR) + "/config/exercises/cocktail-bar.toml";
  return load(files);
}

/// A patient who moves every axis back and forth over that share of its range.
inline Intention sweeping(const DeviceModel& device, double share = 0.1) {
  std::vector<Waypoint> points;
  for (int k = 0; k < 9; ++k) {
    AxisPosition q(device.axisCount());
    for (int a = 0; a < q.size(); ++a) {
      const DeviceAxis& axis = device.axes[a];
      q[a] = std::lerp(axis.lower, axis.upper, 0.5 + (k % 2 == 0 ? -0.5 : 0.5) * share);
    }
    points.push_back({1.0 * k, q});
  }
  return Intention::throughWaypoints(points);
}

struct ProgramOutput {
  int code = -1;
  std::string text;
};

/// Runs the program with these arguments and captures standard output and error together.
inline ProgramOutput program(const std::string& arguments) {
  const std::string command = "'" WHOLEHAND_PROGRAM "' " + arguments + " 2>&1";
  FILE* pipe = ::popen(command.c_str(), "r");
  ProgramOutput said;
  std::array<char, 4096> piece{};
  while (const std::size_t n = std::fread(piece.data(), 1, piece.size(), pipe)) {
    said.text.append(piece.data(), n);
  }
  const int status = ::pclose(pipe);
  said.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return said;
}

/// Checks that `replay --resimulate` of this black box file finds every bit the same. @return its
/// output
inline std::string expectSameRerun(const std::string& box) {
  const ProgramOutput said = program("replay --resimulate '" + box + "'");
  EXPECT_EQ(said.code, 0) << said.text;
  EXPECT_NE(said.text.find("every bit the same"), std::string::npos) << said.text;
  return said.text;
}

}  // namespace wholehand::test
