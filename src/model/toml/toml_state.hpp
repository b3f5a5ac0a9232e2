#pragma once

// Private to toml_*.cpp: only these use toml++.

#include "model/toml/toml_file.hpp"

#include <toml++/toml.h>

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace wholehand {

/// State shared by all tables of a file.
struct TomlFile::Shared {
  std::string path;
  toml::table document;
  Diagnostics faults;
  std::vector<std::shared_ptr<TomlTable::State>> tables;  ///< every table requested, in order
  std::unordered_map<const toml::table*, std::shared_ptr<TomlTable::State>> states;  ///< of them
};

/// Reading state of one table.
struct TomlTable::State {
  struct Missing {
    std::string key;
    std::string remedy;
  };

  TomlFile::Shared* file = nullptr;
  const toml::table* table = nullptr;  ///< null for a missing required table
  std::string path;
  int line = 0;
  bool rest_skipped = false;
  std::set<std::string, std::less<>> known;   ///< keys the program understands
  std::set<std::string, std::less<>> faulty;  ///< keys with a reported fault
  std::vector<Missing> missing;  ///< reported at the end unless a misspelling explains them

  [[nodiscard]] const toml::node* find(std::string_view key) const {
    return table == nullptr ? nullptr : table->get(key);
  }
  [[nodiscard]] std::string keyPath(std::string_view key) const;
  /// Line of the key (of the table if the key is absent).
  [[nodiscard]] int lineOf(std::string_view key) const;
  void report(std::string_view key, DiagnosticCode code, std::string value, std::string problem,
              std::string remedy);
  /// The node of a required key; null (and noted) when it is missing.
  const toml::node* require(std::string_view key, const std::string& remedy);
  std::shared_ptr<State> child(const toml::table* node, std::string child_path, int child_line);
};

/// Limit of a name's length [characters].
inline constexpr std::size_t kLongestText = 200;

/// The file's text of a value, for a message: one line, truncated.
[[nodiscard]] std::string nodeText(const toml::node& node);
/// "is a text", "is a table", ... for a message about a wrong type.
[[nodiscard]] std::string typeProblem(const toml::node& node);
/// Number of a node, integer or float; empty for any other type.
[[nodiscard]] std::optional<double> asNumber(const toml::node& node);
/// A value that the rule allows, to continue with after a fault.
[[nodiscard]] double harmless(const NumberRule& rule);
/// "is out of range" or "is not finite".
[[nodiscard]] std::string numberProblem(double value);

}  // namespace wholehand
