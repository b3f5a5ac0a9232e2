#include "model/toml/toml_file.hpp"

#include "model/toml/toml_bounds.hpp"
#include "model/toml/toml_state.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>
#include <sstream>

namespace wholehand {
namespace {

/// A configuration is written by a person; a larger file was given by mistake.
constexpr std::uintmax_t kLargestFile_bytes = 4U << 20U;

/// Unit endings of keys, longest first, so that range_m and range_rad are recognised as one
/// quantity.
constexpr std::array<std::string_view, 37> kUnitEndings = {
    "_nm_s_rad", "_n_s_m", "_rad_s2",  "_kg_m2", "_deg_s",  "_rad_s", "_mm_s",    "_nm_rad",
    "_n_rad",    "_kg_m3", "_tip_n",   "_n_deg", "_per_s2", "_per_s", "_m_s2",    "_n_mm",
    "_m_s",      "_n_m",   "_tip_n_s", "_nm_s",  "_n_s",    "_ticks", "_samples", "_rad",
    "_deg",      "_nm",    "_mm",      "_cm",    "_um",     "_khz",   "_hz",      "_ms",
    "_kg",       "_g",     "_n",       "_m",     "_s"};

std::string_view stem(std::string_view key) {
  for (std::string_view ending : kUnitEndings) {
    if (key.size() > ending.size() && key.ends_with(ending)) {
      return key.substr(0, key.size() - ending.size());
    }
  }
  return key;
}

std::size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above_left = diagonal;
      diagonal = row[j];
      row[j] =
          std::min({row[j] + 1, row[j - 1] + 1, above_left + (a[i - 1] == b[j - 1] ? 0U : 1U)});
    }
  }
  return row[b.size()];
}

/// Reads the whole file; on failure `fault` says why.
std::optional<std::string> readText(const std::string& path, Diagnostic& fault) {
  fault.file = path;
  fault.code = DiagnosticCode::kUnreadable;
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::is_directory(status)) {
    fault.problem = "is a folder";
    fault.remedy = "name a .toml file in it";
    return std::nullopt;
  }
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
      !std::filesystem::is_fifo(status)) {  // /dev/zero is endless
    fault.problem = "is not a file";
    fault.remedy = "name a .toml file";
    return std::nullopt;
  }
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) {
    fault.problem = std::string("cannot be opened: ") + std::strerror(errno);
    fault.remedy = "check the path and that the file may be read";
    return std::nullopt;
  }
  std::string text;
  std::array<char, 16384> block;
  while (text.size() <= kLargestFile_bytes) {  // the size of a pipe is unknown
    stream.read(block.data(), block.size());
    if (stream.gcount() == 0) break;
    text.append(block.data(), stream.gcount());
  }
  if (text.size() > kLargestFile_bytes) {
    fault.problem = "is larger than 4 MB";
    fault.remedy = "name a configuration file";
    return std::nullopt;
  }
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) {
    fault.problem = "is empty";
    fault.remedy = "copy a file of the same kind from config/ and change it";
    return std::nullopt;
  }
  return text;
}

std::optional<toml::table> parseFile(const std::string& path, Diagnostics& faults) {
  Diagnostic fault;
  const std::optional<std::string> text = readText(path, fault);
  if (!text) {
    faults.push_back(std::move(fault));
    return std::nullopt;
  }
  if (std::optional<Diagnostic> beyond = beyondBounds(*text, path)) {
    faults.push_back(std::move(*beyond));
    return std::nullopt;
  }
  try {
    return toml::parse(*text, path);
  } catch (const toml::parse_error& error) {
    fault.line = static_cast<int>(error.source().begin.line);
    fault.code = DiagnosticCode::kSyntax;
    fault.problem = "is not TOML: " + std::string(error.description());
    fault.remedy = "correct this line (syntax of TOML: https://toml.io)";
    faults.push_back(std::move(fault));
    return std::nullopt;
  }
}

/// Probable meaning of an unknown key.
struct Meant {
  std::string key;
  bool unit = false;  ///< same quantity in another unit
};

/// @param used keys present in the table
Meant meantKey(std::string_view unknown, const std::vector<std::string>& known,
               const std::vector<std::string>& used) {
  for (const std::string& candidate : known) {
    if (stem(candidate) == stem(unknown)) return {candidate, true};
  }
  return {nearestUnused(unknown, known, used), false};
}

}  // namespace

std::string nearestWord(std::string_view word, const std::vector<std::string>& words) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : words) {
    const bool begins = std::min(word.size(), candidate.size()) >= 3 &&
                        (word.starts_with(candidate) || candidate.starts_with(word));
    const std::size_t lengths =
        std::max(word.size(), candidate.size()) - std::min(word.size(), candidate.size());
    if (!begins && lengths >= best_distance) continue;  // no distance is smaller than that
    const std::size_t distance = begins ? 1 : editDistance(word, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

std::string nearestUnused(std::string_view word, const std::vector<std::string>& words,
                          const std::vector<std::string>& used) {
  std::vector<std::string> free;
  std::copy_if(words.begin(), words.end(), std::back_inserter(free), [&](const std::string& w) {
    return std::find(used.begin(), used.end(), w) == used.end();
  });
  const std::string near = nearestWord(word, free);
  return near.empty() ? nearestWord(word, words) : near;
}

std::string formatNumber(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), end.ptr};
}

TomlFile::TomlFile(const std::string& path, std::string_view kind)
    : shared_(std::make_shared<Shared>()) {
  shared_->path = path;
  std::optional<toml::table> document = parseFile(path, shared_->faults);
  if (!document) return;
  shared_->document = std::move(*document);
  auto state = std::make_shared<TomlTable::State>();
  state->file = shared_.get();
  state->table = &shared_->document;
  state->line = 1;
  shared_->tables.push_back(state);
  root_ = TomlTable(state);
  readable_ = true;

  // A file of another kind or version has other keys: further messages would mislead.
  const std::string found = root_->text("kind", kind);
  if (!root_->has("kind")) {
    state->missing.push_back({"kind", "write kind = \"" + std::string(kind) + "\""});
  } else if (root_->isGood("kind") && found != kind) {
    root_->fail("kind", "is another kind of file",
                std::string(kind == "exercise" ? "an " : "a ") + std::string(kind) +
                    " file is expected here",
                DiagnosticCode::kType);
    readable_ = false;
  }
  const std::int64_t version = root_->integer("version", std::numeric_limits<std::int64_t>::min(),
                                              std::numeric_limits<std::int64_t>::max());
  if (root_->isGood("version") && version != kVersion) {
    root_->fail("version", "is not known to this program",
                "write version = " + std::to_string(kVersion) + " and the keys that go with it",
                DiagnosticCode::kVersion);
    readable_ = false;
  }
}

Diagnostics TomlFile::finish() {
  for (const auto& state : shared_->tables) {
    const std::vector<std::string> known(state->known.begin(), state->known.end());
    const std::vector<std::string> used = TomlTable(state).keys();
    std::set<std::string, std::less<>> explained;
    if (readable_ && state->table != nullptr && !state->rest_skipped) {
      for (const auto& [key, node] : *state->table) {
        if (state->known.contains(key.str())) continue;
        const Meant meant = meantKey(key.str(), known, used);
        std::string remedy = "remove it";
        if (!meant.key.empty()) {
          remedy = meant.unit ? "the key for this quantity and its unit is " + meant.key
                              : "did you mean " + meant.key + "?";
          explained.insert(meant.key);
        }
        state->report(key.str(), DiagnosticCode::kUnknown, nodeText(node),
                      meant.unit ? "has the wrong unit" : "is unknown", std::move(remedy));
      }
    }
    for (const auto& [key, remedy] : state->missing) {
      if (readable_ && !explained.contains(key))
        state->report(key, DiagnosticCode::kMissing, "", "is missing", remedy);
    }
    state->missing.clear();
  }
  Diagnostics faults = std::move(shared_->faults);
  shared_->faults.clear();
  std::stable_sort(faults.begin(), faults.end(),
                   [](const Diagnostic& a, const Diagnostic& b) { return a.line < b.line; });
  return firstFaults(std::move(faults), shared_->path);
}

Expected<std::string> fileKind(const std::string& path) {
  Diagnostics faults;
  const std::optional<toml::table> document = parseFile(path, faults);
  if (!document) return faults;
  const toml::node* node = document->get("kind");
  if (node != nullptr && node->is_string()) return node->as_string()->get();
  Diagnostic fault;
  fault.file = path;
  fault.key = "kind";
  fault.line = node == nullptr ? 1 : static_cast<int>(node->source().begin.line);
  fault.value = node == nullptr ? "" : nodeText(*node);
  fault.code = node == nullptr ? DiagnosticCode::kMissing : DiagnosticCode::kType;
  fault.problem = node == nullptr ? "is missing" : typeProblem(*node);
  fault.remedy =
      "write kind = \"hand\", \"device\", \"rendering\", \"patient\", \"scene\" or \"exercise\"";
  return fault;
}

}  // namespace wholehand
