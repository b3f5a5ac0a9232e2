#pragma once

#include "loop/core/expected.hpp"

#include <map>
#include <string>
#include <vector>

namespace wholehand {

/// Journal of the finished cells of a running sweep. It is a folder with one file for each process,
/// to which each finished cell is appended at once. A killed process loses only the cell that it
/// was running. The folder may be shared by several machines.
class SweepJournal {
 public:
  /// Prepares the folder. Returns an error for a folder with cells of another grid or of another
  /// program.
  /// @param digest digest of the grid, the files that it reads, and the program
  /// @param figures number of figures of a cell
  /// @param alone true: no other program may work on the folder, which stays locked until this
  /// program ends
  [[nodiscard]] static Expected<SweepJournal> open(const std::string& folder,
                                                   const std::string& digest, int figures,
                                                   bool alone);

  /// Every finished cell of every process. Cells that a killed process left half written are not
  /// counted.
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
  /// This process's own file, open and locked until the process ends; -1: none yet.
  int file_ = -1;
  int owner_pid_ = 0;  ///< a forked child opens its own
};

}  // namespace wholehand
