#include "telemetry/prediction.hpp"

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

// 0, -1, 1, -2 ... becomes 0, 1, 2, 3 ...: small differences have small bytes.
std::uint64_t folded(std::uint64_t difference) {
  return (difference << 1U) ^ (std::uint64_t{0} - (difference >> 63U));
}
std::uint64_t unfolded(std::uint64_t number) {
  return (number >> 1U) ^ (std::uint64_t{0} - (number & 1U));
}

}  // namespace

void packRows(const std::vector<Prediction>& predictions, const RowBytes& columns,
              const std::vector<std::size_t>& row_bytes, std::uint64_t chunk_rows,
              std::uint64_t begin, std::uint64_t end, RowBytes& packed) {
  const PlainArithmetic plain;
  RowWindow window(columns, row_bytes);
  std::vector<std::uint64_t> expected;
  for (const Prediction& p : predictions) {
    expected.resize(p.width);
    std::vector<std::byte>& out = packed[p.column];
    out.resize((end - begin) * row_bytes[p.column]);
    std::byte* to = out.data();
    for (std::uint64_t row = begin - begin % chunk_rows; row < end; ++row) {
      window.moveTo(row, row % chunk_rows);
      p.expect(window, expected.data());
      if (row < begin) continue;  // the rule learns from it
      for (std::size_t i = 0; i < p.width; ++i, to += sizeof(std::uint64_t)) {
        const auto bits = window.number<std::uint64_t>(p.column, i);
        const std::uint64_t number = folded(bits - expected[i]);
        std::memcpy(to, &number, sizeof number);
      }
    }
  }
}

void unpackRows(const std::vector<Prediction>& predictions, RowBytes& columns,
                const std::vector<std::size_t>& row_bytes, std::uint64_t chunk_rows,
                std::uint64_t rows) {
  const PlainArithmetic plain;
  RowWindow window(columns, row_bytes);
  std::vector<std::uint64_t> expected;
  for (const Prediction& p : predictions) {
    expected.resize(p.width);
    std::byte* at = columns[p.column].data();
    for (std::uint64_t row = 0; row < rows; ++row) {
      window.moveTo(row, row % chunk_rows);
      p.expect(window, expected.data());
      for (std::size_t i = 0; i < p.width; ++i, at += sizeof(std::uint64_t)) {
        std::uint64_t bits = 0;
        std::memcpy(&bits, at, sizeof bits);
        bits = unfolded(bits) + expected[i];
        std::memcpy(at, &bits, sizeof bits);
      }
    }
  }
}

}  // namespace wholehand::recording
