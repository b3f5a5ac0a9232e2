#pragma once

namespace wholehand::moteus {

/// Modes of a drive (register 0x000).
inline constexpr int kModeStopped = 0, kModeFault = 1, kModePosition = 10, kModeTimeout = 11;

/// Meaning of a fault code (register 0x00f). Codes from 96 on are limits in effect while the drive
/// continues. Source: docs/protocol/registers.md and fw/error.h of mjbots/moteus.
[[nodiscard]] const char* faultText(int code) noexcept;
[[nodiscard]] constexpr bool isLimit(int code) noexcept {
  return code >= 96;
}
/// True for a limit caused by heat.
[[nodiscard]] constexpr bool isDerating(int code) noexcept {
  return code == 100 || code == 101;
}

}  // namespace wholehand::moteus
