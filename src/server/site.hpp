#pragma once

#include "server/access.hpp"
#include "server/backend.hpp"
#include "server/replay_service.hpp"

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace wholehand {

/// What a request asks for, as far as the site looks at it.
struct HttpRequest {
  bool get = true;  ///< GET or HEAD
  std::string target;
  std::string host, origin, authorization, cookie, if_none_match;

  [[nodiscard]] std::string_view path() const;
  [[nodiscard]] std::string_view query() const;
  [[nodiscard]] Credentials credentials() const;
};

/// What is answered: a text, or a file.
struct HttpAnswer {
  int status = 200;
  std::string content_type;
  std::string body;
  std::string file;  ///< full path; sent instead of the body where it is not empty
  std::vector<std::pair<std::string, std::string>> headers;
  std::string refused;  ///< why, for the counters; empty: it was not
};

/// All that is served over plain HTTP: pages, recordings, reports, health and figures.
class Site {
 public:
  /// What only the server's thread knows.
  struct Figures {
    std::function<std::pair<bool, std::string>()> health;  ///< healthy, its JSON
    std::function<std::string()> metrics;
  };

  /// @param replay empty: recordings are not looked at again
  Site(ServerBackend& backend, std::string web_folder, Access access, Figures figures,
       ReplayService replay = {});

  /// What the answer is made of, and so who may make it: the server's thread touches no file.
  enum class Needs { kNoFile, kPage, kRecording, kReport, kReplay };
  [[nodiscard]] static Needs needsOf(const HttpRequest& request);
  /// The answer with all its headers: from the server's thread where it needs no file, else from
  /// any other, for it waits for the disk.
  [[nodiscard]] HttpAnswer answer(const HttpRequest& request) const;
  /// Refusal of a request for a WebSocket; status 200 where it may have one.
  [[nodiscard]] HttpAnswer mayConnect(const HttpRequest& request) const;
  /// Of a client that may have a WebSocket.
  [[nodiscard]] Role roleOf(const HttpRequest& request) const;
  /// Set-Cookie for who showed the token in the query, else empty.
  [[nodiscard]] std::string cookieFor(const HttpRequest& request) const;

 private:
  [[nodiscard]] HttpAnswer route(const HttpRequest& request, const std::string& path) const;
  [[nodiscard]] HttpAnswer page(const HttpRequest& request, const std::string& path) const;
  [[nodiscard]] HttpAnswer recordingList() const;
  [[nodiscard]] HttpAnswer recording(const HttpRequest& request,
                                     const std::string& name_and_rest) const;
  [[nodiscard]] HttpAnswer replay(const HttpRequest& request, const std::string& path,
                                  const std::string& question) const;
  [[nodiscard]] HttpAnswer report(const std::string& name, const std::string& rest) const;

  ServerBackend& backend_;
  std::string web_folder_;
  Access access_;
  Figures figures_;
  ReplayService replay_;
};

/// Says why not, on a small page; counted as `reason`.
[[nodiscard]] HttpAnswer plainRefusal(int status, const char* reason, const char* why);
/// A small page of ours that needs no other file.
[[nodiscard]] std::string plainPage(std::string_view title, std::string_view body_html);

}  // namespace wholehand
