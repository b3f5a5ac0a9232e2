#include "server/static_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
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

}  // namespace

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
  }};  // tflite, binarypb and data are opaque bytes
  const std::string_view ending = extension(path);
  const auto* found = std::find_if(kTypes.begin(), kTypes.end(),
                                   [&](const auto& type) { return type.first == ending; });
  return found == kTypes.end() ? kBinary : found->second;
}

bool nameHasHash(std::string_view path) {
  if (!path.starts_with("/assets/")) return false;
  const std::size_t slash = path.rfind('/');
  const std::string_view name = path.substr(slash + 1);
  const std::string_view ending = extension(name);
  if (ending.empty() || name.size() < ending.size() + kHash + 3) return false;
  const std::string_view stem = name.substr(0, name.size() - ending.size() - 1);
  return stem[stem.size() - kHash - 1] == '-';
}

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

std::string entityTag(const std::string& file) {
  std::error_code error;
  const auto size = fs::file_size(file, error);
  if (error) return {};
  const auto time = fs::last_write_time(file, error).time_since_epoch().count();
  return fmt::format("\"{:x}-{:x}\"", size, time);
}

}  // namespace wholehand
