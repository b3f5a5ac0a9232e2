#pragma once

#include "station/server/access.hpp"
#include "vocabulary/backend.hpp"

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace wholehand {

/// The parts of a request that the site uses.
struct HttpRequest {
  bool get = true;  ///< the method is GET or HEAD
  std::string target;
  std::string host, origin, authorization, cookie, if_none_match;

  [[nodiscard]] std::string_view path() const;
  [[nodiscard]] std::string_view query() const;
  [[nodiscard]] Credentials credentials() const;
};

/// An answer: a text or a file.
struct HttpAnswer {
  int status = 200;
  std::string content_type;
  std::string body;
  std::string file;  ///< full path; when not empty, sent instead of the body
  std::vector<std::pair<std::string, std::string>> headers;
  std::string refused;  ///< reason, for the counters; empty: not refused
};

/// Routes of plain HTTP: pages, recordings, reports, health and metrics.
class Site {
 public:
  /// Data from the loop; only the server's thread can ask for it.
  struct LoopReports {
    std::function<std::pair<bool, std::string>()> health;  ///< healthy or not, and its JSON
    std::function<std::string()> metrics;
    /// Port of the clinic's records on this machine; 0: they do not answer; empty function: no
    /// clinic.
    std::function<std::uint16_t()> clinic_port;
  };

  /// @param replay empty: replay is not served
  Site(ServerBackend& backend, std::string web_folder, Access access, LoopReports loop,
       ReplayService replay = {});

  /// Kind of an answer. It says which files the answer needs, and so which thread makes it: the
  /// server's thread touches no file.
  enum class Route { kNoFile, kPage, kRecording, kReport, kReplay };
  [[nodiscard]] static Route routeOf(const HttpRequest& request);
  /// Makes the answer with all its headers. On the server's thread when it needs no file; else on
  /// another thread, because it waits for the disk.
  [[nodiscard]] HttpAnswer answer(const HttpRequest& request) const;
  /// Checks a request for a WebSocket. Returns the refusal, or status 200.
  [[nodiscard]] HttpAnswer mayConnect(const HttpRequest& request) const;
  /// Role granted to a request that may open a WebSocket.
  [[nodiscard]] Role roleOf(const HttpRequest& request) const;
  /// Set-Cookie header for a request that carries the token in its query, else empty.
  [[nodiscard]] std::string cookieFor(const HttpRequest& request) const;

 private:
  [[nodiscard]] HttpAnswer route(const HttpRequest& request, const std::string& path) const;
  [[nodiscard]] HttpAnswer page(const HttpRequest& request, const std::string& path) const;
  [[nodiscard]] HttpAnswer clinic() const;
  [[nodiscard]] std::string pagePolicy(const std::string& path) const;
  /// True when the request may see recordings. With a clinic, only the therapist may.
  [[nodiscard]] bool maySeeRecordings(const HttpRequest& request) const;
  [[nodiscard]] HttpAnswer recordingList() const;
  [[nodiscard]] HttpAnswer recording(const HttpRequest& request,
                                     const std::string& name_and_rest) const;
  [[nodiscard]] HttpAnswer replay(const HttpRequest& request, const std::string& path,
                                  const std::string& question) const;
  [[nodiscard]] HttpAnswer report(const std::string& name, const std::string& rest) const;

  ServerBackend& backend_;
  std::string web_folder_;
  Access access_;
  LoopReports loop_;
  ReplayService replay_;
};

/// Makes a small page that says why a request was refused; counted as `reason`.
[[nodiscard]] HttpAnswer plainRefusal(int status, const char* reason, const char* why);
/// Makes a small page that needs no other file.
[[nodiscard]] std::string plainPage(std::string_view title, std::string_view body_html);

}  // namespace wholehand
