#include "files/text/text_file.hpp"

#include "loop/core/printable.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <sys/random.h>
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
  // Writing replaces the file by a new one, which must not happen to /dev/null or /dev/stdout.
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

// True when two paths name the same file, even if it does not exist yet.
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

namespace {

constexpr int kTries = 16;
constexpr int kMostOfOneName = 10000;

int syncAndClose(int file) {
  const int error = ::fsync(file) != 0 ? errno : 0;
  ::close(file);
  return error;
}

// Syncs a folder. File systems that report that they cannot sync a folder are accepted.
int syncFolder(const std::filesystem::path& folder) {
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return errno;
  const int error = syncAndClose(file);
  return error == EINVAL || error == ENOTSUP ? 0 : error;
}

// Creates a new file in the same folder with a random name. @return its descriptor, or -1
int createBeside(const std::string& path, std::string& name) {
  for (int i = 0; i < kTries; ++i) {
    const std::string random = randomName();
    if (random.empty()) return -1;
    name = path;
    name += "." + random + ".tmp";
    const int file = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file >= 0 || errno != EEXIST) return file;
  }
  return -1;
}

int writeAll(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t taken = ::write(file, bytes.data(), bytes.size());
    if (taken < 0 && errno == EINTR) continue;
    if (taken < 0) return errno;
    if (taken == 0) return ENOSPC;
    bytes.remove_prefix(static_cast<std::size_t>(taken));
  }
  return 0;
}

int syncFoldersOf(const std::string& path) {
  const auto folder = std::filesystem::path(path).parent_path();
  const std::filesystem::path here = folder.empty() ? "." : folder;
  const int error = syncFolder(here);
  // Syncs the parent too, because the folder may be new. Errors are ignored: the parent may be
  // unreadable.
  (void)syncFolder(here / "..");
  return error;
}

int syncFile(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  return file < 0 ? errno : syncAndClose(file);
}

int takeName(const std::string& finished, const std::string& path) {
  return std::rename(finished.c_str(), path.c_str()) != 0 ? errno : syncFoldersOf(path);
}

}  // namespace

std::string randomName() {
  std::uint64_t random = 0;
  if (::getrandom(&random, sizeof random, 0) != sizeof random) return {};
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(random));
  return text;
}

int takeNewName(const std::string& stem, const std::string& extension, std::string& path) {
  path = stem + extension;
  for (int i = 2;; ++i) {
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file >= 0) return ::close(file) == 0 ? 0 : errno;
    if (errno != EEXIST || i > kMostOfOneName) return errno;
    path = stem + "-" + std::to_string(i) + extension;
  }
}

int writeDurably(const std::string& path, std::string_view bytes) {
  std::string beside;
  const int file = createBeside(path, beside);
  if (file < 0) return errno;
  int error = writeAll(file, bytes);
  const int unsynced = syncAndClose(file);
  if (error == 0) error = unsynced;
  if (error == 0) error = takeName(beside, path);
  if (error != 0) ::unlink(beside.c_str());
  return error;
}

int renameDurably(const std::string& finished, const std::string& path) {
  const int error = syncFile(finished);
  return error != 0 ? error : takeName(finished, path);
}

int syncDurably(const std::string& path) {
  const int error = syncFile(path);
  return error != 0 ? error : syncFoldersOf(path);
}

}  // namespace wholehand
