#include "station/server/site.hpp"

#include "loop/core/printable.hpp"
#include "station/server/http_line.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace wholehand {

namespace fs = std::filesystem;

namespace {

constexpr const char* kBinary = "application/octet-stream";
/// Length of the hash that Vite puts before a file extension.
constexpr std::size_t kHash = 8;

std::string_view extension(std::string_view path) {
  const std::size_t dot = path.rfind('.');
  const std::size_t slash = path.rfind('/');
  if (dot == std::string_view::npos || (slash != std::string_view::npos && dot < slash)) return {};
  return path.substr(dot + 1);
}

/// MIME type by file extension; "application/octet-stream" when unknown.
const char* mimeType(std::string_view path) {
  constexpr std::array<std::pair<std::string_view, const char*>, 22> kTypes = {{
      {"html", "text/html; charset=utf-8"},
      {"js", "text/javascript; charset=utf-8"},
      {"mjs", "text/javascript; charset=utf-8"},
      {"css", "text/css; charset=utf-8"},
      {"json", "application/json"},
      {"map", "application/json"},
      {"webmanifest", "application/manifest+json"},
      {"wasm", "application/wasm"},
      {"svg", "image/svg+xml"},
      {"png", "image/png"},
      {"jpg", "image/jpeg"},
      {"webp", "image/webp"},
      {"ico", "image/x-icon"},
      {"woff2", "font/woff2"},
      {"woff", "font/woff"},
      {"txt", "text/plain; charset=utf-8"},
      {"md", "text/plain; charset=utf-8"},
      {"mp3", "audio/mpeg"},
      {"ogg", "audio/ogg"},
      {"wav", "audio/wav"},
      {"glb", "model/gltf-binary"},
      {"h5", "application/x-hdf5"},
  }};  // tflite, binarypb and data are unknown types and get the default
  const std::string_view ending = extension(path);
  const auto* found = std::find_if(kTypes.begin(), kTypes.end(),
                                   [&](const auto& type) { return type.first == ending; });
  return found == kTypes.end() ? kBinary : found->second;
}

/// True when the bundler put a content hash into the name ("assets/main-B2xk9_aQ.js"). Such a file
/// never changes.
bool nameHasHash(std::string_view path) {
  if (!path.starts_with("/assets/")) return false;
  const std::size_t slash = path.rfind('/');
  const std::string_view name = path.substr(slash + 1);
  const std::string_view ending = extension(name);
  if (ending.empty() || name.size() < ending.size() + kHash + 3) return false;
  const std::string_view stem = name.substr(0, name.size() - ending.size() - 1);
  return stem[stem.size() - kHash - 1] == '-';
}

/// Full path of a file in a folder, from a decoded path ("/assets/a.js"; a folder stands for its
/// index.html). Empty when there is no such file, when a segment begins with a dot, or when a
/// symbolic link leads out of the folder.
std::optional<std::string> fileWithin(const std::string& folder, std::string_view path) {
  if (folder.empty() || path.find("/.") != std::string_view::npos) return std::nullopt;
  std::error_code error;
  const fs::path root = fs::canonical(folder, error);
  if (error) return std::nullopt;
  fs::path file = fs::canonical(root / fs::path(path).relative_path(), error);
  if (error) return std::nullopt;
  if (fs::is_directory(file, error)) file = fs::canonical(file / "index.html", error);
  if (error || !fs::is_regular_file(file, error)) return std::nullopt;
  const auto [end, ignored] = std::mismatch(root.begin(), root.end(), file.begin(), file.end());
  if (end != root.end()) return std::nullopt;
  return file.string();
}

/// Entity tag from the file's size and modification time.
std::string entityTag(const std::string& file) {
  std::error_code error;
  const auto size = fs::file_size(file, error);
  if (error) return {};
  const auto time = fs::last_write_time(file, error).time_since_epoch().count();
  return fmt::format("\"{:x}-{:x}\"", size, time);
}

constexpr std::string_view kRecordings = "/api/recordings";
constexpr std::string_view kClinic = "/api/clinic";
constexpr std::string_view kReplay = "/replay/";  ///< follows a recording's name in the path
// Content policy of the pages. Hand tracking compiles WebAssembly and starts from blobs; plots and
// the 3D scene set styles.
constexpr const char* kPagePolicy =
    "default-src 'self'; script-src 'self' 'wasm-unsafe-eval' blob:; worker-src 'self' blob:; "
    "style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; media-src 'self' blob:; "
    "object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; "
    "connect-src 'self' data: blob:";
// Content policy of reports. A report contains its scripts, styles, fonts and data, and loads
// nothing.
constexpr const char* kReportPolicy =
    "default-src 'none'; script-src 'unsafe-inline'; worker-src blob:; style-src 'unsafe-inline'; "
    "img-src data: blob:; font-src data:; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'";

HttpAnswer text(std::string body, const char* content_type) {
  HttpAnswer a;
  a.body = std::move(body);
  a.content_type = content_type;
  a.headers.emplace_back("Cache-Control", "no-store");
  return a;
}

HttpAnswer html(int status, std::string_view title, std::string_view body_html) {
  HttpAnswer a = text(plainPage(title, body_html), "text/html; charset=utf-8");
  a.status = status;
  return a;
}

HttpAnswer refusal(int status, const char* reason, std::string_view title, std::string_view why) {
  HttpAnswer a = html(status, title, fmt::format("<p>{}</p>", escapeHtml(why)));
  a.refused = reason;
  return a;
}

HttpAnswer notFound(std::string_view what) {
  return html(404, "Not here",
              fmt::format("<p>There is no <code>{}</code>.</p><p><a href=\"/\">To the bar</a> · "
                          "<a href=\"/console\">To the console</a></p>",
                          escapeHtml(printable(what))));
}

HttpAnswer file(const std::string& path, const HttpRequest& request, const char* cache) {
  HttpAnswer a;
  a.content_type = mimeType(path);
  a.headers.emplace_back("Cache-Control", cache);
  const std::string tag = entityTag(path);
  if (!tag.empty()) a.headers.emplace_back("ETag", tag);
  if (!tag.empty() && request.if_none_match == tag) {
    a.status = 304;
  } else {
    a.file = path;
  }
  return a;
}

void addSecurity(HttpAnswer& a) {
  const bool has_policy = std::any_of(a.headers.begin(), a.headers.end(), [](const auto& h) {
    return h.first == "Content-Security-Policy";
  });
  if (!has_policy) a.headers.emplace_back("Content-Security-Policy", kPagePolicy);
  a.headers.emplace_back("X-Content-Type-Options", "nosniff");
  a.headers.emplace_back("Referrer-Policy", "no-referrer");
  a.headers.emplace_back("Cross-Origin-Opener-Policy", "same-origin");
  a.headers.emplace_back("Cross-Origin-Resource-Policy", "same-origin");
  a.headers.emplace_back("Permissions-Policy",
                         "camera=(self), gamepad=(self), microphone=(), "
                         "geolocation=()");
}

bool needsToken(std::string_view path) {
  return path.starts_with("/api/") || path == "/metrics" || path == "/ws";
}

}  // namespace

HttpAnswer plainRefusal(int status, const char* reason, const char* why) {
  HttpAnswer a;
  a.status = status;
  a.content_type = "text/html; charset=utf-8";
  a.body = plainPage(reason, std::string("<p>") + why + "</p>");
  a.refused = reason;
  return a;
}

// Page with the colours and fonts of the game's pages.
std::string plainPage(std::string_view title, std::string_view body_html) {
  return fmt::format(R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{0} · Wholehand</title>
<style>
:root {{ color-scheme: light dark; --ink: #16202a; --paper: #f6f4ef; --line: #c9c4b8; --blue: #1f5fa8; }}
@media (prefers-color-scheme: dark) {{
  :root {{ --ink: #eef1f4; --paper: #12181f; --line: #3a4653; --blue: #8fc1ff; }} }}
body {{ margin: 0; min-height: 100vh; display: grid; place-items: center; background: var(--paper);
  color: var(--ink); font: 1.25rem/1.5 system-ui, sans-serif; }}
main {{ max-width: 36rem; padding: 2rem; border-left: 6px solid var(--blue); }}
h1 {{ margin: 0 0 .5rem; font-size: 2.25rem; line-height: 1.15; }}
a {{ color: var(--blue); }}
code {{ font-size: 1.1rem; overflow-wrap: anywhere; }}
pre {{ padding: .75rem 1rem; border: 1px solid var(--line); border-radius: 8px; overflow: auto; }}
</style></head><body><main><h1>{0}</h1>{1}</main></body></html>
)",
                     title, body_html);
}

std::string_view HttpRequest::path() const {
  return std::string_view(target).substr(0, target.find_first_of("?#"));
}

std::string_view HttpRequest::query() const {
  const std::size_t begin = target.find('?');
  return begin == std::string::npos ? std::string_view()
                                    : std::string_view(target).substr(begin + 1);
}

Credentials HttpRequest::credentials() const {
  return {host, origin, query(), authorization, cookie};
}

Site::Site(ServerBackend& backend, std::string web_folder, Access access, LoopReports loop,
           ReplayService replay)
    : backend_(backend),
      web_folder_(std::move(web_folder)),
      access_(std::move(access)),
      loop_(std::move(loop)),
      replay_(std::move(replay)) {}

Site::Route Site::routeOf(const HttpRequest& request) {
  // The path is decoded as in answer(), so that differently encoded paths get the same route.
  const std::optional<std::string> path = decodedPath(request.path());
  if (!path || *path == "/healthz" || *path == "/metrics" || *path == "/ws" || *path == kClinic) {
    return Route::kNoFile;
  }
  if (!path->starts_with(kRecordings)) return Route::kPage;
  const std::size_t after_name = path->find('/', std::min(path->size(), kRecordings.size() + 1));
  if (path->find(kReplay) == after_name && after_name != std::string::npos) return Route::kReplay;
  return path->find("/report") == std::string::npos ? Route::kRecording : Route::kReport;
}

std::string Site::cookieFor(const HttpRequest& request) const {
  return access_.cookieFor(request.credentials());
}

HttpAnswer Site::answer(const HttpRequest& request) const {
  HttpAnswer a;
  const std::optional<std::string> path = decodedPath(request.path());
  if (!access_.hostAllowed(request.host)) {
    a = refusal(421, "host", "Not this address", "This program answers to localhost only.");
  } else if (!request.get) {
    a = refusal(405, "method", "Method not allowed", "This program answers GET and HEAD only.");
    a.headers.emplace_back("Allow", "GET, HEAD");
  } else if (!path) {
    const int status = hasEncodedSlash(request.path()) ? 404 : 400;
    a = refusal(status, "path", "Not found", "The program does not serve this path.");
  } else if (needsToken(*path) && !access_.originAllowed(request.origin, request.host)) {
    a = refusal(403, "origin", "Origin not allowed", "A page of another site may not read this.");
  } else if (needsToken(*path) && !access_.authorized(request.credentials())) {
    a = refusal(401, "token", "A token is needed",
                "Open the page with ?token=..., as the program was started with.");
    a.headers.emplace_back("WWW-Authenticate", "Bearer");
  } else {
    a = route(request, *path);
  }
  if (std::string cookie = cookieFor(request); !cookie.empty()) {
    a.headers.emplace_back("Set-Cookie", std::move(cookie));
  }
  addSecurity(a);
  return a;
}

HttpAnswer Site::mayConnect(const HttpRequest& request) const {
  HttpAnswer a;
  if (!access_.hostAllowed(request.host)) {
    a = refusal(421, "host", "Not this address", "This program answers to localhost only.");
  } else if (!access_.originAllowed(request.origin, request.host)) {
    a = refusal(403, "origin", "Origin not allowed",
                "A page of another site may not connect to this program.");
  } else if (!access_.authorized(request.credentials())) {
    a = refusal(401, "token", "A token is needed", "Connect with ?token=...");
  } else if (!access_.roleOf(request.credentials())) {
    a = refusal(400, "role", "No such role",
                "The roles are therapist, player and watcher: ?role=watcher.");
  }
  addSecurity(a);
  return a;
}

Role Site::roleOf(const HttpRequest& request) const {
  return access_.roleOf(request.credentials()).value_or(Role::kWatcher);
}

HttpAnswer Site::route(const HttpRequest& request, const std::string& path) const {
  if (path == "/healthz") {
    const auto [healthy, json] = loop_.health();
    HttpAnswer a = text(json, "application/json");
    a.status = healthy ? 200 : 503;
    return a;
  }
  if (path == "/metrics") return text(loop_.metrics(), "text/plain; version=0.0.4");
  if (path == "/ws") {
    return refusal(426, "no_upgrade", "WebSocket only",
                   "This address is for WebSocket connections.");
  }
  if (path == kClinic) return clinic();
  if (path.starts_with(kRecordings) && !maySeeRecordings(request)) {
    return refusal(403, "role", "For the therapist",
                   "With a clinic's records, recordings and reports are for the therapist only.");
  }
  if (path == kRecordings) return recordingList();
  if (path.starts_with(std::string(kRecordings) + "/")) {
    return recording(request, path.substr(kRecordings.size() + 1));
  }
  return page(request, path);
}

HttpAnswer Site::clinic() const {
  if (!loop_.clinic_port) return notFound(kClinic);
  return text(nlohmann::json{{"port", loop_.clinic_port()}}.dump() + "\n", "application/json");
}

// The page of the clinic's records may also connect to their process.
std::string Site::pagePolicy(const std::string& path) const {
  const std::uint16_t port = path == "/clinic" && loop_.clinic_port ? loop_.clinic_port() : 0;
  if (port == 0) return {};
  return fmt::format("{0} http://127.0.0.1:{1} http://localhost:{1}", kPagePolicy, port);
}

bool Site::maySeeRecordings(const HttpRequest& request) const {
  if (!loop_.clinic_port) return true;
  const Role role = roleOf(request);
  return role == Role::kTherapist || role == Role::kUnspecified;
}

HttpAnswer Site::page(const HttpRequest& request, const std::string& path) const {
  const bool ours =
      path == "/console" || path == "/commission" || path == "/replay" || path == "/clinic";
  const std::string name = ours ? path + ".html" : path;
  if (const auto found = fileWithin(web_folder_, name)) {
    HttpAnswer a = file(*found, request,
                        nameHasHash(name) ? "public, max-age=31536000, immutable" : "no-cache");
    if (std::string policy = pagePolicy(path); !policy.empty()) {
      a.headers.emplace_back("Content-Security-Policy", std::move(policy));
    }
    return a;
  }
  const bool built = fileWithin(web_folder_, "/index.html").has_value();
  if (built || (path != "/" && !ours)) return notFound(path);
  return html(
      503, "The pages are not built",
      "<p>The loop runs; what shows it does not exist yet. With Node 18.19, 20, or 22 and newer "
      "(packages <code>nodejs</code> and <code>npm</code>):</p>"
      "<pre>cd web &amp;&amp; npm ci &amp;&amp; npm run build</pre>"
      "<p>or <code>./start</code>, which does it. Until then: "
      "<a href=\"/healthz\">health</a>, <a href=\"/metrics\">figures</a>.</p>");
}

HttpAnswer Site::recordingList() const {
  nlohmann::json list = nlohmann::json::array();
  for (const RecordingEntry& r : backend_.recordings()) {
    list.push_back({{"name", r.name},
                    {"title", r.title},
                    {"profile", r.profile},
                    {"created_utc", r.created_utc},
                    {"duration_s", r.duration_s},
                    {"ticks_missing", r.ticks_missing},
                    {"bytes", r.bytes},
                    {"being_written", r.being_written}});
    if (r.being_written) continue;
    list.back()["report"] = fmt::format("{}/{}/report/", kRecordings, percentEncoded(r.name));
  }
  const auto scene = backend_.scene();
  const nlohmann::json json = {{"recordings", list}, {"recording", scene ? scene->recording : ""}};
  return text(json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n",
              "application/json");
}

HttpAnswer Site::recording(const HttpRequest& request, const std::string& name_and_rest) const {
  const std::size_t slash = name_and_rest.find('/');
  const std::string name = name_and_rest.substr(0, slash);
  const std::string path = name.empty() ? std::string() : backend_.recordingPath(name);
  if (path.empty()) return notFound(name_and_rest);
  if (replay_ && slash != std::string::npos && name_and_rest.substr(slash).starts_with(kReplay)) {
    return replay(request, path, name_and_rest.substr(slash + kReplay.size()));
  }
  if (const auto scene = backend_.scene(); scene && scene->recording == name) {
    return refusal(409, "being_written", "Still being recorded",
                   "Stop first, or look at it as far as it goes: replay.");
  }
  if (slash != std::string::npos) return report(name, name_and_rest.substr(slash));
  HttpAnswer a = file(path, HttpRequest{}, "no-cache");
  a.headers.emplace_back("Content-Disposition",
                         "attachment; filename*=UTF-8''" + percentEncoded(name));
  return a;
}

HttpAnswer Site::replay(const HttpRequest& request, const std::string& path,
                        const std::string& question) const {
  ReplayAnswer answer = replay_(path, fmt::format("{}?{}", question, request.query()));
  HttpAnswer a = text(std::move(answer.body), "");
  a.content_type = std::move(answer.content_type);
  a.status = answer.status;
  return a;
}

HttpAnswer Site::report(const std::string& name, const std::string& rest) const {
  if (rest == "/report") {
    HttpAnswer a = text("", "text/plain; charset=utf-8");
    a.status = 308;
    a.headers.emplace_back("Location",
                           fmt::format("{}/{}/report/", kRecordings, percentEncoded(name)));
    return a;
  }
  constexpr std::string_view kReport = "/report/";
  if (!rest.starts_with(kReport)) return notFound(name + rest);
  std::string why;
  const std::string folder = backend_.reportFolder(name, why);
  if (folder.empty()) {
    HttpAnswer a = html(500, "No report",
                        fmt::format("<p>The report of <code>{}</code> could not be made: {}</p>",
                                    escapeHtml(name), escapeHtml(printable(why, 1000))));
    a.refused = "report";
    return a;
  }
  const auto found = fileWithin(folder, rest.substr(kReport.size() - 1));
  if (!found) return notFound(name + rest);
  HttpAnswer a = file(*found, HttpRequest{}, "no-cache");
  a.headers.emplace_back("Content-Security-Policy", kReportPolicy);
  return a;
}

}  // namespace wholehand
