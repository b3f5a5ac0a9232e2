#include "telemetry/grid_steps.hpp"
#include "telemetry/prediction.hpp"

#include <algorithm>
#include <cfenv>

namespace wholehand::recording {
namespace {

/// Reproducible arithmetic on every machine: denormals are kept, rounding is to nearest.
class PlainArithmetic {
 public:
  PlainArithmetic() noexcept {
    std::fegetenv(&before_);
    std::fesetenv(FE_DFL_ENV);
  }
  ~PlainArithmetic() { std::fesetenv(&before_); }
  PlainArithmetic(const PlainArithmetic&) = delete;
  PlainArithmetic& operator=(const PlainArithmetic&) = delete;

 private:
  std::fenv_t before_{};
};

std::uint64_t packedNumber(const Prediction& p, std::size_t i, std::uint64_t bits,
                           std::uint64_t expected) {
  if (p.steps.empty()) return folded(bits - expected);
  return GridSteps(expected, p.steps[i]).pack(bits);
}
std::uint64_t unpackedNumber(const Prediction& p, std::size_t i, std::uint64_t code,
                             std::uint64_t expected) {
  if (p.steps.empty()) return unfolded(code) + expected;
  return GridSteps(expected, p.steps[i]).unpack(code);
}

std::size_t mostNumbers(const std::vector<Prediction>& predictions) {
  std::size_t most = 0;
  for (const Prediction& p : predictions) most = std::max(most, p.width);
  return most;
}

}  // namespace

void packRows(const std::vector<Prediction>& predictions, const RowBytes& columns,
              const std::vector<std::size_t>& row_bytes, std::uint64_t chunk_rows,
              std::uint64_t begin, std::uint64_t end, RowBytes& packed) {
  const PlainArithmetic plain;
  RowWindow window(columns, row_bytes);
  std::vector<std::uint64_t> expected(mostNumbers(predictions));
  for (const Prediction& p : predictions)
    packed[p.column].resize((end - begin) * row_bytes[p.column]);
  for (std::uint64_t row = begin - begin % chunk_rows; row < end; ++row) {
    window.moveTo(row, row % chunk_rows);
    for (const Prediction& p : predictions) {
      p.expect(window, false, expected.data());
      if (!p.later.empty()) p.expect(window, true, expected.data());
      if (row < begin) continue;  // the rule learns from it
      std::byte* to = packed[p.column].data() + (row - begin) * row_bytes[p.column];
      for (std::size_t i = 0; i < p.width; ++i, to += sizeof(std::uint64_t)) {
        const auto bits = window.number<std::uint64_t>(p.column, i);
        const std::uint64_t number = packedNumber(p, i, bits, expected[i]);
        std::memcpy(to, &number, sizeof number);
      }
    }
  }
}

// Row by row: the rule of a column may need another's earlier rows.
void unpackRows(const std::vector<Prediction>& predictions, RowBytes& columns,
                const std::vector<std::size_t>& row_bytes, std::uint64_t chunk_rows,
                std::uint64_t rows) {
  const PlainArithmetic plain;
  RowWindow window(columns, row_bytes);
  std::vector<std::uint64_t> expected(mostNumbers(predictions));
  for (std::uint64_t row = 0; row < rows; ++row) {
    window.moveTo(row, row % chunk_rows);
    for (const Prediction& p : predictions) {
      std::byte* at = columns[p.column].data() + row * row_bytes[p.column];
      for (const bool later : {false, true}) {
        if (later && p.later.empty()) break;
        p.expect(window, later, expected.data());
        for (std::size_t i = 0; i < p.width; ++i) {
          if (!p.later.empty() && p.later[i] != later) continue;
          std::uint64_t bits = 0;
          std::memcpy(&bits, at + i * sizeof bits, sizeof bits);
          bits = unpackedNumber(p, i, bits, expected[i]);
          std::memcpy(at + i * sizeof bits, &bits, sizeof bits);
        }
      }
    }
  }
}

}  // namespace wholehand::recording
