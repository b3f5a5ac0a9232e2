#pragma once

#include "clinic/database.hpp"
#include "clinic/intents.hpp"
#include "clinic/keys.hpp"
#include "clinic/presets/presets.hpp"
#include "clinic/readers.hpp"
#include "clinic/request.hpp"
#include "clinic/text.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace wholehand::clinic {

// The JSON form of plans and presets, for pages and for the database.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PlanItem, exercise, level, minutes, help, parameters)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ForcePreset, id, parameters)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PlanPreset, id, items)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ExerciseFacts, id, levels, parameters)

struct ClinicOptions {
  std::string folder;      ///< holds clinic.db, keys, erased, hands/
  std::string config;      ///< the shipped config/
  std::string recordings;  ///< folder of the recordings; empty: recordings are not read
  std::string backups;     ///< folder of the daily backups; empty: none
  /// folders below which sticks and other disks are mounted
  std::vector<std::string> sticks = {"/media", "/run/media", "/mnt"};
  KeyCost cost;
};

/// Everything that a clinic stores: the database, the key for its encrypted texts, the log and the
/// backups; also the shipped presets and hands. One thread at a time. Throws DatabaseError.
class Records {
 public:
  Records(ClinicOptions options, const Clock& clock)
      : options_(std::move(options)), clock_(clock) {}

  /// Opens everything that is not open yet. The cause of an earlier failure may be gone by the next
  /// request.
  void open();
  /// Closes a database whose file has disappeared; the file may come back.
  void closeLost();
  /// Closes the database; open() opens it again.
  void close() { db_.reset(); }
  /// Number of this opening of the database; another one means another connection.
  [[nodiscard]] std::uint64_t opening() const { return opening_; }
  [[nodiscard]] bool isOpen() const { return db_.has_value(); }
  /// The database. Throws when it was closed, which may happen while a request has released the
  /// lock; the client then asks again.
  [[nodiscard]] Database& db();
  /// Shipped presets, here and below. @pre open() has returned once
  [[nodiscard]] const Presets& presets() const { return *presets_; }
  [[nodiscard]] const std::vector<ShippedHand>& hands() const { return hands_; }
  [[nodiscard]] const ClinicOptions& options() const { return options_; }
  [[nodiscard]] const Clock& clock() const { return clock_; }

  /// True when no clinic was created here yet.
  [[nodiscard]] bool isNew() { return db().number("SELECT COUNT(*) FROM clinic") == 0; }
  /// The key; empty while the clinic is locked.
  [[nodiscard]] const std::optional<Key>& key() const { return key_; }
  void unlock(Key key) { key_ = std::move(key); }
  void lock() { key_.reset(); }
  /// Encrypt and decrypt a text; both throw while the clinic is locked.
  [[nodiscard]] std::string seal(std::string_view kind, std::string_view text) const;
  [[nodiscard]] std::string unseal(std::string_view kind, std::string_view sealed) const;

  void begin(Call& call) { call.transaction.emplace(db()); }
  void log(std::int64_t account, const std::string& what, std::int64_t patient = 0,
           std::int64_t visit = 0, const std::string& detail = {});
  /// Writes the log if possible; a full disk must not keep anybody from reading. @return true when
  /// written
  bool tryToLog(std::int64_t account, const std::string& what, std::int64_t patient = 0);

  /// Stores an action over rows and files, and deletes the rows that it erases (intents.hpp). @pre
  /// a transaction is open
  void storeIntent(const std::string& what, const Erasure& erasure = {});
  /// Removes files and bytes of what was erased, after the commit; Clinic::carryOut() does the
  /// rest.
  /// @return recordings and reports that could not be removed
  std::vector<std::string> removeErased();
  /// Ends this process's readers, then clinic::compact().
  void compact();
  /// Readers beside this connection. A turn is taken under the lock of the requests.
  [[nodiscard]] Readers& readers() { return readers_; }
  /// Actions that are stored and not done yet: kind, time, problem.
  [[nodiscard]] Json underWay();
  [[nodiscard]] Places places() const {
    return {options_.folder, options_.recordings, options_.backups};
  }
  void backUpIfDue();
  /// Writes a backup to the folder; of the daily folder old ones are removed. @return its file
  [[nodiscard]] Expected<std::string> backUpTo(const std::string& folder);
  /// Compares the wall clock with the time that passed. Call before anything is deleted by age.
  void watchClock();
  /// The wall clock went backward, or otherwise than time passed, and nobody has confirmed it:
  /// nothing is deleted by age.
  [[nodiscard]] bool clockJumped();
  void confirmClock();
  /// Names of rows that were damaged when the database was opened.
  [[nodiscard]] const std::vector<std::string>& damaged() const { return damaged_; }
  /// A row that was damaged is sound again. @param name its name, without the code behind it
  void forgetDamaged(const std::string& name);
  /// Time and folder of the last backup, and the reason if none could be made.
  [[nodiscard]] Json backupFacts() const;

 private:
  [[nodiscard]] const Key& openKey() const;

  const ClinicOptions options_;
  const Clock& clock_;
  std::optional<Database> db_;
  std::uint64_t opening_ = 0;
  bool was_open_ = false;  ///< the database existed once, so a missing one is not created again
  std::optional<Key> key_;
  std::optional<Presets> presets_;
  std::vector<ShippedHand> hands_;
  std::int64_t last_backup_us_ = 0;
  std::string backup_problem_;
  std::int64_t seen_us_ = 0, seen_boot_us_ = 0;  ///< clocks when watchClock() last looked
  bool jumped_ = false;                          ///< a jump that could not be stored yet
  std::vector<std::string> damaged_;
  Readers readers_;
};

}  // namespace wholehand::clinic
