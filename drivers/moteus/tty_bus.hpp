#pragma once

#include "can_bus.hpp"
#include "can_lines.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace wholehand::moteus {

/// A CAN adapter behind a tty with a line protocol. Raw and non-blocking. Bytes that the tty does
/// not accept at once wait in a buffer of 4 KiB and are sent first with the next frame.
class TtyBus final : public CanBus {
 public:
  enum class Protocol { kFdcanusb, kSlcan };

  /// Opens a port. Refused, each by name: a port that cannot be opened, or that is not a tty.
  [[nodiscard]] static Expected<std::unique_ptr<CanBus>> open(const std::string& port,
                                                              Protocol protocol);
  /// Takes ownership of a non-blocking descriptor.
  TtyBus(int descriptor, Protocol protocol) noexcept;
  ~TtyBus() override;
  TtyBus(const TtyBus&) = delete;
  TtyBus& operator=(const TtyBus&) = delete;

  /// kFailed when the port is gone, or when the buffer is full because the port accepts nothing.
  [[nodiscard]] BusResult send(const CanFrame& frame) noexcept override;
  /// kFailed when the port is gone, even in the middle of a line.
  [[nodiscard]] BusResult receive(CanFrame& frame) noexcept override;
  [[nodiscard]] std::uint64_t errors() const noexcept override {
    return errors_ + splitter_.dropped();
  }

 private:
  [[nodiscard]] BusResult fail() noexcept;
  [[nodiscard]] bool flush() noexcept;
  [[nodiscard]] bool queue(const char* text, std::size_t length) noexcept;

  int descriptor_;
  Protocol protocol_;
  bool failed_ = false;
  std::uint64_t errors_ = 0;
  LineSplitter splitter_;
  std::array<char, 4096> in_{}, out_{};
  std::size_t in_begin_ = 0, in_end_ = 0, out_end_ = 0;
};

}  // namespace wholehand::moteus
