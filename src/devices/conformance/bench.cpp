#include "devices/conformance/bench.hpp"

#include "devices/conformance/pushes.hpp"
#include "devices/plugin/plugin_driver.hpp"
#include "loop/realtime/monotonic_clock.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <dlfcn.h>
#include <limits>
#include <utility>

namespace wholehand {
namespace {

constexpr double kSamplesFor_s = 0.25;
constexpr double kEnabledWithin_s = 1.0;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

void sleepUntil(std::int64_t at_ns) {
  const timespec at{at_ns / 1'000'000'000, at_ns % 1'000'000'000};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, nullptr) != 0) {
  }
}

}  // namespace

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

void everyMillisecond(double seconds, const std::function<bool()>& step) {
  std::int64_t next_ns = monotonicNow_ns();
  const std::int64_t end_ns = next_ns + static_cast<std::int64_t>(seconds * 1e9);
  while (monotonicNow_ns() < end_ns && step()) {
    next_ns = std::max(next_ns + 1'000'000, monotonicNow_ns());
    sleepUntil(next_ns);
  }
}

DriverBench::DriverBench(DriverLocation location, std::vector<KnownAxis> known)
    : location_(std::move(location)), known_(std::move(known)) {
  host_.size = sizeof(host_);
  host_.context = this;
  host_.say = &DriverBench::take;
}

DriverBench::~DriverBench() {
  disableAtNeutral();
  if (device_ != nullptr) plugin_->close(device_);
}

void DriverBench::take(void* self, const char* line) {
  static_cast<DriverBench*>(self)->host_lines_.emplace_back(line != nullptr ? line : "(null)");
}

std::string DriverBench::reach(DriverStage stage) {
  using Step = std::string (DriverBench::*)();
  static constexpr std::array<std::pair<DriverStage, Step>, 4> kSteps = {
      {{DriverStage::kLoaded, &DriverBench::load},
       {DriverStage::kPlugin, &DriverBench::takePlugin},
       {DriverStage::kOpen, &DriverBench::open},
       {DriverStage::kEnabled, &DriverBench::enable}}};
  for (const auto& [reached, step] : kSteps) {
    if (reached > stage) break;
    if (std::string why = (this->*step)(); !why.empty()) return why;
  }
  return {};
}

std::string DriverBench::load() {
  if (library_ != nullptr) return {};
  // Without a slash dlopen would search the system's library folders.
  const bool bare = location_.path.find('/') == std::string::npos;
  const std::string path = bare ? "./" + location_.path : location_.path;
  library_ = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (library_ == nullptr) {
    return why_not_loaded_ = loaderProblem(path);
  }
  symbol_ = reinterpret_cast<decltype(symbol_)>(::dlsym(library_, "wh_plugin_v1"));
  return {};
}

std::string DriverBench::takePlugin() {
  if (plugin_ != nullptr) return {};
  const wh_plugin* const plugin = symbol_ != nullptr ? symbol_() : nullptr;
  if (plugin == nullptr) return "gives no driver";
  if (plugin->size < sizeof(wh_plugin) || plugin->major != WH_MAJOR)
    return "is of another boundary";
  if (plugin->open == nullptr || plugin->describe == nullptr || plugin->control == nullptr ||
      plugin->read == nullptr || plugin->write == nullptr || plugin->close == nullptr) {
    return "leaves out a function";
  }
  plugin_ = plugin;
  return {};
}

std::string DriverBench::open() {
  if (device_ != nullptr) return {};
  const std::size_t lines = host_lines_.size();
  if (openAnother(location_.locator.c_str(), &device_) < 0 || device_ == nullptr) {
    device_ = nullptr;
    return "the device does not open" +
           (host_lines_.size() > lines ? ": " + host_lines_.back() : std::string());
  }
  std::array<wh_axis, WH_MAX_AXES> axes{};
  for (wh_axis& axis : axes) axis.size = sizeof(wh_axis);
  std::uint32_t count = 0;
  const int described = plugin_->describe(device_, axes.data(), WH_MAX_AXES, &count);
  count = described < 0 ? 0 : std::min<std::uint32_t>(count, WH_MAX_AXES);
  axes_.assign(axes.begin(), axes.begin() + count);
  for (wh_axis& axis : axes_) axis.name[sizeof(axis.name) - 1] = 0;
  return {};
}

std::string DriverBench::enable() {
  disableAtNeutral();
  sequence_ = 0;
  if (control(WH_ENABLE) < 0) return "the device cannot be enabled";
  enabled_ = true;
  bool says_so = false;
  everyMillisecond(kEnabledWithin_s, [&] {
    const SampleRead now = read();
    says_so = now.result >= 0 && (now.sample.status & WH_ENABLED) != 0;
    return !says_so;
  });
  return says_so ? std::string() : "no sample says that it is enabled";
}

void DriverBench::disableAtNeutral() {
  if (!std::exchange(enabled_, false)) return;
  (void)writeNeutral();
  (void)control(WH_DISABLE);
}

int DriverBench::openAnother(const char* locator, wh_device** device) const {
  return plugin_->open(&host_, locator, location_.settings.c_str(), device);
}

std::string DriverBench::reopen() {
  enabled_ = false;
  if (device_ != nullptr) plugin_->close(std::exchange(device_, nullptr));
  return open();
}

int DriverBench::control(std::uint32_t verb) {
  if (verb == WH_ENABLE) written_ns_ = longest_gap_ns_ = 0;
  return plugin_->control(device_, verb, 0.0);
}

SampleRead DriverBench::read() const {
  SampleRead out;
  out.sample.size = sizeof(wh_sample);
  std::fill(std::begin(out.sample.effort), std::end(out.sample.effort), kNan);
  std::fill(std::begin(out.sample.temperature_c), std::end(out.sample.temperature_c), kNan);
  out.result = plugin_->read(device_, &out.sample);
  out.read_ns = monotonicNow_ns();
  return out;
}

int DriverBench::write(const std::array<double, WH_MAX_AXES>& effort, std::uint32_t axes) {
  wh_command command{};
  command.size = sizeof(command);
  command.axes = axes != 0 ? axes : static_cast<std::uint32_t>(axes_.size());
  command.sequence = ++sequence_;
  const std::int64_t now_ns = monotonicNow_ns();
  if (written_ns_ != 0) longest_gap_ns_ = std::max(longest_gap_ns_, now_ns - written_ns_);
  written_ns_ = now_ns;
  std::copy(effort.begin(), effort.end(), std::begin(command.effort));
  return plugin_->write(device_, &command);
}

double DriverBench::patience_s() const noexcept {
  double shortest_s = 1.0;
  for (const wh_axis& axis : axes_) {
    if (axis.silence_s > 0.0) shortest_s = std::min(shortest_s, axis.silence_s);
  }
  return shortest_s;
}

bool DriverBench::stalled() const noexcept {
  return static_cast<double>(longest_gap_ns_) * 1e-9 > 0.5 * patience_s();
}

const KnownAxis* DriverBench::known(std::size_t axis) const {
  const auto found = std::find_if(known_.begin(), known_.end(), [&](const KnownAxis& k) {
    return k.name == axes_.at(axis).name;
  });
  return found != known_.end() ? &*found : nullptr;
}

double DriverBench::neutral(std::size_t axis) const {
  const KnownAxis* const k = known(axis);
  return k != nullptr ? k->neutral_effort : 0.0;
}

double DriverBench::mass(std::size_t axis) const {
  const KnownAxis* const k = known(axis);
  return k != nullptr ? k->mass : 0.0;
}

int DriverBench::writeNeutral() {
  return writeShares({});
}

int DriverBench::writeShares(const std::array<double, WH_MAX_AXES>& shares) {
  std::array<double, WH_MAX_AXES> effort{};
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    effort.at(a) = neutral(a) + shares.at(a) * axes_[a].effort_limit;
  }
  return write(effort);
}

int DriverBench::writeShare(std::size_t axis, double share) {
  std::array<double, WH_MAX_AXES> shares{};
  shares.at(axis) = share;
  return writeShares(shares);
}

const std::vector<SampleRead>& DriverBench::samples() {
  if (samples_.empty()) samples_ = idle(static_cast<int>(kSamplesFor_s * 1e3), false);
  return samples_;
}

const std::vector<PushedAxis>& DriverBench::pushed() {
  if (pushed_ == nullptr) {
    pushed_ = std::make_shared<const std::vector<PushedAxis>>(pushEveryAxis(*this));
  }
  return *pushed_;
}

std::vector<SampleRead> DriverBench::idle(int milliseconds, bool writing) {
  std::vector<SampleRead> out;
  everyMillisecond(milliseconds * 1e-3, [&] {
    if (writing) (void)writeNeutral();
    out.push_back(read());
    return true;
  });
  return out;
}

}  // namespace wholehand
