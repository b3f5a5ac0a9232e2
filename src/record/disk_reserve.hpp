#pragma once

#include <cstdint>
#include <string>

namespace wholehand {

/// A notice is given when the disk has room for less than this duration.
inline constexpr double kRoomWorthReporting_s = 1800.0;

/// Notice before a recording begins: "the disk has room for about 4 minutes of recording:
/// out/run.h5 (28 MB)". Empty when there is room for half an hour or for the known length, or when
/// the free space is unknown. Accesses the disk.
/// @param length_s length of the recording; 0: unknown
[[nodiscard]] std::string roomNotice(const std::string& recording, double period_s,
                                     double length_s);

/// The notice for a number of free bytes. Used by roomNotice() and tests.
[[nodiscard]] std::string roomSentence(const std::string& recording, std::uint64_t free_bytes,
                                       double period_s, double length_s);

/// Allocates disk space for a file before it is written. HDF5 cannot recover a file after a write
/// failed for lack of space. Space is therefore allocated first, and the writer waits until it gets
/// space. Not real-time safe.
class DiskReserve {
 public:
  DiskReserve() = default;
  ~DiskReserve();
  DiskReserve(const DiskReserve&) = delete;
  DiskReserve& operator=(const DiskReserve&) = delete;

  /// Creates or truncates the file. Returns 0 or an errno.
  [[nodiscard]] int create(const std::string& path);
  /// True when the bytes 0 .. end-1 of the file are guaranteed space by disk, quota and
  /// RLIMIT_FSIZE.
  [[nodiscard]] bool claim(std::uint64_t end);
  /// False after the file was unlinked: data written from then on is lost when the file is closed.
  [[nodiscard]] bool hasName() const;
  /// Marks the file as being written until release(), with a shared flock like HDF5's readers.
  /// isOpenElsewhere() detects the mark.
  void mark() const;
  /// True when a program has the file open for writing or reading with an flock as HDF5 does.
  [[nodiscard]] static bool isOpenElsewhere(const std::string& path);
  /// Frees the space allocated beyond the file's end.
  void release();

 private:
  [[nodiscard]] bool allocate(std::uint64_t end);

  int fd_ = -1;
  std::uint64_t claimed_ = 0;
};

}  // namespace wholehand
