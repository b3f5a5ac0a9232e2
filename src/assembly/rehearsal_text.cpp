#include "assembly/rehearsal_text.hpp"

#include <fmt/format.h>

namespace wholehand {
namespace {

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

}  // namespace

Diagnostic tooSlow(const Rehearsal& r, const Models& models) {
  std::string where;
  if (r.heaviest_contacts > 0) {
    where = fmt::format(", with {} contacts on \"{}\"", r.heaviest_contacts, r.heaviest);
  } else if (!r.heaviest.empty()) {
    where = fmt::format(", with the hand at \"{}\"", r.heaviest);
  }
  return {models.files.exercise.empty() ? models.scene.path : models.files.exercise,
          0,
          "rehearsal",
          fmt::format("{:.0f} µs", 1e-3 * r.summary.cpu.p999_ns),
          fmt::format(
              "is the CPU time of a tick with the worst contacts (p99.9); {:.0f} µs are allowed, "
              "most of it is {}{}",
              r.limit_us, stageName(r.slowest), where),
          remedyFor(r, models)};
}

std::string describe(const Rehearsal& r) {
  const std::string pool = r.pool ? "; with " + describe(*r.pool) : "";
  return fmt::format(
      "{:.0f} µs CPU at the median, {:.0f} p99.9, {:.0f} at most ({:.0f} allowed), mostly {}; "
      "up to {} contacts, {} of {} bodies touched{}",
      1e-3 * r.summary.cpu.p50_ns, 1e-3 * r.summary.cpu.p999_ns, 1e-3 * r.summary.cpu.max_ns,
      r.limit_us, stageName(r.slowest), r.summary.contacts_max, r.bodies_touched, r.bodies, pool);
}

}  // namespace wholehand
