#pragma once

#include <string>

namespace wholehand {

/// JSON as text of a file. Bytes that are not UTF-8, such as in file names, become U+FFFD.
template <class Json>
[[nodiscard]] std::string jsonText(const Json& json, int indent = 2) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace wholehand
