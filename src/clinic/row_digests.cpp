#include "clinic/row_digests.hpp"

#include "clinic/keys.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <fcntl.h>
#include <fstream>
#include <map>
#include <memory>
#include <sodium.h>
#include <sqlite3.h>
#include <unistd.h>

namespace wholehand::clinic {

/// State of a connection that guards its rows.
struct RowGuard {
  std::string key;  ///< 32 bytes
  int file = -1;    ///< of the counter; -1: none
  bool aside = false;
  std::int64_t signed_patient = 0;                          ///< that is signed again; 0: none
  std::map<std::string, std::string, std::less<>> columns;  ///< of each table, with a place for
                                                            ///< the alias
  RowGuard() = default;
  RowGuard(const RowGuard&) = delete;
  RowGuard& operator=(const RowGuard&) = delete;
  ~RowGuard() {
    if (file >= 0) ::close(file);
  }
};

namespace {

constexpr std::size_t kDigest_bytes = 16;
constexpr int kPagesOfLog = 1000;  // as SQLite's own automatic checkpoint
constexpr const char* kTables[] = {"clinic", "account", "patient", "visit", "trial",
                                   "note",   "tries",   "answer",  "log",   "merged",
                                   "intent", "mark",    "counter"};
constexpr const char* kNumbered[] = {"account", "patient", "note", "log", "intent", "mark"};

std::string keyFrom(const std::string& hex) {
  std::string out(hex.size() / 2, '\0');
  std::size_t got = 0;
  (void)sodium_hex2bin(reinterpret_cast<unsigned char*>(out.data()), out.size(), hex.data(),
                       hex.size(), nullptr, &got, nullptr);
  if (got != crypto_generichash_KEYBYTES) throw DatabaseError("keys: the key of rows is damaged");
  return out;
}

/// A digest under way.
class Digest {
 public:
  explicit Digest(const std::string& key) {
    crypto_generichash_init(&state_, reinterpret_cast<const unsigned char*>(key.data()), key.size(),
                            kDigest_bytes);
  }
  void add(const void* bytes, std::size_t size) {
    crypto_generichash_update(&state_, static_cast<const unsigned char*>(bytes), size);
  }
  [[nodiscard]] std::array<unsigned char, kDigest_bytes> end() {
    std::array<unsigned char, kDigest_bytes> out{};
    crypto_generichash_final(&state_, out.data(), out.size());
    return out;
  }

 private:
  crypto_generichash_state state_{};
};

void addValue(Digest& digest, sqlite3_value* value) {
  const int type = sqlite3_value_type(value);
  const char tag = static_cast<char>(type);
  digest.add(&tag, 1);
  if (type == SQLITE_INTEGER) {
    const sqlite3_int64 number = sqlite3_value_int64(value);
    digest.add(&number, sizeof number);
  } else if (type != SQLITE_NULL) {
    const void* bytes = sqlite3_value_blob(value);
    const int size = sqlite3_value_bytes(value);
    digest.add(&size, sizeof size);
    if (size > 0) digest.add(bytes, static_cast<std::size_t>(size));
  }
}

RowGuard& guardOf(sqlite3_context* context) {
  return *static_cast<RowGuard*>(sqlite3_user_data(context));
}

/// row_hash(TABLE, NUMBER, VALUE...).
void rowHash(sqlite3_context* context, int count, sqlite3_value** values) {
  Digest digest(guardOf(context).key);
  for (int i = 0; i < count; ++i) addValue(digest, values[i]);
  const auto out = digest.end();
  sqlite3_result_blob(context, out.data(), static_cast<int>(out.size()), SQLITE_TRANSIENT);
}

bool isTable(sqlite3_value* table, std::string_view name) {
  return std::string_view(reinterpret_cast<const char*>(sqlite3_value_text(table))) == name;
}

/// row_hash_kept(...): nothing for a visit that is set aside.
void rowHashKept(sqlite3_context* context, int count, sqlite3_value** values) {
  if (guardOf(context).aside && isTable(values[0], "visit")) return sqlite3_result_null(context);
  rowHash(context, count, values);
}

/// row_check(TABLE, ROW, SOUND): an error for a damaged row.
void rowCheck(sqlite3_context* context, int, sqlite3_value** values) {
  const RowGuard& guard = guardOf(context);
  if (sqlite3_value_int(values[2]) != 0) return;
  if (guard.aside && isTable(values[0], "visit")) return;
  const bool signs = sqlite3_value_int64(values[1]) == guard.signed_patient;
  if (signs && isTable(values[0], "patient")) return;
  const std::string why = fmt::format(
      "row {} of {} is damaged and stays as it is: restore a backup",
      sqlite3_value_int64(values[1]), reinterpret_cast<const char*>(sqlite3_value_text(values[0])));
  sqlite3_result_error(context, why.c_str(), -1);
}

std::string digestOfCount(const std::string& key, const std::string& number) {
  Digest digest(key);
  digest.add("changes", 7);
  digest.add(number.data(), number.size());
  const auto out = digest.end();
  std::string hex(kDigest_bytes * 2 + 1, '\0');
  sodium_bin2hex(hex.data(), hex.size(), out.data(), out.size());
  hex.pop_back();
  return hex;
}

std::int64_t countOf(sqlite3* db, const char* name) {
  sqlite3_stmt* row = nullptr;
  std::int64_t n = 0;
  if (sqlite3_prepare_v2(db, "SELECT n FROM counter WHERE name = ?", -1, &row, nullptr) ==
      SQLITE_OK) {
    sqlite3_bind_text(row, 1, name, -1, SQLITE_STATIC);
    if (sqlite3_step(row) == SQLITE_ROW) n = sqlite3_column_int64(row, 0);
  }
  sqlite3_finalize(row);
  return n;
}

/// Writes the number of the last change beside the database. It is not waited for: after a power
/// cut the file may be older than the database, never newer.
int afterCommit(void* state, sqlite3* db, const char* name, int pages) {
  const auto& guard = *static_cast<RowGuard*>(state);
  if (guard.file >= 0) {
    const std::string number = fmt::format("{:020}", countOf(db, "changes"));
    const std::string line = number + " " + digestOfCount(guard.key, number) + "\n";
    (void)!::pwrite(guard.file, line.data(), line.size(), 0);
  }
  if (pages >= kPagesOfLog) {
    (void)sqlite3_wal_checkpoint_v2(db, name, SQLITE_CHECKPOINT_PASSIVE, nullptr, nullptr);
  }
  return SQLITE_OK;
}

/// Columns with values, each behind a place for an alias.
std::vector<std::string> columnsOf(Database& db, std::string_view table) {
  std::vector<std::string> out;
  Statement rows = db.query(fmt::format("SELECT name FROM pragma_table_info('{}')", table));
  while (rows.step()) {
    if (rows.text(0) != "row_n" && rows.text(0) != "row_digest") out.push_back(rows.text(0));
  }
  return out;
}

/// "'visit', NUMBER, v.id, v.patient, …"
std::string valuesOf(Database& db, std::string_view table, std::string_view alias,
                     const std::string& number) {
  auto& known = db.guard()->columns[std::string(table)];
  if (known.empty()) known = fmt::format("{}", fmt::join(columnsOf(db, table), " "));
  std::string out = fmt::format("'{}', {}", table, number);
  for (std::size_t at = 0; at < known.size();) {
    const std::size_t end = std::min(known.find(' ', at), known.size());
    out += fmt::format(", {}.{}", alias, known.substr(at, end - at));
    at = end + 1;
  }
  return out;
}

void createTriggers(Database& db, const std::string& table) {
  const bool counter = table == "counter";
  const std::string number = counter ? "0" : "(SELECT n FROM counter WHERE name = 'changes')";
  const std::string count = counter ? "" : "UPDATE counter SET n = n + 1 WHERE name = 'changes';";
  const std::string renew = fmt::format(
      "{0} UPDATE {1} SET row_n = {2}, row_digest = row_hash_kept({3}) WHERE rowid = "
      "NEW.rowid;",
      count, table, number, valuesOf(db, table, "NEW", number));
  std::string given;
  for (const char* name : kNumbered) {
    if (table != name) continue;
    given =
        fmt::format("UPDATE counter SET n = NEW.rowid WHERE name = '{}' AND n < NEW.rowid;", name);
  }
  const std::string columns = fmt::format("{}", fmt::join(columnsOf(db, table), ", "));
  db.run(
      fmt::format("CREATE TEMP TRIGGER {0}_added AFTER INSERT ON main.{0} BEGIN {1} {2} END;"
                  "CREATE TEMP TRIGGER {0}_checked BEFORE UPDATE OF {3} ON main.{0} BEGIN"
                  "  SELECT row_check('{0}', OLD.rowid, OLD.row_digest IS row_hash({4})); END;"
                  "CREATE TEMP TRIGGER {0}_changed AFTER UPDATE OF {3} ON main.{0} BEGIN {1} END;",
                  table, renew, given, columns, valuesOf(db, table, "OLD", "OLD.row_n")));
  if (!counter) {
    db.run(fmt::format("CREATE TEMP TRIGGER {0}_deleted AFTER DELETE ON main.{0} BEGIN {1} END;",
                       table, count));
  }
}

/// Words for a damaged row: of which visit or patient it is.
std::string nameOf(Database& db, const std::string& table, std::int64_t row) {
  const auto code_of = [&](std::int64_t patient) {
    const std::string code = db.text("SELECT code FROM patient WHERE id = ?", patient);
    return code.empty() ? code : " of " + code;
  };
  const auto visit = [&](std::int64_t id) {
    return fmt::format("visit {}{}", id,
                       code_of(db.number("SELECT patient FROM visit WHERE id = ?", id)));
  };
  if (table == "patient") return fmt::format("patient {}{}", row, code_of(row));
  if (table == "visit") return visit(row);
  if (table == "trial" || table == "note") {
    const std::int64_t of = db.number(fmt::format("SELECT visit FROM {} WHERE id = ?", table), row);
    if (of != 0) return fmt::format("{} {} of {}", table, row, visit(of));
  }
  if (table == "note") {
    return fmt::format("note {}{}", row,
                       code_of(db.number("SELECT patient FROM note WHERE id = ?", row)));
  }
  return fmt::format("row {} of {}", row, table);
}

}  // namespace

void guardRows(Database& db, const std::string& row_key, const std::string& counter_file) {
  if (db.guard()) return;
  auto guard = std::make_shared<RowGuard>();
  guard->key = keyFrom(row_key);
  if (!counter_file.empty()) {
    guard->file = ::open(counter_file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (guard->file < 0) throw DatabaseError(counter_file + ": cannot be written");
  }
  constexpr int kPure = SQLITE_UTF8 | SQLITE_INNOCUOUS;
  sqlite3* const handle = db.handle();
  sqlite3_create_function_v2(handle, "row_hash", -1, kPure | SQLITE_DETERMINISTIC, guard.get(),
                             rowHash, nullptr, nullptr, nullptr);
  sqlite3_create_function_v2(handle, "row_hash_kept", -1, kPure, guard.get(), rowHashKept, nullptr,
                             nullptr, nullptr);
  sqlite3_create_function_v2(handle, "row_check", 3, kPure, guard.get(), rowCheck, nullptr, nullptr,
                             nullptr);
  sqlite3_wal_hook(handle, afterCommit, guard.get());
  db.setGuard(std::move(guard));
  for (const char* table : kTables) createTriggers(db, table);
}

bool hasDigests(Database& db) {
  // One damaged row must not make a database look like one of an earlier version.
  for (const char* table : kTables) {
    if (db.number(fmt::format("SELECT COUNT(*) FROM {} WHERE row_digest IS NOT NULL", table)) != 0)
      return true;
  }
  return false;
}

void digestAllRows(Database& db) {
  db.run("DELETE FROM counter");
  db.run("INSERT INTO counter (name, n) VALUES ('changes', 0), ('lost', 0), ('jump', 0)");
  for (const char* table : kNumbered) {
    db.change("INSERT INTO counter (name, n) VALUES (?, 0)", table);
  }
  noteSequences(db);
  for (const std::string table : kTables) {
    if (table == "counter") continue;
    db.run(fmt::format("UPDATE {0} SET row_n = 0, row_digest = row_hash({1})", table,
                       valuesOf(db, table, table, "0")));
  }
}

void guardAndAdopt(Database& db, const std::string& row_key, const std::string& counter_file) {
  guardRows(db, row_key, counter_file);
  if (hasDigests(db)) return;
  Transaction transaction(db);
  digestAllRows(db);
  transaction.commit();
}

void guardByKeys(Database& db, const std::string& folder, bool is_copy) {
  const auto keys = readKeyFile(folder + "/keys");
  if (!keys || keys->rows.empty()) return;
  if (!is_copy) return guardAndAdopt(db, keys->rows, counterIn(folder));
  if (hasDigests(db)) guardRows(db, keys->rows);
}

void noteSequences(Database& db) {
  db.run(
      "UPDATE counter SET n = (SELECT seq FROM sqlite_sequence s WHERE s.name = counter.name)"
      " WHERE name IN (SELECT name FROM sqlite_sequence)");
}

std::vector<std::string> damagedRows(Database& db, std::size_t most) {
  std::vector<std::string> out;
  if (!db.guard()) return out;
  for (const std::string table : kTables) {
    std::vector<std::int64_t> rows;
    {
      Statement damaged = db.query(
          fmt::format("SELECT t.rowid FROM {} t WHERE NOT {}", table, soundness(db, table, "t")));
      while (damaged.step() && rows.size() + out.size() < most) rows.push_back(damaged.integer(0));
    }
    for (const std::int64_t row : rows) out.push_back(nameOf(db, table, row));
  }
  // Rows of `counter` are never deleted.
  if (db.number("SELECT COUNT(*) FROM counter") != std::ssize(kNumbered) + 3) {
    out.emplace_back("the table counter");
  }
  for (const std::string& table : db.all<std::string>(
           "SELECT c.name FROM counter c LEFT JOIN sqlite_sequence s ON s.name = c.name"
           " WHERE c.name NOT IN ('changes', 'lost', 'jump') AND c.n IS NOT COALESCE(s.seq, 0)")) {
    out.push_back("the last number of " + table);
  }
  return out;
}

std::string soundness(Database& db, std::string_view table, std::string_view alias) {
  if (!db.guard()) return "1";
  const std::string number = table == "counter" ? "0" : fmt::format("{}.row_n", alias);
  return fmt::format("({}.row_digest IS row_hash({}))", alias, valuesOf(db, table, alias, number));
}

bool isSound(Database& db, std::string_view table, std::int64_t row) {
  if (!db.guard()) return true;
  return db.number(
             fmt::format("SELECT {} FROM {} t WHERE t.rowid = ?", soundness(db, table, "t"), table),
             row) != 0;
}

SetAside::SetAside(Database& db) : db_(db) {
  if (db_.guard()) db_.guard()->aside = true;
}
SetAside::~SetAside() {
  if (db_.guard()) db_.guard()->aside = false;
}

SignAgain::SignAgain(Database& db, std::int64_t patient) : db_(db) {
  if (db_.guard()) db_.guard()->signed_patient = patient;
}
SignAgain::~SignAgain() {
  if (db_.guard()) db_.guard()->signed_patient = 0;
}

std::int64_t changesIn(Database& db) {
  return db.number("SELECT n FROM counter WHERE name = 'changes'");
}

void confirmLostChanges(Database& db) {
  db.run("UPDATE counter SET n = 0 WHERE name = 'lost'");
}

std::int64_t clockJump(Database& db) {
  return db.number("SELECT n FROM counter WHERE name = 'jump'");
}

void setClockJump(Database& db, std::int64_t at_us) {
  db.change("UPDATE counter SET n = ? WHERE name = 'jump'", at_us);
}

ChangesBeside changesBeside(const std::string& counter_file, const std::string& row_key) {
  ChangesBeside out;
  std::ifstream in(counter_file, std::ios::binary);
  std::string number, digest;
  if (!(in >> number)) return out;
  in >> digest;
  std::int64_t n = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), n);
  out.damaged = error != std::errc{} || end != number.data() + number.size() ||
                digest != digestOfCount(keyFrom(row_key), number);
  if (!out.damaged) out.n = n;
  return out;
}

std::int64_t lostChanges(Database& db) {
  return db.number("SELECT n FROM counter WHERE name = 'lost'");
}

void setLostChanges(Database& db, std::int64_t lost) {
  db.change("UPDATE counter SET n = n + ? WHERE name = 'changes'", lost);
  db.change("UPDATE counter SET n = ? WHERE name = 'lost'", lost);
}

std::string counterIn(const std::string& folder) {
  return folder + "/counter";
}

void checkSchema(Database& db) {
  Database fresh(":memory:", Database::Mode::kCreate);
  migrate(fresh);
  const auto text_of = [](Database& of) {
    std::string out;
    Statement rows = of.query(
        "SELECT type, name, tbl_name, COALESCE(sql, '') FROM sqlite_schema ORDER BY type, name");
    while (rows.step()) {
      for (int i = 0; i < 4; ++i) out += rows.text(i) + '\n';
    }
    return out;
  };
  if (text_of(db) == text_of(fresh)) return;
  throw DatabaseError(db.path() +
                      ": is damaged: its tables are not those of this program; restore a backup");
}

}  // namespace wholehand::clinic
