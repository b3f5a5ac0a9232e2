#include "replay/resimulation/resimulation.hpp"

#include "devices/passport/passport.hpp"
#include "files/toml/toml_file.hpp"
#include "loop/core/tick_digest.hpp"
#include "loop/realtime/thread_setup.hpp"
#include "rig/arming.hpp"
#include "rig/rig.hpp"
#include "rig/run/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <utility>

namespace wholehand {
namespace fs = std::filesystem;
namespace {

// A temporary folder, removed by its destructor.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::error_code error;
    std::string pattern = (fs::temp_directory_path(error) / "wholehand-XXXXXX").string();
    if (!error && mkdtemp(pattern.data()) != nullptr) path_ = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }  ///< empty: there is none

 private:
  fs::path path_;
};

Expected<Done> write(const fs::path& path, const std::string& text) {
  std::error_code ignored;  // the stream's state reports the write
  fs::create_directories(path.parent_path(), ignored);
  std::ofstream out(path, std::ios::binary);
  out << text;
  out.close();
  if (out) return Done{};
  return fileFault(path.string(), "cannot be unpacked",
                   "make room in the folder for temporary files, or set TMPDIR to another");
}

// True for a hand file that mirrors another. If a recording has two hand files, the mirroring one
// is the hand. The other file may not be unpacked yet.
bool mirrorsAnother(const fs::path& path) {
  TomlFile file(path.string(), "hand");
  return file.readable() && file.root().has("mirror_of");
}

// Restores the recorded files in their folder structure. Each file states its kind.
Expected<ModelFiles> unpack(const RecordingMeta& meta, const fs::path& folder) {
  ModelFiles files{"", "", "", "", "", "", "", meta.level, "", meta.period_s};
  for (const auto& [name, text] : meta.files) {
    const fs::path path = (folder / name).lexically_normal();
    const fs::path inside = path.lexically_relative(folder);
    if (inside.empty() || *inside.begin() == "..") {
      return fileFault(name, "a file of the recording lies outside its folder",
                       "the recording was tampered with");
    }
    if (auto written = write(path, text); !written) return written.errors();
    if (path.extension() == ".csv") files.motion = path.string();
    if (path.extension() != ".toml") continue;
    auto kind = fileKind(path.string());
    if (!kind) return kind.errors();
    if (*kind == "scene") files.scene = path.string();
    if (*kind == "exercise") files.exercise = path.string();
    if (*kind == "hand" && (files.hand.empty() || mirrorsAnother(path))) files.hand = path.string();
    if (*kind == "device") files.device = path.string();
    if (*kind == "rendering") files.rendering = path.string();
    if (*kind == "patient") files.patient = path.string();
    if (*kind == "prescription") files.prescription = path.string();
  }
  // Refuses a recording without one of the required files.
  const std::pair<const char*, const std::string*> needed[] = {{"scene", &files.scene},
                                                               {"hand", &files.hand},
                                                               {"device", &files.device},
                                                               {"rendering", &files.rendering},
                                                               {"patient", &files.patient}};
  Diagnostics missing;
  for (const auto& [kind, file] : needed) {
    if (!file->empty()) continue;
    missing.push_back(fileFault("", fmt::format("the recording carries no {} file", kind),
                                "copy it again from where it was recorded"));
  }
  if (!missing.empty()) return missing;
  return files;
}

// Replaces the temporary folder by the recording in the errors.
Diagnostics named(Diagnostics errors, const fs::path& folder, const std::string& recording) {
  for (Diagnostic& error : errors) {
    const std::string prefix = folder.string() + "/";
    const bool unpacked = error.file.rfind(prefix, 0) == 0;
    const std::string inside = unpacked ? error.file.substr(prefix.size()) : error.file;
    error.file = inside.empty() ? recording : recording + ": " + inside;
  }
  return errors;
}

}  // namespace

Expected<Models> recordedModels(const RecordingMeta& meta, const std::string& recording) {
  const TemporaryFolder folder;
  if (folder.path().empty()) {
    return fileFault(recording, "there is no folder to unpack it into",
                     "set TMPDIR to a folder that you may write to");
  }
  auto files = unpack(meta, folder.path());
  if (!files) return named(files.errors(), folder.path(), recording);
  auto models = loadModels(*files);
  if (!models) return named(models.errors(), folder.path(), recording);
  for (std::string* file :
       {&models->files.scene, &models->files.hand, &models->files.device, &models->files.rendering,
        &models->files.patient, &models->files.exercise, &models->files.prescription}) {
    if (file->empty()) continue;
    *file = recording + ": " + fs::path(*file).lexically_relative(folder.path()).string();
  }
  return models;
}

namespace {

Expected<int> recordedDelay(const std::string& path) {
  TomlFile file(path, "arming-delay");
  if (!file.readable()) return file.finish();
  const auto periods = static_cast<int>(file.root().integer("periods", 0, 1000));
  if (Diagnostics faults = file.finish(); !faults.empty()) return faults;
  return periods;
}

}  // namespace

Expected<std::vector<DeviceModel>> recordedCorners(const RecordingMeta& meta,
                                                   const DeviceModel& device,
                                                   const std::string& recording) {
  const auto text_of = [&meta](const char* name) -> const std::string* {
    const auto carried = std::find_if(meta.files.begin(), meta.files.end(),
                                      [name](const auto& file) { return file.first == name; });
    return carried != meta.files.end() ? &carried->second : nullptr;
  };
  const std::string* const passport_text = text_of(kRecordedPassport);
  if (passport_text == nullptr) return std::vector<DeviceModel>();
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "passport.toml";
  if (auto written = write(path, *passport_text); !written) return written.errors();
  const auto passport = readPassport(path.string());
  if (!passport) return named(passport.errors(), folder.path(), recording);
  if (!sameAxes(*passport, device)) {
    return fileFault(recording, "its passport is of a device with other axes",
                     "the recording was tampered with");
  }
  std::vector<DeviceModel> corners = worstCorners(device, *passport, meta.period_s);
  const std::string* const delay_text = text_of(kRecordedDelay);
  if (delay_text == nullptr) return corners;
  const fs::path delay_path = folder.path() / "delay.toml";
  if (auto written = write(delay_path, *delay_text); !written) return written.errors();
  const auto periods = recordedDelay(delay_path.string());
  if (!periods) return named(periods.errors(), folder.path(), recording);
  for (DeviceModel& corner : corners) corner.output_delay_ticks = *periods;
  return corners;
}

namespace {

struct ComputedColumn {
  std::string_view name;
  std::vector<double> numbers;
};

std::vector<ComputedColumn> computed(const TickRecord& record) {
  std::vector<ComputedColumn> columns;
  visitComputed(record, [&columns](const char* name, const double* numbers, int count) {
    if (columns.empty() || columns.back().name != name) columns.push_back({name, {}});
    columns.back().numbers.insert(columns.back().numbers.end(), numbers, numbers + count);
  });
  return columns;
}

/// How a recording stores a computed column, and what labels its numbers.
struct ColumnFacts {
  FieldStorage storage = FieldStorage::kExact;
  FieldLabels labels = FieldLabels::kNone;
};
ColumnFacts factsOf(std::string_view column) {
  ColumnFacts facts;
  const auto look = [&](const auto& field) {
    if (field.name == column) facts = {field.storage, field.labels};
  };
  visitFields(kRecordFields, look);
  visitFields(kEventFields, look);
  visitFields(kContactFields, look);
  return facts;
}

// Compares two numbers. Unlike ==, NaN equals itself, and 0 differs from -0.
template <class T>
bool same(T a, T b) {
  return (std::isnan(a) && std::isnan(b)) || (a == b && std::signbit(a) == std::signbit(b));
}

bool same(double a, double b, bool exact) {
  return exact ? same<double>(a, b) : same<float>(static_cast<float>(a), static_cast<float>(b));
}

void compare(const ComputedColumn& recorded, const ComputedColumn& again, bool exact,
             std::vector<TickDifference>& out) {
  const std::size_t count = recorded.numbers.size();
  TickDifference found{std::string(recorded.name), 0, 0, 0.0, 0.0};
  exact = exact || factsOf(recorded.name).storage == FieldStorage::kExact;
  if (count != again.numbers.size()) {
    found.recorded = static_cast<double>(count);
    found.again = static_cast<double>(again.numbers.size());
    out.push_back(found);
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const double a = recorded.numbers[i], b = again.numbers[i];
    if (same(a, b, exact)) continue;
    if (found.numbers++ > 0) continue;
    found.place = static_cast<int>(i);
    found.recorded = a;
    found.again = b;
  }
  if (found.numbers > 0) out.push_back(found);
}

// Source of recorded inputs and ticks.
class RecordedTicks {
 public:
  virtual ~RecordedTicks() = default;
  // Reads the next tick's inputs; false at the end.
  virtual Expected<bool> next(TickInput& input) = 0;
  // Reads the tick with this number as it was recorded, with its digest, if available.
  virtual bool recorded(std::uint64_t tick, TickRecord& record, std::uint64_t& digest) = 0;
  // True when the recorded numbers equal those of the tick bit by bit.
  [[nodiscard]] virtual bool isExact() const = 0;
};

Diagnostic cannotRun(const std::string& path, std::string why, std::string remedy) {
  return fileFault(path, "cannot be run again: " + std::move(why), std::move(remedy));
}

class TicksOfRecording final : public RecordedTicks {
 public:
  TicksOfRecording(RecordingReader& recording, std::string path)
      : recording_(recording), path_(std::move(path)) {}

  Expected<bool> next(TickInput& input) override {
    const std::uint64_t before = record_.tick;
    if (row_ == recording_.size()) return false;
    if (!recording_.read(row_, record_)) return unreadable(path_, row_, recording_.size());
    const std::uint64_t expected = row_++ == 0 ? 0 : before + record_.elapsed_periods;
    if (record_.tick != expected) {
      const RecordingOutline& outline = recording_.outline();
      if (outline.contradicted_tick == expected) {
        return cannotRun(path_, "tick " + std::to_string(expected) + " " + outline.contradiction,
                         "the file was changed, or the disk refused a part of it");
      }
      return cannotRun(path_,
                       row_ == 1 ? "it begins with tick " + std::to_string(record_.tick)
                                 : "tick " + std::to_string(expected) + " is missing",
                       row_ == 1 ? "run the black box or the whole recording again"
                                 : "there was no room for it on the disk, or it was cut out");
    }
    input.q_m = record_.q_m;
    input.elapsed_periods = record_.elapsed_periods;
    input.faults = record_.faults & kInputFaults;
    input.moved_by = record_.moved_by;
    input.help = record_.help;
    input.command_count = record_.command_count;
    input.commands = record_.commands;
    return true;
  }
  bool recorded(std::uint64_t, TickRecord& record, std::uint64_t& digest) override {
    record = record_;
    digest = recording_.digest();
    return true;
  }
  [[nodiscard]] bool isExact() const override { return recording_.isExact(); }

 private:
  RecordingReader& recording_;
  const std::string path_;
  std::uint64_t row_ = 0;
  TickRecord record_;
};

class TicksOfBox final : public RecordedTicks {
 public:
  explicit TicksOfBox(BlackBoxReader& box) : box_(box) { known_ = box_.read(0, record_); }

  Expected<bool> next(TickInput& input) override { return box_.nextInput(input); }
  [[nodiscard]] bool isExact() const override { return true; }
  bool recorded(std::uint64_t tick, TickRecord& record, std::uint64_t& digest) override {
    if (!known_ || record_.tick != tick) return false;
    record = record_;
    digest = box_.digest();
    known_ = box_.read(++row_, record_);
    return true;
  }

 private:
  BlackBoxReader& box_;
  std::uint64_t row_ = 0;
  TickRecord record_;
  bool known_ = false;
};

// Device that returns the recorded positions and who moved the hand; it ignores what is written to
// it.
class FedDevice final : public HapticDevice, public KnownPerson {
 public:
  explicit FedDevice(const RecordingMeta& meta) : simulated_(meta.simulated_device) {
    q_m_ = AxisPosition(static_cast<int>(meta.armed_position.size()));
    std::copy(meta.armed_position.begin(), meta.armed_position.end(), q_m_.data());
  }
  void feed(const TickInput& input) noexcept {
    q_m_ = input.q_m;
    faults_ = input.faults;
    moved_by_ = input.moved_by;
    help_ = input.help;
  }
  [[nodiscard]] Expected<Done> open() override { return Done{}; }
  [[nodiscard]] Expected<Done> ready() override { return Done{}; }
  [[nodiscard]] bool simulated() const noexcept override { return simulated_; }
  [[nodiscard]] Fault read(DeviceReading& reading, int) noexcept override {
    reading.q_m = q_m_;
    return faults_ & kOfReading;
  }
  void report(PersonReading& reading) const noexcept override {
    reading.moved_by = moved_by_;
    reading.help = help_;
  }
  [[nodiscard]] Fault write(const AxisEffort&) noexcept override {
    return faults_ & Fault::kDeviceWrite;
  }
  void close() noexcept override {}

 private:
  const bool simulated_;
  AxisPosition q_m_;
  Fault faults_ = Fault::kNone;
  Mover moved_by_ = Mover::kNobody;
  Help help_ = Help::kUnspecified;
};

// Rebuilds the recorded renderer and arms it as it was.
Expected<std::unique_ptr<Rig>> armedRig(const RecordingMeta& meta, const std::string& path) {
  if (meta.models_changed) {
    return cannotRun(path,
                     "what was rendered is not what the files in it say: the models were "
                     "changed in memory, or the files after they were read",
                     "write the change into the files and record again");
  }
  if (meta.schema < kRecordingSchema) {
    return cannotRun(
        path,
        fmt::format("it has schema version {}, and what a tick records has changed", meta.schema),
        "run it again with the program that recorded it: " + meta.git_version);
  }
  auto models = recordedModels(meta, path);
  if (!models) return models.errors();
  RigOptions options;
  options.period_s = meta.period_s;
  options.engine = meta.engine;
  options.uncertified = true;  // no person is moved, so no certificate is needed
  auto corners = recordedCorners(meta, models->device, path);
  if (!corners) return corners.errors();
  options.measured = std::move(*corners);
  auto device = std::make_unique<FedDevice>(meta);
  const KnownPerson& person = *device;
  auto rig = buildRigWithoutPerson(std::move(*models), std::move(device), options, &person);
  if (!rig) return rig;
  (*rig)->renderer->startParametersAt(meta.parameter_values);
  if (auto armed = (*rig)->renderer->arm(); !armed) return armed.errors();
  return rig;
}

void runTick(Rig& rig, const TickInput& input, bool first, TickRecord& record) {
  static_cast<FedDevice&>(*rig.device).feed(input);
  if (any(input.faults & Fault::kGentleStop)) {
    rig.renderer->requestGentleStop();
  } else if (any(input.faults & Fault::kStopRequested)) {
    rig.renderer->requestStop();
  }
  if (any(input.faults & Fault::kEmergencyStop)) rig.renderer->requestEmergencyStop();
  record.tick = first ? 0 : record.tick + input.elapsed_periods;
  record.time_s = static_cast<double>(record.tick) * rig.options.period_s;
  record.command_count = input.command_count;
  record.commands = input.commands;
  rig.renderer->tick(input.elapsed_periods, record);
}

Expected<Resimulation> resimulate(RecordedTicks& ticks, const RecordingMeta& meta,
                                  const std::string& path) {
  const DenormalsFlushed as_recorded;
  auto rig = armedRig(meta, path);
  if (!rig) return rig.errors();
  Resimulation result;
  TickInput input;
  TickRecord recorded, again;
  std::uint64_t digest = 0;
  while (true) {
    const Expected<bool> more = ticks.next(input);
    if (!more) return more.errors();
    if (!*more) return result;
    runTick(**rig, input, result.ticks == 0, again);
    ++result.ticks;
    if (!ticks.recorded(again.tick, recorded, digest)) continue;
    ++result.compared;
    if (!result.different_tick && digest != digestOf(again)) result.different_tick = again.tick;
    result.visible = differences(recorded, again, ticks.isExact());
    if (result.visible.empty()) continue;
    result.visible_tick = again.tick;
    return result;
  }
}

}  // namespace

std::vector<TickDifference> differences(const TickRecord& recorded, const TickRecord& again,
                                        bool exact) {
  const std::vector<ComputedColumn> a = computed(recorded), b = computed(again);
  std::vector<TickDifference> out;
  const auto in = [](const std::vector<ComputedColumn>& columns, std::string_view name) {
    const auto found = std::find_if(columns.begin(), columns.end(),
                                    [name](const ComputedColumn& c) { return c.name == name; });
    return found == columns.end() ? ComputedColumn{name, {}} : *found;
  };
  for (const ComputedColumn& column : a) compare(column, in(b, column.name), exact, out);
  for (const ComputedColumn& column : b) {
    if (in(a, column.name).numbers.empty()) compare({column.name, {}}, column, exact, out);
  }
  return out;
}

std::string describe(const TickDifference& d, const std::vector<std::string>& axis_names) {
  if (d.numbers == 0) {
    return fmt::format("{}: {:.0f} numbers recorded, now {:.0f}", d.column, d.recorded, d.again);
  }
  const auto place = static_cast<std::size_t>(d.place);
  std::string where = d.column;
  if (factsOf(d.column).labels == FieldLabels::kAxes && place < axis_names.size()) {
    where += " of " + axis_names[place];
  } else if (d.place > 0 || d.numbers > 1) {
    where += fmt::format("[{}]", d.place);
  }
  std::string text = fmt::format("{}: recorded {:.9g}, now {:.9g}", where, d.recorded, d.again);
  const double more = d.again - d.recorded;
  if (std::isfinite(more)) {
    text += fmt::format(", {:.3g} {}", std::abs(more), more < 0.0 ? "less" : "more");
  }
  if (d.numbers > 1) text += fmt::format(" ({} numbers of it differ)", d.numbers);
  return text;
}

Expected<Resimulation> resimulate(RecordingReader& recording, const std::string& path) {
  TicksOfRecording ticks(recording, path);
  return resimulate(ticks, recording.meta(), path);
}

Expected<Resimulation> resimulate(BlackBoxReader& box, const std::string& path) {
  if (!box.inputsWhole()) {
    return cannotRun(
        path,
        "it holds the inputs of the first " + std::to_string(box.inputTicks()) + " ticks only",
        "it can be shown; run the recording of that session again, if there is one");
  }
  TicksOfBox ticks(box);
  return resimulate(ticks, box.meta(), path);
}

Expected<std::uint64_t> recordAgain(InputJournalReader& journal, const std::string& path,
                                    RecordingWriter& writer) {
  const DenormalsFlushed as_recorded;
  auto rig = armedRig(journal.meta(), path);
  if (!rig) return rig.errors();
  TickInput input;
  TickRecord record;
  for (bool first = true; journal.next(input); first = false) {
    runTick(**rig, input, first, record);
    writer.append(record);
  }
  writer.close();
  return writer.written();
}

}  // namespace wholehand
