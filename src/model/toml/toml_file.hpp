#pragma once

#include "core/expected.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace wholehand {

/// Which numbers a key may hold. Non-finite numbers are refused whatever the rule.
struct NumberRule {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool open_lower = false;  ///< the lower bound itself is not allowed
  std::string unit;         ///< for messages: "N", "m", "rad"; may be empty

  [[nodiscard]] bool allows(double value) const noexcept;
  /// "must be in (0, 1000] N"
  [[nodiscard]] std::string remedy() const;
};
/// lower <= number <= upper
[[nodiscard]] NumberRule between(double lower, double upper, std::string unit = {});
/// lower < number <= upper
[[nodiscard]] NumberRule above(double lower, double upper, std::string unit = {});

/// One table of a TOML file under strict reading. A light handle: copies speak of the same table.
///
/// Each getter marks its key as known, reports what is wrong with it (missing, wrong type, not
/// finite, out of range) to the file, and returns something harmless in that case, so that reading
/// goes on and every fault of the file is found. A getter with a fallback does not mind a missing
/// key. Keys that no getter asked for are reported by TomlFile::finish(). Not for the tick.
class TomlTable {
 public:
  [[nodiscard]] bool has(std::string_view key) const;
  /// True when the key is there and nothing was reported about it: guards checks across keys.
  [[nodiscard]] bool good(std::string_view key) const;
  /// Says that the key may stand here. @return whether it does
  bool mayHave(std::string_view key);
  /// The keys of a table in the order of the file, for tables whose keys are names (`[reference]`).
  [[nodiscard]] std::vector<std::string> keys() const;

  double number(std::string_view key, const NumberRule& rule);
  double number(std::string_view key, const NumberRule& rule, double fallback);
  std::int64_t integer(std::string_view key, std::int64_t lower, std::int64_t upper);
  std::int64_t integer(std::string_view key, std::int64_t lower, std::int64_t upper,
                       std::int64_t fallback);
  bool flag(std::string_view key);
  bool flag(std::string_view key, bool fallback);
  /// A text that is not empty.
  std::string text(std::string_view key);
  std::string text(std::string_view key, std::string_view fallback);
  /// One of the given words; the first one when the file is wrong.
  std::string choice(std::string_view key, const std::vector<std::string>& words);
  std::string choice(std::string_view key, const std::vector<std::string>& words,
                     std::string_view fallback);
  /// An array of exactly `count` numbers, each within the rule.
  std::vector<double> numbers(std::string_view key, std::size_t count, const NumberRule& rule);
  std::vector<double> numbers(std::string_view key, std::size_t count, const NumberRule& rule,
                              const std::vector<double>& fallback);
  /// A square matrix as an array of `size` rows of `size` numbers, each within the rule; row by
  /// row.
  std::vector<double> matrix(std::string_view key, std::size_t size, const NumberRule& rule);
  /// [lower, upper] with lower < upper, both within the rule.
  std::array<double, 2> interval(std::string_view key, const NumberRule& rule);
  /// An array of texts that are not empty.
  std::vector<std::string> texts(std::string_view key);

  /// The table `[key]`, which must be there.
  TomlTable table(std::string_view key);
  /// The table `[key]` where there is one.
  std::optional<TomlTable> optionalTable(std::string_view key);
  /// Every `[[key]]`; at least `minimum` of them.
  std::vector<TomlTable> tables(std::string_view key, std::size_t minimum);

  /// Reports a fault of a key's value (or of the table, when the key is empty or absent).
  void fail(std::string_view key, std::string problem, std::string remedy);
  /// When `wrong` stands in the table: says to write `right` instead, and why; `right` is then not
  /// reported as missing as well. Keys that differ only in their unit (range_m, range_rad) are
  /// recognised without this.
  void refuse(std::string_view wrong, std::string_view right, std::string reason);

  /// Keys of this table that nobody asked for are not reported: after a fault that leaves open
  /// which keys belong here.
  void skipRest();

  /// Key path of the table ("axes[finger_flexion]"); empty for the file itself.
  [[nodiscard]] std::string path() const;
  /// 1-based line where the table starts; 0 when unknown.
  [[nodiscard]] int line() const;
  /// 1-based line of a key; that of the table where it has none.
  [[nodiscard]] int lineOf(std::string_view key) const;

 private:
  friend class TomlFile;
  struct State;
  explicit TomlTable(std::shared_ptr<State> state);
  std::shared_ptr<State> state_;
};

/// A TOML file under strict reading: opens it, checks `kind` and `version`, collects faults.
///
///     TomlFile file(path, "device");
///     if (!file.readable()) return file.finish();       // cannot go on: no such file, other kind
///     TomlTable& root = file.root();
///     model.name = root.text("name");
///     for (TomlTable& axis : root.tables("axes", 1)) {
///       axis_model.mass = axis.number("mass_kg", above(0.0, 100.0, "kg"));
///     }
///     if (Diagnostics faults = file.finish(); !faults.empty()) return faults;
class TomlFile {
 public:
  /// The version every file must state.
  static constexpr std::int64_t kVersion = 1;

  TomlFile(const std::string& path, std::string_view kind);

  /// False when there is nothing to read: finish() says why.
  [[nodiscard]] bool readable() const noexcept { return readable_; }
  /// @pre readable()
  [[nodiscard]] TomlTable& root() { return *root_; }
  /// Adds the keys that nobody asked for (with the nearest known key, or the key of the right unit)
  /// and returns every fault, in the order of the file.
  [[nodiscard]] Diagnostics finish();

 private:
  struct Shared;
  friend class TomlTable;
  std::shared_ptr<Shared> shared_;
  std::optional<TomlTable> root_;
  bool readable_ = false;
};

/// What kind of file this is ("hand", "device", "rendering", "patient", "scene", ...), as it says
/// itself. Says nothing about whether the rest of it is right.
[[nodiscard]] Expected<std::string> fileKind(const std::string& path);

/// The word of `words` that is spelled most like `word`; empty when none is near.
[[nodiscard]] std::string nearestWord(std::string_view word, const std::vector<std::string>& words);

/// The same, of the words that are not in `used` where one of them is near: a misspelt name rarely
/// stands for one that is there as well.
[[nodiscard]] std::string nearestUnused(std::string_view word,
                                        const std::vector<std::string>& words,
                                        const std::vector<std::string>& used);

/// A number for people: shortest form that reads back to the same double.
[[nodiscard]] std::string formatNumber(double value);

}  // namespace wholehand
