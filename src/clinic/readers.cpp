#include "clinic/readers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <sys/stat.h>
#include <unistd.h>

namespace wholehand::clinic {
namespace {

/// Bytes of the file -shm that SQLite locks: for writers and for readers of the write-ahead log
/// (https://sqlite.org/walformat.html).
constexpr std::int64_t kFirstLock = 120, kLastLock = 127;

std::string nameOf(std::int64_t process) {
  std::string name;
  std::ifstream in(fmt::format("/proc/{}/comm", process));
  if (process <= 0 || !std::getline(in, name)) return "another program";
  return fmt::format("{} (process {})", name, process);
}

}  // namespace

Readers::Turn::Turn(Readers& readers) : readers_(readers), round_(readers.round_) {
  const std::lock_guard lock(readers_.mutex_);
  ++readers_.turns_;
}

Readers::Turn::~Turn() {
  const std::lock_guard lock(readers_.mutex_);
  if (--readers_.turns_ == 0) readers_.all_gone_.notify_all();
}

void Readers::end() {
  std::unique_lock lock(mutex_);
  ++round_;
  all_gone_.wait(lock, [this] { return turns_ == 0; });
}

std::vector<std::string> otherReaders(const std::string& database) {
  std::vector<std::string> out;
  struct stat file {};
  // The file is not opened: closing it would release SQLite's own locks.
  if (::stat((database + "-shm").c_str(), &file) != 0) return out;
  // "7: POSIX  ADVISORY  READ 812 fd:00:131077 124 124"
  std::ifstream in("/proc/locks");
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string number, kind, advisory, mode, inode;
    std::int64_t process = 0, first = 0, last = 0;
    if (!(words >> number >> kind >> advisory >> mode >> process >> inode >> first >> last))
      continue;
    const bool same = inode.substr(inode.rfind(':') + 1) == std::to_string(file.st_ino);
    if (!same || last < kFirstLock || first > kLastLock || process == ::getpid()) continue;
    std::string name = nameOf(process);
    if (std::find(out.begin(), out.end(), name) == out.end()) out.push_back(std::move(name));
  }
  return out;
}

}  // namespace wholehand::clinic
