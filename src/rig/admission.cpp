#include "rig/admission.hpp"

#include "rig/models.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

namespace wholehand {
namespace {

/// Start pose of a run of these models.
AxisPosition startOf(const Models& models) {
  const auto player = makeExercisePlayer(models, 1);
  return player ? player->start() : restPose(models);
}

/// Rehearses without a limit, so that the measurement succeeds even if ticks take too long.
Expected<Rehearsal> measure(const Models& models, const RigOptions& rig,
                            const RehearsalOptions& options) {
  constexpr double kAnything = 1e6;
  RehearsalOptions finding_out = options;
  finding_out.allowed_period_share = kAnything;
  finding_out.attempts = 1;
  finding_out.fill_pool = false;
  finding_out.most_bodies = std::min(options.most_bodies, kAdmissionBodies);
  const double limit_us = 1e6 * options.allowed_period_share * rig.period_s;
  std::optional<Rehearsal> best;
  for (int attempt = 0; attempt < std::max(1, options.attempts); ++attempt) {
    auto now = rehearse(models, startOf(models), rig, finding_out);
    if (!now) return now.errors();
    now->limit_us = limit_us;
    if (!best || now->summary.cpu.p999_ns < best->summary.cpu.p999_ns) best = std::move(*now);
    if (1e-3 * best->summary.cpu.p999_ns <= limit_us) break;
  }
  return *best;
}

bool passes(const Rehearsal& r) {
  return 1e-3 * r.summary.cpu.p999_ns <= r.limit_us;
}

/// Indices of the moving bodies, the highest first.
std::vector<std::size_t> fromTheTop(const SceneModel& scene) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (!scene.bodies[i].fixed) order.push_back(i);
  }
  const auto height = [&](std::size_t i) {
    const SceneBody& body = scene.bodies[i];
    return -scene.gravity_m_s2.dot(body.pose * body.com_m);
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return height(a) > height(b); });
  return order;
}

Models without(const Models& models, const std::vector<std::string>& names) {
  Models fewer = models;
  std::erase_if(fewer.scene.bodies, [&](const SceneBody& body) {
    return std::find(names.begin(), names.end(), body.name) != names.end();
  });
  return fewer;
}

}  // namespace

Expected<Admission> admit(const Models& models, const RigOptions& rig,
                          const RehearsalOptions& options,
                          const std::function<void(const std::string&)>& status) {
  const auto report = [&](const std::string& what) {
    if (status) status(what);
  };
  Admission out;
  report(fmt::format("all {} bodies", models.scene.bodies.size()));
  auto measured = measure(models, rig, options);
  if (!measured) return measured.errors();
  out.measured = *measured;
  out.admitted = passes(out.measured);
  if (out.admitted && models.scene.game.slots > 0) {
    RehearsalOptions with_status = options;
    with_status.status = status;
    auto pool = rehearsePool(models, startOf(models), rig, with_status);
    if (!pool) return pool.errors();
    out.admitted = pool->measured.passes();
    out.pool = *pool;
  }
  if (out.admitted || out.pool) return out;

  const auto leave_out = [&](std::vector<std::string> names) -> Expected<bool> {
    report(fmt::format("without {} of {} bodies", names.size(), models.scene.bodies.size()));
    auto now = measure(without(models, names), rig, options);
    if (!now) return now.errors();
    if (!passes(*now)) return false;
    out.remove = std::move(names);
    out.without = *now;
    return true;
  };
  if (!out.measured.heaviest.empty()) {
    auto enough = leave_out({out.measured.heaviest});
    if (!enough) return enough.errors();
    if (*enough) return out;
  }
  // Finds the least number of bodies to remove, from the top down, by bisection.
  const std::vector<std::size_t> order = fromTheTop(models.scene);
  const auto leave_out_top = [&](std::size_t count) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < count; ++i) names.push_back(models.scene.bodies[order[i]].name);
    return leave_out(std::move(names));
  };
  std::size_t too_few = 0, most = order.size();
  if (order.empty()) return out;
  for (std::size_t count = most; most - too_few > 1; count = too_few + (most - too_few) / 2) {
    auto enough = leave_out_top(count);
    if (!enough) return enough.errors();
    if (!*enough && count == order.size())
      return out;  // even the removal of all moving bodies does not help
    (*enough ? most : too_few) = count;
  }
  return out;
}

}  // namespace wholehand
