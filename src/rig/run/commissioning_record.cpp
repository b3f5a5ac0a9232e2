#include "rig/run/commissioning_record.hpp"

#include "files/text/text_file.hpp"
#include "rig/program_version.hpp"
#include "rig/run/run.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

namespace wholehand {
namespace {

constexpr std::size_t kQueue_bytes = std::size_t{4} << 20U;

RecordingMeta describe(const DeviceModel& model, const CommissioningRecord::Plan& plan) {
  RecordingMeta meta;
  meta.created_utc =
      fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::now()));
  meta.git_version = programVersion();
  meta.period_s = plan.period_s;
  meta.simulated_device = false;
  meta.models_changed = true;  // nothing was rendered, so the recording cannot be re-simulated
  meta.title = plan.title;
  describeAxes(model, meta);
  meta.armed_position.assign(model.axes.size(), 0.0);
  meta.value_names = CommissioningRecord::valueNames();
  meta.files.emplace_back("device", plan.device_text);
  return meta;
}

// Missing folders of a file's path, innermost first.
std::vector<std::filesystem::path> missingFolders(const std::filesystem::path& file) {
  std::vector<std::filesystem::path> missing;
  std::error_code unknown;
  for (auto folder = file.parent_path();
       !folder.empty() && !std::filesystem::exists(folder, unknown);
       folder = folder.parent_path()) {
    missing.push_back(folder);
  }
  return missing;
}

}  // namespace

CommissioningRecord::CommissioningRecord(const DeviceModel& model, Plan plan)
    : plan_(std::move(plan)), limit_(static_cast<int>(model.axes.size())), queue_(kQueue_bytes) {
  for (std::size_t i = 0; i < model.axes.size(); ++i) {
    limit_[static_cast<int>(i)] = plan_.effort_share * model.axes[i].effort_limit;
  }
}

Expected<std::unique_ptr<CommissioningRecord>> CommissioningRecord::begin(const DeviceModel& model,
                                                                          const Plan& plan) {
  std::unique_ptr<CommissioningRecord> record(new CommissioningRecord(model, plan));
  record->made_folders_ = missingFolders(plan.path);
  if (auto good = prepareFiles({plan.path}); !good) return good.errors();
  const RecordingMeta meta = describe(model, plan);
  BlackBoxPlan box;
  box.path = blackBoxPath(plan.path);
  auto armed = BlackBox::arm(meta, box);
  if (!armed) return armed.errors();
  record->black_box_ = std::move(*armed);
  auto writer = RecordingWriter::create(plan.path, meta);
  if (!writer) return writer.errors();
  record->writer_ = std::move(*writer);
  record->hub_ = std::make_unique<TelemetryHub>(
      [queue = &record->queue_](TickRecord& next) { return queue->try_pop(next); });
  record->hub_->record(*record->writer_);
  record->hub_->start();
  return Expected<std::unique_ptr<CommissioningRecord>>(std::move(record));
}

CommissioningRecord::~CommissioningRecord() {
  if (hub_) hub_->stop();
  if (!writer_) return;
  writer_->close();
  std::error_code unknown;
  if (kept_ > 0) return;
  std::filesystem::remove(plan_.path, unknown);
  for (const auto& folder : made_folders_)
    std::filesystem::remove(folder, unknown);  // removes the folder only if it is empty
}

void CommissioningRecord::keep(const Tick& tick) noexcept {
  const auto period_ns = static_cast<double>(std::llround(1e9 * plan_.period_s));
  if (kept_ == 0) began_ns_ = tick.monotonic_ns;
  // The clock numbers the ticks, so that gaps in the numbers show pauses between moves.
  const auto at = static_cast<std::uint64_t>(
      std::llround(static_cast<double>(tick.monotonic_ns - began_ns_) / period_ns));
  const std::uint64_t number = kept_ == 0 ? 0 : std::max(record_.tick + 1, at);
  record_.elapsed_periods = kept_ == 0 ? 1U : static_cast<std::uint32_t>(number - record_.tick);
  record_.tick = number;
  record_.time_s = static_cast<double>(number) * plan_.period_s;
  record_.q_m = tick.position;
  record_.rendered = tick.sent;
  record_.sent = tick.sent;
  record_.effort_limit = limit_;
  record_.authority = tick.rendering ? 1.0 : 0.0;
  record_.safety_state = tick.rendering     ? SafetyState::kRendering
                         : tick.let_go != 0 ? SafetyState::kFaulted
                                            : SafetyState::kDisarmed;
  record_.exercise.value_count = 3;
  record_.exercise.values[0] = step_;
  record_.exercise.values[1] = tick.status;
  record_.exercise.values[2] = tick.let_go;
  ++kept_;
  black_box_->beforeTick(record_);
  black_box_->afterTick(record_);
  (void)queue_.try_push(record_);  // a full queue counts the record as dropped
}

}  // namespace wholehand
