#include "model/toml/toml_state.hpp"

#include <algorithm>
#include <sstream>

namespace wholehand {
namespace {

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

}  // namespace

std::string nodeText(const toml::node& node) {
  std::string text = wholeText(node);
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20; }, ' ');
  constexpr std::size_t kLongest = 60;
  if (text.size() > kLongest) {
    std::size_t end = kLongest;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U)
      --end;  // whole UTF-8
    text = text.substr(0, end) + "...";
  }
  return text;
}

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

}  // namespace wholehand
