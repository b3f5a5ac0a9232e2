#pragma once

#include "clinic/database.hpp"
#include "clinic/marks.hpp"

#include <cstdint>
#include <string>
#include <vector>

/// Actions over rows and files. Each is stored as an intent in the transaction that changes the
/// rows. Its steps may be repeated: whatever ends the process, the next start goes on. Functions
/// throw DatabaseError. One thread at a time.
namespace wholehand::clinic {

/// Folders with files of a clinic; empty: none.
struct Places {
  std::string folder, recordings, backups;
};

/// Marks and recordings of something to be erased.
struct Erasure {
  Lines lines;
  std::vector<std::string> recordings;  ///< file names
};
/// Of a patient: also of the duplicates that were merged into it, and all copies of its recordings.
[[nodiscard]] Erasure erasureOfPatient(Database& db, std::int64_t patient);
[[nodiscard]] Erasure erasureOfVisit(Database& db, std::int64_t visit);
/// Of a session without a visit. The original of a copy is kept.
[[nodiscard]] Erasure erasureOfSession(Database& db, std::int64_t trial);

/// Stores an intent and its marks, and deletes the rows that are to be erased. @pre a transaction
/// is open
/// @param what "erase", "delete", "restore", or "list" when only the lists `erased` change
void storeIntent(Database& db, std::int64_t now_us, const std::string& what,
                 const Erasure& erasure = {});
/// Number of the last stored intent; 0: all are done.
[[nodiscard]] std::int64_t lastIntent(Database& db);
/// True when an intent up to this one erases something.
[[nodiscard]] bool erases(Database& db, std::int64_t up_to);

/// First step: writes the lists `erased`, and removes recordings with their accompanying files and
/// reports, and hand files that no visit names.
/// @return recordings and reports that could not be removed
[[nodiscard]] std::vector<std::string> removeErasedFiles(Database& db, const Places& places,
                                                         std::int64_t now_us);
/// The database cannot be compacted, because other programs read it, which the message names.
class ReadByOthers : public DatabaseError {
 public:
  using DatabaseError::DatabaseError;
};
/// Second step: frees the pages of deleted rows, and empties the write-ahead log. Throws
/// ReadByOthers while another program reads the database.
/// @pre the readers of this process have ended
void compact(Database& db);
/// Third step: erases from every backup and replaced database: copies, erases, verifies, renames.
/// Needs no database: other threads may use it.
/// @return marks that the copies added
[[nodiscard]] Lines eraseFromCopies(const Places& places, const Lines& lines, const Kept& kept);
/// Marks under which backups and replaced databases know a patient.
/// @param created_us tells the patient from another one with this number
[[nodiscard]] std::vector<std::string> marksInCopies(const Places& places, std::int64_t patient,
                                                     std::int64_t created_us);
/// Adds marks of copies. @return false: the database has them all
bool addLinesOfCopies(Database& db, const Lines& lines);
/// Last step.
void finishIntents(Database& db, std::int64_t up_to, std::int64_t now_us);
[[nodiscard]] std::string notRemoved(const std::vector<std::string>& left);
/// Notes why the intents are not done.
void noteProblem(Database& db, std::int64_t up_to, const std::string& problem);

/// All steps in a row. @return recordings that could not be removed
std::vector<std::string> carryOutIntents(Database& db, const Places& places, std::int64_t now_us);

/// Removes hand files of visits that the database does not name.
void removeUnnamedHandFiles(Database& db, const std::string& folder);
/// Removes a recording with its accompanying files and its report.
void removeRecording(const std::string& recordings, const std::string& name);
/// Removes a database with the files that SQLite keeps beside it.
void removeDatabase(const std::string& path);
/// Checks pages and references.
void checkIntegrity(Database& db);

}  // namespace wholehand::clinic
