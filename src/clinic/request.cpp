#include "clinic/request.hpp"

#include "clinic/text.hpp"

#include <fmt/format.h>

#include <limits>
#include <set>

namespace wholehand::clinic {
namespace {

constexpr std::size_t kMostDepth = 16;

/// Parses JSON like Json::parse(), but refuses a key that occurs twice in an object, because its
/// meaning is unclear.
Json parsedOnce(const std::string& body) {
  std::vector<std::set<std::string>> keys;  // keys of each object being read
  return Json::parse(body, [&keys](int, Json::parse_event_t event, const Json& value) {
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second) {
      throw badValue("", "a key stands twice");  // the key is not quoted: it may be any text
    }
    return true;
  });
}

}  // namespace

std::string textOf(const Json& body, const char* key, const std::string& field) {
  const auto found = body.find(key);
  if (found == body.end() || !found->is_string()) throw badValue(field, field + " is no text");
  return found->get<std::string>();
}

std::string textOr(const Json& body, const char* key, std::size_t most, bool lines) {
  const auto found = body.find(key);
  if (found == body.end() || found->is_null()) return {};
  if (!found->is_string()) throw badValue(key, fmt::format("{} is no text", key));
  std::string text = found->get<std::string>();
  if (!isText(text, most, lines)) {
    throw badValue(key,
                   fmt::format("{} has more than {} characters, or control characters", key, most));
  }
  return text;
}

std::int64_t integerOf(const Json& body, const char* key, const std::string& why) {
  const auto found = body.find(key);
  if (found == body.end() || !found->is_number_integer()) throw badValue(key, why);
  return found->get<std::int64_t>();
}

double numberOf(const Json& value, const std::string& field, double lower, double upper,
                const std::string& unit) {
  const double number =
      value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
  if (!(number >= lower && number <= upper)) {
    throw badValue(field, fmt::format("{} = {}: must be a number in [{}, {}]{}", field,
                                      value.dump(-1, ' ', true, Json::error_handler_t::replace),
                                      lower, upper, unit.empty() ? "" : " " + unit));
  }
  return number;
}

Json parsed(const std::string& body) {
  if (body.empty()) return Json::object();
  if (jsonDepth(body) > kMostDepth) {
    throw badValue("", fmt::format("the JSON is nested {} deep; at most {} are read",
                                   jsonDepth(body), kMostDepth));
  }
  Json json;
  try {
    json = parsedOnce(body);
  } catch (const Json::exception& error) {
    const std::string why = error.what();
    const bool utf8 = why.find("UTF-8") != std::string::npos;
    // The parser's own message is not used, because it quotes the request.
    throw badValue("", utf8 ? "the text is not UTF-8" : "the body is not JSON");
  }
  if (!json.is_object()) throw badValue("", "the body is no JSON object");
  return json;
}

}  // namespace wholehand::clinic
