#pragma once

#include "clinic/database.hpp"
#include "clinic/keys.hpp"
#include "clinic/presets/presets.hpp"
#include "clinic/request.hpp"
#include "clinic/text.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace wholehand::clinic {

struct ClinicOptions {
  std::string folder;      ///< of clinic.db, keys, erased, hands/
  std::string config;      ///< the shipped config/
  std::string recordings;  ///< empty: none are looked at
  std::string backups;     ///< a backup a day goes here; empty: none
  KeyCost cost;
};

/// What a clinic keeps: the database, the key that opens its sealed texts, the log, the backups,
/// and what it was shipped with. One thread at a time. Throws DatabaseError.
class Records {
 public:
  Records(ClinicOptions options, const Clock& clock)
      : options_(std::move(options)), clock_(clock) {}

  /// Opens what is not open yet: what hindered it may be gone by the next request.
  void open();
  /// Lets go of a database whose file is gone: it may come back.
  void closeLost();
  [[nodiscard]] bool isOpen() const { return db_.has_value(); }
  /// Throws where it was let go of: whoever gave up the lock in between asks again.
  [[nodiscard]] Database& db();
  /// @pre open() has returned once; likewise below
  [[nodiscard]] const Presets& presets() const { return *presets_; }
  [[nodiscard]] const std::vector<ShippedHand>& hands() const { return hands_; }
  [[nodiscard]] const ClinicOptions& options() const { return options_; }
  [[nodiscard]] const Clock& clock() const { return clock_; }

  /// Whether nobody has begun this clinic.
  [[nodiscard]] bool isNew() { return db().number("SELECT COUNT(*) FROM clinic") == 0; }
  /// The key; empty while the clinic is locked.
  [[nodiscard]] const std::optional<Key>& key() const { return key_; }
  void unlock(Key key) { key_ = std::move(key); }
  void lock() { key_.reset(); }
  /// Both throw while the clinic is locked.
  [[nodiscard]] std::string seal(std::string_view kind, std::string_view text) const;
  [[nodiscard]] std::string unseal(std::string_view kind, std::string_view sealed) const;

  void begin(Call& call) { call.transaction.emplace(db()); }
  void log(std::int64_t account, const std::string& what, std::int64_t patient = 0,
           std::int64_t visit = 0, const std::string& detail = {});
  /// Writes the log where it can: a full disk keeps nobody from reading.
  bool tryToLog(std::int64_t account, const std::string& what, std::int64_t patient = 0);

  /// Frees what was erased; where the disk is full, the next call of backUpIfDue() does.
  void freeErased();
  void backUpIfDue();
  /// When the last backup was made, in which folder, and why none could be.
  [[nodiscard]] Json backupFacts() const;
  /// From when on no backup has what is erased now; 0: none has it.
  [[nodiscard]] std::int64_t goneFromBackups_us() const;

 private:
  void tryToCompact();
  [[nodiscard]] const Key& openKey() const;

  const ClinicOptions options_;
  const Clock& clock_;
  std::optional<Database> db_;
  bool was_open_ = false;  ///< the database was there once: none is made in its place
  std::optional<Key> key_;
  std::optional<Presets> presets_;
  std::vector<ShippedHand> hands_;
  std::int64_t last_backup_us_ = 0;
  std::string backup_problem_;
  bool compact_due_ = false;  ///< rows were erased; a full disk kept their pages from being freed
};

}  // namespace wholehand::clinic
