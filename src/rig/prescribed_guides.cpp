#include "rig/prescribed_guides.hpp"

#include "certify/certificate_refusal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <mutex>
#include <string>
#include <utility>

namespace wholehand {
namespace {

// Stiffness of a limit's wall, at the tip for a rotation.
constexpr double kWall_n_m = 300.0, kWallTip_n_m = 100.0;
constexpr double kTip_m = 0.08;  ///< lever arm of a rotation without a tip, as in certificates
// Largest effort of a wall: that of so many bands, and a share of the axis's limit.
constexpr double kWallBands = 2.0, kWallShare = 0.5;
// Largest force of a corridor, and the share of the least limit of a translation.
constexpr double kCorridor_n = 3.0, kCorridorShare = 0.2;
constexpr double kEach = 0.5;  ///< share of what an axis bears for each of the two
constexpr std::array<double, 6> kShares = {1.0, 0.8, 0.6, 0.4, 0.2, 0.1};

constexpr std::array<const char*, 3> kTranslations = {"x", "y", "z"};

double wallOf(const DeviceAxis& axis) {
  if (axis.kind == AxisKind::kTranslation) return kWall_n_m;
  const double lever_m = axis.lever_arm_m > 0.0 ? axis.lever_arm_m : kTip_m;
  return kWallTip_n_m * lever_m * lever_m;
}

std::array<int, 3> translationsOf(const DeviceModel& device) {
  std::array<int, 3> out{};
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = device.axisIndex(kTranslations[i]);
  return out;
}

std::vector<GuideStiffness> asked(const Models& models) {
  std::vector<GuideStiffness> out(models.device.axes.size());
  for (const Prescription::Limit& limit : models.prescription->limits) {
    out[limit.axis].wall = wallOf(models.device.axes[limit.axis]);
  }
  if (!models.prescription->corridor) return out;
  for (const int axis : translationsOf(models.device)) {
    if (axis >= 0) out[axis].corridor = models.prescription->corridor->stiffness_n_m;
  }
  return out;
}

/// What guideStiffnesses() depends on, as a text.
std::string keyOf(const CertificateInput& without, const std::vector<GuideStiffness>& asked) {
  std::string key = fmt::format("{:.17g} {}", without.period_s, static_cast<int>(without.persons));
  for (const FingerprintPart& part : fingerprintOf(without).parts) key += " " + part.hash;
  for (const GuideStiffness& axis : asked) {
    key += fmt::format(" {:.17g} {:.17g}", axis.wall, axis.corridor);
  }
  return key;
}

/// Largest spring to the ground that an axis bears, at most `most`.
double bearable(const CertificateInput& without, int axis, double most) {
  AxisCase c = axisCase(without, axis);
  c.walls = {{most, 0.0}};
  return most * bearableWallShare(c);
}

std::vector<GuideStiffness> searched(const CertificateInput& without,
                                     std::vector<GuideStiffness> out) {
  double corridor = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < out.size(); ++a) {
    const double most = std::max(out[a].wall, out[a].corridor);
    if (!(most > 0.0)) continue;
    const double each = kEach * bearable(without, static_cast<int>(a), most / kEach);
    out[a].wall = std::min(out[a].wall, each);
    if (out[a].corridor > 0.0) corridor = std::min({corridor, out[a].corridor, each});
  }
  // The corridor is as stiff in every direction.
  for (GuideStiffness& axis : out) axis.corridor = std::min(axis.corridor, corridor);
  const std::vector<GuideStiffness> whole = out;
  for (const double share : kShares) {
    for (std::size_t a = 0; a < out.size(); ++a) {
      out[a] = {share * whole[a].wall, share * whole[a].corridor};
    }
    CertificateInput with = without;
    addGuideWalls(with, out);
    if (passesCertificate(with)) break;
  }
  return out;
}

}  // namespace

std::vector<GuideStiffness> guideStiffnesses(const Models& models,
                                             const CertificateInput& without) {
  constexpr std::size_t kMost = 1000;
  static std::mutex mutex;
  static std::map<std::string, std::vector<GuideStiffness>> known;
  if (!models.prescription) return {};
  const std::vector<GuideStiffness> wanted = asked(models);
  const std::string key = keyOf(without, wanted);
  {
    const std::lock_guard lock(mutex);
    if (const auto at = known.find(key); at != known.end()) return at->second;
  }
  std::vector<GuideStiffness> found = searched(without, wanted);
  const std::lock_guard lock(mutex);
  if (known.size() < kMost) known.emplace(key, found);
  return found;
}

PersonGuidesConfig guidesOf(const Models& models, double period_s) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const int axes = models.device.axisCount();
  const std::vector<GuideStiffness> stiffness =
      guideStiffnesses(models, certificateInputWithoutGuides(models, period_s));
  PersonGuidesConfig out;
  LimitWallConfig& walls = out.walls;
  walls.axes = axes;
  walls.lower = AxisPosition(axes, -kNone);
  walls.upper = AxisPosition(axes, kNone);
  walls.band = AxisPosition(axes, kLimitBand_m);
  walls.stiffness = AxisStiffness(axes);
  walls.most = AxisEffort(axes);
  for (const Prescription::Limit& limit : models.prescription->limits) {
    const DeviceAxis& axis = models.device.axes[limit.axis];
    // An end at the device's own end narrows nothing.
    if (limit.lower > axis.lower) walls.lower[limit.axis] = limit.lower;
    if (limit.upper < axis.upper) walls.upper[limit.axis] = limit.upper;
    if (axis.kind == AxisKind::kRotation) walls.band[limit.axis] = kLimitBand_rad;
    walls.stiffness[limit.axis] = stiffness[limit.axis].wall;
    walls.most[limit.axis] =
        std::min(kWallBands * walls.band[limit.axis] * walls.stiffness[limit.axis],
                 kWallShare * axis.effort_limit);
  }
  out.translations = translationsOf(models.device);
  if (!models.prescription->corridor) return out;
  CorridorConfig corridor{models.prescription->corridor->radius_m, 0.0, kCorridor_n};
  for (const int axis : out.translations) {
    if (axis < 0) continue;
    corridor.stiffness_n_m = stiffness[axis].corridor;
    corridor.most_n =
        std::min(corridor.most_n, kCorridorShare * models.device.axes[axis].effort_limit);
  }
  if (corridor.stiffness_n_m > 0.0) out.corridor = corridor;
  return out;
}

void addGuideWalls(CertificateInput& input, const std::vector<GuideStiffness>& guides) {
  for (std::size_t a = 0; a < guides.size(); ++a) {
    const double stiffness = guides[a].wall + guides[a].corridor;
    if (stiffness > 0.0) input.walls.push_back({static_cast<int>(a), {stiffness, 0.0}});
  }
}

}  // namespace wholehand
