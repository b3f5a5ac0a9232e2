#include "core/printable.hpp"
#include "model/toml/toml_state.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace wholehand {

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
  // A missing table was reported itself; its keys are not.
  const bool already_told =
      std::any_of(missing.begin(), missing.end(), [&](const Missing& m) { return m.key == key; });
  if (node == nullptr && table != nullptr && !faulty.contains(key) && !already_told) {
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

std::optional<double> asNumber(const toml::node& node) {
  if (const auto* integer = node.as_integer()) return static_cast<double>(integer->get());
  if (const auto* floating = node.as_floating_point()) return floating->get();
  return std::nullopt;
}

double harmless(const NumberRule& rule) {
  if (rule.allows(0.0)) return 0.0;
  if (std::isfinite(rule.upper)) return rule.upper;
  return std::isfinite(rule.lower) ? rule.lower + 1.0 : 0.0;
}

std::string numberProblem(double value) {
  return std::isfinite(value) ? "is out of range" : "is not finite";
}

namespace {

std::string quotedList(const std::vector<std::string>& words) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) out += i + 1 == words.size() ? " or " : ", ";
    out += "\"" + words[i] + "\"";
  }
  return out;
}

}  // namespace

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
                   "write a text that can be shown in a list");
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
  // This message explains the absence of the right key.
  state_->faulty.emplace(right);
  std::erase_if(state_->missing, [&](const State::Missing& m) { return m.key == right; });
}

}  // namespace wholehand
