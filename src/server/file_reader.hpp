#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace wholehand {

/// A regular file that is read in pieces. Whatever it does waits for the disk, closing included: it
/// belongs on a worker (FileWorkers), never on the thread of stops.
class FileReader {
 public:
  /// The most bytes of one piece.
  static constexpr std::size_t kPiece = 64 * 1024;

  /// Null where there is no such file.
  [[nodiscard]] static std::unique_ptr<FileReader> open(const std::string& path);
  ~FileReader();
  FileReader(const FileReader&) = delete;
  FileReader& operator=(const FileReader&) = delete;

  /// Of the file when it was opened.
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  /// Not read yet.
  [[nodiscard]] std::uint64_t left() const noexcept { return left_; }
  /// The next piece; empty where all are read, or the file has become shorter or cannot be read.
  [[nodiscard]] std::string next();

 private:
  FileReader(int fd, std::uint64_t size) : fd_(fd), size_(size), left_(size) {}

  int fd_;
  std::uint64_t size_, left_;
};

}  // namespace wholehand
