#pragma once

#include "clinic/database.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// A value that may be null.
template <class T>
struct nlohmann::adl_serializer<std::optional<T>> {
  static void to_json(nlohmann::json& out, const std::optional<T>& value) {
    out = value ? nlohmann::json(*value) : nlohmann::json();
  }
  static void from_json(const nlohmann::json& in, std::optional<T>& value) {
    if (!in.is_null()) value = in.get<T>();
  }
};

/// Requests of the pages, their answers and refusals.
namespace wholehand::clinic {

using Json = nlohmann::json;

/// Reason why a request was refused; it changes nothing. Thrown inside the clinic and answered as
/// JSON. `code` is a stable word that the pages know.
struct RequestRefusal {
  int status = 400;
  std::string code, why, field;
  Json more = Json::object();  ///< further keys of the answer
};

[[nodiscard]] inline RequestRefusal badValue(std::string field, std::string why) {
  return {400, "bad_value", std::move(why), std::move(field)};
}
[[nodiscard]] inline RequestRefusal notFound(std::string what) {
  return {404, "not_found", std::move(what), {}};
}
[[nodiscard]] inline RequestRefusal refusal(int status, std::string code, std::string why,
                                            Json more = Json::object()) {
  return {status, std::move(code), std::move(why), {}, std::move(more)};
}
/// Refusal of a request whose data were changed since the page read them.
[[nodiscard]] inline RequestRefusal changedMeanwhile(std::string why, Json now) {
  return refusal(409, "changed", std::move(why), {{"now", std::move(now)}});
}

struct Request {
  std::string method;  ///< "GET", "POST", "PUT", "DELETE"
  std::string path;    ///< decoded, e.g. "/api/patients/3"
  std::string find;    ///< value of `find` in the query, decoded
  std::string token;   ///< token of the session; empty: none
  std::string key;     ///< header Idempotency-Key
  std::string body;
  std::int64_t page = 0;  ///< value of `page` in the query
};

struct Answer {
  int status = 200;
  std::string type = "application/json";
  std::string file;  ///< name under which a browser saves the answer; empty: the browser shows it
  std::string body;
};

/// Session of somebody who is signed in.
struct Session {
  std::int64_t account = 0;
  std::int64_t last_us = 0;   ///< time of the last request, steady clock
  std::int64_t heard_us = 0;  ///< the same, polling for the open visit included
  bool hidden = false;
  std::int64_t opened_patient = 0;  ///< last opened patient in the log
};

/// A request under way.
struct Call {
  const Request& request;
  std::unique_lock<std::mutex>& lock;
  Json body = Json::object();
  std::vector<std::int64_t> ids = {};  ///< numbers in the path
  Session session = {};
  std::string session_id = {};
  Answer answer = {};
  std::optional<Transaction> transaction = {};
  std::vector<std::function<void()>> after = {};  ///< called after the commit
};

/// Values of a request's body. Each function throws badValue() with the field's name.
[[nodiscard]] std::string textOf(const Json& body, const char* key, const std::string& field);
/// Text of a key; empty when the key is missing. @param most limit in characters @param lines line
/// feeds are allowed
[[nodiscard]] std::string textOr(const Json& body, const char* key, std::size_t most,
                                 bool lines = false);
/// Integer of a key; refused with `why` when there is none.
[[nodiscard]] std::int64_t integerOf(const Json& body, const char* key, const std::string& why);
[[nodiscard]] double numberOf(const Json& value, const std::string& field, double lower,
                              double upper, const std::string& unit);
/// Parses the body of a request, which must be an object.
[[nodiscard]] Json parsed(const std::string& body);

}  // namespace wholehand::clinic
