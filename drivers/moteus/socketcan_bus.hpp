#pragma once

#include "can_bus.hpp"

#include <cstdint>
#include <memory>
#include <string>

namespace wholehand::moteus {

/// A network interface of the kernel (`can0`) with CAN-FD frames.
class SocketCanBus final : public CanBus {
 public:
  /// Opens an interface. Refused, each by name: a kernel without CAN, no such interface, one
  /// without CAN-FD, one that is in use.
  [[nodiscard]] static Expected<std::unique_ptr<CanBus>> open(const std::string& interface);
  /// Takes ownership of a non-blocking socket.
  /// @param held descriptor that holds the lock of the bus; −1: none
  explicit SocketCanBus(int descriptor, int held = -1) noexcept
      : descriptor_(descriptor), held_(held) {}
  ~SocketCanBus() override;
  SocketCanBus(const SocketCanBus&) = delete;
  SocketCanBus& operator=(const SocketCanBus&) = delete;

  [[nodiscard]] BusResult send(const CanFrame& frame) noexcept override;
  [[nodiscard]] BusResult receive(CanFrame& frame) noexcept override;
  [[nodiscard]] std::uint64_t errors() const noexcept override { return errors_; }

 private:
  int descriptor_;
  int held_;
  std::uint64_t errors_ = 0;
};

}  // namespace wholehand::moteus
