#include "clinic/marks.hpp"

#include "clinic/keys.hpp"
#include "clinic/row_digests.hpp"
#include "clinic/rows.hpp"
#include "clinic/text.hpp"
#include "files/text/text_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <string_view>
#include <utility>

namespace wholehand::clinic {
namespace {

constexpr int kBlockBits = 20;  // keeps numbers below 2^53, the integers of JSON
constexpr std::string_view kUntil = "# until ";

/// Rows that the lines name, as a condition of each table. The table `gone` holds the lines' words.
constexpr std::string_view kErasedRows[][2] = {
    {"patient", "mark IN (SELECT value FROM gone WHERE kind = 'patient')"},
    {"visit", "id IN (SELECT CAST(value AS INTEGER) FROM gone WHERE kind = 'visit')"},
    {"note", "id IN (SELECT CAST(value AS INTEGER) FROM gone WHERE kind = 'note')"},
    {"trial",
     "sha256 IN (SELECT value FROM gone WHERE kind = 'recording') OR recording IN"
     " (SELECT value FROM gone WHERE kind = 'trial')"}};

std::string erasedRowsOf(std::string_view table) {
  for (const auto& [name, where] : kErasedRows) {
    if (name == table) return std::string(where);
  }
  return "0";
}

std::string erasedPatients() {
  return "SELECT id FROM patient WHERE " + erasedRowsOf("patient");
}

void insertGone(Database& db, const std::string& line) {
  const std::size_t space = line.find(' ');
  if (space == std::string::npos) return;
  db.change("INSERT INTO gone VALUES (?, ?)", line.substr(0, space), line.substr(space + 1));
}

void fillGone(Database& db, const Lines& lines) {
  db.run("CREATE TEMP TABLE IF NOT EXISTS gone (kind TEXT, value TEXT); DELETE FROM gone");
  for (const std::string& line : lines) insertGone(db, line);
}

/// To whom visits were moved and recordings given at last; by visit, or by digest.
std::map<std::string, std::pair<std::int64_t, std::string>> lastOwners(const Lines& lines) {
  std::map<std::string, std::pair<std::int64_t, std::string>> last;
  for (const std::string& line : lines) {
    const std::vector<std::string> words = wordsOf(line);
    if (words.size() != 4 || (words[0] != "moved" && words[0] != "given")) continue;
    auto& owner = last[words[2]];
    owner = std::max(owner, {numberIn(words[1]), words[3]});
  }
  return last;
}

/// Marks of visits that no line names although their patient is erased: a backup may know a visit
/// that a restored database did not. What was moved or given to another person since stays.
Lines visitsWithThem(Database& db, const Lines& lines, const Kept& kept) {
  const std::set<std::string> erased(lines.begin(), lines.end());
  const auto owners = lastOwners(lines);
  const auto is_others = [&](const std::string& what) {
    const auto owner = owners.find(what);
    if (kept.contains(what)) return true;
    return owner != owners.end() && !erased.contains("patient " + owner->second.second);
  };
  Lines more;
  for (const std::int64_t visit :
       db.all<std::int64_t>("SELECT id FROM visit WHERE patient IN (" + erasedPatients() +
                            ") AND NOT (" + erasedRowsOf("visit") + ")")) {
    if (is_others(std::to_string(visit))) continue;
    for (std::string& line : linesOfVisit(db, visit)) {
      if (!is_others(line.substr(line.find(' ') + 1))) more.push_back(std::move(line));
    }
  }
  return more;
}

}  // namespace

std::vector<std::string> wordsOf(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

std::int64_t numberIn(const std::string& word) {
  std::int64_t number = 0;
  std::from_chars(word.data(), word.data() + word.size(), number);
  return number;
}

Lines linesOf(Database& db) {
  return db.all<std::string>("SELECT line FROM mark ORDER BY n");
}

bool hasLine(Database& db, const std::string& line) {
  return db.number("SELECT COUNT(*) FROM mark WHERE line = ?", line) != 0;
}

void addLines(Database& db, const Lines& more) {
  for (const std::string& line : more) {
    if (!hasLine(db, line)) db.change("INSERT INTO mark (line) VALUES (?)", line);
  }
}

std::string markOf(Database& db, std::int64_t patient) {
  return db.text("SELECT mark FROM patient WHERE id = ?", patient);
}

std::int64_t nextCount(Database& db) {
  return db.number("SELECT COALESCE(MAX(n), 0) + 1 FROM mark");
}

std::string markListIn(const std::string& folder) {
  return folder + "/erased";
}

MarkList readMarkList(const std::string& path) {
  MarkList list;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with(kUntil)) {
      list.until_us = timeOf(line.substr(kUntil.size())).value_or(0);
    } else if (!line.empty() && line[0] != '#') {
      list.lines.push_back(line);
    }
  }
  return list;
}

void extendMarkList(const std::string& path, const MarkList& more) {
  MarkList list = readMarkList(path);
  std::set<std::string> known(list.lines.begin(), list.lines.end());
  for (const std::string& line : more.lines) {
    if (known.insert(line).second) list.lines.push_back(line);
  }
  std::string text =
      "# Erased patients, visits, notes and recordings, which no restored backup brings back;\n"
      "# visits that were moved, and the blocks of their numbers.\n";
  text += fmt::format("{}{}\n", kUntil, isoTime(std::max(list.until_us, more.until_us)));
  for (const std::string& line : list.lines) text += line + "\n";
  if (const int error = writeDurably(path, text); error != 0) {
    throw DatabaseError(path + ": cannot be written: " + std::strerror(error));
  }
}

std::int64_t eraseMarked(Database& db, const Lines& lines, const Kept& kept) {
  fillGone(db, lines);
  const Lines more = visitsWithThem(db, lines, kept);
  addLines(db, more);
  for (const std::string& line : more) insertGone(db, line);
  // A visit that was erased as another person's: its settings are not this person's either.
  for (const std::int64_t visit : db.all<std::int64_t>(
           "SELECT id FROM visit WHERE patient IS NOT NULL AND " + erasedRowsOf("visit") +
           " AND patient NOT IN (" + erasedPatients() + ")")) {
    if (isSound(db, "visit", visit)) takeBackSettings(db, visitRow(db, visit));
  }
  // Trials and notes of a visit, and notes of a patient, are deleted with it.
  std::int64_t erased = db.change("DELETE FROM trial WHERE " + erasedRowsOf("trial"));
  erased += db.change("DELETE FROM note WHERE " + erasedRowsOf("note"));
  erased += db.change("DELETE FROM visit WHERE " + erasedRowsOf("visit"));
  db.run(
      "UPDATE visit SET patient = NULL, state = 'guest', changed = '{}', before = '{}' WHERE "
      "patient"
      " IN (" +
      erasedPatients() + ")");
  erased += db.change("DELETE FROM patient WHERE " + erasedRowsOf("patient"));
  if (erased > 0) db.run("DELETE FROM answer");
  return erased;
}

Kept keptOf(Database& db) {
  const auto kept = db.all<std::string>(
      "SELECT CAST(id AS TEXT) FROM visit UNION SELECT sha256 FROM trial WHERE visit IS NOT NULL");
  return {kept.begin(), kept.end()};
}

bool hasMarked(Database& db, const Lines& lines) {
  fillGone(db, lines);
  return std::any_of(std::begin(kErasedRows), std::end(kErasedRows), [&](const auto& rows) {
    return db.number(fmt::format("SELECT COUNT(*) FROM {} WHERE {}", rows[0], rows[1])) != 0;
  });
}

Lines linesOfVisit(Database& db, std::int64_t visit) {
  Lines lines = {fmt::format("visit {}", visit)};
  for (const std::string& sha256 : db.all<std::string>(
           "SELECT DISTINCT sha256 FROM trial WHERE visit = ? AND sha256 <> '' ORDER BY sha256",
           visit)) {
    lines.push_back("recording " + sha256);
  }
  return lines;
}

bool isErasedVisit(Database& db, std::int64_t visit) {
  return visit != 0 && hasLine(db, fmt::format("visit {}", visit));
}

bool isErasedRecording(Database& db, const std::string& sha256) {
  return !sha256.empty() && hasLine(db, "recording " + sha256);
}

std::string ownerOf(Database& db, const std::string& sha256) {
  const auto owners = lastOwners(linesOf(db));
  const auto owner = owners.find(sha256);
  const bool has = owner != owners.end() && !hasLine(db, "patient " + owner->second.second);
  return has ? owner->second.second : std::string{};
}

bool isGivenAway(Database& db, const std::string& sha256) {
  return !ownerOf(db, sha256).empty();
}

bool isDrawnHere(Database& db, std::int64_t visit) {
  return hasLine(db,
                 fmt::format("block {} {}", db.text("SELECT id FROM clinic"), visit >> kBlockBits));
}

std::int64_t visitInName(std::string_view name) {
  constexpr std::string_view kWord = "visit-";
  constexpr std::size_t kMostDigits = 16;
  for (std::size_t at = name.find(kWord); at != std::string_view::npos;
       at = name.find(kWord, at + 1)) {
    if (at != 0 && name[at - 1] != '-') continue;
    const std::string rest(name.substr(at + kWord.size()));
    const std::string digits = rest.substr(0, rest.find_first_not_of("0123456789"));
    if (!digits.empty() && digits.size() <= kMostDigits) return numberIn(digits);
  }
  return 0;
}

std::int64_t drawBlock(Database& db, const std::string& clinic) {
  for (;;) {
    const std::int64_t block = std::int64_t{randomBelow(0xFFFF'FFFEU)} + 1;
    const std::string line = fmt::format("block {} {}", clinic, block);
    if (hasLine(db, line)) continue;
    addLines(db, {line});
    return (block << kBlockBits) + 1;
  }
}

}  // namespace wholehand::clinic
