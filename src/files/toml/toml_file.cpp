#include "files/toml/toml_file.hpp"

#include "files/foreign/foreign_file.hpp"
#include "loop/core/printable.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

/// This is the only source file that uses toml++.
namespace wholehand {

/// State shared by all tables of a file.
struct TomlFile::Shared {
  std::string path;
  toml::table document;
  Diagnostics faults;
  std::vector<std::shared_ptr<TomlTable::State>> tables;  ///< every table requested, in order
  std::unordered_map<const toml::table*, std::shared_ptr<TomlTable::State>>
      states;  ///< state of each TOML table
};

/// Reading state of one table.
struct TomlTable::State {
  struct MissingKey {
    std::string key;
    std::string remedy;
  };

  TomlFile::Shared* file = nullptr;
  const toml::table* table = nullptr;  ///< null for a missing required table
  std::string path;
  int line = 0;
  bool rest_skipped = false;
  std::set<std::string, std::less<>> known;   ///< keys that a getter asked for
  std::set<std::string, std::less<>> faulty;  ///< keys with a reported fault
  std::vector<MissingKey>
      missing;  ///< missing keys, reported at the end unless a misspelling explains them

  [[nodiscard]] const toml::node* find(std::string_view key) const {
    return table == nullptr ? nullptr : table->get(key);
  }
  [[nodiscard]] std::string keyPath(std::string_view key) const;
  /// Line of the key, or of the table if the key is absent.
  [[nodiscard]] int lineOf(std::string_view key) const;
  void report(std::string_view key, DiagnosticCode code, std::string value, std::string problem,
              std::string remedy);
  /// The node of a required key; null when it is missing, which is noted in `missing`.
  const toml::node* require(std::string_view key, const std::string& remedy);
  std::shared_ptr<State> child(const toml::table* node, std::string child_path, int child_line);
};

namespace {

/// Limit of a name's length [characters].
constexpr std::size_t kLongestText = 200;

std::string wholeText(const toml::node& node) {
  if (node.is_table()) return "{...}";
  if (const auto* number = node.as_floating_point()) return formatNumber(number->get());
  std::ostringstream out;
  if (const toml::array* array = node.as_array()) {
    out << '[';
    for (std::size_t i = 0; i < array->size(); ++i) {
      out << (i == 0 ? "" : ", ") << wholeText((*array)[i]);
    }
    out << ']';
  } else if (const auto* string = node.as_string()) {
    out << '"' << string->get() << '"';
  } else {
    node.visit([&](const auto& value) { out << value; });
  }
  return out.str();
}

/// Number of a node, integer or float; empty for any other type.
std::optional<double> asNumber(const toml::node& node) {
  if (const auto* integer = node.as_integer()) return static_cast<double>(integer->get());
  if (const auto* floating = node.as_floating_point()) return floating->get();
  return std::nullopt;
}

/// A value that the rule allows; reading continues with it after a fault.
double harmless(const NumberRule& rule) {
  if (rule.allows(0.0)) return 0.0;
  if (std::isfinite(rule.upper)) return rule.upper;
  return std::isfinite(rule.lower) ? rule.lower + 1.0 : 0.0;
}

/// "is out of range" or "is not finite".
std::string numberProblem(double value) {
  return std::isfinite(value) ? "is out of range" : "is not finite";
}

/// A value as written in the file, shortened to one line for a message.
std::string nodeText(const toml::node& node) {
  std::string text = wholeText(node);
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20; }, ' ');
  constexpr std::size_t kLongest = 60;
  if (text.size() > kLongest) {
    std::size_t end = kLongest;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U)
      --end;  // keeps UTF-8 characters complete
    text = text.substr(0, end) + "...";
  }
  return text;
}

/// "is a text", "is a table", ... for a message about a wrong type.
std::string typeProblem(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::string:
      return "is a text";
    case toml::node_type::integer:
    case toml::node_type::floating_point:
      return "is a number";
    case toml::node_type::boolean:
      return "is true or false";
    case toml::node_type::array:
      return "is an array";
    case toml::node_type::table:
      return "is a table";
    default:
      return "is a date or time";
  }
}

std::string quotedList(const std::vector<std::string>& words) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) out += i + 1 == words.size() ? " or " : ", ";
    out += "\"" + words[i] + "\"";
  }
  return out;
}

// Bounds of a file. The largest file of the project has 140 keys; a scene of 1,024 bodies has some
// 7,000.
constexpr int kMostKeys = 12000, kMostTables = 1200, kMostInlineTables = 12000, kMostLevels = 32;

/// Scans TOML for brackets, dots and keys only; skips quoted text and comments (toml.io, v1.0.0).
class Counter {
 public:
  explicit Counter(std::string_view text) : text_(text) {}

  /// Scans until a bound is exceeded. Returns false at the end of the text.
  bool findBeyond() {
    while (at_ < text_.size()) {
      take(text_[at_]);
      if (problem_ != nullptr) return true;
      ++at_;
    }
    return false;
  }
  [[nodiscard]] int line() const { return line_; }
  [[nodiscard]] const char* problem() const { return problem_; }

 private:
  void take(char c) {
    switch (c) {
      case '"':
      case '\'':
        skipQuoted(c);
        break;
      case '#':
        at_ = std::min(text_.find('\n', at_), text_.size()) - 1;
        break;
      case '\n':
        ++line_;
        dots_ = 0;
        line_is_empty_ = true;
        return;
      case '{':
        if (++inline_tables_ > kMostInlineTables) problem_ = "has more than 12000 inline tables";
        [[fallthrough]];
      case '[':
        open();
        break;
      case ']':
      case '}':
        depth_ = std::max(0, depth_ - 1);
        break;
      case '.':
        if (++dots_ > kMostLevels) problem_ = "has a key of more than 32 parts";
        break;
      case '=':
        dots_ = 0;
        if (++keys_ > kMostKeys) problem_ = "has more than 12000 keys";
        break;
      case ',':
        dots_ = 0;
        break;
      default:
        break;
    }
    if (c != ' ' && c != '\t' && c != '\r') line_is_empty_ = false;
  }
  void open() {
    if (line_is_empty_ && depth_ == 0 && ++tables_ > kMostTables) {
      problem_ = "has more than 1200 tables";
    }
    if (++depth_ > kMostLevels) problem_ = "has more than 32 nested levels";
  }
  // Skips to the closing quote.
  void skipQuoted(char quote) {
    const std::string_view three(quote == '"' ? "\"\"\"" : "'''");
    const bool many_lines = text_.substr(at_, 3) == three;
    at_ += many_lines ? 3 : 1;
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '\n') {
        ++line_;
        if (!many_lines) return;  // the parser will report the error
      }
      if (c == '\\' && quote == '"') {
        ++at_;
      } else if (c == quote && (!many_lines || text_.substr(at_, 3) == three)) {
        if (!many_lines) return;
        at_ += 2;
        // Up to two quotes directly before the closing ones belong to the text.
        for (int more = 0; more < 2 && text_.substr(at_ + 1, 1) == three.substr(0, 1); ++more)
          ++at_;
        return;
      }
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1, depth_ = 0, dots_ = 0, keys_ = 0, tables_ = 0, inline_tables_ = 0;
  bool line_is_empty_ = true;
  const char* problem_ = nullptr;
};

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
      !std::filesystem::is_fifo(status)) {  // a device such as /dev/zero is endless
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

/// True when a line holds a backslash within "...", as a path of Windows does.
bool hasWindowsPath(std::string_view text, int line) {
  for (int n = 1; n < line && !text.empty(); ++n) {
    text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  }
  text = text.substr(0, text.find('\n'));
  const std::size_t quote = text.find('"');
  return quote != text.npos && text.find('\\', quote) != text.npos;
}

/// True when the first line that is no comment holds commas and none of TOML's signs.
bool isTable(std::string_view text) {
  while (text.starts_with('#')) text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  const std::string_view line = text.substr(0, text.find('\n'));
  return line.find(',') != line.npos && line.find_first_of("=[{") == line.npos;
}

std::optional<toml::table> parseText(std::string_view text, const std::string& path,
                                     Diagnostics& faults) {
  Diagnostic fault;
  fault.file = path;
  if (std::optional<Diagnostic> foreign = foreignFile(text.substr(0, 4096), "")) {
    foreign->file = path;
    foreign->code = DiagnosticCode::kSyntax;
    faults.push_back(std::move(*foreign));
    return std::nullopt;
  }
  if (std::optional<Diagnostic> beyond = beyondBounds(text, path)) {
    faults.push_back(std::move(*beyond));
    return std::nullopt;
  }
  try {
    return toml::parse(text, path);
  } catch (const toml::parse_error& error) {
    // The extension of the name shows the format of another program.
    if (std::optional<Diagnostic> foreign = foreignFileAt(path)) {
      fault.problem = foreign->problem;
      fault.remedy = foreign->remedy;
      fault.code = DiagnosticCode::kSyntax;
      faults.push_back(std::move(fault));
      return std::nullopt;
    }
    fault.code = DiagnosticCode::kSyntax;
    if (isTable(text)) {
      fault.problem = "is a table (CSV)";
      fault.remedy = "a motion is given with --motion";
      faults.push_back(std::move(fault));
      return std::nullopt;
    }
    fault.line = static_cast<int>(error.source().begin.line);
    fault.problem = "is not TOML: " + std::string(error.description());
    fault.remedy = "correct this line (syntax of TOML: https://toml.io)";
    if (hasWindowsPath(text, fault.line)) {
      fault.problem = "has a backslash in \"...\", where it begins an escape";
      fault.remedy = "write / in place of \\, or put the path in '...'";
    }
    faults.push_back(std::move(fault));
    return std::nullopt;
  }
}

std::optional<toml::table> parseFile(const std::string& path, Diagnostics& faults) {
  Diagnostic fault;
  const std::optional<std::string> text = readText(path, fault);
  if (text) return parseText(*text, path, faults);
  faults.push_back(std::move(fault));
  return std::nullopt;
}

/// Probable meaning of an unknown key.
struct SuggestedKey {
  std::string key;
  bool unit = false;  ///< the unknown key is the same quantity in another unit
};

/// @param used keys present in the table
SuggestedKey meantKey(std::string_view unknown, const std::vector<std::string>& known,
                      const std::vector<std::string>& used) {
  for (const std::string& candidate : known) {
    if (stem(candidate) == stem(unknown)) return {candidate, true};
  }
  return {nearestUnused(unknown, known, used), false};
}

}  // namespace

// ---------------------------------------------------------------- rules

bool NumberRule::allows(double value) const noexcept {
  if (!std::isfinite(value)) return false;
  return (open_lower ? value > lower : value >= lower) && value <= upper;
}

std::string NumberRule::remedy() const {
  const std::string suffix = unit.empty() ? "" : " " + unit;
  const bool has_lower = std::isfinite(lower);
  const bool has_upper = std::isfinite(upper);
  if (!has_lower && !has_upper) {
    return "must be a finite number" + (unit.empty() ? "" : " of " + unit);
  }
  if (!has_upper) {
    return std::string("must be ") + (open_lower ? "> " : ">= ") + formatNumber(lower) + suffix;
  }
  if (!has_lower) return "must be <= " + formatNumber(upper) + suffix;
  return std::string("must be in ") + (open_lower ? "(" : "[") + formatNumber(lower) + ", " +
         formatNumber(upper) + "]" + suffix;
}

NumberRule between(double lower, double upper, std::string unit) {
  return {lower, upper, false, std::move(unit)};
}
NumberRule above(double lower, double upper, std::string unit) {
  return {lower, upper, true, std::move(unit)};
}

// ---------------------------------------------------------------- state

std::string TomlTable::State::keyPath(std::string_view key) const {
  if (key.empty()) return path;
  return path.empty() ? std::string(key) : path + "." + std::string(key);
}

int TomlTable::State::lineOf(std::string_view key) const {
  if (table != nullptr && !key.empty()) {
    const auto at = table->find(key);
    if (at != table->end()) return static_cast<int>(at->first.source().begin.line);
  }
  return line;
}

void TomlTable::State::report(std::string_view key, DiagnosticCode code, std::string value,
                              std::string problem, std::string remedy) {
  faulty.emplace(key);
  file->faults.push_back({file->path, lineOf(key), keyPath(key), std::move(value),
                          std::move(problem), std::move(remedy), code});
}

const toml::node* TomlTable::State::require(std::string_view key, const std::string& remedy) {
  known.emplace(key);
  const toml::node* node = find(key);
  // A missing table is reported once; its keys are not reported.
  const bool already_reported = std::any_of(missing.begin(), missing.end(),
                                            [&](const MissingKey& m) { return m.key == key; });
  if (node == nullptr && table != nullptr && !faulty.contains(key) && !already_reported) {
    missing.push_back({std::string(key), remedy});
  }
  return node;
}

std::shared_ptr<TomlTable::State> TomlTable::State::child(const toml::table* node,
                                                          std::string child_path, int child_line) {
  if (const auto open = file->states.find(node); node != nullptr && open != file->states.end()) {
    return open->second;
  }
  auto state = std::make_shared<State>();
  state->file = file;
  state->table = node;
  state->path = std::move(child_path);
  state->line = child_line;
  file->tables.push_back(state);
  if (node != nullptr) file->states.emplace(node, state);
  return state;
}

// ---------------------------------------------------------------- scalar getters

TomlTable::TomlTable(std::shared_ptr<State> state) : state_(std::move(state)) {}

bool TomlTable::has(std::string_view key) const {
  return state_->find(key) != nullptr;
}
bool TomlTable::isGood(std::string_view key) const {
  return has(key) && !state_->faulty.contains(key);
}
bool TomlTable::allowKey(std::string_view key) {
  state_->known.emplace(key);
  return has(key);
}
std::string TomlTable::path() const {
  return state_->path;
}
int TomlTable::line() const {
  return state_->line;
}
int TomlTable::lineOf(std::string_view key) const {
  return state_->lineOf(key);
}

std::vector<std::string> TomlTable::keys() const {
  std::vector<std::pair<toml::source_position, std::string>> found;
  if (state_->table != nullptr) {
    for (const auto& [key, node] : *state_->table) {
      found.emplace_back(key.source().begin, std::string(key.str()));
    }
  }
  std::sort(found.begin(), found.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> names;
  for (auto& [position, name] : found) names.push_back(std::move(name));
  return names;
}

double TomlTable::number(std::string_view key, const NumberRule& rule) {
  const toml::node* node = state_->require(key, "write it; it " + rule.remedy());
  if (node == nullptr) return harmless(rule);
  const std::optional<double> value = asNumber(*node);
  if (!value) {
    state_->report(key, DiagnosticCode::kType, nodeText(*node), typeProblem(*node),
                   (node->is_string() ? "write a number without quotes; it " : "") + rule.remedy());
    return harmless(rule);
  }
  if (!rule.allows(*value)) {
    state_->report(key, DiagnosticCode::kRange, nodeText(*node), numberProblem(*value),
                   rule.remedy());
    return harmless(rule);
  }
  return *value;
}

double TomlTable::number(std::string_view key, const NumberRule& rule, double fallback) {
  state_->known.emplace(key);
  return has(key) ? number(key, rule) : fallback;
}

std::int64_t TomlTable::integer(std::string_view key, std::int64_t lower, std::int64_t upper) {
  const bool bounded = upper < std::numeric_limits<std::int64_t>::max();
  const std::string remedy = bounded ? "must be a whole number in [" + std::to_string(lower) +
                                           ", " + std::to_string(upper) + "]"
                                     : "must be a whole number";
  const toml::node* node = state_->require(key, "write it; it " + remedy);
  if (node == nullptr) return lower;
  const auto* value = node->as_integer();
  if (value == nullptr) {
    state_->report(key, DiagnosticCode::kType, nodeText(*node),
                   node->is_floating_point() ? "is not a whole number" : typeProblem(*node),
                   remedy);
    return lower;
  }
  if (value->get() < lower || value->get() > upper) {
    state_->report(key, DiagnosticCode::kRange, nodeText(*node), "is out of range", remedy);
    return lower;
  }
  return value->get();
}

std::int64_t TomlTable::integer(std::string_view key, std::int64_t lower, std::int64_t upper,
                                std::int64_t fallback) {
  state_->known.emplace(key);
  return has(key) ? integer(key, lower, upper) : fallback;
}

bool TomlTable::flag(std::string_view key) {
  const toml::node* node = state_->require(key, "write true or false");
  if (node == nullptr) return false;
  if (const auto* value = node->as_boolean()) return value->get();
  state_->report(key, DiagnosticCode::kType, nodeText(*node), typeProblem(*node),
                 "must be true or false, without quotes");
  return false;
}

bool TomlTable::flag(std::string_view key, bool fallback) {
  state_->known.emplace(key);
  return has(key) ? flag(key) : fallback;
}

std::string TomlTable::text(std::string_view key) {
  const toml::node* node = state_->require(key, "write a text in quotes");
  if (node == nullptr) return {};
  const auto* value = node->as_string();
  if (value == nullptr) {
    state_->report(key, DiagnosticCode::kType, nodeText(*node), typeProblem(*node),
                   "must be a text in quotes");
    return {};
  }
  if (value->get().empty())
    state_->report(key, DiagnosticCode::kMissing, "\"\"", "is empty", "write a text in quotes");
  if (!isPrintable(value->get(), kLongestText)) {
    state_->report(key, DiagnosticCode::kRange, nodeText(*node),
                   "is longer than 200 characters or holds control characters",
                   "write a text that can be shown in a list; of a path, write / in place of \\");
    return {};
  }
  return value->get();
}

std::string TomlTable::text(std::string_view key, std::string_view fallback) {
  state_->known.emplace(key);
  return has(key) ? text(key) : std::string(fallback);
}

std::string TomlTable::choice(std::string_view key, const std::vector<std::string>& words) {
  if (state_->require(key, "must be " + quotedList(words)) == nullptr) return words.front();
  std::string word = text(key);
  if (!isGood(key)) return words.front();
  if (std::find(words.begin(), words.end(), word) != words.end()) return word;
  state_->report(key, DiagnosticCode::kUnknown, "\"" + word + "\"", "is unknown",
                 "must be " + quotedList(words));
  return words.front();
}

std::string TomlTable::choice(std::string_view key, const std::vector<std::string>& words,
                              std::string_view fallback) {
  state_->known.emplace(key);
  return has(key) ? choice(key, words) : std::string(fallback);
}

// ---------------------------------------------------------------- faults

void TomlTable::fail(std::string_view key, std::string problem, std::string remedy,
                     DiagnosticCode code) {
  const toml::node* node = key.empty() ? nullptr : state_->find(key);
  // A list of tables has no value to show.
  if (node != nullptr && node->is_array_of_tables()) node = nullptr;
  state_->known.emplace(key);
  state_->report(key, code, node == nullptr ? "" : nodeText(*node), std::move(problem),
                 std::move(remedy));
}

void TomlTable::ignoreUnknownKeys() {
  state_->rest_skipped = true;
}

void TomlTable::refuse(std::string_view wrong, std::string_view right, std::string reason) {
  if (!has(wrong)) return;
  const toml::node* node = state_->find(wrong);
  state_->known.emplace(wrong);
  state_->report(wrong, DiagnosticCode::kUnknown, nodeText(*node), std::move(reason),
                 "write " + std::string(right));
  // This message already explains why the right key is missing.
  state_->faulty.emplace(right);
  std::erase_if(state_->missing, [&](const State::MissingKey& m) { return m.key == right; });
}

// ---------------------------------------------------------------- arrays

std::vector<double> TomlTable::numbers(std::string_view key, std::size_t count,
                                       const NumberRule& rule) {
  std::vector<double> out(count, harmless(rule));
  const std::string shape = "must be an array of " + std::to_string(count) + " numbers";
  const toml::node* node = state_->require(key, shape + "; each " + rule.remedy());
  if (node == nullptr) return out;
  const toml::array* array = node->as_array();
  if (array == nullptr || array->size() != count) {
    state_->report(key, DiagnosticCode::kType, nodeText(*node),
                   array == nullptr ? typeProblem(*node)
                                    : "has " + std::to_string(array->size()) +
                                          (array->size() == 1 ? " element" : " elements"),
                   shape);
    return out;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::optional<double> value = asNumber((*array)[i]);
    if (value && rule.allows(*value)) {
      out[i] = *value;
      continue;
    }
    const std::string which = "element " + std::to_string(i) + " ";
    state_->report(key, value ? DiagnosticCode::kRange : DiagnosticCode::kType, nodeText(*node),
                   which + (value ? numberProblem(*value) : typeProblem((*array)[i])),
                   "each " + rule.remedy());
    break;
  }
  return out;
}

std::vector<double> TomlTable::numbers(std::string_view key, std::size_t count,
                                       const NumberRule& rule,
                                       const std::vector<double>& fallback) {
  state_->known.emplace(key);
  return has(key) ? numbers(key, count, rule) : fallback;
}

std::vector<double> TomlTable::numbersUpTo(std::string_view key, std::size_t most,
                                           const NumberRule& rule) {
  const toml::node* node = state_->find(key);
  const toml::array* array = node == nullptr ? nullptr : node->as_array();
  if (array != nullptr && !array->empty() && array->size() <= most) {
    return numbers(key, array->size(), rule);
  }
  const std::string shape = "must be an array of 1 to " + std::to_string(most) + " numbers";
  node = state_->require(key, shape + "; each " + rule.remedy());
  if (node == nullptr) return {};
  state_->report(
      key, DiagnosticCode::kType, nodeText(*node),
      array == nullptr ? typeProblem(*node) : "has " + std::to_string(array->size()) + " elements",
      shape);
  return {};
}

std::vector<double> TomlTable::matrix(std::string_view key, std::size_t size,
                                      const NumberRule& rule) {
  std::vector<double> out(size * size, harmless(rule));
  const std::string count = std::to_string(size);
  const std::string shape = "must be " + count + " rows of " + count + " numbers";
  const toml::node* node = state_->require(key, shape + "; each " + rule.remedy());
  if (node == nullptr) return out;
  const auto refuse = [&](const std::string& problem, const std::string& remedy) {
    state_->report(key, DiagnosticCode::kType, nodeText(*node), problem, remedy);
    return out;
  };
  const toml::array* rows = node->as_array();
  if (rows == nullptr) return refuse(typeProblem(*node), shape);
  if (rows->size() != size) {
    return refuse("has " + std::to_string(rows->size()) + (rows->size() == 1 ? " row" : " rows"),
                  shape);
  }
  for (std::size_t i = 0; i < size; ++i) {
    const std::string in_row = "row " + std::to_string(i) + " ";
    const toml::array* row = (*rows)[i].as_array();
    if (row == nullptr) return refuse(in_row + typeProblem((*rows)[i]), shape);
    if (row->size() != size) {
      return refuse(in_row + "has " + std::to_string(row->size()) +
                        (row->size() == 1 ? " element" : " elements"),
                    shape);
    }
    for (std::size_t k = 0; k < size; ++k) {
      const std::optional<double> value = asNumber((*row)[k]);
      if (!value || !rule.allows(*value)) {
        return refuse(in_row + "element " + std::to_string(k) + " " +
                          (value ? numberProblem(*value) : typeProblem((*row)[k])),
                      "each " + rule.remedy());
      }
      out[i * size + k] = *value;
    }
  }
  return out;
}

std::array<double, 2> TomlTable::interval(std::string_view key, const NumberRule& rule) {
  const std::vector<double> ends = numbers(key, 2, rule);
  if (isGood(key) && !(ends[0] < ends[1])) {
    fail(key, "is not an interval", "write [lower, upper] with lower < upper");
  }
  return {ends[0], ends[1]};
}

std::vector<std::string> TomlTable::texts(std::string_view key) {
  std::vector<std::string> out;
  const toml::node* node = state_->require(key, "write an array of texts");
  if (node == nullptr) return out;
  const toml::array* array = node->as_array();
  if (array == nullptr) {
    state_->report(key, DiagnosticCode::kType, nodeText(*node), typeProblem(*node),
                   "must be an array of texts");
    return out;
  }
  for (const toml::node& element : *array) {
    const auto* value = element.as_string();
    if (value == nullptr || value->get().empty()) {
      state_->report(key, DiagnosticCode::kType, nodeText(*node),
                     "holds something that is not a text", "must be an array of texts in quotes");
      break;
    }
    out.push_back(value->get());
  }
  return out;
}

// ---------------------------------------------------------------- tables

TomlTable TomlTable::table(std::string_view key) {
  const toml::node* node = state_->require(key, "write the table [" + state_->keyPath(key) + "]");
  const toml::table* found = node == nullptr ? nullptr : node->as_table();
  if (node != nullptr && found == nullptr) {
    state_->report(key, DiagnosticCode::kType, nodeText(*node), typeProblem(*node),
                   "must be the table [" + state_->keyPath(key) + "]");
  }
  return TomlTable(state_->child(found, state_->keyPath(key), state_->lineOf(key)));
}

std::optional<TomlTable> TomlTable::optionalTable(std::string_view key) {
  state_->known.emplace(key);
  if (!has(key)) return std::nullopt;
  return table(key);
}

std::vector<TomlTable> TomlTable::tables(std::string_view key, std::size_t minimum) {
  std::vector<TomlTable> out;
  const std::string header = "[[" + state_->keyPath(key) + "]]";
  state_->known.emplace(key);
  if (minimum == 0 && !has(key)) return out;
  const toml::node* node = state_->require(key, "write at least one table " + header);
  if (node == nullptr) return out;
  const toml::array* array = node->as_array();
  const bool right = array != nullptr && (array->empty() || array->is_homogeneous<toml::table>());
  if (!right || array->size() < minimum) {
    state_->report(key, DiagnosticCode::kType, nodeText(*node),
                   right ? "is empty" : typeProblem(*node),
                   "must be tables, each starting with " + header);
    return out;
  }
  for (std::size_t i = 0; i < array->size(); ++i) {
    const toml::table& element = *(*array)[i].as_table();
    // Messages name a table by its `name` if it has one, else by its position.
    const auto* name = element.get("name") == nullptr ? nullptr : element.get("name")->as_string();
    const std::string index = name == nullptr ? std::to_string(i) : name->get();
    out.push_back(TomlTable(state_->child(&element, state_->keyPath(key) + "[" + index + "]",
                                          static_cast<int>(element.source().begin.line))));
  }
  return out;
}

std::optional<Diagnostic> beyondBounds(std::string_view toml, const std::string& path) {
  Counter counter(toml);
  if (!counter.findBeyond()) return std::nullopt;
  return Diagnostic{path,
                    counter.line(),
                    "",
                    "",
                    counter.problem(),
                    "name a configuration file",
                    DiagnosticCode::kRange};
}

std::string nearestWord(std::string_view word, const std::vector<std::string>& words) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : words) {
    const bool begins = std::min(word.size(), candidate.size()) >= 3 &&
                        (word.starts_with(candidate) || candidate.starts_with(word));
    const std::size_t lengths =
        std::max(word.size(), candidate.size()) - std::min(word.size(), candidate.size());
    if (!begins && lengths >= best_distance)
      continue;  // the length difference is a lower bound of the distance
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
  if (auto document = parseFile(path, shared_->faults)) {
    shared_->document = std::move(*document);
    begin(kind);
  }
}

TomlFile::TomlFile(const std::string& path, std::string_view kind, std::string_view text)
    : shared_(std::make_shared<Shared>()) {
  shared_->path = path;
  if (auto document = parseText(text, path, shared_->faults)) {
    shared_->document = std::move(*document);
    begin(kind);
  }
}

void TomlFile::begin(std::string_view kind) {
  auto state = std::make_shared<TomlTable::State>();
  state->file = shared_.get();
  state->table = &shared_->document;
  state->line = 1;
  shared_->tables.push_back(state);
  root_ = TomlTable(state);
  readable_ = true;

  // A file of another kind or version has other keys. Messages about them would mislead.
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
        const SuggestedKey meant = meantKey(key.str(), known, used);
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
