#include "core/record_packing.hpp"
#include "files/durable_file.hpp"
#include "telemetry/mapped_box.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstring>

namespace wholehand {
namespace {

using black_box::Entry;
using black_box::Header;

constexpr Fault kWanting = kStopping | Fault::kEmergencyStop;
/// Time after a run's end for the ramp to neutral, with a margin.
constexpr double kRamp_s = 1.0;
/// Kept beyond the requested time: this much may be overwritten while a crash is written.
constexpr double kMargin = 1.1;

/// Every parent folder of a file, outermost first.
std::vector<std::string> foldersOf(const std::string& path) {
  std::vector<std::string> folders;
  for (std::size_t at = path.find('/', 1); at != std::string::npos; at = path.find('/', at + 1)) {
    folders.push_back(path.substr(0, at));
  }
  return folders;
}

}  // namespace

MappedBox::Sizes MappedBox::sizesOf(const RecordingMeta& meta, const BlackBoxPlan& plan) {
  const auto count = [](const auto& list) { return static_cast<int>(list.size()); };
  const double run = static_cast<double>(plan.most_ticks) + kRamp_s / meta.period_s;
  const double kept = std::clamp(std::ceil(kMargin * plan.keep_s / meta.period_s), 1.0, run);
  const int values = count(meta.value_names) + count(meta.parameter_names);
  const auto tick_bytes =
      static_cast<double>(packedBytes(count(meta.axis_names), count(meta.joint_names),
                                      count(meta.body_names), values, kMaxContacts));
  Sizes sizes;
  sizes.entries = static_cast<std::size_t>(kept) + kSpareEntries;
  // One more tick, since the last of a lap may not fit; and commands.
  sizes.data = std::min(static_cast<std::size_t>(kept * tick_bytes), plan.most_tick_bytes) +
               2 * kMostPackedBytes;
  // A game that moves its bodies sends about two orders a tick, of seven numbers each.
  const double orders_bytes = meta.game_slots > 0 ? 128.0 : 0.0;
  const double axes_bytes =
      orders_bytes + 10.0 + static_cast<double>(sizeof(double)) * count(meta.axis_names);
  sizes.inputs = static_cast<std::size_t>(
      std::min(run * axes_bytes + 64.0 * kMostInputBytes, static_cast<double>(plan.input_bytes)));
  return sizes;
}

MappedBox::MappedBox(const RecordingMeta& meta, const BlackBoxPlan& plan)
    : path_(plan.path),
      temporary_(plan.path + "." + randomName() + ".part"),
      crash_text_("\nwholehand: crashed; the last seconds are in " + plan.path +
                  ": wholehand replay " + plan.path + " --resimulate\n"),
      stop_(plan.stop),
      stop_whom_(plan.stop_whom),
      folders_(foldersOf(plan.path)),
      meta_(black_box::packMeta(meta)),
      sizes_(sizesOf(meta, plan)) {
  log_ = inputLogOf(meta);
  header_.header_bytes = sizeof(Header);
  const std::size_t length = std::min(meta.git_version.size(), header_.program.size() - 1);
  std::copy_n(meta.git_version.begin(), length, header_.program.begin());
  header_.record_bytes = sizeof(TickRecord);
  header_.record_layout = recordLayout();
  header_.entry_slots = sizes_.entries;
  header_.data_capacity = sizes_.data;
}

std::string MappedBox::takeMemory() {
  const bool taken = entries_.take(sizes_.entries * sizeof(Entry)) && data_.take(sizes_.data) &&
                     inputs_.take(sizes_.inputs) && arming_stack_.take(kSignalStackBytes) &&
                     ticking_stack_.take(kSignalStackBytes);
  if (!taken) return std::string("has no memory: ") + std::strerror(errno);
  useSignalStack(arming_stack_.data());
  guard_ = std::make_unique<CrashGuard>(*this);
  if (!guard_->stands()) {
    return "cannot be armed: " + std::to_string(kMostWitnesses) + " of them are";
  }
  return {};
}

void MappedBox::beforeTick(const TickRecord&) noexcept {
  if (first_tick_) {
    useSignalStack(ticking_stack_.data());
    ticking_thread_.store(callingThread(), std::memory_order_relaxed);
    first_tick_ = false;
  }
  ticks_begun_.store(ticks_begun_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
}

void MappedBox::afterTick(const TickRecord& record) noexcept {
  keepInputs(record);
  keepWhole(record);
  noteFaults(record);
  ticks_done_.store(ticks_begun_.load(std::memory_order_relaxed), std::memory_order_release);
}

void MappedBox::keepInputs(const TickRecord& record) noexcept {
  const std::uint64_t used = input_bytes_.load(std::memory_order_relaxed);
  if (!inputs_whole_.load(std::memory_order_relaxed)) return;
  if (used + kMostInputBytes > sizes_.inputs) {
    inputs_whole_.store(false, std::memory_order_release);
    return;
  }
  const std::size_t bytes = logInput(log_, record, inputs_.data() + used);
  input_bytes_.store(used + bytes, std::memory_order_release);
}

void MappedBox::keepWhole(const TickRecord& record) noexcept {
  std::uint64_t begin = data_done_.load(std::memory_order_relaxed);
  const std::uint64_t n = entries_done_.load(std::memory_order_relaxed);
  const std::uint64_t at = begin % sizes_.data;
  if (at + kMostPackedBytes > sizes_.data) begin += sizes_.data - at;  // ticks are contiguous
  // Announced before it is overwritten, so that a concurrent reader can tell afterwards which data
  // is invalid.
  entries_begun_.store(n + 1, std::memory_order_relaxed);
  data_begun_.store(begin + kMostPackedBytes, std::memory_order_relaxed);
  std::atomic_thread_fence(std::memory_order_release);
  const std::size_t bytes = packRecord(record, data_.data() + begin % sizes_.data);
  *entryAt(n) = {begin, record.tick, bytes};
  data_done_.store(begin + bytes, std::memory_order_release);
  entries_done_.store(n + 1, std::memory_order_release);
}

void MappedBox::noteFaults(const TickRecord& record) noexcept {
  const Fault wanting = record.faults & kWanting;
  if (!any(wanting)) return;
  if (header_.faults == 0) {
    header_.fault_axis = record.fault_axis;
    header_.fault_tick = record.tick;
  }
  header_.faults |= static_cast<std::uint32_t>(wanting);
}

Expected<std::unique_ptr<BlackBox>> BlackBox::arm(const RecordingMeta& meta,
                                                  const BlackBoxPlan& plan) {
  auto box = std::make_unique<MappedBox>(meta, plan);
  if (const std::string problem = box->takeMemory(); !problem.empty()) {
    return Diagnostic{plan.path,
                      0,
                      "",
                      "",
                      "the black box " + problem,
                      "close other programs, raise `ulimit -l`, or end another session"};
  }
  return Expected<std::unique_ptr<BlackBox>>(std::unique_ptr<BlackBox>(std::move(box)));
}

}  // namespace wholehand
