#pragma once

#include "loop/core/expected.hpp"

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

/// Allowed values of a number. Non-finite numbers are always refused.
struct NumberRule {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool open_lower = false;  ///< the lower bound itself is excluded
  std::string unit;         ///< for messages: "N", "m", "rad"; may be empty

  [[nodiscard]] bool allows(double value) const noexcept;
  /// "must be in (0, 1000] N"
  [[nodiscard]] std::string remedy() const;
};
/// lower <= number <= upper
[[nodiscard]] NumberRule between(double lower, double upper, std::string unit = {});
/// lower < number <= upper
[[nodiscard]] NumberRule above(double lower, double upper, std::string unit = {});

/// One table of a TOML file under strict reading. A light handle: copies refer to the same table.
///
/// Each getter marks its key as known, reports any fault of it (missing, wrong type, not finite,
/// out of range) to the file, and then returns a harmless value, so that reading continues and
/// finds every fault. A getter with a fallback accepts a missing key. TomlFile::finish() reports
/// keys that no getter requested. Not real-time safe.
class TomlTable {
 public:
  [[nodiscard]] bool has(std::string_view key) const;
  /// True when the key is present and has no reported fault. Checks that compare keys call it
  /// first.
  [[nodiscard]] bool isGood(std::string_view key) const;
  /// Marks a key as allowed. @return whether it is present
  bool allowKey(std::string_view key);
  /// Keys of a table in file order, for tables whose keys are names (`[reference]`).
  [[nodiscard]] std::vector<std::string> keys() const;

  double number(std::string_view key, const NumberRule& rule);
  double number(std::string_view key, const NumberRule& rule, double fallback);
  std::int64_t integer(std::string_view key, std::int64_t lower, std::int64_t upper);
  std::int64_t integer(std::string_view key, std::int64_t lower, std::int64_t upper,
                       std::int64_t fallback);
  bool flag(std::string_view key);
  bool flag(std::string_view key, bool fallback);
  /// A non-empty text.
  std::string text(std::string_view key);
  std::string text(std::string_view key, std::string_view fallback);
  /// One of the given words; the first one after a fault.
  std::string choice(std::string_view key, const std::vector<std::string>& words);
  std::string choice(std::string_view key, const std::vector<std::string>& words,
                     std::string_view fallback);
  /// An array of exactly `count` numbers, each within the rule.
  std::vector<double> numbers(std::string_view key, std::size_t count, const NumberRule& rule);
  std::vector<double> numbers(std::string_view key, std::size_t count, const NumberRule& rule,
                              const std::vector<double>& fallback);
  /// An array of 1 to `most` numbers, each within the rule.
  std::vector<double> numbersUpTo(std::string_view key, std::size_t most, const NumberRule& rule);
  /// A square matrix: an array of `size` rows of `size` numbers, each within the rule. Row-major.
  std::vector<double> matrix(std::string_view key, std::size_t size, const NumberRule& rule);
  /// [lower, upper] with lower < upper, both within the rule.
  std::array<double, 2> interval(std::string_view key, const NumberRule& rule);
  /// An array of non-empty texts.
  std::vector<std::string> texts(std::string_view key);

  /// The table `[key]`; required.
  TomlTable table(std::string_view key);
  /// The table `[key]`, if present.
  std::optional<TomlTable> optionalTable(std::string_view key);
  /// Every `[[key]]`; at least `minimum` of them.
  std::vector<TomlTable> tables(std::string_view key, std::size_t minimum);

  /// Reports a fault of a key's value (or of the table, when the key is empty or absent).
  void fail(std::string_view key, std::string problem, std::string remedy,
            DiagnosticCode code = DiagnosticCode::kInvalid);
  /// If the table has the key `wrong`, reports that it must be `right`, and why; `right` is then
  /// not reported as missing. Keys that differ only in their unit (range_m, range_rad) need no such
  /// call.
  void refuse(std::string_view wrong, std::string_view right, std::string reason);

  /// Suppresses reports of unknown keys of this table. Used after a fault that leaves open which
  /// keys are allowed.
  void ignoreUnknownKeys();

  /// Key path of the table ("axes[finger_flexion]"); empty for the root.
  [[nodiscard]] std::string path() const;
  /// 1-based line of the table's start; 0: unknown.
  [[nodiscard]] int line() const;
  /// 1-based line of a key; the table's line if the key is absent.
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
  /// Version that every file must state.
  static constexpr std::int64_t kVersion = 1;

  TomlFile(const std::string& path, std::string_view kind);
  /// The same for a text that stands in no file. @param path name in faults
  TomlFile(const std::string& path, std::string_view kind, std::string_view text);

  /// False when the file cannot be read; finish() returns the reason.
  [[nodiscard]] bool readable() const noexcept { return readable_; }
  /// @pre readable()
  [[nodiscard]] TomlTable& root() { return *root_; }
  /// Adds the unknown keys (with the nearest known key, or the key of the right unit) and returns
  /// every fault in file order.
  [[nodiscard]] Diagnostics finish();

 private:
  struct Shared;
  friend class TomlTable;
  void begin(std::string_view kind);
  std::shared_ptr<Shared> shared_;
  std::optional<TomlTable> root_;
  bool readable_ = false;
};

/// Reads a file of one kind into a `Model`: stores the path and calls `read(root, model)`. Returns
/// the model, or every fault.
template <class Model, class Read>
[[nodiscard]] Expected<Model> readTomlFile(const std::string& path, std::string_view kind,
                                           Read read) {
  TomlFile file(path, kind);
  if (!file.readable()) return file.finish();
  Model model;
  model.path = path;
  read(file.root(), model);
  if (Diagnostics faults = file.finish(); !faults.empty()) return faults;
  return model;
}

/// The kind that a file states ("hand", "device", "rendering", "patient", "scene", ...). The rest
/// of the file is not checked.
[[nodiscard]] Expected<std::string> fileKind(const std::string& path);

/// The most similar of `words`; empty when none is similar.
[[nodiscard]] std::string nearestWord(std::string_view word, const std::vector<std::string>& words);

/// The most similar of `words`, with preference for words that are not in `used`: a misspelt name
/// rarely means a name that is also present.
[[nodiscard]] std::string nearestUnused(std::string_view word,
                                        const std::vector<std::string>& words,
                                        const std::vector<std::string>& used);

/// Shortest text that reads back to the same double.
[[nodiscard]] std::string formatNumber(double value);

/// Rejects, before parsing, a text with too many keys, tables or nesting levels: the parser
/// recurses for each level, and each look-up searches all keys of a table. Empty when within
/// bounds.
[[nodiscard]] std::optional<Diagnostic> beyondBounds(std::string_view toml,
                                                     const std::string& path);

}  // namespace wholehand
