#include "files/urdf/urdf_text.hpp"

#include "files/mesh/mesh_readers.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <string_view>

namespace wholehand {
namespace {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;

constexpr const char* kBlanks = " \t\r\n";

// Bounds of a URDF. A complete robot description has some 2,000 attributes; an element has two '<'.
constexpr std::ptrdiff_t kMostAttributes = 8'000, kMostTags = 32'000;
constexpr std::streamsize kLargestUrdf_bytes = std::streamsize{4} << 20U;

/// Text of a URI with percent escapes such as "%20" decoded.
std::string unescaped(std::string_view uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    int code = 0;
    const char* const digits = uri.data() + i + 1;
    if (uri[i] == '%' && i + 2 < uri.size() &&
        std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2) {
      text += static_cast<char>(code);
      i += 2;
    } else {
      text += uri[i];
    }
  }
  return text;
}

constexpr int kMostFoldersBeside =
    200;  ///< folders in which a package is looked for, at each level

/// Name of the package in a folder by its package.xml (ROS); empty: none.
std::string packageIn(const fs::path& folder) {
  const fs::path path = folder / "package.xml";
  std::error_code error;
  if (!fs::is_regular_file(path, error) || !beyondUrdfBounds(path.string()).empty()) return {};
  tinyxml2::XMLDocument document;
  if (document.LoadFile(path.c_str()) != tinyxml2::XML_SUCCESS) return {};
  const XMLElement* const package = document.FirstChildElement("package");
  const XMLElement* const name = package != nullptr ? package->FirstChildElement("name") : nullptr;
  if (name == nullptr || name->GetText() == nullptr) return {};
  const std::string_view text = name->GetText();
  const std::size_t from = text.find_first_not_of(kBlanks);
  if (from == text.npos) return {};
  return std::string(text.substr(from, text.find_last_not_of(kBlanks) + 1 - from));
}

/// Path of an unescaped mesh name in any of the accepted forms; empty if no file is found.
fs::path foundMesh(std::string_view name, const fs::path& folder, fs::path& tried) {
  std::error_code error;
  const auto known = [&](const fs::path& path) { return fs::is_regular_file(path, error); };
  constexpr std::string_view kFile = "file://";
  for (const std::string_view scheme : {"package://", "model://"}) {
    if (!name.starts_with(scheme)) continue;
    name.remove_prefix(scheme.size());
    const std::size_t slash = std::min(name.find('/'), name.size());
    // "package://cup.stl", as onshape-to-robot writes it, names no package.
    const fs::path package(slash < name.size() ? name.substr(0, slash) : "");
    const fs::path rest(slash < name.size() ? name.substr(slash + 1) : name);
    tried = folder / package / rest;
    for (fs::path up = folder; up.has_relative_path(); up = up.parent_path()) {
      if (up.filename() == package && known(up / rest)) return up / rest;
      if (known(up / package / rest)) return up / package / rest;
    }
    // A folder may have another name than the package that it holds (ROS).
    for (fs::path up = folder; up.has_relative_path(); up = up.parent_path()) {
      if (packageIn(up) == package.string() && known(up / rest)) return up / rest;
      int looked_at = 0;
      for (const auto& beside : fs::directory_iterator(up, error)) {
        if (++looked_at > kMostFoldersBeside) break;
        if (packageIn(beside.path()) == package.string() && known(beside.path() / rest)) {
          return beside.path() / rest;
        }
      }
    }
    return {};
  }
  if (name.starts_with(kFile)) name.remove_prefix(kFile.size());
  tried = folder / fs::path(name);
  // Some programs give mesh names relative to the folder that holds all their objects.
  const bool climbs = name.find("..") != name.npos;
  for (fs::path up = folder; up.has_relative_path(); up = up.parent_path()) {
    if (known(up / name)) return up / name;
    if (climbs) break;
  }
  return {};
}

}  // namespace

std::string beyondUrdfBounds(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::array<char, 16384> block;
  std::streamsize bytes = 0;
  std::ptrdiff_t attributes = 0, tags = 0;
  while (in.read(block.data(), block.size()) || in.gcount() > 0) {
    const auto end = block.begin() + in.gcount();
    bytes += in.gcount();
    attributes += std::count(block.begin(), end, '=');
    tags += std::count(block.begin(), end, '<');
    if (bytes > kLargestUrdf_bytes) return "is larger than 4 MB";
    if (attributes > kMostAttributes) return "has more than 8000 attributes";
    if (tags > kMostTags) return "has more than 16000 elements";
  }
  return {};
}

std::optional<std::vector<double>> parseNumbers(std::string text) {
  // "1.5, 2" is two numbers; "1,5" may be one, in the writing of some countries.
  for (std::size_t at = text.find(','); at != text.npos; at = text.find(',', at + 1)) {
    if (at + 1 < text.size() && std::string_view(kBlanks).find(text[at + 1]) != text.npos) {
      text[at] = ' ';
    }
  }
  std::vector<double> numbers;
  std::size_t begin = text.find_first_not_of(kBlanks);
  while (begin != std::string::npos) {
    const std::size_t end = std::min(text.find_first_of(kBlanks, begin), text.size());
    const auto value = meshNumber(std::string_view(text).substr(begin, end - begin));
    if (!value || !std::isfinite(*value)) return std::nullopt;
    numbers.push_back(*value);
    begin = text.find_first_not_of(kBlanks, end);
  }
  return numbers;
}

fs::path meshPath(const std::string& name, const fs::path& urdf) {
  const fs::path folder = fs::absolute(urdf).parent_path();
  std::string slashes = name;
  std::replace(slashes.begin(), slashes.end(), '\\', '/');
  fs::path tried;
  for (const std::string& form : {name, unescaped(name), slashes, unescaped(slashes)}) {
    if (fs::path found = foundMesh(form, folder, tried); !found.empty()) return found;
  }
  return tried;
}

}  // namespace wholehand
