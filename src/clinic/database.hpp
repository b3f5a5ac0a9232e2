#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

struct sqlite3;
struct sqlite3_stmt;

namespace wholehand::clinic {

struct RowGuard;  // row_digests.hpp

/// A statement that SQLite refused; it has changed nothing.
class DatabaseError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A statement that endReadsWhen() ended.
class ReadEnded : public DatabaseError {
 public:
  using DatabaseError::DatabaseError;
};

/// Bytes for a BLOB column.
struct Blob {
  std::string_view bytes;
};

/// Prepared statements of a connection that are not in use: most requests run the same ones, and
/// SQLite takes longer to prepare a statement with its triggers than to run it.
class IdleStatements {
 public:
  IdleStatements() = default;
  IdleStatements(const IdleStatements&) = delete;
  IdleStatements& operator=(const IdleStatements&) = delete;
  ~IdleStatements();
  /// A statement with this text; null: there is none.
  [[nodiscard]] sqlite3_stmt* take(std::string_view sql);
  void put(sqlite3_stmt* statement);

 private:
  std::unordered_multimap<std::string, sqlite3_stmt*> statements_;
};

/// A prepared statement. Columns and parameters count from 0. Throws DatabaseError.
class Statement {
 public:
  Statement(sqlite3* db, std::string_view sql, const std::shared_ptr<IdleStatements>& idle);

  void bind(int at, std::int64_t value);
  void bind(int at, int value) { bind(at, std::int64_t{value}); }
  void bind(int at, double value);
  void bind(int at, std::string_view text);
  void bind(int at, const std::string& text) { bind(at, std::string_view(text)); }
  void bind(int at, const char* text) { bind(at, std::string_view(text)); }
  void bind(int at, Blob blob);
  void bind(int at, const std::optional<std::int64_t>& value);

  /// Advances to the next row; true when there is one.
  bool step();
  [[nodiscard]] bool isNull(int column) const;
  [[nodiscard]] std::int64_t integer(int column) const;
  /// Text or bytes of a column.
  [[nodiscard]] std::string text(int column) const;
  /// Reads the columns from the first on; NULL is 0 or an empty text.
  template <class... Values>
  void read(Values&... values) const {
    int at = 0;
    (get(at++, values), ...);
  }
  void get(int column, std::int64_t& value) const { value = integer(column); }
  void get(int column, int& value) const { value = static_cast<int>(integer(column)); }
  void get(int column, std::string& value) const { value = text(column); }
  void get(int column, std::optional<std::int64_t>& value) const;
  [[nodiscard]] int columns() const;
  [[nodiscard]] const char* name(int column) const;
  [[nodiscard]] bool isInteger(int column) const;

 private:
  /// Puts a statement back, or finalizes it when its connection is gone.
  struct Release {
    std::weak_ptr<IdleStatements> idle;
    void operator()(sqlite3_stmt* statement) const;
  };
  void check(int code) const;
  sqlite3* db_;
  std::unique_ptr<sqlite3_stmt, Release> statement_;
};

/// A connection to the database: WAL, synchronous = FULL, foreign keys, secure_delete. One thread
/// at a time. Throws DatabaseError, which names the file and the failed operation.
class Database {
 public:
  enum class Mode { kCreate, kReadWrite, kReadOnly };
  Database(const std::string& path, Mode mode);

  /// Runs statements that return no rows.
  void run(const std::string& sql);
  template <class... Values>
  Statement query(std::string_view sql, const Values&... values) {
    Statement statement(db_.get(), sql, idle_);
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
  /// The same of a text.
  template <class... Values>
  std::string text(std::string_view sql, const Values&... values) {
    Statement statement = query(sql, values...);
    return statement.step() ? statement.text(0) : std::string{};
  }
  /// First column of every row.
  template <class T, class... Values>
  std::vector<T> all(std::string_view sql, const Values&... values) {
    std::vector<T> out;
    for (Statement rows = query(sql, values...); rows.step();) rows.read(out.emplace_back());
    return out;
  }
  [[nodiscard]] std::int64_t lastId() const;
  [[nodiscard]] const std::string& path() const { return path_; }
  /// Throws when the path no longer leads to the opened file: SQLite would otherwise go on writing
  /// to a file that nobody can find.
  void checkFile() const;
  /// Copies one consistent state of everything into a new file. @pre no file of that name exists
  void copyTo(const std::string& path);
  /// State of guardRows(); empty: rows are not guarded.
  [[nodiscard]] const std::shared_ptr<RowGuard>& guard() const { return guard_; }
  void setGuard(std::shared_ptr<RowGuard> guard) { guard_ = std::move(guard); }
  [[nodiscard]] sqlite3* handle() const { return db_.get(); }
  /// From now on a statement throws ReadEnded soon after `ends` returns true.
  void endReadsWhen(std::function<bool()> ends);

 private:
  struct Close {
    void operator()(sqlite3* db) const;
  };
  [[nodiscard]] int changes() const;
  std::string path_;
  std::shared_ptr<RowGuard> guard_;  ///< outlives the connection, whose functions use it
  std::unique_ptr<std::function<bool()>> ends_;  ///< the same
  std::unique_ptr<sqlite3, Close> db_;
  std::shared_ptr<IdleStatements> idle_ = std::make_shared<IdleStatements>();  ///< goes before db_
  std::uint64_t device_ = 0, inode_ = 0;
};

/// Begins with BEGIN IMMEDIATE. The destructor rolls back unless commit() was called.
class Transaction {
 public:
  explicit Transaction(Database& db);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  /// Commits. The changes are on the disk when this returns.
  void commit();

 private:
  Database& db_;
  bool open_ = true;
};

/// Brings a database to this program's schema, with one transaction per migration. Refuses, by
/// number, a migration that this program does not know, and one whose text differs from the text
/// that was run.
void migrate(Database& db);

}  // namespace wholehand::clinic
