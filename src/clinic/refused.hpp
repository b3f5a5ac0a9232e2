#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <utility>

namespace wholehand::clinic {

using Json = nlohmann::json;

/// Why a request changes nothing; thrown inside of the clinic, answered as JSON. `code` is a stable
/// word that the pages know.
struct Refused {
  int status = 400;
  std::string code, why, field;
  Json more = Json::object();  ///< further keys of the answer
};

[[nodiscard]] inline Refused badValue(std::string field, std::string why) {
  return {400, "bad_value", std::move(why), std::move(field)};
}
[[nodiscard]] inline Refused notFound(std::string what) {
  return {404, "not_found", std::move(what), {}};
}

}  // namespace wholehand::clinic
