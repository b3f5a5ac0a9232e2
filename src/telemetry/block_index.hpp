#pragma once

#include "core/tick_record.hpp"
#include "telemetry/recording_layout.hpp"

#include <cstdint>
#include <optional>
#include <vector>

/// The index of a recording: what a reader has to know of each chunk of /ticks before it reads it
/// (docs/recording.md, docs/adr/0035-recordings-have-an-index.md). It repeats what /ticks says: a
/// recording without it, or with a part of it, is read as well, only later. Private to telemetry.
namespace wholehand::recording {

/// A chunk of /ticks, all of whose rows are whole.
struct BlockRow {
  std::uint64_t first_tick = 0, last_tick = 0;          ///< numbers of its ticks
  std::uint64_t missing = 0;                            ///< in it and before it (missingBetween())
  std::uint64_t contacts = 0, events = 0, commands = 0; /**< rows of these tables that belong to
                                                             ticks up to its last */
};

/// Rows of the index that are written at once; each costs a reader that finds them missing 2 ms.
inline constexpr std::uint64_t kIndexChunkRows = 64;

/// The dataset of /index.
[[nodiscard]] std::vector<Column<BlockRow>> indexColumns();

/// Describes the blocks of a recording while it is written. Not for the tick.
class BlockIndexer {
 public:
  explicit BlockIndexer(std::uint64_t chunk_rows) : chunk_rows_(chunk_rows) {}

  /// Takes the ticks in the order of their rows; `after` counts the rows of the other tables up to
  /// this tick. Gives the block that the tick ends.
  std::optional<BlockRow> add(const TickRecord& record, const BlockRow& after);
  /// Describes no more blocks: the rows of the file are no longer those that were added.
  void stop() noexcept { stopped_ = true; }

 private:
  const std::uint64_t chunk_rows_;
  std::uint64_t rows_ = 0, last_tick_ = 0;
  BlockRow block_;
  bool stopped_ = false;
};

/// What a file of this size may say of its blocks.
struct IndexBounds {
  std::uint64_t chunk_rows = 1;
  std::uint64_t ticks = 0, contacts = 0, events = 0, commands = 0;  ///< rows of the tables
};

/// How many of the blocks, from the first on, can be true.
[[nodiscard]] std::size_t plausibleBlocks(const std::vector<BlockRow>& blocks,
                                          const IndexBounds& bounds);

}  // namespace wholehand::recording
