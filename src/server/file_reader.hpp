#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace wholehand {

/// Reads a regular file in pieces. Every call, closing included, may wait for the disk: use it on a
/// worker (FileWorkers), never on the thread that handles stops.
class FileReader {
 public:
  /// Largest piece [bytes].
  static constexpr std::size_t kPiece = 64 * 1024;

  /// Opens a file; null when there is none.
  [[nodiscard]] static std::unique_ptr<FileReader> open(const std::string& path);
  ~FileReader();
  FileReader(const FileReader&) = delete;
  FileReader& operator=(const FileReader&) = delete;

  /// Size of the file when it was opened [bytes].
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  /// Bytes not read yet.
  [[nodiscard]] std::uint64_t left() const noexcept { return left_; }
  /// Reads the next piece. Empty at the end, or when the file was shortened or cannot be read.
  [[nodiscard]] std::string next();

 private:
  FileReader(int fd, std::uint64_t size) : fd_(fd), size_(size), left_(size) {}

  int fd_;
  std::uint64_t size_, left_;
};

}  // namespace wholehand
