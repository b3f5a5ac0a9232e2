#pragma once

#include "clinic/database.hpp"
#include "clinic/text.hpp"
#include "loop/core/expected.hpp"

#include <cstdint>
#include <string>
#include <vector>

/// Operations on whole clinics: copies and checks. A backup F has its keys in F.keys, and the
/// list `erased` (marks.hpp) in the same folder. Errors name the file and the remedy. Not for the
/// tick.
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
/// @param now_us time until which the marks of the copy reach [µs UTC]
/// @return number of rows
[[nodiscard]] Expected<std::int64_t> backUp(const std::string& folder, const std::string& file,
                                            std::int64_t now_us);
/// Restores a clinic's folder from a backup: the backup without everything erased since, by the
/// marks in the backup, beside it, in the folder and in the database that was there, which is kept
/// under another name. Visits get new numbers. What was moved, joined and given since is listed, in
/// the sentences and in the column `restored` of the clinic.
/// @return what was done, one sentence each
[[nodiscard]] Expected<std::vector<std::string>> restoreBackup(const std::string& file,
                                                               const std::string& folder,
                                                               std::int64_t now_us);
/// Completes a restore that was broken off while files were renamed. Throws DatabaseError.
void finishRestore(const std::string& folder);
/// Checks pages, references, migrations and key file. @return number of rows
[[nodiscard]] Expected<std::int64_t> verifyClinic(const std::string& folder);

/// Time for which a folder keeps its backups.
inline constexpr std::int64_t kBackupsKept_us = 30 * kDay_us;
inline constexpr std::size_t kBackupsAlwaysKept = 7;
/// Time of the newest backup of a folder [µs UTC]; 0: none.
[[nodiscard]] std::int64_t newestBackup_us(const std::string& folder);
/// Removes backups that this program made in the folder and that are older than 30 days,
/// except the newest seven.
void removeOldBackups(const std::string& folder, std::int64_t now_us);

}  // namespace wholehand::clinic
