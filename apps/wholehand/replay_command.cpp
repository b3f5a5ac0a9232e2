#include "replay_command.hpp"

#include "exit_code.hpp"
#include "git_version.hpp"
#include "resimulation.hpp"
#include "telemetry/recording.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>

namespace wholehand {
namespace {

// A difference between two versions of the program is no fault of either.
std::string versions(const RecordingMeta& meta) {
  if (meta.git_version == WHOLEHAND_VERSION) return {};
  return " (recorded by " + meta.git_version + ", this is " + WHOLEHAND_VERSION + ")";
}

int compare(RecordingReader& recording, const std::string& path) {
  Expected<Resimulation> result = resimulate(recording, path);
  if (!result) return refuse(result.errors());
  if (result->difference.field.empty()) {
    std::printf("%s: %llu ticks run again, every bit the same\n", path.c_str(),
                static_cast<unsigned long long>(result->ticks));
    return kExitDone;
  }
  std::printf("%s: tick %llu differs in %s: recorded %s, now %s%s\n", path.c_str(),
              static_cast<unsigned long long>(result->different_tick),
              result->difference.field.c_str(), result->difference.first.c_str(),
              result->difference.again.c_str(), versions(recording.meta()).c_str());
  return kExitDifferent;
}

std::string lineOf(const TickRecord& r, const RecordingMeta& meta) {
  std::string line = fmt::format("{:8.2f} s ", r.time_s);
  for (int a = 0; a < r.sent.size(); ++a) {
    const double arm = meta.lever_arms_m[static_cast<std::size_t>(a)];
    line += fmt::format(" {} {:+.2f}", meta.axis_names[static_cast<std::size_t>(a)],
                        arm > 0.0 ? r.sent[a] / arm : r.sent[a]);
  }
  return line + fmt::format("  contacts {}", r.contact_count);
}

int play(RecordingReader& recording, double speed) {
  constexpr double kFrame_s = 0.1;
  const RecordingMeta& meta = recording.meta();
  std::printf("%s, %s, %llu ticks (efforts in N, at the tip where there is one)\n",
              meta.title.c_str(), meta.created_utc.c_str(),
              static_cast<unsigned long long>(recording.size()));
  const auto step = static_cast<std::uint64_t>(std::ceil(kFrame_s / meta.period_s));
  TickRecord record;
  for (std::uint64_t i = 0; recording.read(i, record); i += step) {
    std::printf("%s\n", lineOf(record, meta).c_str());
    if (std::fflush(stdout) != 0) break;  // nobody reads on
    std::this_thread::sleep_for(std::chrono::duration<double>(kFrame_s / speed));
  }
  return kExitDone;
}

}  // namespace

int replayCommand(const ReplayOptions& options) {
  auto recording = RecordingReader::open(options.recording);
  if (!recording) return refuse(recording.errors());
  if (options.resimulate) return compare(**recording, options.recording);
  return play(**recording, options.speed);
}

}  // namespace wholehand
