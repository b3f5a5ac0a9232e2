#pragma once

#include "realtime/machine_facts.hpp"
#include "realtime/wakeup_probe.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace wholehand {

/// What a finding stands in the way of.
enum class Blocks { kNothing, kDevice, kEverything };

struct DoctorFinding {
  std::string what;
  bool good = false;
  Blocks blocks = Blocks::kNothing;  ///< while it is not good
  std::string fact;
  std::string remedy;  ///< empty where good
  // For the one sentence at the end; empty: it says nothing there.
  std::string reason{};  ///< "the kernel is not PREEMPT_RT"
  std::string cure{};    ///< "start a kernel with PREEMPT_RT"
};
using Findings = std::vector<DoctorFinding>;

/// How often the loop is woken, and how long that is tried.
inline constexpr std::int64_t kDoctorPeriod_ns = 1'000'000;
inline constexpr std::size_t kDoctorWakeUps = 3000;

/// Kernel, cores, governor and limits. @param root whoever asks may exceed the limits
[[nodiscard]] Findings findingsAboutMachine(const MachineFacts& machine, bool root);
/// How this program was built, the packages of the list, the free disk.
[[nodiscard]] Findings findingsAboutSoftware(const std::filesystem::path& packages_file);
/// Serial adapters that keep what a device says for longer than they must. FTDI's wait for more
/// bytes, 16 ms where nobody has changed it. @param folder /sys/bus/usb-serial/devices
[[nodiscard]] Findings findingsAboutAdapters(const std::filesystem::path& folder);
/// What a loop's thread is granted and how late it woke up.
[[nodiscard]] Findings findingsAboutLoop(const WakeUpProbe& probe, std::int64_t period_ns);
/// That there is no loop at all.
[[nodiscard]] Findings findingsAboutNoLoop(const Diagnostics& why);

struct Verdict {
  bool fit = false;
  std::string sentence;  ///< whether this machine may drive a device, why, and what to do
};
[[nodiscard]] Verdict verdictOf(const Findings& findings);

}  // namespace wholehand
