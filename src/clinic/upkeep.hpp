#pragma once

#include "clinic/records.hpp"
#include "clinic/request.hpp"

namespace wholehand::clinic {

/// What a clinic's staff does for the records themselves: a backup at once, and reading the log.
/// One thread at a time.
class Upkeep {
 public:
  explicit Upkeep(Records& records) : records_(records) {}

  /// Folders that a backup can be written to: that of the daily backups, then mounted sticks and
  /// disks.
  Json places(Call& call);
  /// Writes a backup to one of these folders, and reads it back.
  Json backUpNow(Call& call);
  /// The newest entries of the log, with the patients' codes and without texts.
  Json log(Call& call);

 private:
  [[nodiscard]] std::vector<std::string> folders() const;

  Records& records_;
};

}  // namespace wholehand::clinic
