#include "telemetry/block_index.hpp"

#include "telemetry/recording.hpp"

#include <algorithm>
#include <cstring>
#include <type_traits>

namespace wholehand::recording {
namespace {

bool rises(std::uint64_t before, std::uint64_t after, std::uint64_t most_more, std::uint64_t most) {
  return after >= before && after - before <= most_more && after <= most;
}

bool canFollow(const BlockRow& before, const BlockRow& block, bool is_first,
               const IndexBounds& bounds) {
  const std::uint64_t rows = bounds.chunk_rows;
  if (block.last_tick < block.first_tick || block.last_tick - block.first_tick < rows - 1 ||
      block.last_tick == UINT64_MAX || (!is_first && block.first_tick <= before.last_tick)) {
    return false;
  }
  const std::uint64_t from = is_first ? block.first_tick : before.last_tick + 1;
  return block.missing <= block.last_tick - from + 1 - rows &&
         rises(before.contacts, block.contacts, rows * kMaxContacts, bounds.contacts) &&
         rises(before.events, block.events, rows * kMaxExerciseEvents, bounds.events) &&
         rises(before.commands, block.commands, rows * kMaxCommands, bounds.commands);
}

}  // namespace

std::vector<Column<BlockRow>> indexColumns() {
  static_assert(std::is_trivially_copyable_v<BlockRow> &&
                sizeof(BlockRow) == 6 * sizeof(std::uint64_t));
  Column<BlockRow> c;
  c.name = "blocks";
  c.type = hdf5::NumberType::kUint64;
  c.shape = {6};
  c.units = {"1"};
  c.labels = {"first_tick", "last_tick", "missing", "contacts", "events", "commands"};
  c.store = [](const BlockRow& row, std::byte* out) { std::memcpy(out, &row, sizeof row); };
  c.load = [](const std::byte* in, BlockRow& row) { std::memcpy(&row, in, sizeof row); };
  return {c};
}

std::optional<BlockRow> BlockIndexer::add(const TickRecord& record, const BlockRow& after) {
  const bool begins = rows_ % chunk_rows_ == 0;
  // Non-increasing numbers do not identify the rows between them.
  if (rows_ > 0 && record.tick <= last_tick_) stopped_ = true;
  if (stopped_) return std::nullopt;
  const std::uint64_t missing =
      rows_ > 0 ? missingBetween(last_tick_, record.tick, record.elapsed_periods) : 0;
  block_ = {begins ? record.tick : block_.first_tick,
            record.tick,
            (begins ? 0 : block_.missing) + missing,
            after.contacts,
            after.events,
            after.commands};
  last_tick_ = record.tick;
  ++rows_;
  return rows_ % chunk_rows_ == 0 ? std::optional(block_) : std::nullopt;
}

std::size_t plausibleBlocks(const std::vector<BlockRow>& blocks, const IndexBounds& bounds) {
  const std::size_t most = std::min<std::size_t>(blocks.size(), bounds.ticks / bounds.chunk_rows);
  BlockRow before;
  for (std::size_t i = 0; i < most; ++i) {
    if (!canFollow(before, blocks[i], i == 0, bounds)) return i;
    before = blocks[i];
  }
  return most;
}

}  // namespace wholehand::recording
