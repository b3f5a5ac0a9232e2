#include "station/loop_answers.hpp"

#include <chrono>
#include <utility>

namespace wholehand {
namespace {

/// Longest silence of the loop or the device, and longest time until a stop is obeyed [ns].
struct Patience {
  std::int64_t silent_ns, obeyed_ns;
};
constexpr Patience kWithRobot{50'000'000, 100'000'000};
/// A simulated device moves nobody, and a busy machine delays its loop.
constexpr Patience kSimulated{1'000'000'000, 1'000'000'000};

constexpr auto kWatchEvery = std::chrono::milliseconds(10);

double seconds(std::int64_t duration_ns) {
  return 1e-9 * static_cast<double>(duration_ns);
}

}  // namespace

void LoopAnswers::noteStop(bool at_once, std::int64_t now_ns) {
  if (!stop_asked_ns_ || (at_once && !stop_at_once_)) stop_asked_ns_ = now_ns;
  stop_at_once_ = stop_at_once_ || at_once;
}

void LoopAnswers::endSession(bool silent) {
  dropSession();
  left_silent_ = robot_ && silent;
}

void LoopAnswers::dropSession() {
  stop_asked_ns_.reset();
  stop_at_once_ = false;
}

void LoopAnswers::describe(const std::optional<LoopWord>& word, bool has_record,
                           std::int64_t now_ns, LoopStatus& status) const {
  const std::optional<DeviceStatus>& device = status.device;
  status.silent = left_silent_ || (device && device->overdue);
  if (!word) return;
  const Patience& most = robot_ ? kWithRobot : kSimulated;
  const std::int64_t age_ns = now_ns - word->ticked_ns;
  if (word->ticked_ns != 0) {
    if (!word->over) status.loop_age_s = seconds(age_ns);
    const bool late = !word->over && age_ns > most.silent_ns;
    // A loop ends without neutral when the device has refused its effort for a second.
    const bool refused_neutral = robot_ && word->over && !word->at_neutral;
    // The loop reads the age of the host's newest cycle in every tick.
    const bool host_late = device && device->hosted && has_record &&
                           device->host_age_s - seconds(age_ns) > seconds(most.silent_ns);
    status.silent = status.silent || late || refused_neutral || host_late;
  }
  if (!stop_asked_ns_) return;
  const Fault asked = stop_at_once_ ? Fault::kEmergencyStop : Fault::kStopRequested;
  status.stop_pending = !any(word->stops & asked) && !word->at_neutral;
  status.stop_unconfirmed = status.stop_pending && now_ns - *stop_asked_ns_ > most.obeyed_ns;
  status.silent = status.silent || status.stop_unconfirmed;
}

AnswerWatch::AnswerWatch(std::function<LoopStatus()> answers,
                         std::function<void(const std::string&)> log)
    : answers_(std::move(answers)), log_(std::move(log)), thread_([this] { watch(); }) {}

AnswerWatch::~AnswerWatch() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void AnswerWatch::watch() {
  bool silent = false;
  while (true) {
    {
      std::unique_lock lock(mutex_);
      if (wake_.wait_for(lock, kWatchEvery, [this] { return ends_; })) return;
    }
    const LoopStatus now = answers_();
    if (now.silent == silent) continue;
    silent = now.silent;
    const char* again = now.device ? "The robot answers again." : "The simulation answers again.";
    log_(silent ? alarmOf(now) : again);
  }
}

}  // namespace wholehand
