#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace wholehand {

/// Writes a file through a temporary one beside it, with a CRC-32 of the data written since the
/// last takeCrc(). Async-signal-safe: uses only open, write, fsync, close, rename and unlink, and
/// no memory but its own. The data may change during writing: file and CRC are computed from one
/// copy.
class SignalSafeFile {
 public:
  /// Creates the temporary file, which must not be there yet. Returns 0 or an errno.
  /// @param temporary renamed to `path` by close() @pre both are zero-terminated and outlive this
  [[nodiscard]] int create(const char* temporary, const char* path) noexcept;
  /// Writes data. After a failure nothing more is written, and close() reports it.
  void put(const void* bytes, std::size_t count) noexcept;
  /// CRC-32 of the data since the last call.
  [[nodiscard]] std::uint32_t takeCrc() noexcept;
  /// Syncs the file to disk and gives it its name. Returns 0, or an errno; then there is no file.
  [[nodiscard]] int close() noexcept;

 private:
  void writeOut() noexcept;

  const char* temporary_ = nullptr;
  const char* path_ = nullptr;
  int fd_ = -1;
  int error_ = 0;
  std::uint32_t crc_ = 0;
  std::size_t used_ = 0;
  alignas(64) std::array<std::byte, std::size_t{64} << 10U> buffer_{};
};

}  // namespace wholehand
