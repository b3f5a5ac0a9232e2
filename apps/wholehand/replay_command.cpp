#include "replay_command.hpp"

#include "assembly/program_version.hpp"
#include "core/printable.hpp"
#include "exit_code.hpp"
#include "replay/answering.hpp"
#include "replay_web_command.hpp"
#include "report_command.hpp"
#include "resimulation/resimulation.hpp"
#include "telemetry/recording.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <thread>

namespace wholehand {
namespace {

// A difference between program versions is not an error.
std::string versions(const RecordingMeta& meta) {
  if (meta.git_version == programVersion()) return {};
  return " (recorded by " + meta.git_version + ", this is " + programVersion() + ")";
}

int tell(const Expected<Resimulation>& result, const RecordingMeta& meta, const std::string& path) {
  if (!result) return refuse(result.errors());
  const Resimulation& r = result.value();
  if (!r.difference.field.empty()) {
    std::printf("%s: tick %llu differs in %s: recorded %s, now %s%s\n", printable(path).c_str(),
                static_cast<unsigned long long>(r.different_tick), r.difference.field.c_str(),
                r.difference.first.c_str(), r.difference.again.c_str(), versions(meta).c_str());
    return kExitDifferent;
  }
  if (r.compared == r.ticks) {
    std::printf("%s: %llu ticks run again, every bit the same\n", printable(path).c_str(),
                static_cast<unsigned long long>(r.ticks));
  } else {
    std::printf("%s: %llu ticks of the last %.1f s run again after %llu others, %s\n",
                printable(path).c_str(), static_cast<unsigned long long>(r.compared),
                static_cast<double>(r.compared) * meta.period_s,
                static_cast<unsigned long long>(r.ticks - r.compared),
                r.compared > 0 ? "every bit the same" : "nothing to compare them with");
  }
  return kExitDone;
}

std::string lineOf(const TickRecord& r, const RecordingMeta& meta) {
  std::string line = fmt::format("{:8.2f} s ", r.time_s);
  for (int a = 0; a < r.sent.size(); ++a) {
    const double arm = meta.lever_arms_m[a];
    line += fmt::format(" {} {:+.2f}", meta.axis_names[a], arm > 0.0 ? r.sent[a] / arm : r.sent[a]);
  }
  return line + fmt::format("  contacts {}", r.contact_count);
}

int play(RecordingReader& recording, const std::string& path, double speed) {
  constexpr double kFrame_s = 0.1;
  const RecordingMeta& meta = recording.meta();
  std::printf("%s, %s, %llu ticks (efforts in N, at the tip where there is one)\n",
              meta.title.c_str(), meta.created_utc.c_str(),
              static_cast<unsigned long long>(recording.size()));
  const auto step = static_cast<std::uint64_t>(std::ceil(kFrame_s / meta.period_s));
  TickRecord record;
  std::uint64_t before = 0;
  for (std::uint64_t i = 0; i < recording.size(); ++i) {
    if (!recording.read(i, record)) return refuse({unreadable(path, i, recording.size())});
    const std::uint64_t missing =
        i > 0 ? missingBetween(before, record.tick, record.elapsed_periods) : 0;
    if (missing > 0) {
      std::printf("          -- %llu ticks, %.3f s, are missing --\n",
                  static_cast<unsigned long long>(missing),
                  static_cast<double>(missing) * meta.period_s);
    }
    before = record.tick;
    if (i % step != 0) continue;
    std::printf("%s\n", lineOf(record, meta).c_str());
    if (std::fflush(stdout) != 0) break;  // the reader of the output is gone
    std::this_thread::sleep_for(std::chrono::duration<double>(kFrame_s / speed));
  }
  return kExitDone;
}

// E.g. "SIGSEGV within a tick", "speed limit exceeded on axis x in tick 1234".
std::string causeOf(const BlackBoxCause& cause, const RecordingMeta& meta) {
  std::string text;
  if (cause.signal != 0) {
    const char* name = sigabbrev_np(cause.signal);
    text = fmt::format("SIG{}{}", name != nullptr ? name : "?",
                       cause.within_tick ? " within a tick" : "");
  }
  const std::string names = faultNames(cause.faults);
  text += text.empty() || names.empty() ? names : ", " + names;
  if (!any(cause.faults)) return text;
  const auto axis = static_cast<std::size_t>(cause.fault_axis);
  if (axis < meta.axis_names.size()) text += " on " + meta.axis_names[axis];
  return text + fmt::format(", first in tick {}", cause.fault_tick);
}

void introduce(const BlackBoxReader& box) {
  const std::time_t written = box.cause().unix_ns / 1'000'000'000;
  std::printf("black box, written %s: %s\n",
              fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(written)).c_str(),
              causeOf(box.cause(), box.meta()).c_str());
  std::printf("the inputs of %llu ticks since arming, %s\n",
              static_cast<unsigned long long>(box.inputTicks()),
              box.inputsWhole() ? "all of them" : "and none after: it cannot be run again");
}

// Writes unpacked numbers, for readers without support for packing.
int extract(RecordingReader& box, const ReplayOptions& options) {
  RecordingMeta plain = box.meta();
  plain.schema = std::min(plain.schema, kPackedSchema - 1);
  auto writer = RecordingWriter::create(options.extract, plain);
  if (!writer) return refuse(writer.errors());
  TickRecord record;
  for (std::uint64_t i = 0; i < box.size(); ++i) {
    if (!box.read(i, record)) return refuse({unreadable(options.recording, i, box.size())});
    (*writer)->append(record);
  }
  (*writer)->close();
  if ((*writer)->dropped() > 0 || (*writer)->written() != box.size()) {
    std::error_code ignored;
    std::filesystem::remove(options.extract, ignored);
    return refuse({{options.extract, 0, "", "", "could not be written", "make room on the disk"}});
  }
  std::printf("%s: %llu ticks\n", printable(options.extract).c_str(),
              static_cast<unsigned long long>(box.size()));
  return kExitDone;
}

int replayBox(const ReplayOptions& options) {
  auto box = BlackBoxReader::openBox(options.recording);
  if (!box) return refuse(box.errors());
  if (!options.extract.empty()) return extract(**box, options);
  if (options.resimulate) {
    return tell(resimulate(**box, options.recording), (*box)->meta(), options.recording);
  }
  introduce(**box);
  return play(**box, options.recording, options.speed);
}

}  // namespace

int replayCommand(const ReplayOptions& options) {
  if (options.answer) {
    answerQuestions(options.recording);
    return kExitDone;
  }
  if (!options.report.empty())
    return reportCommand({options.recording, options.report, options.before});
  if (options.web) return replayWebCommand(options);
  if (BlackBoxReader::isBox(options.recording)) return replayBox(options);
  auto recording = RecordingReader::open(options.recording);
  if (!recording) return refuse(recording.errors());
  if (!options.extract.empty()) return extract(**recording, options);
  if (options.resimulate) {
    return tell(resimulate(**recording, options.recording), (*recording)->meta(),
                options.recording);
  }
  return play(**recording, options.recording, options.speed);
}

}  // namespace wholehand
