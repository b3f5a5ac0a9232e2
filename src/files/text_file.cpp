#include "files/text_file.hpp"

#include "core/printable.hpp"
#include "files/durable_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <unistd.h>

namespace wholehand {
namespace fs = std::filesystem;
namespace {

Diagnostic unwritable(const fs::path& path, const std::string& why) {
  return fileFault(path.string(), "cannot be written: " + why,
                   "name a file in a folder that you may write to");
}

Expected<Done> checkWritable(const std::string& path) {
  std::error_code error;
  const fs::file_status there = fs::symlink_status(path, error);
  if (fs::is_directory(there)) return unwritable(path, "it is a folder");
  // The file is replaced by a new one, which must not happen to /dev/null or /dev/stdout.
  if (fs::exists(there) && !fs::is_regular_file(there)) {
    return unwritable(path, "it is not a regular file");
  }
  fs::path folder = fs::absolute(path).parent_path();
  while (!fs::exists(folder, error) && folder != folder.root_path()) folder = folder.parent_path();
  if (!fs::is_directory(folder, error)) {
    return unwritable(path, printable(folder.string()) + " is not a folder");
  }
  if (access(folder.c_str(), W_OK | X_OK) != 0) return unwritable(path, std::strerror(errno));
  return Done{};
}

}  // namespace

Expected<Done> writeText(const std::string& path, const std::string& text) {
  const int error = writeDurably(path, text);
  if (error != 0) return unwritable(path, std::strerror(error));
  return Done{};
}

// Whether two paths name one file, even if it does not exist yet.
bool isSameFile(const std::string& a, const std::string& b) {
  std::error_code error;
  if (fs::equivalent(a, b, error)) return true;
  const fs::path first = fs::weakly_canonical(fs::absolute(a, error), error),
                 second = fs::weakly_canonical(fs::absolute(b, error), error);
  return !first.empty() && first == second;
}

Expected<Done> checkFiles(const std::vector<std::string>& paths,
                          const std::vector<std::string>& inputs) {
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const std::string& path = paths[i];
    if (path.empty()) continue;
    if (auto writable = checkWritable(path); !writable) return writable;
    const auto is_this = [&](const std::string& other) {
      return !other.empty() && isSameFile(path, other);
    };
    const auto begin = paths.begin(), own = begin + static_cast<std::ptrdiff_t>(i);
    if (std::any_of(begin, own, is_this)) {
      return fileFault(path, "is named for two outputs", "give each a file of its own");
    }
    if (std::any_of(inputs.begin(), inputs.end(), is_this)) {
      return fileFault(path, "is read by this run and would be replaced",
                       "write into another file");
    }
  }
  return Done{};
}

Expected<Done> prepareFiles(const std::vector<std::string>& paths) {
  if (auto writable = checkFiles(paths); !writable) return writable;
  for (const std::string& path : paths) {
    if (path.empty()) continue;
    std::error_code error;
    fs::create_directories(fs::absolute(path).parent_path(), error);
    if (error) return unwritable(path, error.message());
  }
  return Done{};
}

}  // namespace wholehand
