#pragma once

#include "loop/core/expected.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace wholehand {

/// Trial that a cell of a sweep runs (docs/sweeps.md).
enum class SweepTrial {
  kGrasp,    ///< grasps a free object, carries and holds it
  kContact,  ///< closes on a fixed object and presses; tests whether the contact comes to rest
  kPlay      ///< a virtual patient plays an exercise
};

/// One dimension of a grid, with names or numbers as values.
struct SweepAxis {
  std::string name;
  std::vector<std::string> names;  ///< empty for numbers
  std::vector<double> numbers;     ///< empty for names
  [[nodiscard]] int size() const {
    return static_cast<int>(names.empty() ? numbers.size() : names.size());
  }
  /// A value as text: "man-p05-right", "0.4".
  [[nodiscard]] std::string label(int index) const;
};

/// A table of one figure over two axes, with the mean over all other axes.
struct SweepMap {
  std::string figure;
  int rows = 0, columns = 0;  ///< indices of the axes
};

/// A sweep: every combination of the values of its axes is one cell. The last axis changes fastest.
struct SweepGrid {
  static constexpr int kMostCells = 1'000'000;

  std::string path;
  std::string text;  ///< text of the grid file
  std::string name;
  SweepTrial trial = SweepTrial::kGrasp;
  double hold_s = 2.0;  ///< grasp: duration of holding
  std::vector<SweepAxis> axes;
  std::vector<SweepMap> maps;

  [[nodiscard]] int cells() const;
  /// Index of a cell's value on every axis.
  [[nodiscard]] std::vector<int> places(int cell) const;
  /// "hand man-p05-right, friction 0.4"
  [[nodiscard]] std::string describe(int cell) const;
};

/// Names of the figures of a trial, with their units.
[[nodiscard]] std::vector<std::string> figuresOf(SweepTrial trial);
/// "grasp", "contact" or "play"
[[nodiscard]] const char* trialName(SweepTrial trial);

/// Reads a grid. Does not check that named hands, devices and other files exist.
[[nodiscard]] Expected<SweepGrid> loadSweepGrid(const std::string& path);

}  // namespace wholehand
