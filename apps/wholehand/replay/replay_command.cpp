#include "apps/wholehand/replay/replay_command.hpp"

#include "apps/wholehand/report/report_command.hpp"
#include "apps/wholehand/shared/exit_code.hpp"
#include "loop/core/printable.hpp"
#include "record/recording.hpp"
#include "replay/recorded_scene.hpp"
#include "replay/replay_children.hpp"
#include "replay/resimulation/resimulation.hpp"
#include "rig/program_version.hpp"

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

std::string whatDiffers(const Resimulation& r) {
  const std::uint64_t visible = r.visible_tick;
  if (r.visible.empty()) {
    return fmt::format("tick {} differs by its digest, no tick in single precision",
                       *r.different_tick);
  }
  if (r.different_tick == visible) return fmt::format("tick {} differs", visible);
  if (!r.different_tick) {
    return fmt::format("tick {} has other numbers than its digest says: the file was changed",
                       visible);
  }
  return fmt::format("tick {} differs by its digest, tick {} in single precision",
                     *r.different_tick, visible);
}

// Datasets that the lines of replay do not show.
const LeftOut kLeftOutOfLines = {
    {"digest",
     "intention",
     "patient_effort",
     "q_s",
     "qd_s",
     "theta",
     "coupling_error_rad",
     "palm_distance_m",
     "qd_mf",
     "f_s",
     "coupling",
     "phi",
     "damping",
     "rendered",
     "bodies",
     "effort_limit",
     "tank",
     "tank_effort",
     "exercise_effort",
     "wall",
     "wall_active",
     "closure",
     "alpha",
     "palm_body",
     "palm_target_distance_m",
     "parameters",
     "exercise_values"},
    {"capsule", "link", "body", "point_m", "normal", "force_n", "torque_nm", "distance_m"}};

int printResult(const Expected<Resimulation>& result, const RecordingMeta& meta,
                const std::string& path) {
  if (!result) return refuse(result.errors());
  const Resimulation& r = result.value();
  if (!r.same()) {
    std::printf("%s: %s%s\n", printable(path).c_str(), whatDiffers(r).c_str(),
                versions(meta).c_str());
    for (const TickDifference& d : r.visible) {
      std::printf("  %s\n", describe(d, meta.axis_names).c_str());
    }
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

int play(const ViewedRecording& viewed, const std::string& path, double speed) {
  constexpr double kFrame_s = 0.1;
  RecordingReader& recording = *viewed.reader;
  const RecordingMeta& meta = recording.meta();
  std::printf("%s, %s, %llu ticks (efforts in N, at the tip where there is one)\n",
              meta.title.c_str(), meta.created_utc.c_str(),
              static_cast<unsigned long long>(recording.size()));
  const auto step = static_cast<std::uint64_t>(std::ceil(kFrame_s / meta.period_s));
  TickRecord record;
  std::uint64_t before = 0;
  UnreadTicks unread;
  std::string ended_by;
  for (std::uint64_t i = 0; i < recording.size(); ++i) {
    if (!recording.read(i, record)) {
      if (unread.count++ == 0) unread.first = i;
      before = recording.outline().numbers[i];
      continue;
    }
    const std::uint64_t missing =
        i > 0 ? missingBetween(before, record.tick, record.elapsed_periods) : 0;
    if (missing > 0) {
      std::printf("          -- %llu ticks, %.3f s, are missing --\n",
                  static_cast<unsigned long long>(missing),
                  static_cast<double>(missing) * meta.period_s);
    }
    before = record.tick;
    ended_by = endedBy(record);
    if (i % step != 0) continue;
    std::printf("%s\n", lineOf(record, meta).c_str());
    if (std::fflush(stdout) != 0) break;  // the reader of the output is gone
    std::this_thread::sleep_for(std::chrono::duration<double>(kFrame_s / speed));
  }
  if (ended_by == "broken_off" && !viewed.reader->outline().being_written) {
    std::printf("%s: %s\n", printable(path).c_str(), kBrokenOff);
  }
  return printNotShown(notShown(viewed, unread, path));
}

// Text of a cause: "SIGSEGV within a tick", "speed limit exceeded on axis x in tick 1234".
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

// Writes the last seconds in a black box file as a recording.
int extract(RecordingReader& box, const ReplayOptions& options) {
  auto writer = RecordingWriter::create(options.extract, box.meta());
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
    return refuse({fileFault(options.extract, "could not be written", "make room on the disk")});
  }
  std::printf("%s: %llu ticks\n", printable(options.extract).c_str(),
              static_cast<unsigned long long>(box.size()));
  return kExitDone;
}

// Makes a recording from the inputs that remain after a power cut.
int recordInputsAgain(const ReplayOptions& options) {
  auto journal = InputJournalReader::open(options.recording);
  if (!journal) return refuse(journal.errors());
  if (options.extract.empty()) {
    return refuse({fileFault(options.recording, "holds the inputs of a recording",
                             "make the recording of them: wholehand replay " + options.recording +
                                 " --extract again.h5")});
  }
  // The new recording writes its own inputs, which must not overwrite these.
  std::error_code none;
  const std::string own = InputJournal::pathOf(options.extract);
  if (std::filesystem::equivalent(own, options.recording, none)) {
    return refuse({keyFault(options.extract, "--extract", "",
                            "would replace the inputs that it is made of: " + options.recording,
                            "give the recording another name")});
  }
  auto writer = RecordingWriter::create(options.extract, (*journal)->meta());
  if (!writer) return refuse(writer.errors());
  const auto ticks = recordAgain(**journal, options.recording, **writer);
  if (!ticks) return refuse(ticks.errors());
  if ((*writer)->dropped() > 0) {
    return refuse({{options.extract, 0, "", "",
                    fmt::format("holds {} ticks, {} found no room", *ticks, (*writer)->dropped()),
                    "make room on the disk and repeat it; the inputs are as they were"}});
  }
  std::printf("%s: %llu ticks, made again of their inputs\n", printable(options.extract).c_str(),
              static_cast<unsigned long long>(*ticks));
  return kExitDone;
}

int replayBox(const ReplayOptions& options) {
  auto box = BlackBoxReader::openBox(options.recording);
  if (!box) return refuse(box.errors());
  if (!options.extract.empty()) return extract(**box, options);
  if (options.resimulate) {
    return printResult(resimulate(**box, options.recording), (*box)->meta(), options.recording);
  }
  introduce(**box);
  ViewedRecording viewed;
  viewed.reader = std::move(*box);
  return play(viewed, options.recording, options.speed);
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
  if (InputJournalReader::isJournal(options.recording)) return recordInputsAgain(options);
  if (!options.resimulate && options.extract.empty()) {
    // Reads all datasets, so that damage anywhere is reported. If a dataset is missing, reads only
    // those that the lines show.
    auto viewed = viewRecording(options.recording);
    if (!viewed) viewed = viewRecording(options.recording, kLeftOutOfLines);
    if (!viewed) return refuse(viewed.errors());
    return play(*viewed, options.recording, options.speed);
  }
  ViewedRecording whole;
  auto recording = RecordingReader::open(options.recording);
  if (!recording) return refuse(recording.errors());
  if (!options.extract.empty()) {
    return refuse({keyFault(options.recording, "--extract", "", "is a recording already",
                            "read it with any program for HDF5 (docs/recording.md)")});
  }
  whole.reader = std::move(*recording);
  const int reported = printResult(resimulate(*whole.reader, options.recording),
                                   whole.reader->meta(), options.recording);
  if (reported == kExitBadInput) return reported;  // the reason has been printed
  return std::max(reported, printNotShown(notShown(whole, {}, options.recording)));
}

}  // namespace wholehand
