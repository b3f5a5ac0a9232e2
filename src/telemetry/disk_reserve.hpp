#pragma once

#include <cstdint>
#include <string>

namespace wholehand {

/// Claims disk space for a file before it is written. HDF5 cannot mend a file after a write that
/// failed for want of space, so no write may fail: space is claimed first, and where there is none
/// the writer waits. Not for the tick.
class DiskReserve {
 public:
  DiskReserve() = default;
  ~DiskReserve();
  DiskReserve(const DiskReserve&) = delete;
  DiskReserve& operator=(const DiskReserve&) = delete;

  /// Opens (creates, empties) the file. 0 or an errno.
  [[nodiscard]] int create(const std::string& path);
  /// True when the bytes 0 .. end-1 of the file are sure to find room, by disk, quota and
  /// RLIMIT_FSIZE.
  [[nodiscard]] bool claim(std::uint64_t end);
  /// False once the file was removed: what is written to it then is lost when it is closed.
  [[nodiscard]] bool hasName() const;
  /// Marks the file as being written, until release() (flock, shared: HDF5's readers take the
  /// same). For isOpenElsewhere() of others.
  void mark() const;
  /// True where a program writes or reads that file as HDF5 does.
  [[nodiscard]] static bool isOpenElsewhere(const std::string& path);
  /// Gives back what was claimed behind the file's end.
  void release();

 private:
  [[nodiscard]] bool allocate(std::uint64_t end);

  int fd_ = -1;
  std::uint64_t claimed_ = 0;
};

}  // namespace wholehand
