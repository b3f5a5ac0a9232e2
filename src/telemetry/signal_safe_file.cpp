#include "telemetry/signal_safe_file.hpp"

#include "core/crc32.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>

namespace wholehand {

int SignalSafeFile::create(const char* temporary, const char* path) noexcept {
  temporary_ = temporary;
  path_ = path;
  error_ = 0;
  crc_ = 0;
  used_ = 0;
  fd_ = ::open(temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd_ < 0) error_ = errno;
  return error_;
}

void SignalSafeFile::put(const void* bytes, std::size_t count) noexcept {
  const auto* from = static_cast<const std::byte*>(bytes);
  while (count > 0 && error_ == 0) {
    const std::size_t piece = std::min(count, buffer_.size() - used_);
    std::memcpy(buffer_.data() + used_, from, piece);
    crc_ = crc32(crc_, buffer_.data() + used_, piece);
    used_ += piece;
    from += piece;
    count -= piece;
    if (used_ == buffer_.size()) writeOut();
  }
}

void SignalSafeFile::writeOut() noexcept {
  std::size_t done = 0;
  while (done < used_ && error_ == 0) {
    const ssize_t n = ::write(fd_, buffer_.data() + done, used_ - done);
    if (n >= 0) {
      done += n;
    } else if (errno != EINTR) {
      error_ = errno;
    }
  }
  used_ = 0;
}

std::uint32_t SignalSafeFile::takeCrc() noexcept {
  const std::uint32_t crc = crc_;
  crc_ = 0;
  return crc;
}

int SignalSafeFile::close() noexcept {
  if (fd_ < 0) return error_;
  writeOut();
  if (error_ == 0 && ::fsync(fd_) != 0) error_ = errno;
  if (::close(fd_) != 0 && error_ == 0) error_ = errno;
  fd_ = -1;
  if (error_ == 0 && ::rename(temporary_, path_) != 0) error_ = errno;
  if (error_ != 0) ::unlink(temporary_);
  return error_;
}

}  // namespace wholehand
