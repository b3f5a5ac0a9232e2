#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace wholehand::clinic {

/// What SQLite refused: the statement's effect is none.
class DatabaseError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Bytes for a BLOB column.
struct Blob {
  std::string_view bytes;
};

/// One prepared statement. Columns and parameters count from 0. Throws DatabaseError.
class Statement {
 public:
  Statement(sqlite3* db, std::string_view sql);

  void bind(int at, std::int64_t value);
  void bind(int at, int value) { bind(at, std::int64_t{value}); }
  void bind(int at, double value);
  void bind(int at, std::string_view text);
  void bind(int at, const std::string& text) { bind(at, std::string_view(text)); }
  void bind(int at, const char* text) { bind(at, std::string_view(text)); }
  void bind(int at, Blob blob);
  void bind(int at, const std::optional<std::int64_t>& value);

  /// True when there is a row.
  bool step();
  [[nodiscard]] bool isNull(int column) const;
  [[nodiscard]] std::int64_t integer(int column) const;
  /// Text or bytes.
  [[nodiscard]] std::string text(int column) const;

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  void check(int code) const;
  sqlite3* db_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

/// One connection: WAL, synchronous = FULL, foreign keys, secure_delete. One thread at a time.
/// Throws DatabaseError with the file and what failed.
class Database {
 public:
  enum class Mode { kCreate, kReadWrite, kReadOnly };
  Database(const std::string& path, Mode mode);

  /// Statements without results.
  void run(const std::string& sql);
  template <class... Values>
  Statement query(std::string_view sql, const Values&... values) {
    Statement statement(db_.get(), sql);
    int at = 0;
    (statement.bind(at++, values), ...);
    return statement;
  }
  /// Runs one statement to its end; returns the number of changed rows.
  template <class... Values>
  int change(std::string_view sql, const Values&... values) {
    Statement statement = query(sql, values...);
    while (statement.step()) {
    }
    return changes();
  }
  /// First column of the first row; 0 without one.
  template <class... Values>
  std::int64_t number(std::string_view sql, const Values&... values) {
    Statement statement = query(sql, values...);
    return statement.step() ? statement.integer(0) : 0;
  }
  [[nodiscard]] std::int64_t lastId() const;
  [[nodiscard]] const std::string& path() const { return path_; }
  /// Throws where the file of this name is no longer the one that was opened: SQLite would go on
  /// writing to a file that nobody finds again.
  void checkFile() const;
  /// Copies everything into a new file, one consistent state. @pre no file of that name
  void copyTo(const std::string& path);

 private:
  struct Close {
    void operator()(sqlite3* db) const;
  };
  [[nodiscard]] int changes() const;
  std::string path_;
  std::unique_ptr<sqlite3, Close> db_;
  std::uint64_t device_ = 0, inode_ = 0;
};

/// BEGIN IMMEDIATE until commit(); rolled back where it is left without one.
class Transaction {
 public:
  explicit Transaction(Database& db);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  /// Answered changes are on the disk when this returns.
  void commit();

 private:
  Database& db_;
  bool open_ = true;
};

/// Brings a database to this program's schema, one transaction a migration. Refused by name: a
/// number that this program does not know, and a migration whose text is not the one that was run.
void migrate(Database& db);

}  // namespace wholehand::clinic
