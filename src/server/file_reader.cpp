#include "server/file_reader.hpp"

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace wholehand {

std::unique_ptr<FileReader> FileReader::open(const std::string& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return nullptr;
  struct stat status {};
  if (::fstat(fd, &status) != 0 || !S_ISREG(status.st_mode)) {
    ::close(fd);
    return nullptr;
  }
  return std::unique_ptr<FileReader>(
      new FileReader(fd, static_cast<std::uint64_t>(status.st_size)));
}

FileReader::~FileReader() {
  ::close(fd_);
}

std::string FileReader::next() {
  std::string piece(std::min<std::uint64_t>(kPiece, left_), '\0');
  std::size_t have = 0;
  while (have < piece.size()) {
    const ssize_t n = ::read(fd_, piece.data() + have, piece.size() - have);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    have += n;
  }
  piece.resize(have);
  left_ -= have;
  return piece;
}

}  // namespace wholehand
