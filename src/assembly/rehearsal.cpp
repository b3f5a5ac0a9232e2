#include "assembly/rehearsal.hpp"

#include "assembly/rehearsal_moves.hpp"
#include "core/sanitized.hpp"
#include "device/simulated/simulated_device.hpp"
#include "realtime/thread_setup.hpp"
#include "runtime/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

constexpr double kHold_s = 0.1;       // pressing goes on after the last movement
constexpr double kBlocked_s = 0.06;   // fingers at rest this long count as closed
constexpr int kFirst_ticks = 20;      // first ticks of an attempt, with cold caches
constexpr double kNeutral_s = 1.0;    // longer than any ramp to neutral
constexpr int kHopeless_ticks = 100;  // slow ticks that noise does not explain ...
constexpr double kHopeless_ns = 1e9;  // ... or total time in them
constexpr double kStill_rad_s = 0.2;

/// Faults of the world, caused by the scene. Faults of the device's motion are the rehearsal's own.
constexpr Fault kOfTheScene = Fault::kNonFiniteEffort | Fault::kNonFiniteState |
                              Fault::kPhysicsStep | Fault::kSingularInertia |
                              Fault::kBodiesExploded;

/// Cost of a tick, to find what slow ticks have in common.
struct TickCost {
  std::int64_t cpu_ns = 0;
  std::array<std::int32_t, kStages> stage_ns{};
  int body = -1;  // most touched body, else the target of the move
  int contacts = 0;
};

/// One attempt: all moves, once.
class Attempt {
 public:
  Attempt(Rig& rig, Rehearser& player, const RehearsalPlan& plan, const RehearsalOptions& options)
      : rig_(rig),
        player_(player),
        plan_(plan),
        options_(options),
        limit_ns_(options.most_of_period * rig.options.period_s * 1e9) {}

  [[nodiscard]] Expected<Done> run() {
    const auto bodies = static_cast<int>(rig_.models.scene.bodies.size());
    touched_.assign(bodies, false);
    // A subset is spread evenly over the bodies.
    const int step = std::max(1, (bodies + options_.most_bodies - 1) / options_.most_bodies);
    for (int body = 0; body < bodies && !hopeless(); body += step) {
      for (const RehearsalMove& move : plan_.movesFor(body, ticks_ > 0 ? &record_ : nullptr)) {
        if (!armAtStartOf(move)) continue;
        if (Expected<Done> done = perform(move); !done) return done;
      }
    }
    if (costs_.empty()) return stayAtHome();
    return Done{};
  }

  [[nodiscard]] bool hopeless() const {
    const bool many = 10 * too_slow_ > costs_.size();
    return many && (too_slow_ >= kHopeless_ticks || slow_ns_ >= kHopeless_ns);
  }

  [[nodiscard]] Rehearsal result() const {
    Rehearsal out;
    out.summary = statistics_.snapshot();
    out.limit_us = 1e-3 * limit_ns_;
    out.bodies = static_cast<int>(touched_.size());
    out.bodies_touched = static_cast<int>(std::count(touched_.begin(), touched_.end(), true));
    out.unsettled =
        static_cast<double>(unsettled_) / static_cast<double>(std::max(1, untouched_ticks_));
    explainSlowTicks(out);
    return out;
  }

  /// Sets the session's initial pose. A scene without anything in reach is rehearsed there.
  void setHome(const AxisPosition& home) { home_ = home; }

 private:
  [[nodiscard]] bool armAtStartOf(const RehearsalMove& move) {
    for (const AxisPosition& start : move.starts) {
      player_.begin(start, move.goal);
      if (rig_.renderer->arm()) return true;
    }
    player_.begin(home_, move.goal);  // from the initial pose instead
    return rig_.renderer->arm().ok();
  }

  [[nodiscard]] Expected<Done> stayAtHome() {
    RehearsalMove rest;
    rest.goal = home_;
    player_.begin(home_, home_);
    if (Expected<Done> armed = rig_.renderer->arm(); !armed) return armed;
    return perform(rest);
  }

  // Closes the fingers as far as possible, then presses with the arm.
  [[nodiscard]] Expected<Done> perform(const RehearsalMove& move) {
    const int hold = ticksIn(kHold_s), still_for = ticksIn(kBlocked_s);
    int held = 0, blocked = 0;
    while (held < hold && !hopeless()) {
      if (options_.cancelled && options_.cancelled()) {
        return fileFault("", "the rehearsal was stopped", "");
      }
      tick(move);
      if (any(record_.faults & kStoppingFaults)) return recover(move);
      blocked = record_.contact_count > 0 && still() ? blocked + 1 : 0;
      if (!player_.pressing() && (player_.arrived() || blocked > still_for)) player_.press();
      if (player_.pressing() && player_.arrived()) ++held;
    }
    return Done{};
  }

  void tick(const RehearsalMove& move) {
    record_.tick = ticks_;
    record_.time_s = static_cast<double>(ticks_) * rig_.options.period_s;
    record_.command_count = 0;
    timer_.start();
    rig_.renderer->tick(1, record_, &timer_);
    timer_.finish(record_);
    if (ticks_++ >= kFirst_ticks) count(move);
  }

  void count(const RehearsalMove& move) {
    statistics_.add(record_);
    TickCost cost;
    cost.cpu_ns = record_.cpu_ns;
    cost.stage_ns = record_.stage_cpu_ns;
    cost.body = move.body;
    std::array<int, kMaxSceneBodies> contacts{};
    for (int i = 0; i < record_.contact_count; ++i) {
      const int body = record_.contacts[i].body;
      if (body < 0 || body >= kMaxSceneBodies) continue;
      const int of_it = ++contacts[body];
      if (std::cmp_less(body, touched_.size())) {
        touched_[body] = true;
      }
      if (of_it <= cost.contacts) continue;
      cost.contacts = of_it;
      cost.body = body;
    }
    costs_.push_back(cost);
    untouched_ = untouched_ && record_.contact_count == 0;
    if (untouched_) {
      ++untouched_ticks_;
      if (any(record_.faults & Fault::kContactsUnsettled)) ++unsettled_;
    }
    if (static_cast<double>(cost.cpu_ns) <= limit_ns_) return;
    ++too_slow_;
    slow_ns_ += static_cast<double>(cost.cpu_ns);
  }

  [[nodiscard]] int ticksIn(double time_s) const {
    return static_cast<int>(std::lround(time_s / rig_.options.period_s));
  }

  [[nodiscard]] bool still() const {
    for (int i = 0; i < record_.qd_mf.size(); ++i) {
      if (std::abs(record_.qd_mf[i]) > kStill_rad_s) return false;
    }
    return true;
  }

  // A fault of the device's motion ends the move. A fault of the world refuses the scene.
  [[nodiscard]] Expected<Done> recover(const RehearsalMove& move) {
    const Fault fault = record_.faults & kOfTheScene;
    if (any(fault)) return broken(fault, move);
    for (int i = 0; i < ticksIn(kNeutral_s) && !rig_.renderer->atNeutral(); ++i) tick(move);
    return Done{};
  }

  [[nodiscard]] Diagnostic broken(Fault fault, const RehearsalMove& move) const {
    const SceneModel& scene = rig_.models.scene;
    const auto body = static_cast<std::size_t>(move.body);
    const std::string name = body < scene.bodies.size() ? scene.bodies[body].name : "nothing";
    return keyFault(scene.path, "bodies", name,
                    "the rehearsal broke the simulated world here: " + faultNames(fault),
                    "correct or remove what lies there: its mass, or what it overlaps");
  }

  // Finds the stage and the body behind the slowest hundredth of the ticks.
  void explainSlowTicks(Rehearsal& out) const {
    std::vector<TickCost> slow = costs_;
    const std::size_t count =
        std::max<std::size_t>(slow.size() / 100, std::min<std::size_t>(slow.size(), 10));
    std::partial_sort(slow.begin(), slow.begin() + static_cast<std::ptrdiff_t>(count), slow.end(),
                      [](const TickCost& a, const TickCost& b) { return a.cpu_ns > b.cpu_ns; });
    slow.resize(count);
    std::array<std::int64_t, kStages> stages{};
    std::array<int, kMaxSceneBodies> most{};
    std::array<std::int64_t, kMaxSceneBodies> contacts{};
    for (const TickCost& tick : slow) {
      for (std::size_t s = 0; s < stages.size(); ++s) stages[s] += tick.stage_ns[s];
      if (tick.body < 0) continue;
      most[tick.body] = std::max(most[tick.body], tick.contacts);
      contacts[tick.body] += 1 + tick.contacts;
    }
    out.slowest =
        static_cast<Stage>(std::max_element(stages.begin(), stages.end()) - stages.begin());
    const std::size_t index = std::max_element(contacts.begin(), contacts.end()) - contacts.begin();
    if (contacts[index] == 0 || index >= rig_.models.scene.bodies.size()) return;
    out.heaviest = rig_.models.scene.bodies[index].name;
    out.heaviest_contacts = most[index];
  }

  Rig& rig_;
  Rehearser& player_;
  const RehearsalPlan& plan_;
  const RehearsalOptions& options_;
  const double limit_ns_;
  AxisPosition home_;
  TickTimer timer_;
  TickRecord record_;
  TickStatistics statistics_;
  std::vector<TickCost> costs_;
  std::vector<bool> touched_;
  std::uint64_t ticks_ = 0;
  std::size_t too_slow_ = 0;
  bool untouched_ = true;
  int untouched_ticks_ = 0, unsettled_ = 0;
  double slow_ns_ = 0.0;
};

std::size_t faces(const SceneBody& body) {
  std::size_t count = 0;
  for (const Shape& shape : body.shapes) count += shape.triangles.size();
  return count;
}

std::string remedyFor(const Rehearsal& r, const Models& models) {
  if (r.slowest == Stage::kExercise)
    return "use a simpler exercise, a slower rate or a faster machine";
  const int index = models.scene.bodyIndex(r.heaviest);
  if (index >= 0) {
    const SceneBody& body = models.scene.bodies[index];
    if (body.shapes.size() > 1) {
      return fmt::format("make \"{}\" of fewer than {} shapes, or remove it", body.name,
                         body.shapes.size());
    }
    if (faces(body) > 50) {
      return fmt::format("give \"{}\" a coarser mesh than {} faces, or remove it", body.name,
                         faces(body));
    }
    return fmt::format("remove \"{}\" or others of the {} bodies, or run at a slower rate",
                       body.name, models.scene.bodies.size());
  }
  return "use a slower rate or a faster machine, or close other programs";
}

/// Diagnostic of a scene whose ticks take too long: the time, the stage, and what to remove.
Diagnostic tooSlow(const Rehearsal& r, const Models& models) {
  std::string where;
  if (r.heaviest_contacts > 0) {
    where = fmt::format(", with {} contacts on \"{}\"", r.heaviest_contacts, r.heaviest);
  } else if (!r.heaviest.empty()) {
    where = fmt::format(", with the hand at \"{}\"", r.heaviest);
  }
  return keyFault(
      models.files.exercise.empty() ? models.scene.path : models.files.exercise, "rehearsal",
      fmt::format("{:.0f} µs", 1e-3 * r.summary.cpu.p999_ns),
      fmt::format(
          "is the CPU time of a tick with the worst contacts (p99.9); {:.0f} µs are allowed, "
          "most of it is {}{}",
          r.limit_us, stageName(r.slowest), where),
      remedyFor(r, models));
}

}  // namespace

double mostOfPeriod() noexcept {
#if WHOLEHAND_SANITIZED || !defined(__OPTIMIZE__)
  return 100.0;
#else
  return 0.5;
#endif
}

Expected<Rehearsal> rehearse(const Models& models, const AxisPosition& start,
                             const RigOptions& rig_options, const RehearsalOptions& options) {
  const DenormalsFlushed scope;  // as in the loop
  const RehearsalPlan plan(models.hand, models.device, models.scene, start);
  const bool has_pool = models.scene.game.slots > 0;
  std::optional<Rehearsal> best;
  std::string fingerprint;
  bool passes = false;
  for (int attempt = 1; attempt <= std::max(1, options.attempts) && !passes; ++attempt) {
    auto player = std::make_unique<Rehearser>(models.device);
    Rehearser& moves = *player;
    moves.begin(start, start);
    Models of_its_own = models;
    of_its_own.patient = strongPerson(models.device);
    auto rig = buildRig(std::move(of_its_own), std::move(player), rig_options);
    if (!rig) return rig.errors();
    fingerprint = (*rig)->renderer->config().rehearsal;
    auto run = std::make_unique<Attempt>(**rig, moves, plan, options);
    run->setHome(start);
    if (Expected<Done> done = run->run(); !done) return done.errors();
    Rehearsal now = run->result();
    now.attempts = attempt;
    if (!best || now.summary.cpu.p999_ns < best->summary.cpu.p999_ns) best = std::move(now);
    best->attempts = attempt;
    passes = 1e-3 * best->summary.cpu.p999_ns <= best->limit_us;
    if (run->hopeless()) break;
  }
  if (!passes) return tooSlow(*best, models);
  if (has_pool && options.fill_pool) {
    auto pool = rehearsePool(models, start, rig_options, options);
    if (!pool) return pool.errors();
    if (!pool->measured.passes()) return poolTooSlow(*pool, models);
    best->pool = pool->measured;
  }
  const auto bodies = static_cast<int>(models.scene.bodies.size());
  const bool whole = options.most_bodies >= bodies && (!has_pool || best->pool);
  if (options.most_of_period <= mostOfPeriod() && whole) {
    best->passed = RehearsalPassed(fingerprint);
  }
  return *best;
}

std::string describe(const Rehearsal& r) {
  const std::string pool = r.pool ? "; with " + describe(*r.pool) : "";
  const std::string unsettled =
      r.unsettled > 0.0
          ? fmt::format(
                "; before the hand touches anything, contact forces do not settle in {:.1f} % of "
                "the ticks: what is heavy sinks into what is light below it",
                100.0 * r.unsettled)
          : "";
  return fmt::format(
      "{:.0f} µs CPU at the median, {:.0f} p99.9, {:.0f} at most ({:.0f} allowed), mostly {}; "
      "up to {} contacts, {} of {} bodies touched{}{}",
      1e-3 * r.summary.cpu.p50_ns, 1e-3 * r.summary.cpu.p999_ns, 1e-3 * r.summary.cpu.max_ns,
      r.limit_us, stageName(r.slowest), r.summary.contacts_max, r.bodies_touched, r.bodies,
      unsettled, pool);
}

}  // namespace wholehand
