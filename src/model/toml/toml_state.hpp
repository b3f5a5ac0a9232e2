#pragma once

// Private to toml_*.cpp: the only place that sees toml++.

#include "model/toml/toml_file.hpp"

#include <toml++/toml.h>

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace wholehand {

/// What all tables of one file share.
struct TomlFile::Shared {
  std::string path;
  toml::table document;
  Diagnostics faults;
  std::vector<std::shared_ptr<TomlTable::State>> tables;  ///< every table that was asked for
};

/// What is known about one table while it is read.
struct TomlTable::State {
  struct Missing {
    std::string key;
    std::string remedy;
  };

  TomlFile::Shared* file = nullptr;
  const toml::table* table = nullptr;  ///< null for a required table that is not there
  std::string path;
  int line = 0;
  bool rest_skipped = false;
  std::set<std::string, std::less<>> known;   ///< keys the program understands
  std::set<std::string, std::less<>> faulty;  ///< keys something was reported about
  std::vector<Missing> missing;  ///< reported at the end, when no misspelling explains them

  [[nodiscard]] const toml::node* find(std::string_view key) const {
    return table == nullptr ? nullptr : table->get(key);
  }
  [[nodiscard]] std::string keyPath(std::string_view key) const;
  /// Line of the key (or of the table when it has none).
  [[nodiscard]] int lineOf(std::string_view key) const;
  void report(std::string_view key, std::string value, std::string problem, std::string remedy);
  /// The node of a key that must be there; null (and noted) when it is not.
  const toml::node* require(std::string_view key, const std::string& remedy);
  std::shared_ptr<State> child(const toml::table* node, std::string child_path, int child_line);
};

/// Of a text that names something, in characters.
inline constexpr std::size_t kLongestText = 200;

/// What stands in a file, for a message: one line, not too long.
[[nodiscard]] std::string nodeText(const toml::node& node);
/// "is a text", "is a table", ... for a message about a wrong type.
[[nodiscard]] std::string typeProblem(const toml::node& node);
/// The number of a node, whole or not; nothing for any other type.
[[nodiscard]] std::optional<double> asNumber(const toml::node& node);
/// Something the rule allows, to go on with after a fault.
[[nodiscard]] double harmless(const NumberRule& rule);
/// "is out of range" or "is not finite".
[[nodiscard]] std::string numberProblem(double value);

}  // namespace wholehand
