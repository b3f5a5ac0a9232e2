#include "record/recorded_tables.hpp"

#include "record/recording_meta.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <utility>

namespace wholehand::recording {
namespace {

/// Limit of rows per byte of the file. It is far above real files and prevents huge allocations for
/// a damaged file.
constexpr std::uint64_t kMostRowsPerByte = 10;

/// Empties a record faster than its constructor does: only the bodies and contacts in use are
/// cleared. @pre the record is empty beyond its counts
void clear(TickRecord& record) noexcept {
  static_assert(std::is_trivially_copyable_v<TickRecord>);
  static const TickRecord kEmpty;
  constexpr std::size_t kBodies = offsetof(TickRecord, bodies);
  constexpr std::size_t kBodiesEnd = kBodies + sizeof(TickRecord::bodies);
  constexpr std::size_t kContacts = offsetof(TickRecord, contacts);
  constexpr std::size_t kContactsEnd = kContacts + sizeof(TickRecord::contacts);
  static_assert(kBodiesEnd <= kContacts);
  std::fill_n(record.bodies.begin(), std::clamp(record.body_count, 0, kMaxBodies), BodyState{});
  std::fill_n(record.contacts.begin(), std::clamp(record.contact_count, 0, kMaxContacts),
              Contact{});
  auto* to = reinterpret_cast<std::byte*>(&record);
  const auto* from = reinterpret_cast<const std::byte*>(&kEmpty);
  for (const auto& [begin, end] : {std::pair{std::size_t{0}, kBodies},
                                   {kBodiesEnd, kContacts},
                                   {kContactsEnd, sizeof(TickRecord)}}) {
    std::memcpy(to + begin, from + begin, end - begin);
  }
}

}  // namespace

RecordedTables::RecordedTables(const RecordingMeta& meta, const LeftOut& left_out)
    : meta_(meta),
      ticks_(tickColumns(meta)),
      contacts_(contactColumns(meta)),
      events_(eventColumns(meta)),
      commands_(commandColumns(meta)),
      block_(chunkRows(meta.period_s)) {
  ticks_.leaveOut(left_out.of_ticks);
  contacts_.table.leaveOut(left_out.of_contacts);
}

template <class Row>
std::string RecordedTables::openTable(TablesSource& file, const char* name,
                                      TableReader<Row>& table) {
  std::unique_ptr<TableSource> source = file.table(name);
  if (source == nullptr) return std::string("is truncated: it has no ").append(name);
  const std::string problem = table.open(std::move(source));
  return problem.empty() ? problem : "is damaged: it " + problem;
}

std::string RecordedTables::open(TablesSource& file, WriterState writer) {
  outline_.being_written = writer == WriterState::kWriting;
  for (const std::string& problem :
       {openTable(file, "ticks", ticks_), openTable(file, "contacts", contacts_.table),
        openTable(file, "events", events_.table), openTable(file, "commands", commands_.table)}) {
    if (!problem.empty()) return problem;
  }
  if (writer == WriterState::kClosed) {
    for (const auto& [name, flaw] :
         {std::pair{"/ticks", &ticks_.flaw()}, std::pair{"/contacts", &contacts_.table.flaw()},
          std::pair{"/events", &events_.table.flaw()},
          std::pair{"/commands", &commands_.table.flaw()}}) {
      if (outline_.flaw.empty() && !flaw->empty()) {
        outline_.flaw = std::string(name).append(" ").append(*flaw);
      }
    }
  }
  const std::uint64_t bytes = file.bytes();
  if (bytes == 0) return "is truncated or damaged";
  for (const std::uint64_t rows :
       {ticks_.rows(), contacts_.table.rows(), events_.table.rows(), commands_.table.rows()}) {
    if (rows / kMostRowsPerByte > bytes) {
      return "is damaged: it claims more ticks than a file of its size can hold";
    }
  }
  findRows();
  countMissing();
  return ticks_.rows() > 0 && rows_.empty() ? "is truncated or damaged: its ticks cannot be read"
                                            : "";
}

// Finds the complete rows. A row whose number, contacts, events or commands never reached the disk
// is left out; later rows are still read, and the gap in tick numbers shows the loss. If a count
// cannot be read, read() refuses the tick.
void RecordedTables::findRows() {
  constexpr std::int32_t kUnknown = -1;
  const std::uint64_t rows = ticks_.rows();
  std::vector<std::uint64_t> numbers;
  std::vector<std::int32_t> contacts, events, commands;
  // Reads tick numbers and counts; unreadable ones get marker values.
  const std::uint64_t unread = ticks_.readSound("tick", block_, kNeverWritten, numbers);
  if (unread > 0) {
    outline_.flaw = "/ticks has " + std::to_string(unread) + " rows of 'tick' that cannot be read";
  }
  ticks_.readSound("contact_count", block_, kUnknown, contacts);
  ticks_.readSound("event_count", block_, kUnknown, events);
  ticks_.readSound("command_count", block_, kUnknown, commands);
  // Finds the rows of the side tables for each block of ticks.
  contacts_.findBlocks(rows, block_);
  events_.findBlocks(rows, block_);
  commands_.findBlocks(rows, block_);
  TickRecord counts;  // large, so it is constructed once
  for (std::uint64_t i = 0; i < rows; ++i) {
    if (numbers[i] == kNeverWritten) continue;
    counts.contact_count = contacts[i];
    counts.exercise.event_count = events[i];
    counts.command_count = commands[i];
    const bool known = contacts[i] != kUnknown && events[i] != kUnknown && commands[i] != kUnknown;
    if (known && !isWhole(i, counts)) {
      if (!outline_.contradicted_tick) {
        outline_.contradicted_tick = numbers[i];
        outline_.contradiction = contradiction(i, counts);
      }
      continue;
    }
    rows_.push_back(i);
    outline_.numbers.push_back(numbers[i]);
  }
}

// Counts missing ticks. Does not read a whole column when the ticks are consecutive.
void RecordedTables::countMissing() {
  if (rows_.empty() || outline_.numbers.back() - outline_.numbers.front() == rows_.size() - 1) {
    return;
  }
  std::vector<std::uint32_t> elapsed;
  ticks_.readSound("elapsed_periods", block_, std::uint32_t{1}, elapsed);
  for (std::size_t i = 1; i < rows_.size(); ++i) {
    outline_.missing +=
        missingBetween(outline_.numbers[i - 1], outline_.numbers[i], elapsed[rows_[i]]);
  }
}

// Loads the chunk of a row. A damaged chunk does not affect other chunks and is not retried for
// each of its rows.
bool RecordedTables::loadAround(std::uint64_t row) {
  if (row / block_ == unreadable_block_) return false;
  hdf5::beginHdf5();
  const std::uint64_t first = row / block_ * block_;
  const std::uint64_t end = std::min(ticks_.rows(), first + block_);
  if (ticks_.load(first, end - first) && contacts_.load(first, end, block_) &&
      events_.load(first, end, block_) && commands_.load(first, end, block_)) {
    return true;
  }
  unreadable_block_ = row / block_;
  return false;
}

bool RecordedTables::endsWhole() {
  return rows_.empty() || holds(rows_.back()) || loadAround(rows_.back());
}

std::optional<std::uint64_t> RecordedTables::leaveOutDamagedEnd() {
  std::optional<std::uint64_t> first;
  while (!endsWhole()) {
    const std::uint64_t block = rows_.back() / block_;
    while (!rows_.empty() && rows_.back() / block_ == block) {
      first = outline_.numbers.back();
      rows_.pop_back();
      outline_.numbers.pop_back();
    }
  }
  return first;
}

bool RecordedTables::holds(std::uint64_t row) const {
  return ticks_.holds(row) && contacts_.holds(row) && events_.holds(row) && commands_.holds(row);
}

bool RecordedTables::isWhole(std::uint64_t row, const TickRecord& counts) const {
  return contacts_.isWhole(row, counts.contact_count, kMaxContacts) &&
         events_.isWhole(row, counts.exercise.event_count, kMaxExerciseEvents) &&
         commands_.isWhole(row, counts.command_count, kMaxCommands);
}

// @pre !isWhole()
std::string RecordedTables::contradiction(std::uint64_t row, const TickRecord& counts) const {
  const auto said = [row](const auto& side, const char* table, const char* column,
                          std::int32_t count, int most) {
    if (side.isWhole(row, count, most)) return std::string();
    const std::int32_t rows = side.count(row);
    return "has " + std::to_string(rows) + (rows == 1 ? " row in " : " rows in ") + table +
           ", its " + column + " says " + std::to_string(count);
  };
  std::string text =
      said(contacts_, "/contacts", "contact_count", counts.contact_count, kMaxContacts);
  if (text.empty()) {
    text = said(events_, "/events", "event_count", counts.exercise.event_count, kMaxExerciseEvents);
  }
  if (text.empty()) {
    text = said(commands_, "/commands", "command_count", counts.command_count, kMaxCommands);
  }
  return text;
}

bool RecordedTables::read(std::uint64_t index, TickRecord& record) {
  if (index >= rows_.size()) return false;
  const std::uint64_t i = rows_[index];
  if (!holds(i) && !loadAround(i)) return false;
  clear(record);
  ticks_.get(i, record);
  digest_ = ticks_.number<std::uint64_t>(kDigest, i);
  // The file was damaged after opening, or the numbers cannot come from a tick.
  if (record.tick != outline_.numbers[index] || !isWhole(i, record) || !isPlausible(record)) {
    return false;
  }
  record.body_count =
      std::clamp(record.body_count, 0, static_cast<std::int32_t>(meta_.body_names.size()));
  record.body_joint_count = static_cast<std::int32_t>(meta_.body_joint_names.size());
  record.contact_count = contacts_.count(i);
  for (std::int32_t c = 0; c < record.contact_count; ++c) {
    record.contacts[c] = contacts_.row(i, c).contact;
  }
  record.parameter_count = static_cast<std::int32_t>(meta_.parameter_names.size());
  record.exercise.value_count = static_cast<std::int32_t>(meta_.value_names.size());
  record.exercise.event_count = events_.count(i);
  for (std::int32_t c = 0; c < record.exercise.event_count; ++c) {
    record.exercise.events[c] = events_.row(i, c).event;
  }
  record.command_count = commands_.count(i);
  for (std::int32_t c = 0; c < record.command_count; ++c) {
    record.commands[c] = commands_.row(i, c).command;
  }
  return true;
}

}  // namespace wholehand::recording
