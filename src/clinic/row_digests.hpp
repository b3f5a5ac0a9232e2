#pragma once

#include "clinic/database.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Keyed digests of rows. Every row carries the number of the change that wrote it (`row_n`) and a
/// digest (`row_digest`) of table, number and all values, keyed by a key that is derived from the
/// clinic's. Triggers of the connection renew them in the transaction that changes the row, and
/// refuse to change a row whose digest is wrong or missing. Functions throw DatabaseError. One
/// thread at a time.
namespace wholehand::clinic {

/// Renews and checks digests on this connection from now on.
/// @param row_key 64 hexadecimal digits (Key::derived("rows"))
/// @param counter_file file that keeps the number of the last change, beside the database; empty:
/// none
void guardRows(Database& db, const std::string& row_key, const std::string& counter_file = {});
/// True when rows carry digests; false: a database of an earlier version.
[[nodiscard]] bool hasDigests(Database& db);
/// Gives every row a digest, once, when a database of an earlier version is taken over. @pre
/// guardRows() was called, a transaction is open
void digestAllRows(Database& db);
/// guardRows(), and digestAllRows() for a database of an earlier version.
void guardAndAdopt(Database& db, const std::string& row_key, const std::string& counter_file = {});
/// Guards the database of a folder by the key in its file `keys`. Does nothing without one, or in a
/// copy of an earlier version.
void guardByKeys(Database& db, const std::string& folder, bool is_copy = false);
/// Notes numbers that tables gave, after they were set by hand. @pre a transaction is open
void noteSequences(Database& db);

/// Names of the rows whose digest is wrong or missing, of whom they are included; at most `most`.
[[nodiscard]] std::vector<std::string> damagedRows(Database& db, std::size_t most);
/// SQL that is true for a row with the right digest, and on a connection without guardRows().
/// @param alias name of the table in the query
[[nodiscard]] std::string soundness(Database& db, std::string_view table, std::string_view alias);
/// True when a row has the right digest, or the connection is not guarded.
[[nodiscard]] bool isSound(Database& db, std::string_view table, std::int64_t row);

/// Keeps a row of `visit` damaged while it is changed: it gets no digest.
class SetAside {
 public:
  explicit SetAside(Database& db);
  ~SetAside();
  SetAside(const SetAside&) = delete;
  SetAside& operator=(const SetAside&) = delete;

 private:
  Database& db_;
};

/// Lets a damaged row of `patient` be changed, which gives it the right digest.
class SignAgain {
 public:
  SignAgain(Database& db, std::int64_t patient);
  ~SignAgain();
  SignAgain(const SignAgain&) = delete;
  SignAgain& operator=(const SignAgain&) = delete;

 private:
  Database& db_;
};

/// Number of the last change: in the database, and in the file beside it (empty: there is none).
[[nodiscard]] std::int64_t changesIn(Database& db);
struct ChangesBeside {
  std::optional<std::int64_t> n;
  bool damaged = false;
};
[[nodiscard]] ChangesBeside changesBeside(const std::string& counter_file,
                                          const std::string& row_key);
/// Changes that a damaged write-ahead log lost and nobody has confirmed.
[[nodiscard]] std::int64_t lostChanges(Database& db);
/// Sets lostChanges(), and goes on counting above them. @pre a transaction is open
void setLostChanges(Database& db, std::int64_t lost);

void confirmLostChanges(Database& db);
/// When the clock jumped and nobody has confirmed it [µs UTC]; 0: it did not.
[[nodiscard]] std::int64_t clockJump(Database& db);
/// Notes a jump, or with 0 that somebody confirmed it.
void setClockJump(Database& db, std::int64_t at_us);

/// Path of the counter in a clinic's folder.
[[nodiscard]] std::string counterIn(const std::string& folder);

/// Compares tables, indexes and triggers with those that the migrations make.
void checkSchema(Database& db);

}  // namespace wholehand::clinic
