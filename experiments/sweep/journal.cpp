#include "experiments/sweep/journal.hpp"

#include "devices/passport/sealed_file.hpp"
#include "files/text/text_file.hpp"
#include "loop/core/crc32.hpp"

#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <string_view>
#include <sys/file.h>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <utility>

namespace wholehand {
namespace fs = std::filesystem;
namespace {

/// Number of attempts to lock. The processes of a killed program keep its lock for a moment.
constexpr int kLockTries = 100;
constexpr std::chrono::milliseconds kLockAgain{20};

constexpr int kMostFiles = 100'000;

/// Encodes a cell as bytes: index, figures, and a checksum of both.
std::string encode(int cell, const std::vector<double>& figures) {
  const auto index = static_cast<std::uint64_t>(cell);
  std::string bytes(sizeof index + figures.size() * sizeof(double), '\0');
  std::memcpy(bytes.data(), &index, sizeof index);
  std::memcpy(bytes.data() + sizeof index, figures.data(), figures.size() * sizeof(double));
  const std::uint32_t crc =
      crc32(0, reinterpret_cast<const std::byte*>(bytes.data()), bytes.size());
  return bytes.append(reinterpret_cast<const char*>(&crc), sizeof crc);
}

std::size_t recordSize(int figures) {
  return sizeof(std::uint64_t) + static_cast<std::size_t>(figures) * sizeof(double) +
         sizeof(std::uint32_t);
}

/// Decodes a cell; returns false when the bytes are damaged.
bool decode(std::string_view bytes, int& cell, std::vector<double>& figures) {
  std::uint64_t index = 0;
  std::memcpy(&index, bytes.data(), sizeof index);
  cell = static_cast<int>(index);
  std::memcpy(figures.data(), bytes.data() + sizeof index, figures.size() * sizeof(double));
  return encode(cell, figures) == bytes;
}

bool tryLock(int file, bool alone) {
  for (int i = 0; i < kLockTries; ++i) {
    if (::flock(file, (alone ? LOCK_EX : LOCK_SH) | LOCK_NB) == 0) return true;
    std::this_thread::sleep_for(kLockAgain);
  }
  return false;
}

Diagnostic cannotWrite(const std::string& path) {
  return keyFault(
      path, "", std::strerror(errno), "cannot be written",
      "is the disk full, or the folder read-only? What is finished stays; run the same again");
}

}  // namespace

SweepJournal::SweepJournal(std::string folder, int figures)
    : folder_(std::move(folder)), figures_(figures) {}

Expected<SweepJournal> SweepJournal::open(const std::string& folder, const std::string& digest,
                                          int figures, bool alone) {
  std::error_code error;
  fs::create_directories(folder, error);
  // The lock is held until the last process of this program has ended.
  const int lock = ::open((folder + "/lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (lock < 0) return cannotWrite(folder);
  if (!tryLock(lock, alone)) {
    ::close(lock);
    return fileFault(folder, "is in use by another `wholehand sweep`",
                     "wait for it, or give both a --share of the cells");
  }
  const std::string path = folder + "/digest";
  if (!fs::exists(path, error)) {
    // Several processes may begin at once. Each writes the same text to a file with its own name.
    const std::string own = path + "." + std::to_string(::getpid());
    if (auto written = writeText(own, digest + "\n"); !written) return written.errors();
    // A link keeps the file of the first process. A rename would replace it, and two different
    // sweeps of one name would each find their own digest.
    if (::link(own.c_str(), path.c_str()) != 0 && errno != EEXIST) {
      fs::rename(own, path, error);  // for a file system without links
    }
    fs::remove(own, error);
  }
  const auto found = readWhole(path);
  if (!found || *found != digest + "\n") {
    return fileFault(folder, "holds cells of another grid, of other files, or of another program",
                     "name another --out, or remove this folder");
  }
  return SweepJournal(folder, figures);
}

std::map<int, std::vector<double>> SweepJournal::finished() const {
  std::map<int, std::vector<double>> cells;
  std::error_code error;
  const std::size_t size = recordSize(figures_);
  for (fs::directory_iterator it(folder_, error), end; !error && it != end; it.increment(error)) {
    if (it->path().extension() != ".cells") continue;
    const auto bytes = readWhole(it->path().string());
    if (!bytes) continue;
    for (std::size_t at = 0; at + size <= bytes->size(); at += size) {
      int cell = 0;
      std::vector<double> figures(static_cast<std::size_t>(figures_));
      if (decode(std::string_view(*bytes).substr(at, size), cell, figures)) {
        cells[cell] = std::move(figures);
      }
    }
  }
  return cells;
}

// Opens the first file that no living process holds, and cuts off a half-written end.
Expected<Done> SweepJournal::openOwnFile() {
  for (int i = 0; i < kMostFiles; ++i) {
    const std::string path = folder_ + "/" + std::to_string(i) + ".cells";
    const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    if (file < 0) return cannotWrite(path);
    if (::flock(file, LOCK_EX | LOCK_NB) != 0) {
      ::close(file);
      continue;
    }
    const off_t length = ::lseek(file, 0, SEEK_END);
    const auto size = static_cast<off_t>(recordSize(figures_));
    if (length % size != 0 && ::ftruncate(file, length - length % size) != 0) {
      ::close(file);
      return cannotWrite(path);
    }
    file_ = file;
    owner_pid_ = ::getpid();
    return Done{};
  }
  return cannotWrite(folder_);
}

Expected<Done> SweepJournal::append(int cell, const std::vector<double>& figures) {
  if (file_ < 0 || owner_pid_ != ::getpid()) {
    if (auto opened = openOwnFile(); !opened) return opened.errors();
  }
  const std::string bytes = encode(cell, figures);
  if (::write(file_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size())) {
    return Done{};
  }
  return cannotWrite(folder_);
}

void SweepJournal::remove() const {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

}  // namespace wholehand
