#include "telemetry/recorded_tables.hpp"

#include "telemetry/recording_bounds.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <numeric>
#include <type_traits>
#include <utility>

namespace wholehand::recording {
namespace {

/// Far more rows than a byte of a file can hold; a damaged file must not cause huge allocations.
constexpr std::uint64_t kMostRowsPerByte = 10;

/// Makes a record empty, faster than construction: of bodies and contacts, most of its bytes, only
/// those that it has are cleared. @pre it is empty beyond its counts
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

RecordedTables::RecordedTables(const RecordingMeta& meta, std::uint64_t chunks_at_once,
                               const LeftOut& left_out)
    : meta_(meta),
      ticks_(tickColumns(meta)),
      contacts_(contactColumns()),
      events_(eventColumns()),
      commands_(commandColumns(meta)),
      block_(chunkRows(meta.period_s)),
      chunks_at_once_(chunks_at_once) {
  ticks_.unpack(predictions(shapesOf(tickColumns(meta)), meta), block_);
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

std::string RecordedTables::open(TablesSource& file, bool being_written) {
  outline_.being_written = being_written;
  for (const std::string& problem :
       {openTable(file, "ticks", ticks_), openTable(file, "contacts", contacts_.table),
        openTable(file, "events", events_.table), openTable(file, "commands", commands_.table)}) {
    if (!problem.empty()) return problem;
  }
  const std::uint64_t bytes = file.bytes();
  if (bytes == 0) return "is truncated or damaged";
  for (const std::uint64_t rows :
       {ticks_.rows(), contacts_.table.rows(), events_.table.rows(), commands_.table.rows()}) {
    if (rows / kMostRowsPerByte > bytes) {
      return "is damaged: it claims more ticks than a file of its size can hold";
    }
  }
  return findTicks(file) ? "" : "is truncated or damaged: its ticks cannot be read";
}

bool RecordedTables::findTicks(TablesSource& file) {
  const std::uint64_t described = takeBlocks(readIndex(file));
  return findRowsFrom(described) && countMissingFrom(described);
}

// No blocks when the index is missing or damaged.
std::vector<BlockRow> RecordedTables::readIndex(TablesSource& file) const {
  std::unique_ptr<TableSource> source = file.table("index");
  TableReader<BlockRow> index(indexColumns());
  if (source == nullptr || !index.open(std::move(source)).empty()) return {};
  const std::uint64_t rows = std::min(index.rows(), ticks_.rows() / block_);
  if (!index.load(0, rows)) return {};
  std::vector<BlockRow> blocks(rows);
  for (std::uint64_t i = 0; i < rows; ++i) index.get(i, blocks[i]);
  blocks.resize(plausibleBlocks(blocks, {block_, ticks_.rows(), contacts_.table.rows(),
                                         events_.table.rows(), commands_.table.rows()}));
  return blocks;
}

// Uses the index as far as it is valid; returns the rows that it describes.
std::uint64_t RecordedTables::takeBlocks(const std::vector<BlockRow>& blocks) {
  const auto skips = [this](const BlockRow& b) { return b.last_tick - b.first_tick != block_ - 1; };
  std::size_t taken = 0;
  while (taken < blocks.size()) {
    std::size_t end = taken + 1;
    while (end < blocks.size() && skips(blocks[end]) == skips(blocks[taken])) ++end;
    if (!takeNumbers(blocks, taken, end)) break;
    taken = end;
  }
  for (std::size_t i = 0; i < taken; ++i) {
    outline_.missing += blocks[i].missing;
    contacts_.addBlock(blocks[i].contacts);
    events_.addBlock(blocks[i].events);
    commands_.addBlock(blocks[i].commands);
  }
  rows_.resize(taken * block_);
  std::iota(rows_.begin(), rows_.end(), 0);
  return rows_.size();
}

// If a block skips ticks, reads their numbers from /ticks.
bool RecordedTables::takeNumbers(const std::vector<BlockRow>& blocks, std::size_t begin,
                                 std::size_t end) {
  const std::uint64_t rows = (end - begin) * block_;
  std::vector<std::uint64_t> numbers(rows);
  if (blocks[begin].last_tick - blocks[begin].first_tick == block_ - 1) {
    for (std::uint64_t i = 0; i < rows; ++i) {
      numbers[i] = blocks[begin + i / block_].first_tick + i % block_;
    }
  } else {
    if (!ticks_.read("tick", begin * block_, rows, numbers)) return false;
    for (std::size_t b = begin; b < end; ++b) {
      const auto first = numbers.begin() + static_cast<std::ptrdiff_t>((b - begin) * block_);
      const auto last = first + static_cast<std::ptrdiff_t>(block_ - 1);
      if (*first != blocks[b].first_tick || *last != blocks[b].last_tick) return false;
    }
  }
  outline_.numbers.insert(outline_.numbers.end(), numbers.begin(), numbers.end());
  return true;
}

// A row whose number, contacts, events or commands never reached the disk is a hole: later rows are
// read nevertheless, and the gap in tick numbers shows it.
bool RecordedTables::findRowsFrom(std::uint64_t first_row) {
  const std::uint64_t end = ticks_.rows(), rows = end - first_row;
  std::vector<std::uint64_t> numbers;
  std::vector<std::int32_t> contacts, events, commands;
  if (!ticks_.read("tick", first_row, rows, numbers) ||
      !ticks_.read("contact_count", first_row, rows, contacts) ||
      !ticks_.read("event_count", first_row, rows, events) ||
      !ticks_.read("command_count", first_row, rows, commands) ||
      !contacts_.findBlocks(end, block_) || !events_.findBlocks(end, block_) ||
      !commands_.findBlocks(end, block_)) {
    return false;
  }
  TickRecord counts;  // large: cleared once
  for (std::uint64_t i = 0; i < rows; ++i) {
    counts.contact_count = contacts[i];
    counts.exercise.event_count = events[i];
    counts.command_count = commands[i];
    if (numbers[i] == UINT64_MAX || !isWhole(first_row + i, counts)) continue;
    rows_.push_back(first_row + i);
    outline_.numbers.push_back(numbers[i]);
  }
  return true;
}

// Reads no whole column when the ticks are consecutive.
bool RecordedTables::countMissingFrom(std::uint64_t first_row) {
  const std::size_t begin = std::lower_bound(rows_.begin(), rows_.end(), first_row) - rows_.begin();
  const std::size_t from = std::max<std::size_t>(begin, 1);
  if (from >= rows_.size() ||
      outline_.numbers.back() - outline_.numbers[from - 1] == rows_.size() - from) {
    return true;
  }
  std::vector<std::uint32_t> elapsed;
  if (!ticks_.read("elapsed_periods", first_row, ticks_.rows() - first_row, elapsed)) return false;
  for (std::size_t i = from; i < rows_.size(); ++i) {
    outline_.missing +=
        missingBetween(outline_.numbers[i - 1], outline_.numbers[i], elapsed[rows_[i] - first_row]);
  }
  return true;
}

bool RecordedTables::load(std::uint64_t row, std::uint64_t rows) {
  const std::uint64_t first = row / rows * rows;
  const std::uint64_t end = std::min(ticks_.rows(), first + rows);
  return ticks_.load(first, end - first) && contacts_.load(first, end, block_) &&
         events_.load(first, end, block_) && commands_.load(first, end, block_);
}

// A damaged chunk affects no other one, and is not retried for each of its rows.
bool RecordedTables::loadAround(std::uint64_t row) {
  if (row / block_ == unreadable_block_) return false;
  hdf5::beginHdf5();
  if (chunks_at_once_ > 1 && load(row, chunks_at_once_ * block_)) return true;
  if (load(row, block_)) return true;
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

bool RecordedTables::read(std::uint64_t index, TickRecord& record) {
  if (index >= rows_.size()) return false;
  const std::uint64_t i = rows_[index];
  if (!holds(i) && !loadAround(i)) return false;
  clear(record);
  ticks_.get(i, record);
  // The index contradicts the rows, or no tick wrote these numbers.
  if (record.tick != outline_.numbers[index] || !isWhole(i, record) || !isPlausible(record)) {
    return false;
  }
  record.body_count =
      std::clamp(record.body_count, 0, static_cast<std::int32_t>(meta_.body_names.size()));
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
