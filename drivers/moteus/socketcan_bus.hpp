#pragma once

#include "can_bus.hpp"

#include <cstdint>
#include <memory>
#include <string>

namespace wholehand::moteus {

/// A network interface of the kernel (`can0`) with CAN-FD frames.
class SocketCanBus final : public CanBus {
 public:
  /// Refused by name: a kernel without CAN, no such interface, one that has no CAN-FD, one that is
  /// held.
  [[nodiscard]] static Expected<std::unique_ptr<CanBus>> open(const std::string& interface);
  /// Takes the socket over, which does not block, and what holds the bus for it; −1: nothing.
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
