#include "model/toml/toml_state.hpp"

#include <algorithm>

namespace wholehand {

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
    // A name tells a person more than a position does.
    const auto* name = element.get("name") == nullptr ? nullptr : element.get("name")->as_string();
    const std::string index = name == nullptr ? std::to_string(i) : name->get();
    out.push_back(TomlTable(state_->child(&element, state_->keyPath(key) + "[" + index + "]",
                                          static_cast<int>(element.source().begin.line))));
  }
  return out;
}

}  // namespace wholehand
