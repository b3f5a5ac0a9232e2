#pragma once

#include "telemetry/recording.hpp"
#include "telemetry/recording_layout.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

/// Predicts a tick's numbers from the rest of its row and from earlier rows of its chunk. A packed
/// dataset stores only the difference from the prediction: it is lossless, and results computed
/// from recorded numbers take almost no space. The rules are part of the file format
/// (docs/recording.md, docs/adr/0033-packed-recordings.md): if a law of the renderer changes,
/// recordings grow but stay correct. Private to telemetry.
namespace wholehand::recording {

/// The rows of one chunk, column by column, in memory layout.
using RowBytes = std::vector<std::vector<std::byte>>;

/// One row and the rows before it.
class RowWindow {
 public:
  RowWindow(const RowBytes& columns, const std::vector<std::size_t>& row_bytes)
      : columns_(columns), row_bytes_(row_bytes) {}

  /// @param past number of earlier rows that may be read
  void moveTo(std::uint64_t row, std::uint64_t past) noexcept {
    row_ = row;
    past_ = past;
  }
  [[nodiscard]] std::uint64_t past() const noexcept { return past_; }
  /// The i-th number of a column, `back` rows earlier. @pre back <= past()
  template <class T = double>
  [[nodiscard]] T number(std::size_t column, std::size_t i, std::uint64_t back = 0) const noexcept;

 private:
  const RowBytes& columns_;
  const std::vector<std::size_t>& row_bytes_;
  std::uint64_t row_ = 0, past_ = 0;
};

/// Prediction rule of one column of doubles.
struct Prediction {
  std::size_t column = 0;
  std::size_t width = 1;      ///< numbers per row
  bool row_elements = false;  ///< of the column, see ColumnShape
  /// Writes the predicted bits of the numbers of the window's row that are `later`, or of the
  /// others. Many per call: calls for single numbers would cost more than the rules. Called for the
  /// rows of a chunk in order: some rules keep what they learnt from earlier rows of the chunk.
  std::function<void(const RowWindow&, bool later, std::uint64_t* expected)> expect;
  std::vector<bool>
      later;  ///< per number: its rule needs those in its row that are not; empty: none
  std::vector<double> steps = {};  ///< of each number's grid, see GridSteps; empty: none
};

/// Rules of the columns that a file with this description packs. Within its own row, a rule uses
/// only columns without a rule or with an earlier one.
[[nodiscard]] std::vector<Prediction> predictions(const std::vector<ColumnShape>& columns,
                                                  const RecordingMeta& meta);

/// Packs rows begin .. end-1 of the predicted columns into `packed`. @pre `columns` begins with the
/// first row of a chunk.
void packRows(const std::vector<Prediction>& predictions, const RowBytes& columns,
              const std::vector<std::size_t>& row_bytes, std::uint64_t chunk_rows,
              std::uint64_t begin, std::uint64_t end, RowBytes& packed);

/// Restores the recorded numbers of the predicted columns in place; the rows begin at a chunk.
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
