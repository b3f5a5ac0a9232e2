#pragma once

#include "files/patient/csv_line.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// The lines before the samples of a CSV file of OptiTrack Motive ("Format Version", then names and
/// kinds by rows) or Vicon Nexus and Tracker ("Trajectories" or "Objects", the rate, names, axes,
/// units). Fed line by line.
class MocapHead {
 public:
  /// True if a first line begins such a file.
  [[nodiscard]] static bool begins(const std::vector<Cell>& first);
  /// True for the first line of a section of Nexus that holds no positions, such as "Devices".
  [[nodiscard]] static bool isOtherSection(const std::vector<Cell>& first);

  /// Takes one more line. @return false: the line is not of this head
  bool add(const std::vector<Cell>& line);
  [[nodiscard]] bool begun() const { return !lines_.empty(); }
  /// True when the next line is a sample.
  [[nodiscard]] bool complete() const { return complete_; }

  /// Of a complete head: "OptiTrack Motive" or "Vicon Nexus".
  [[nodiscard]] std::string program() const;
  /// One name for each column: "Wrist Position X (mm)", "RWRI X (mm)". The time is "Time (s)", or
  /// "Frame".
  [[nodiscard]] std::vector<std::string> columns() const;
  /// True if a blank line ends the samples.
  [[nodiscard]] bool hasSections() const { return begun() && isNexus(); }
  /// Frames a second; 0: the samples have a time, or there is no such head.
  [[nodiscard]] double rate_hz() const;

 private:
  [[nodiscard]] bool isNexus() const;

  std::vector<std::vector<Cell>> lines_;
  bool complete_ = false;
};

}  // namespace wholehand
