#pragma once

#include "clinic/database.hpp"
#include "clinic/text.hpp"
#include "loop/core/expected.hpp"

#include <cstdint>
#include <set>
#include <string>
#include <vector>

/// Operations on whole clinics: copies, checks, erasing. A backup F has its keys in F.keys, and the
/// list `erased` in the same folder. Errors name the file and the remedy. Not for the tick.
namespace wholehand::clinic {

/// Lock of the one process that may change a folder; released when the process ends.
class FolderLock {
 public:
  /// Takes the lock.
  /// @return an error when another process has it or the folder cannot be written
  [[nodiscard]] static Expected<FolderLock> take(const std::string& folder);
  FolderLock(FolderLock&& other) noexcept : file_(other.file_) { other.file_ = -1; }
  FolderLock& operator=(FolderLock&&) = delete;
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();

 private:
  explicit FolderLock(int file) : file_(file) {}
  int file_;
};

/// Copies a clinic while it runs, reads the copy back, and compares it. @pre no file of that name
/// exists
/// @return number of rows
[[nodiscard]] Expected<std::int64_t> backUp(const std::string& folder, const std::string& file);
/// Restores a clinic's folder from a backup. Erased patients stay erased; an existing database is
/// kept under another name; visits get new numbers.
/// @return what was done, one sentence each
[[nodiscard]] Expected<std::vector<std::string>> restoreBackup(const std::string& file,
                                                               const std::string& folder);
/// Checks pages, references, migrations and key file. @return number of rows
[[nodiscard]] Expected<std::int64_t> verifyClinic(const std::string& folder);

/// Time for which a folder keeps its backups.
inline constexpr std::int64_t kBackupsKept_us = 30 * kDay_us;
/// Time of the newest backup of a folder [µs UTC]; 0: none.
[[nodiscard]] std::int64_t newestBackup_us(const std::string& folder);
/// Removes backups that this program made in the folder and that are older than 30 days.
void removeOldBackups(const std::string& folder, std::int64_t now_us);

/// Marks of a patient, and of the duplicate records that were merged into it.
[[nodiscard]] std::set<std::string> marksOf(Database& db, std::int64_t patient);
/// Adds marks to the lists of erased patients, which restoreBackup() obeys. Called before any row
/// is deleted.
void listErased(const std::string& folder, const std::string& backups,
                const std::set<std::string>& marks);
/// Files that belong to an erased patient.
struct ErasedFiles {
  std::vector<std::string> recordings, hands;  ///< file names
};
/// Deletes every row of a patient except in the log. @return the patient's files
[[nodiscard]] ErasedFiles eraseRows(Database& db, std::int64_t patient);
/// Removes recordings with their accompanying files and reports, and hand files of FOLDER/hands.
/// @return recordings and reports that could not be removed
[[nodiscard]] std::vector<std::string> removeFiles(const std::string& folder,
                                                   const std::string& recordings,
                                                   const ErasedFiles& files);
/// Frees the pages of deleted rows, and empties the write-ahead log.
void compact(Database& db);

/// First number of a block of visits. It is drawn at random, so that the visit numbers of two
/// clinics differ.
[[nodiscard]] std::int64_t drawnVisitNumber();

}  // namespace wholehand::clinic
