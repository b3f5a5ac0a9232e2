#pragma once

#include "clinic/database.hpp"
#include "clinic/text.hpp"
#include "loop/core/expected.hpp"

#include <cstdint>
#include <set>
#include <string>
#include <vector>

/// Whole clinics: copies, checks, erasing. A backup F has its keys in F.keys, and the list `erased`
/// of its folder beside it. Errors name the file and what to do. Not for the tick.
namespace wholehand::clinic {

/// Held by the one process that changes a folder; ends with the process.
class FolderLock {
 public:
  /// @return empty: another process has it, or the folder cannot be written
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

/// Copies a clinic while it runs, reads the copy again, and compares it. @pre no file of that name
/// @return number of rows
[[nodiscard]] Expected<std::int64_t> backUp(const std::string& folder, const std::string& file);
/// Makes a backup the clinic of a folder. Erased patients stay erased; a database that was there is
/// kept under another name; visits get new numbers.
/// @return what was done, one sentence each
[[nodiscard]] Expected<std::vector<std::string>> restoreBackup(const std::string& file,
                                                               const std::string& folder);
/// Checks pages, references, migrations and key file. @return number of rows
[[nodiscard]] Expected<std::int64_t> verifyClinic(const std::string& folder);

/// How long a folder keeps its backups.
inline constexpr std::int64_t kBackupsKept_us = 30 * kDay_us;
/// Time of the newest backup of a folder [µs UTC]; 0: none.
[[nodiscard]] std::int64_t newestBackup_us(const std::string& folder);
/// Removes the folder's own backups that are older than 30 days.
void removeOldBackups(const std::string& folder, std::int64_t now_us);

/// Marks of a patient, and of the doubles that were merged into this one.
[[nodiscard]] std::set<std::string> marksOf(Database& db, std::int64_t patient);
/// Puts marks on the lists of the erased, which restoreBackup() obeys: first of all.
void listErased(const std::string& folder, const std::string& backups,
                const std::set<std::string>& marks);
/// Files that belong to an erased patient.
struct ErasedFiles {
  std::vector<std::string> recordings, hands;  ///< names
};
/// Deletes every row of a patient but the log's.
[[nodiscard]] ErasedFiles eraseRows(Database& db, std::int64_t patient);
/// Removes recordings with what stands beside them, their reports, and hand files of FOLDER/hands.
/// @return recordings and reports that are still there
[[nodiscard]] std::vector<std::string> removeFiles(const std::string& folder,
                                                   const std::string& recordings,
                                                   const ErasedFiles& files);
/// Frees what deleted rows held, and empties the write-ahead log.
void compact(Database& db);

/// First number of a block of visits, drawn at random: two clinics have none in common.
[[nodiscard]] std::int64_t drawnVisitNumber();

}  // namespace wholehand::clinic
