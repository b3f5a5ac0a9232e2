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

/// Requests of the pages, and how they are answered or refused.
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
/// Something was changed since the page looked.
[[nodiscard]] inline Refused changedMeanwhile(std::string why, Json now) {
  return {409, "changed", std::move(why), {}, {{"now", std::move(now)}}};
}

struct Request {
  std::string method;  ///< "GET", "POST", "PUT", "DELETE"
  std::string path;    ///< "/api/patients/3", decoded
  std::string find;    ///< query's `find`, decoded
  std::string token;   ///< of the session; empty: none
  std::string key;     ///< Idempotency-Key
  std::string body;
};

struct Answer {
  int status = 200;
  std::string type = "application/json";
  std::string file;  ///< name under which a browser saves it; empty: it shows it
  std::string body;
};

/// Somebody who is signed in.
struct Session {
  std::int64_t account = 0;
  std::int64_t last_us = 0;  ///< steady clock
  bool hidden = false;
  std::int64_t opened_patient = 0;  ///< last one in the log
};

/// A request that is being answered.
struct Call {
  const Request& request;
  std::unique_lock<std::mutex>& lock;
  Json body = Json::object();
  std::vector<std::int64_t> ids = {};  ///< numbers of the path
  Session session = {};
  std::string session_id = {};
  Answer answer = {};
  std::optional<Transaction> transaction = {};
  std::vector<std::function<void()>> after = {};  ///< once all is committed
};

/// Values of a body. Each throws badValue() of its field.
[[nodiscard]] std::string textOf(const Json& body, const char* key, const std::string& field);
/// Empty where there is none. @param most characters @param lines line feeds are allowed
[[nodiscard]] std::string textOr(const Json& body, const char* key, std::size_t most,
                                 bool lines = false);
[[nodiscard]] double numberOf(const Json& value, const std::string& field, double lower,
                              double upper, const std::string& unit);
/// The body of a request, an object.
[[nodiscard]] Json parsed(const std::string& body);

}  // namespace wholehand::clinic
