#pragma once

#include "core/tick_record.hpp"
#include "telemetry/recording_layout.hpp"

#include <cstdint>
#include <optional>
#include <vector>

/// Index of a recording: what a reader must know of each chunk of /ticks before it reads it
/// (docs/recording.md, docs/adr/0035-recordings-have-an-index.md). It is redundant: a recording
/// without it, or with a part of it, is readable, only more slowly. Private to telemetry.
namespace wholehand::recording {

/// A chunk of /ticks that contains only complete rows.
struct BlockRow {
  std::uint64_t first_tick = 0, last_tick = 0;  ///< tick numbers
  std::uint64_t missing = 0;  ///< ticks missing in it and before it (missingBetween())
  std::uint64_t contacts = 0, events = 0, commands = 0; /**< rows of these tables that belong to
                                                             ticks up to its last */
};

/// Index rows written at once. Each one that is missing costs a reader 2 ms.
inline constexpr std::uint64_t kIndexChunkRows = 64;

/// The datasets of /index.
[[nodiscard]] std::vector<Column<BlockRow>> indexColumns();

/// Builds the index while a recording is written. Not for the tick.
class BlockIndexer {
 public:
  explicit BlockIndexer(std::uint64_t chunk_rows) : chunk_rows_(chunk_rows) {}

  /// Adds a tick, in the order of rows; `after` counts the rows of the other tables up to this
  /// tick. Returns the block that the tick completes.
  std::optional<BlockRow> add(const TickRecord& record, const BlockRow& after);
  /// Stops indexing, when the file's rows no longer match those that were added.
  void stop() noexcept { stopped_ = true; }

 private:
  const std::uint64_t chunk_rows_;
  std::uint64_t rows_ = 0, last_tick_ = 0;
  BlockRow block_;
  bool stopped_ = false;
};

/// The file's row counts, which limit what its index may claim.
struct IndexBounds {
  std::uint64_t chunk_rows = 1;
  std::uint64_t ticks = 0, contacts = 0, events = 0, commands = 0;  ///< rows of the tables
};

/// Number of leading blocks that are plausible.
[[nodiscard]] std::size_t plausibleBlocks(const std::vector<BlockRow>& blocks,
                                          const IndexBounds& bounds);

}  // namespace wholehand::recording
