#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace wholehand {

/// Writes a file by way of a temporary one beside it, with a CRC-32 of what was put since it was
/// last taken. All of it async-signal-safe: only open, write, fsync, close, rename and unlink, and
/// no memory but its own. What it is given may change while it is written: what is written and what
/// is summed up are one copy.
class SignalSafeFile {
 public:
  /// @param temporary is renamed to `path` in the end @pre both live on, ended by a zero
  /// 0, or the errno with which it could not be created.
  [[nodiscard]] int create(const char* temporary, const char* path) noexcept;
  /// After a failure nothing is written any more, and close() tells of it.
  void put(const void* bytes, std::size_t count) noexcept;
  /// The CRC-32 of what was put since the last call.
  [[nodiscard]] std::uint32_t takeCrc() noexcept;
  /// Brings it to the disk under its name. 0, or an errno; then there is no file.
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
