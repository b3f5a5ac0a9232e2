#include "assembly/pool_rehearsal.hpp"

#include "assembly/pool_filling.hpp"
#include "assembly/rehearsal.hpp"
#include "assembly/rehearsal_moves.hpp"
#include "runtime/tick_timer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

namespace wholehand {
namespace {

constexpr int kFirst_ticks = 20;     // first ticks of an attempt, with cold caches
constexpr double kGather_s = 0.3;    // driven bodies come to the hand
constexpr double kMove_s = 0.3;      // at most, for each move of the hand
constexpr int kHopeless_ticks = 50;  // slow ticks that noise does not explain
constexpr double kToSpare = 0.9;     // of the limit, for a budget that is named as a remedy
constexpr Fault kOfTheWorld = Fault::kNonFiniteEffort | Fault::kNonFiniteState |
                              Fault::kPhysicsStep | Fault::kSingularInertia;

/// A move of the hand through the bodies, from where it is.
struct Move {
  std::array<double, 3> by_m;  ///< of the arm, from the start
  double closed;               ///< share of the fingers' range
};
constexpr std::array kMoves{Move{{0.0, 0.0, 0.0}, 1.0}, Move{{0.0, 0.0, -0.04}, 1.0},
                            Move{{0.0, 0.0, 0.0}, 0.0}, Move{{0.04, 0.0, 0.0}, 1.0},
                            Move{{0.0, 0.04, 0.0}, 0.0}};

/// One filled world, and a hand that moves through it.
class FilledWorld {
 public:
  FilledWorld(Rig& rig, Rehearser& hand, PoolFilling& filling, const RehearsalOptions& options)
      : rig_(rig), hand_(hand), filling_(filling), options_(options) {}

  /// @param limit_ns of a tick; an attempt with too many slow ticks ends early
  [[nodiscard]] Expected<Done> run(const AxisPosition& start, double limit_ns) {
    limit_ns_ = limit_ns;
    hand_.begin(start, start);
    if (Expected<Done> armed = rig_.renderer->arm(); !armed) return armed;
    while (!filling_.spawned()) {
      if (Expected<Done> done = tick(); !done) return done;
    }
    if (Expected<Done> done = ticks(kGather_s, false); !done) return done;
    for (const Move& move : kMoves) {
      hand_.moveTo(goal(start, move));
      if (Expected<Done> done = ticks(kMove_s, true); !done) return done;
      if (hopeless()) return Done{};
      if (ended_) return moves_ > 0 ? Expected<Done>(Done{}) : Expected<Done>(unmoved());
      ++moves_;
    }
    return Done{};
  }

  [[nodiscard]] PoolMeasurement result() const {
    PoolMeasurement out;
    out.budget = rig_.models.scene.game;
    out.summary = statistics_.snapshot();
    out.limit_us = 1e-3 * limit_ns_;
    out.bodies_max = bodies_max_;
    out.moving_max = moving_max_;
    const auto& owners = filling_.owners();
    out.driven = static_cast<int>(std::count(owners.begin(), owners.end(), BodyOwner::kGame));
    out.free = static_cast<int>(std::count(owners.begin(), owners.end(), BodyOwner::kLoop));
    return out;
  }

  [[nodiscard]] bool hopeless() const { return too_slow_ >= kHopeless_ticks; }

 private:
  [[nodiscard]] AxisPosition goal(const AxisPosition& start, const Move& move) const {
    AxisPosition q = start;
    const DeviceModel& device = rig_.models.device;
    for (int i = 0; i < q.size(); ++i) {
      const DeviceAxis& axis = device.axes[i];
      if (axis.group == AxisGroup::kHand)
        q[i] = axis.lower + move.closed * (axis.upper - axis.lower);
    }
    for (int i = 0; i < 3; ++i) {
      const int index = device.axisIndex(std::string(1, "xyz"[i]));
      if (index < 0) continue;
      const DeviceAxis& axis = device.axes[index];
      q[index] = std::clamp(start[index] + move.by_m[i], axis.lower, axis.upper);
    }
    return q;
  }

  /// Ticks for a time, or until the hand has arrived.
  [[nodiscard]] Expected<Done> ticks(double time_s, bool moving) {
    const auto count = std::lround(time_s / rig_.options.period_s);
    for (long k = 0; k < count && !ended_ && !hopeless(); ++k) {
      if (Expected<Done> done = tick(); !done) return done;
      if (moving && hand_.arrived()) break;
    }
    return Done{};
  }

  [[nodiscard]] Expected<Done> tick() {
    if (options_.cancelled && options_.cancelled()) {
      return Diagnostic{"", 0, "", "", "the rehearsal was stopped", ""};
    }
    filling_.order(record_);
    record_.tick = ticks_;
    record_.time_s = static_cast<double>(ticks_) * rig_.options.period_s;
    timer_.start();
    rig_.renderer->tick(1, record_, &timer_);
    timer_.finish(record_);
    if (ticks_++ >= kFirst_ticks) count();
    countBodies();
    if (!any(record_.faults & kStopping)) return Done{};
    ended_ = true;  // by the strong hand's own motion, or by what it threw
    stopped_by_ = record_.faults & kStopping;
    const Fault fault = record_.faults & kOfTheWorld;
    if (!any(fault)) return Done{};
    return Diagnostic{rig_.models.files.exercise,
                      0,
                      "budget",
                      "",
                      "the worst bodies of a game broke the simulated world: " + faultNames(fault),
                      "narrow the masses and sizes that it allows"};
  }

  [[nodiscard]] Diagnostic unmoved() const {
    return {rig_.models.files.exercise,
            0,
            "budget",
            "",
            "the rehearsal's hand could not be closed round the worst bodies of a game: " +
                faultNames(stopped_by_),
            "narrow the masses and sizes that it allows"};
  }

  void count() {
    if (options_.extra_ns) {
      record_.cpu_ns += std::max<std::int64_t>(0, options_.extra_ns(record_));
    }
    statistics_.add(record_);
    if (static_cast<double>(record_.cpu_ns) > limit_ns_) ++too_slow_;
  }

  void countBodies() {
    int bodies = 0, moving = 0;
    const std::size_t first = rig_.models.scene.bodies.size();
    for (std::size_t slot = 0; slot < filling_.owners().size(); ++slot) {
      const BodyState& state = record_.bodies[first + slot];
      if (PoolFilling::isEmpty(state)) continue;
      ++bodies;
      if (state.velocity_m_s.eigen().norm() > 0.0) ++moving;
    }
    bodies_max_ = std::max(bodies_max_, bodies);
    moving_max_ = std::max(moving_max_, moving);
  }

  Rig& rig_;
  Rehearser& hand_;
  PoolFilling& filling_;
  const RehearsalOptions& options_;
  double limit_ns_ = 0.0;
  TickTimer timer_;
  TickRecord record_;
  TickStatistics statistics_;
  std::uint64_t ticks_ = 0;
  int moves_ = 0, too_slow_ = 0, bodies_max_ = 0, moving_max_ = 0;
  bool ended_ = false;
  Fault stopped_by_ = Fault::kNone;
};

/// Measures a budget; the best of the attempts counts.
Expected<PoolMeasurement> measure(const Models& models, const GameBudget& budget,
                                  const AxisPosition& start, const RigOptions& rig_options,
                                  const RehearsalOptions& options, double share, int attempts) {
  const double limit_ns = share * options.most_of_period * rig_options.period_s * 1e9;
  std::optional<PoolMeasurement> best;
  for (int attempt = 1; attempt <= std::max(1, attempts); ++attempt) {
    auto player = std::make_unique<Rehearser>(models.device);
    Rehearser& hand = *player;
    hand.begin(start, start);
    Models of_its_own = models;
    of_its_own.patient = strongPerson(models.device);
    of_its_own.scene.game = budget;
    auto rig = buildRig(std::move(of_its_own), std::move(player), rig_options);
    if (!rig) return rig.errors();
    PoolFilling filling((*rig)->models, budget, start);
    auto world = std::make_unique<FilledWorld>(**rig, hand, filling, options);
    if (Expected<Done> done = world->run(start, limit_ns); !done) return done.errors();
    PoolMeasurement now = world->result();
    if (!best || now.summary.cpu.p999_ns < best->summary.cpu.p999_ns) best = now;
    best->attempts = attempt;
    if (best->passes() || world->hopeless()) break;
  }
  if (best->passes() && best->bodies_max < budget.slots) {
    return Diagnostic{models.files.exercise,
                      0,
                      "budget.slots",
                      std::to_string(budget.slots),
                      fmt::format("cannot be rehearsed: only {} bodies of this size find a place "
                                  "near the hand",
                                  best->bodies_max),
                      "allow smaller bodies (budget.size_m), or state fewer slots"};
  }
  return *best;
}

}  // namespace

Expected<PoolRehearsal> rehearsePool(const Models& models, const AxisPosition& start,
                                     const RigOptions& rig, const RehearsalOptions& options) {
  const GameBudget whole = models.scene.game;
  const auto tell = [&](const GameBudget& budget) {
    if (!options.status) return;
    options.status(fmt::format("{} awake bodies of a game, {} pieces of {} vertices each",
                               budget.awake, budget.pieces, budget.vertices));
  };
  PoolRehearsal out;
  tell(whole);
  auto measured = measure(models, whole, start, rig, options, 1.0, options.attempts);
  if (!measured) return measured.errors();
  out.measured = *measured;
  if (out.measured.passes()) {
    out.awake = whole.awake;
    return out;
  }
  // The most awake bodies that pass, by halving.
  const auto largest = [&](GameBudget budget, int most) -> Expected<int> {
    int passes = 0;
    while (most - passes > 1) {
      budget.awake = passes + (most - passes) / 2;
      tell(budget);
      auto now = measure(models, budget, start, rig, options, kToSpare, 1);
      if (!now) return now.errors();
      (now->passes() ? passes : most) = budget.awake;
    }
    return passes;
  };
  auto awake = largest(whole, whole.awake);
  if (!awake) return awake.errors();
  out.awake = *awake;
  if (out.awake > 0 || whole.pieces == 1) return out;
  GameBudget of_one = whole;
  of_one.pieces = 1;
  auto alone = largest(of_one, whole.awake + 1);
  if (!alone) return alone.errors();
  out.awake_alone = *alone;
  return out;
}

Diagnostic poolTooSlow(const PoolRehearsal& pool, const Models& models) {
  const PoolMeasurement& m = pool.measured;
  std::string remedy;
  if (pool.awake > 0) {
    remedy = fmt::format(
        "at most {} fit here, with {} pieces of {} vertices: state awake = {}, "
        "or fewer pieces",
        pool.awake, m.budget.pieces, m.budget.vertices, pool.awake);
  } else if (pool.awake_alone > 0) {
    remedy =
        fmt::format("with these pieces even 1 is too many here: state pieces = 1 and awake = {}",
                    pool.awake_alone);
  } else {
    remedy =
        "even 1 is too many here: use fewer slots or vertices, a slower rate or a faster machine";
  }
  return {
      models.files.exercise,
      0,
      "budget.awake",
      std::to_string(m.budget.awake),
      fmt::format("is too many for this machine: with its slots full, a tick takes {:.0f} µs of "
                  "CPU time (p99.9); {:.0f} µs are allowed",
                  1e-3 * m.summary.cpu.p999_ns, m.limit_us),
      remedy};
}

std::string describe(const PoolMeasurement& p) {
  return fmt::format(
      "{} awake and {} fixed bodies of a game, {} pieces of {} vertices each: {:.0f} µs CPU at the "
      "median, {:.0f} p99.9, {:.0f} at most ({:.0f} allowed); up to {} moved, up to {} contacts "
      "with the hand",
      p.driven + p.free, p.bodies_max - p.driven - p.free, p.budget.pieces, p.budget.vertices,
      1e-3 * p.summary.cpu.p50_ns, 1e-3 * p.summary.cpu.p999_ns, 1e-3 * p.summary.cpu.max_ns,
      p.limit_us, p.moving_max, p.summary.contacts_max);
}

}  // namespace wholehand
