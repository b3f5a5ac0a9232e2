#pragma once

#include "loop/core/expected.hpp"

#include <map>
#include <string>
#include <vector>

namespace wholehand {

/// The finished cells of a sweep that is under way: a folder with a file for each process that
/// works on it, to which each finished cell is appended at once. A process that is killed loses
/// only the cell that it was running. Works on a folder that several machines share.
class SweepJournal {
 public:
  /// Prepares the folder. Refused: one that holds cells of another grid, or of another program.
  /// @param digest of the grid, the files that it reads, and the program
  /// @param figures number of figures of a cell
  /// @param alone whether no other program may work on it; it stays locked until this one ends
  [[nodiscard]] static Expected<SweepJournal> open(const std::string& folder,
                                                   const std::string& digest, int figures,
                                                   bool alone);

  /// Every finished cell of every process. What a killed process left half written is not counted.
  [[nodiscard]] std::map<int, std::vector<double>> finished() const;

  /// Appends a finished cell to this process's own file.
  [[nodiscard]] Expected<Done> append(int cell, const std::vector<double>& figures);

  /// Removes the folder.
  void remove() const;

 private:
  SweepJournal(std::string folder, int figures);
  [[nodiscard]] Expected<Done> openOwnFile();

  std::string folder_;
  int figures_ = 0;
  int file_ = -1;      ///< this process's own; -1: none yet. Kept open and locked until it ends
  int owner_pid_ = 0;  ///< a forked child opens its own
};

}  // namespace wholehand
