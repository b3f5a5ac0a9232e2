#pragma once

#include "loop/realtime/machine_facts.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace wholehand {

/// What a bad finding prevents.
enum class Blocks { kNothing, kDevice, kEverything };

struct DoctorFinding {
  std::string what;
  bool good = false;
  Blocks blocks = Blocks::kNothing;  ///< effect unless it is good
  std::string fact;
  std::string remedy;  ///< empty if good
  // Parts of the final sentence; empty: not mentioned.
  std::string reason{};  ///< "the kernel is not PREEMPT_RT"
  std::string cure{};    ///< "start a kernel with PREEMPT_RT"
};
using Findings = std::vector<DoctorFinding>;

/// Period and duration of the wake-up test.
inline constexpr std::int64_t kDoctorPeriod_ns = 1'000'000;
inline constexpr std::size_t kDoctorWakeUps = 3000;

/// Findings on kernel, cores, governor and limits. @param root true if the user may exceed the
/// limits
[[nodiscard]] Findings findingsAboutMachine(const MachineFacts& machine, bool root);
/// Findings on this program's build, the listed packages and the free disk space.
[[nodiscard]] Findings findingsAboutSoftware(const std::filesystem::path& packages_file);
/// Findings on serial adapters that delay received data. FTDI adapters wait for more bytes, 16 ms
/// by default. @param folder /sys/bus/usb-serial/devices
[[nodiscard]] Findings findingsAboutAdapters(const std::filesystem::path& folder);
/// Findings on the loop thread's settings and its wake-up lateness.
[[nodiscard]] Findings findingsAboutLoop(const WakeUpProbe& probe, std::int64_t period_ns);
/// Finding that the loop could not be run.
[[nodiscard]] Findings findingsAboutNoLoop(const Diagnostics& why);

struct Verdict {
  bool fit = false;
  std::string sentence;  ///< whether this machine may drive a device, why, and what to do
};
[[nodiscard]] Verdict verdictOf(const Findings& findings);

}  // namespace wholehand
