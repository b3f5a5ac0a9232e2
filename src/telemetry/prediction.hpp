#pragma once

#include "telemetry/recording.hpp"
#include "telemetry/recording_layout.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

/// What a number of a tick is expected to be, from the rest of its row and from the rows before it
/// in its chunk. A packed dataset holds only how far each number is from that: nothing is lost, and
/// what a law computed from recorded numbers takes no room. The rules belong to the file format
/// (docs/recording.md, docs/adr/0033-packed-recordings.md): where a law of the renderer changes,
/// recordings grow, and stay right. Private to telemetry.
namespace wholehand::recording {

/// The rows of one chunk, column by column, as they stand in memory.
using RowBytes = std::vector<std::vector<std::byte>>;

/// One row and those before it.
class RowWindow {
 public:
  RowWindow(const RowBytes& columns, const std::vector<std::size_t>& row_bytes)
      : columns_(columns), row_bytes_(row_bytes) {}

  /// @param past how many rows before this one may be asked for
  void moveTo(std::uint64_t row, std::uint64_t past) noexcept {
    row_ = row;
    past_ = past;
  }
  [[nodiscard]] std::uint64_t past() const noexcept { return past_; }
  /// The i-th number of a column. @pre back <= past()
  template <class T = double>
  [[nodiscard]] T number(std::size_t column, std::size_t i, std::uint64_t back = 0) const noexcept;

 private:
  const RowBytes& columns_;
  const std::vector<std::size_t>& row_bytes_;
  std::uint64_t row_ = 0, past_ = 0;
};

/// The rule of one column of doubles.
struct Prediction {
  std::size_t column = 0;
  std::size_t width = 1;  ///< numbers in a row
  /// Writes the bits that are expected of each number of the window's row. A row at a time: asked
  /// for each number, the calls would cost more than the rules.
  std::function<void(const RowWindow&, std::uint64_t* expected)> expect;
};

/// The rules of the columns that a file of that description packs. Each uses of its own row only
/// columns that have no rule, or one before it.
[[nodiscard]] std::vector<Prediction> predictions(const std::vector<ColumnShape>& columns,
                                                  const RecordingMeta& meta);

/// Writes rows begin .. end-1 of the predicted columns packed into `packed`. @pre `columns` begins
/// with the first row of a chunk.
void packRows(const std::vector<Prediction>& predictions, const RowBytes& columns,
              const std::vector<std::size_t>& row_bytes, std::uint64_t chunk_rows,
              std::uint64_t begin, std::uint64_t end, RowBytes& packed);

/// Turns the predicted columns of `rows` rows, which begin with a chunk, into the numbers that were
/// recorded.
void unpackRows(const std::vector<Prediction>& predictions, RowBytes& columns,
                const std::vector<std::size_t>& row_bytes, std::uint64_t chunk_rows,
                std::uint64_t rows);

template <class T>
inline T RowWindow::number(std::size_t column, std::size_t i, std::uint64_t back) const noexcept {
  T value;
  const std::size_t at = (row_ - back) * row_bytes_[column] + i * sizeof(T);
  std::memcpy(&value, columns_[column].data() + at, sizeof(T));
  return value;
}

}  // namespace wholehand::recording
