// From an order to arm to a loop that runs: all on the thread that runs the station.
#include "station/station_core.hpp"

#include <fmt/format.h>

#include <utility>

namespace wholehand {
namespace {

OrderReply stopCame() {
  return refused(Refusal::kStopCame, "a stop came meanwhile: nothing pushes");
}

}  // namespace

// What a therapist has set, where it is still in range; their own values otherwise.
std::vector<double> Station::Core::parametersAtStart() {
  const std::lock_guard lock(mutex_);
  std::vector<double> values;
  for (const PublishedParameter& parameter : scene_->parameters) {
    const auto asked = asked_parameters_.find(parameter.name);
    values.push_back(asked == asked_parameters_.end() ? parameter.initial : asked->second);
  }
  return values;
}

bool Station::Core::stoppedSince(std::uint64_t asked) const {
  const std::lock_guard lock(mutex_);
  return stop_asked_ > asked || quit_ || InterruptScope::interrupted();
}

// Before the first force of what was loaded. One order after `asked` that stops ends it.
Expected<Rehearsal> Station::Core::rehearsalOf(const Models& models, const AxisPosition& start,
                                               std::uint64_t asked) const {
  RehearsalOptions options = config_.rehearsal;
  options.cancelled = [this, asked] { return stoppedSince(asked); };
  auto rehearsal = rehearse(models, start, config_.rig, options);
  if (rehearsal) say("rehearsal " + describe(*rehearsal));
  return rehearsal;
}

// What is to be loaded while something renders; a stop that comes lets it be loaded unrehearsed.
OrderReply Station::Core::rehearseNext(const Models& models, std::optional<Rehearsal>& passed) {
  const std::uint64_t asked = [this] {
    const std::lock_guard lock(mutex_);
    return armed_by_;
  }();
  auto rehearsal = rehearsalOf(models, makePlayer(models)->start(), asked);
  if (!rehearsal && !stoppedSince(asked)) {
    return refused(Refusal::kRehearsalFailed, format(rehearsal.errors()));
  }
  if (rehearsal) passed = std::move(*rehearsal);
  return {true, ""};
}

OrderReply Station::Core::arm(std::uint64_t asked, const std::string& record,
                              std::uint64_t duration_ticks) {
  if (live_) {
    const bool ends = status().run_state != RunState::kRendering;
    return ends ? refused(Refusal::kStillStopping,
                          "it is still on its way to neutral: arm again then")
                : refused(Refusal::kArmedAlready, "it is armed already");
  }
  if (stoppedSince(asked)) return stopCame();
  std::unique_ptr<Player> player = makePlayer(models_);
  if (config_.rehearse && !rehearsed_) {
    auto rehearsal = rehearsalOf(models_, player->start(), asked);
    if (stoppedSince(asked)) return stopCame();
    if (!rehearsal) return refused(Refusal::kRehearsalFailed, format(rehearsal.errors()));
    rehearsed_ = std::move(*rehearsal);  // until something else is loaded
  }
  auto live = startSession(std::move(player), record, duration_ticks);
  if (!live) return refused(Refusal::kCannotStart, format(live.errors()));
  for (const SetupLine& line : (*live)->setup()) {
    if (!line.granted && arming_ == 1) say(line.what + ": " + line.sentence);
  }
  record_path_ = record;
  ++outcome_.sessions;
  return armedNow(std::move(*live), asked);
}

// Shows the new session before its first record comes; where there is none, the last one again.
Expected<std::unique_ptr<LiveSession>> Station::Core::startSession(std::unique_ptr<Player> player,
                                                                   const std::string& record,
                                                                   std::uint64_t duration_ticks) {
  LiveSessionPlan plan;
  plan.title = title();
  plan.seed = config_.seed + arming_;
  plan.record = record;
  plan.duration_ticks = duration_ticks;
  plan.parameters = parametersAtStart();
  plan.sinks.push_back([this](const TickRecord& r) {
    keepLatest(r);
    serveStop();
  });
  plan.sinks.insert(plan.sinks.end(), sinks_.begin(), sinks_.end());
  const auto count = [this](std::uint32_t by) {
    const std::lock_guard lock(mutex_);
    status_.session += by;
  };
  const bool had_latest = forgetLatest();
  count(1);
  publishScene(record);
  auto live = LiveSession::start(models_, std::move(player), config_.rig, plan);
  ++arming_;
  if (live) return live;
  count(static_cast<std::uint32_t>(-1));
  publishScene("");
  const std::lock_guard lock(latest_mutex_);
  has_latest_ = had_latest;
  return live;
}

OrderReply Station::Core::armedNow(std::unique_ptr<LiveSession> live, std::uint64_t asked) {
  const std::lock_guard lock(mutex_);
  live_ = std::move(live);
  armed_by_ = asked;
  status_.latched = Fault::kNone;
  status_.steering = Steering::kVirtualPatient;
  stop_at_.reset();
  if (stop_asked_ > asked) {  // it came while this was being built
    if (emergency_) live_->requestEmergencyStop();
    live_->requestStop();
    status_.run_state = RunState::kRampingDown;
    return stopCame();
  }
  status_.run_state = RunState::kRendering;
  if (!owner_alive_) {
    Command silent;
    silent.type = CommandType::kOwner;
    (void)live_->tryCommand(silent);
  }
  return {true, ""};
}

OrderReply Station::Core::armForClient(std::uint64_t asked) {
  const std::string exercise = scene()->exercise_name;
  return arm(asked, files_.kept() ? files_.nameNew(exercise, models_.files.level) : "", 0);
}

}  // namespace wholehand
