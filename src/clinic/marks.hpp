#pragma once

#include "clinic/database.hpp"

#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

/// Marks: what a clinic erased, moved, joined, gave and drew. They are rows of the table `mark`,
/// and lines of the lists `erased` beside the key and beside backups, so that no restored backup
/// brings an erased person back. Functions throw DatabaseError.
namespace wholehand::clinic {

/// Marks, oldest first:
/// - `patient MARK`, `visit N`, `note N`, `recording SHA256`, `trial NAME` (a row only): erased
/// - `block CLINIC N`: the clinic numbers visits from N · 2^20 on
/// - `moved COUNT VISIT MARK`: the visit is the patient's; `joined COUNT MARK MARK`: the first
///   patient became part of the second; `given COUNT SHA256 MARK`: the recording is the patient's.
///   COUNT orders them, because a clock may be set back.
using Lines = std::vector<std::string>;

/// Words of a line.
[[nodiscard]] std::vector<std::string> wordsOf(const std::string& line);
/// Number that a word is; 0: it is none.
[[nodiscard]] std::int64_t numberIn(const std::string& word);

[[nodiscard]] Lines linesOf(Database& db);
[[nodiscard]] bool hasLine(Database& db, const std::string& line);
/// Adds the lines that the database does not have. @pre a transaction is open
void addLines(Database& db, const Lines& more);
/// Mark of a patient.
[[nodiscard]] std::string markOf(Database& db, std::int64_t patient);
/// The count of the next line of what happened. @pre a transaction is open
[[nodiscard]] std::int64_t nextCount(Database& db);

/// A list `erased`.
struct MarkList {
  Lines lines;
  std::int64_t until_us = 0;  ///< everything erased until then is in it; 0: unknown
};
/// Reads a list; empty without one.
[[nodiscard]] MarkList readMarkList(const std::string& path);
/// Adds lines to a list, durably.
void extendMarkList(const std::string& path, const MarkList& more);
/// Path of the list in a folder.
[[nodiscard]] std::string markListIn(const std::string& folder);

/// Marks of a visit and of its recordings.
[[nodiscard]] Lines linesOfVisit(Database& db, std::int64_t visit);
/// Visits, and digests of recordings of visits, that a database has: they are no erased person's.
using Kept = std::set<std::string>;
[[nodiscard]] Kept keptOf(Database& db);
/// Deletes every row that the lines name, except in the log, and all visits of an erased patient;
/// marks of those that no line names are added. A visit that was moved to another person, or that
/// the clinic's database has, stays, without a patient. @pre a transaction is open
/// @return number of deleted patients, visits, notes and trials
std::int64_t eraseMarked(Database& db, const Lines& lines, const Kept& kept = {});
/// True when a row is left that eraseMarked() would delete.
[[nodiscard]] bool hasMarked(Database& db, const Lines& lines);

/// Visits and recordings that the database's lines name as erased.
[[nodiscard]] bool isErasedVisit(Database& db, std::int64_t visit);
[[nodiscard]] bool isErasedRecording(Database& db, const std::string& sha256);
/// Mark of the patient to whom the recording was given at last, and who is not erased; empty: none.
[[nodiscard]] std::string ownerOf(Database& db, const std::string& sha256);
/// True when the recording was given at last to somebody who is not erased.
[[nodiscard]] bool isGivenAway(Database& db, const std::string& sha256);
/// True when this clinic drew the block of a visit's number.
[[nodiscard]] bool isDrawnHere(Database& db, std::int64_t visit);
/// The visit's number in a file name of the station ("…-visit-5512340001-…"); 0: none.
[[nodiscard]] std::int64_t visitInName(std::string_view name);

/// Draws a block of visit numbers at random, so that the numbers of two clinics differ, and notes
/// it. @pre a transaction is open
/// @return first number of the block
[[nodiscard]] std::int64_t drawBlock(Database& db, const std::string& clinic);

}  // namespace wholehand::clinic
