#include "clinic/database.hpp"

#include "clinic_schema.hpp"
#include "loop/core/sha256.hpp"

#include <fmt/format.h>

#include <sqlite3.h>
#include <sys/stat.h>

namespace wholehand::clinic {
namespace {

constexpr std::size_t kMostIdle = 200;
constexpr int kOperationsBetweenLooks = 1000;  // of a statement, until it looks whether to end
constexpr int kBusy_ms = 2000;  // waits for another process that holds the lock, e.g. a backup or a
                                // copy program

[[noreturn]] void fail(sqlite3* db, const std::string& what) {
  const std::string why = db != nullptr ? sqlite3_errmsg(db) : "out of memory";
  if (db != nullptr && (sqlite3_errcode(db) & 0xFF) == SQLITE_INTERRUPT) {
    throw ReadEnded(what + ": " + why);
  }
  throw DatabaseError(what + ": " + why);
}

}  // namespace

IdleStatements::~IdleStatements() {
  for (const auto& [sql, statement] : statements_) sqlite3_finalize(statement);
}

sqlite3_stmt* IdleStatements::take(std::string_view sql) {
  const auto found = statements_.find(std::string(sql));
  if (found == statements_.end()) return nullptr;
  sqlite3_stmt* const statement = found->second;
  statements_.erase(found);
  return statement;
}

void IdleStatements::put(sqlite3_stmt* statement) {
  sqlite3_reset(statement);
  sqlite3_clear_bindings(statement);
  const std::string sql = sqlite3_sql(statement);
  // Some PRAGMAs act when they are prepared.
  if (statements_.size() < kMostIdle && !sql.starts_with("PRAGMA")) {
    statements_.emplace(sql, statement);
  } else {
    sqlite3_finalize(statement);
  }
}

Statement::Statement(sqlite3* db, std::string_view sql, const std::shared_ptr<IdleStatements>& idle)
    : db_(db), statement_(idle->take(sql), Release{idle}) {
  if (statement_) return;
  sqlite3_stmt* statement = nullptr;
  const int code =
      sqlite3_prepare_v2(db, sql.data(), static_cast<int>(sql.size()), &statement, nullptr);
  statement_.reset(statement);
  check(code);
}

void Statement::Release::operator()(sqlite3_stmt* statement) const {
  if (const auto there = idle.lock()) {
    there->put(statement);
  } else {
    sqlite3_finalize(statement);
  }
}

void Statement::check(int code) const {
  if (code == SQLITE_OK) return;
  const char* path = sqlite3_db_filename(db_, "main");
  fail(db_, path != nullptr ? path : "the database");
}

void Statement::bind(int at, std::int64_t value) {
  check(sqlite3_bind_int64(statement_.get(), at + 1, value));
}
void Statement::bind(int at, double value) {
  check(sqlite3_bind_double(statement_.get(), at + 1, value));
}
void Statement::bind(int at, std::string_view text) {
  check(sqlite3_bind_text(statement_.get(), at + 1, text.data(), static_cast<int>(text.size()),
                          SQLITE_TRANSIENT));
}
void Statement::bind(int at, Blob blob) {
  check(sqlite3_bind_blob(statement_.get(), at + 1, blob.bytes.data(),
                          static_cast<int>(blob.bytes.size()), SQLITE_TRANSIENT));
}
void Statement::bind(int at, const std::optional<std::int64_t>& value) {
  if (value) {
    bind(at, *value);
  } else {
    check(sqlite3_bind_null(statement_.get(), at + 1));
  }
}

bool Statement::step() {
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) check(code);
  return false;
}

bool Statement::isNull(int column) const {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL;
}
bool Statement::isInteger(int column) const {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_INTEGER;
}
int Statement::columns() const {
  return sqlite3_column_count(statement_.get());
}
const char* Statement::name(int column) const {
  return sqlite3_column_name(statement_.get(), column);
}
void Statement::get(int column, std::optional<std::int64_t>& value) const {
  value.reset();
  if (!isNull(column)) value = integer(column);
}
std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}
std::string Statement::text(int column) const {
  const void* bytes = sqlite3_column_blob(statement_.get(), column);
  const int size = sqlite3_column_bytes(statement_.get(), column);
  return bytes == nullptr ? std::string{} : std::string(static_cast<const char*>(bytes), size);
}

void Database::Close::operator()(sqlite3* db) const {
  sqlite3_close_v2(db);
}

Database::Database(const std::string& path, Mode mode) : path_(path) {
  int flags = mode == Mode::kReadOnly ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE;
  if (mode == Mode::kCreate) flags |= SQLITE_OPEN_CREATE;
  sqlite3* db = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &db, flags, nullptr);
  db_.reset(db);
  if (code != SQLITE_OK) fail(db, path);
  sqlite3_extended_result_codes(db, 1);
  sqlite3_busy_timeout(db, kBusy_ms);
  sqlite3_db_config(db, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  run("PRAGMA trusted_schema = OFF; PRAGMA foreign_keys = ON; PRAGMA secure_delete = ON;"
      "PRAGMA synchronous = FULL; PRAGMA temp_store = MEMORY;");
  if (mode != Mode::kReadOnly) run("PRAGMA journal_mode = WAL;");
  struct stat file {};
  if (::stat(path.c_str(), &file) == 0) {
    device_ = file.st_dev;
    inode_ = file.st_ino;
  }
}

void Database::run(const std::string& sql) {
  if (sqlite3_exec(db_.get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) {
    fail(db_.get(), path_);
  }
}

std::int64_t Database::lastId() const {
  return sqlite3_last_insert_rowid(db_.get());
}
int Database::changes() const {
  return sqlite3_changes(db_.get());
}

void Database::checkFile() const {
  if (inode_ == 0) return;  // in memory
  struct stat file {};
  if (::stat(path_.c_str(), &file) != 0 || file.st_dev != device_ || file.st_ino != inode_) {
    throw DatabaseError(path_ +
                        ": was removed or replaced while it is open; put it back, or "
                        "restore a backup");
  }
}

void Database::endReadsWhen(std::function<bool()> ends) {
  ends_ = std::make_unique<std::function<bool()>>(std::move(ends));
  sqlite3_progress_handler(
      db_.get(), kOperationsBetweenLooks,
      [](void* look) { return (*static_cast<std::function<bool()>*>(look))() ? 1 : 0; },
      ends_.get());
}

void Database::copyTo(const std::string& path) {
  const Database to(path, Mode::kCreate);
  sqlite3_backup* copy = sqlite3_backup_init(to.db_.get(), "main", db_.get(), "main");
  if (copy == nullptr) fail(to.db_.get(), path);
  const int code = sqlite3_backup_step(copy, -1);
  if (sqlite3_backup_finish(copy) != SQLITE_OK || code != SQLITE_DONE) fail(to.db_.get(), path);
}

Transaction::Transaction(Database& db) : db_(db) {
  db_.checkFile();
  db_.run("BEGIN IMMEDIATE");
}
Transaction::~Transaction() {
  if (!open_) return;
  try {
    db_.run("ROLLBACK");
  } catch (const DatabaseError&) {  // SQLite has already rolled back: disk full, I/O error
  }
}
void Transaction::commit() {
  db_.run("COMMIT");
  open_ = false;
}

void migrate(Database& db) {
  db.run(
      "CREATE TABLE IF NOT EXISTS migration (n INTEGER PRIMARY KEY, sha256 TEXT NOT NULL) STRICT");
  std::int64_t done = 0;
  constexpr auto kKnown = static_cast<std::int64_t>(std::size(kMigrations));
  {
    Statement rows = db.query("SELECT n, sha256 FROM migration ORDER BY n");
    while (rows.step()) {
      const std::int64_t n = rows.integer(0);
      if (n < 1 || n > kKnown) {
        throw DatabaseError(fmt::format(
            "{}: migration {} is newer than this program, which knows {}; start the program that "
            "wrote it, or a later one",
            db.path(), n, kKnown));
      }
      if (rows.text(1) != sha256(kMigrations[n - 1])) {
        throw DatabaseError(
            fmt::format("{}: migration {:03} was run with another text than src/clinic/schema/"
                        "{:03}.sql has; start the program that wrote it",
                        db.path(), n, n));
      }
      done = n;
    }
  }
  for (std::int64_t n = done + 1; n <= kKnown; ++n) {
    Transaction transaction(db);
    db.run(std::string(kMigrations[n - 1]));
    db.change("INSERT INTO migration VALUES (?, ?)", n, sha256(kMigrations[n - 1]));
    transaction.commit();
  }
}

}  // namespace wholehand::clinic
