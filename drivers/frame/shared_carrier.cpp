#include "drivers/frame/carriers.hpp"
#include "drivers/frame/firmware/shared_ring.h"
#include "drivers/one_owner.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace wholehand {
namespace {

class SharedCarrier final : public Carrier {
 public:
  SharedCarrier(sr_memory* memory, int fd) : memory_(memory), fd_(fd) {}
  ~SharedCarrier() override {
    ::munmap(memory_, sizeof(sr_memory));
    ::close(fd_);
  }
  SharedCarrier(const SharedCarrier&) = delete;
  SharedCarrier& operator=(const SharedCarrier&) = delete;

  [[nodiscard]] bool send(const std::uint8_t* bytes, std::size_t count) noexcept override {
    (void)sr_put(&memory_->to_device, bytes, count);
    return true;
  }
  [[nodiscard]] int receive(std::uint8_t* bytes, std::size_t capacity) noexcept override {
    return capacity < WF_MAX_WIRE ? 0 : static_cast<int>(sr_get(&memory_->from_device, bytes));
  }
  [[nodiscard]] int descriptor() const noexcept override { return -1; }

 private:
  sr_memory* memory_;
  int fd_;  // keeps the lock on the segment
};

}  // namespace

Expected<std::unique_ptr<Carrier>> openShared(const std::string& locator, const std::string& name) {
  if (name.empty() || name.size() > 32 ||
      name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-") != std::string::npos) {
    return noCarrier(locator, "names no shared memory", "give shm: and 1 to 32 of a-z, 0-9 and -");
  }
  const int fd = ::shm_open(("/wholehand-frame-" + name).c_str(), O_RDWR | O_CLOEXEC, 0);
  if (fd < 0) {
    return noCarrier(locator, std::string("cannot be opened: ") + std::strerror(errno),
                     "start the device's side first, as the same user");
  }
  struct stat file {};
  void* at = MAP_FAILED;
  const bool ours = ::fstat(fd, &file) == 0 && file.st_uid == ::geteuid() &&
                    file.st_size == static_cast<off_t>(sizeof(sr_memory));
  if (ours && !takeAlone(fd)) {
    ::close(fd);
    return noCarrier(locator, kTaken, kEndTheOther);
  }
  if (ours) {
    at = ::mmap(nullptr, sizeof(sr_memory), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  }
  if (at == MAP_FAILED) {
    ::close(fd);
    return noCarrier(locator, "is of another user or another size",
                     "start the device's side of this version, as the same user");
  }
  auto* const memory = static_cast<sr_memory*>(at);
  auto carrier = std::make_unique<SharedCarrier>(memory, fd);
  if (__atomic_load_n(&memory->magic, __ATOMIC_ACQUIRE) != SR_MAGIC ||
      memory->layout != SR_LAYOUT) {
    return noCarrier(locator, "was not set up by a device of this version",
                     "start the device's side of this version");
  }
  return Expected<std::unique_ptr<Carrier>>(std::move(carrier));
}

}  // namespace wholehand
