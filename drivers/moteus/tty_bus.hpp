#pragma once

#include "can_bus.hpp"
#include "can_lines.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace wholehand::moteus {

/// A CAN adapter behind a tty that speaks lines. Raw and non-blocking: what the tty does not take
/// at once waits in a buffer of 4 KiB and goes first with the next frame.
class TtyBus final : public CanBus {
 public:
  enum class Protocol { kFdcanusb, kSlcan };

  /// Refused by name: a port that cannot be opened, or that is no tty.
  [[nodiscard]] static Expected<std::unique_ptr<CanBus>> open(const std::string& port,
                                                              Protocol protocol);
  /// Takes the descriptor over, which does not block.
  TtyBus(int descriptor, Protocol protocol) noexcept;
  ~TtyBus() override;
  TtyBus(const TtyBus&) = delete;
  TtyBus& operator=(const TtyBus&) = delete;

  /// kFailed where the port is gone, or has taken nothing for so long that the buffer is full.
  [[nodiscard]] BusResult send(const CanFrame& frame) noexcept override;
  /// kFailed where the port is gone, in the middle of a line or not.
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
