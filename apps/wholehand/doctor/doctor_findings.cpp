#include "apps/wholehand/doctor/doctor_findings.hpp"

#include "loop/core/printable.hpp"
#include "rig/engines.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>

namespace wholehand {
namespace {

// Free space for recordings. A full disk ends the recording, not the run.
constexpr double kDiskWanted_gb = 2.0;

const char* const kLimitsRemedy =
    "Put the line '@realtime - %s' into /etc/security/limits.d/realtime.conf, add yourself to the "
    "group realtime (groupadd -f realtime; usermod -aG realtime <you>) and log in again.";

// Texts of the final sentence. A limit and its effect share one reason.
const char* const kNoPriority = "real-time priority is not granted";
const char* const kGrantPriority = "grant rtprio 99";
const char* const kNoCore = "the loop has no core of its own";
const char* const kGrantCore = "give it a second core";
const char* const kNoMemory = "its memory cannot be locked";
const char* const kGrantMemory = "grant memlock unlimited";

std::string limitsRemedy(const char* item) {
  std::array<char, 400> text{};
  std::snprintf(text.data(), text.size(), kLimitsRemedy, item);
  return text.data();
}

std::string decimal(double value, int digits) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return text.data();
}

std::string listOf(const std::vector<int>& numbers) {
  std::string text;
  for (const int number : numbers) {
    text += (text.empty() ? "" : ", ") + std::to_string(number);
  }
  return text;
}

void lookAtKernelAndCores(const MachineFacts& m, Findings& findings) {
  findings.push_back(
      {"kernel", m.real_time_kernel, Blocks::kDevice,
       m.kernel + (m.real_time_kernel ? ", real time (PREEMPT_RT)" : ", not a real-time kernel"),
       "apt-get install linux-image-rt-amd64, then start that kernel.",
       m.real_time_kernel ? "its kernel is PREEMPT_RT" : "its kernel is not PREEMPT_RT",
       "start a kernel with PREEMPT_RT (package linux-image-rt-amd64)"});
  findings.push_back(
      {"cores", m.cpus_allowed > 1, Blocks::kDevice,
       std::to_string(m.cpus_allowed) + " of " + std::to_string(m.cpus_online) + " usable",
       "Give the program a second core: the loop wants one of its own.",
       m.cpus_allowed > 1 ? "" : kNoCore, kGrantCore});
  findings.push_back({"isolated cores", !m.isolated.empty(), Blocks::kNothing,
                      m.isolated.empty() ? "none" : listOf(m.isolated),
                      "Boot with isolcpus=" + std::to_string(m.cpus_online - 1) + " nohz_full=" +
                          std::to_string(m.cpus_online - 1) + " to keep the loop's core free."});
  if (m.governor.empty()) {
    findings.push_back(
        {"governor", true, Blocks::kNothing, "none: the kernel shows no cpufreq", ""});
  } else {
    findings.push_back({"governor", m.governor == "performance", Blocks::kDevice, m.governor,
                        "cpupower frequency-set -g performance (package linux-cpupower).",
                        "its governor is " + m.governor, "set the governor performance"});
  }
}

void lookAtLimits(const MachineFacts& m, bool root, Findings& findings) {
  const bool priority = root || m.rtprio_limit < 0 || m.rtprio_limit >= 80;
  findings.push_back({"rtprio limit", priority, Blocks::kDevice,
                      (m.rtprio_limit < 0 ? "unlimited" : std::to_string(m.rtprio_limit)) +
                          std::string(root ? ", but root may anyway" : ", 80 wanted"),
                      limitsRemedy("rtprio 99"), priority ? "" : kNoPriority, kGrantPriority});
  const bool memory = root || m.memlock_limit_bytes < 0;
  findings.push_back(
      {"memlock limit", memory, Blocks::kDevice,
       (m.memlock_limit_bytes < 0 ? "unlimited"
                                  : std::to_string(m.memlock_limit_bytes / 1024) + " KiB") +
           std::string(root && m.memlock_limit_bytes >= 0 ? ", but root may anyway" : ""),
       limitsRemedy("memlock unlimited"), memory ? "" : kNoMemory, kGrantMemory});
}

/// Packages under [run] in the list: one per line; # begins a comment.
std::vector<std::string> packagesToRun(const std::filesystem::path& file) {
  std::vector<std::string> packages;
  std::ifstream stream(file);
  std::string line;
  bool in_run = false;
  while (std::getline(stream, line)) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string word;
    while (words >> word) {
      if (word.front() == '[') {
        in_run = word == "[run]";
      } else if (in_run) {
        packages.push_back(word);
      }
    }
  }
  return packages;
}

/// Packages installed by dpkg, one per line; empty without dpkg.
std::vector<std::string> installedPackages() {
  std::vector<std::string> installed;
  FILE* pipe = popen("dpkg-query -W -f='${db:Status-Status} ${Package}\\n' 2>/dev/null", "re");
  if (pipe == nullptr) {
    return installed;
  }
  std::array<char, 512> line{};
  while (std::fgets(line.data(), static_cast<int>(line.size()), pipe) != nullptr) {
    std::istringstream words(line.data());
    std::string status;
    std::string package;
    if (words >> status >> package && status == "installed") {
      installed.push_back(package);
    }
  }
  pclose(pipe);
  std::sort(installed.begin(), installed.end());
  return installed;
}

void lookAtPackages(const std::filesystem::path& file, Findings& findings) {
  // An installed program has no list, because dpkg checks its dependencies.
  if (!std::filesystem::exists(file)) return;
  const std::vector<std::string> wanted = packagesToRun(file);
  const std::vector<std::string> installed = installedPackages();
  if (wanted.empty() || installed.empty()) {
    findings.push_back({"packages", false, Blocks::kNothing,
                        wanted.empty() ? "the list " + printable(file.string()) + " cannot be read"
                                       : "dpkg-query reports nothing: no Debian?",
                        "Nothing to do as long as ./start builds."});
    return;
  }
  std::string missing;
  for (const std::string& package : wanted) {
    if (!std::binary_search(installed.begin(), installed.end(), package)) {
      missing += " " + package;
    }
  }
  findings.push_back({"packages", missing.empty(), Blocks::kNothing,
                      missing.empty() ? "all " + std::to_string(wanted.size()) +
                                            " of scripts/packages.txt that a build needs"
                                      : "missing:" + missing,
                      "apt-get install" + missing});
}

void lookAtDisk(Findings& findings) {
  std::error_code error;
  const std::filesystem::path here = std::filesystem::current_path(error);
  const std::filesystem::space_info space = std::filesystem::space(here, error);
  const double free_gb = error ? 0.0 : static_cast<double>(space.available) * 1e-9;
  findings.push_back({"free disk", free_gb >= kDiskWanted_gb, Blocks::kNothing,
                      decimal(free_gb, 1) + " GB in " + printable(here.string()),
                      "Free " + decimal(kDiskWanted_gb, 0) + " GB here, or record elsewhere."});
}

void lookAtBuild(Findings& findings) {
#if defined(__OPTIMIZE__) && defined(NDEBUG)
  const bool optimised = true;
#else
  const bool optimised = false;
#endif
#if defined(__clang__)
  const std::string compiler = "clang " __clang_version__;
#else
  const std::string compiler = "g++ " __VERSION__;
#endif
  findings.push_back({"build", optimised, Blocks::kDevice,
                      compiler + (optimised ? ", optimised" : ", not optimised or with assertions"),
                      "Use build/release/wholehand, which ./start builds.",
                      optimised ? "" : "this program is not an optimised build",
                      "use build/release/wholehand"});
  std::string built;
  for (const Engine& engine : engines()) {
    if (engine.build)
      built += (built.empty() ? "" : "; ") + engine.name + ": " + engine.description;
  }
  findings.push_back({"engine", true, Blocks::kNothing, built, ""});
}

DoctorFinding grantedOrNot(const SetupLine& line) {
  const std::string mark = " Remedy: ";
  const std::size_t remedy = std::min(line.sentence.find(mark), line.sentence.size());
  DoctorFinding finding{line.what, line.granted, Blocks::kDevice, line.sentence.substr(0, remedy),
                        ""};
  if (remedy < line.sentence.size()) finding.remedy = line.sentence.substr(remedy + mark.size());
  if (line.what == "real-time priority") {
    finding.reason = line.granted ? "real-time priority is granted" : kNoPriority;
    finding.cure = kGrantPriority;
  } else if (line.what == "locked memory") {
    finding.reason = line.granted ? "its memory is locked" : kNoMemory;
    finding.cure = kGrantMemory;
  } else if (line.what == "own core") {
    finding.reason = line.granted ? "" : kNoCore;
    finding.cure = kGrantCore;
  } else if (!line.granted) {
    finding.reason = "it refuses the loop: " + line.what;
    finding.cure = "see the line '" + line.what + "'";
  }
  return finding;
}

// Limit: half a period. A later wake-up may make a tick of usual length miss its deadline.
DoctorFinding wakeUpFinding(const WakeUpStatistics& s, std::int64_t period_ns) {
  const auto us = [](std::int64_t ns) { return decimal(static_cast<double>(ns) * 1e-3, 0); };
  const bool good = s.max_ns < period_ns / 2 && s.skipped_periods == 0;
  return {"wake-ups",
          good,
          Blocks::kDevice,
          "late by p50 " + us(s.p50_ns) + ", p99 " + us(s.p99_ns) + ", p99.9 " + us(s.p999_ns) +
              ", max " + us(s.max_ns) + " µs; " + std::to_string(s.skipped_periods) + " of " +
              std::to_string(s.wake_ups + s.skipped_periods) + " periods skipped",
          "Fix the lines above, close other programs; a virtual machine stalls when its host is "
          "busy.",
          std::string("it woke the loop ") + (good ? "at most " : "up to ") + us(s.max_ns) +
              " µs late (p99.9 " + us(s.p999_ns) + " µs; allowed is half a period, " +
              us(period_ns / 2) + " µs)",
          "close other programs and leave the virtual machine, if this is one"};
}

/// Joins parts as "a, b and c".
std::string joined(const std::vector<std::string>& parts, const char* between, const char* last) {
  std::string text;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i > 0) text += i + 1 < parts.size() ? between : last;
    text += parts[i];
  }
  return text;
}

}  // namespace

Findings findingsAboutMachine(const MachineFacts& machine, bool root) {
  Findings findings;
  lookAtKernelAndCores(machine, findings);
  lookAtLimits(machine, root, findings);
  return findings;
}

Findings findingsAboutSoftware(const std::filesystem::path& packages_file) {
  Findings findings;
  lookAtBuild(findings);
  lookAtPackages(packages_file, findings);
  lookAtDisk(findings);
  return findings;
}

Findings findingsAboutAdapters(const std::filesystem::path& folder) {
  Findings findings;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::filesystem::path timer = entry.path() / "latency_timer";
    std::ifstream file(timer);
    int latency_ms = 0;
    if (!(file >> latency_ms)) continue;  // adapter without a latency setting
    findings.push_back({entry.path().filename().string(), latency_ms == 1, Blocks::kNothing,
                        "waits up to " + std::to_string(latency_ms) +
                            " ms for more bytes (latency_timer; 1 wanted)",
                        latency_ms == 1 ? "" : "echo 1 > " + timer.string() + " as root."});
  }
  std::sort(findings.begin(), findings.end(),
            [](const DoctorFinding& a, const DoctorFinding& b) { return a.what < b.what; });
  return findings;
}

Findings findingsAboutLoop(const WakeUpProbe& probe, std::int64_t period_ns) {
  Findings findings;
  for (const SetupLine& line : probe.setup) {
    findings.push_back(grantedOrNot(line));
  }
  findings.push_back(wakeUpFinding(probe.statistics, period_ns));
  return findings;
}

Findings findingsAboutNoLoop(const Diagnostics& why) {
  return {{"loop", false, Blocks::kEverything, format(why), "",
           "no loop can run here: " + format(why), "fix that"}};
}

Verdict verdictOf(const Findings& findings) {
  const bool fit = std::none_of(findings.begin(), findings.end(), [](const DoctorFinding& f) {
    return !f.good && f.blocks != Blocks::kNothing;
  });
  std::vector<std::string> reasons, cures;
  const auto add = [](std::vector<std::string>& to, const std::string& text) {
    if (!text.empty() && std::find(to.begin(), to.end(), text) == to.end()) to.push_back(text);
  };
  for (const DoctorFinding& f : findings) {
    if (f.blocks == Blocks::kNothing || f.good != fit || f.reason.empty()) continue;
    add(reasons, f.reason);
    if (!fit) add(cures, f.cure);
  }
  if (fit) {
    return {true, "This machine may drive a device: " + joined(reasons, ", ", " and ") +
                      "; before a person holds it, measure for an hour under load."};
  }
  return {false,
          "This machine must not drive a device, only simulate: " + joined(reasons, ", ", " and ") +
              "; remedy: " + joined(cures, ", then ", ", then ") + "."};
}

}  // namespace wholehand
