#include "exercises/cocktail_bar/serving.hpp"

#include "loop/patient/reach.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

/// A body closer than this to its place has arrived.
constexpr double kThere_m = 1e-6;
/// A free dispenser within this distance of its place is home; within this tilt it stands.
constexpr double kHome_m = 2e-3, kUpright_rad = 0.02;
/// Clearance between placed bodies and the hand.
constexpr double kClear_m = 0.02;

void place(BodyPlacements& placements, int body, const Eigen::Vector3d& at_m,
           const Eigen::Vector3d& velocity_m_s) noexcept {
  if (placements.count >= kMaxPlacements) return;
  BodyPlacement& out = placements.items[placements.count++];
  out = BodyPlacement{body, 0, Vec3::from(at_m), QuatXyzw{}, Vec3::from(velocity_m_s)};
}

}  // namespace

void Serving::reset() noexcept {
  placed_ = false;
  pending_ = false;
  row_ = glass_ = Slide{};
  row_home_ = false;
  lying_ = called_ = {};
  away_s_ = {};
  leaking_ = knocked_over_ = stood_up_ = 0;
}

void Serving::bringHome() noexcept {
  row_home_ = bar_.row.slides;
  for (std::size_t i = 0; i < bar_.dispensers.size(); ++i) called_[i] = bar_.dispensers[i].free;
}

void Serving::tick(const BarObservation& senses, const HandPosture& hand, int target,
                   const RowReach& reach, bool running, BodyPlacements& placements) noexcept {
  placements.count = 0;
  reach_ = reach;
  knocked_over_ = stood_up_ = 0;
  if (!placed_) {  // reads positions from the world, because a slide may have been interrupted
    row_y_m_ = row_to_m_ = senses.at_m[0].y();
    nearer_m_ = nearer_to_m_ = bar_.dispensers[0].home_m.x() - senses.at_m[0].x();
    glass_m_ = glass_to_m_ = senses.glass_m;
    placed_ = true;
  }
  const bool sliding = row_.active() || glass_.active();
  const bool may_move = running && senses.drawn_back && !(sliding && isNear(hand, senses));
  standUp(senses, hand, running && senses.behind && !senses.grips_any, placements);
  pending_ = target >= 0 && (lying_[target] || called_[target]);
  slideRow(senses, target, may_move, placements);
  slideGlass(senses, target, may_move, placements);
}

double Serving::wantedRowY_m(int target) const noexcept {
  const double offset_m = target * bar_.row.spacing_m;
  const double from_m = row_home_ ? bar_.dispensers[0].home_m.y() : row_y_m_;
  return std::clamp(from_m + offset_m, reach_.lower_m, reach_.upper_m) - offset_m;
}

/// Begins a slide if the row is not at the position that the target requires.
void Serving::startRow(int target) noexcept {
  const double to_m = wantedRowY_m(target);
  const double way_m = std::hypot(to_m - row_y_m_, reach_.nearer_m - nearer_m_);
  if (way_m <= kThere_m) {
    row_home_ = false;
    return;
  }
  row_from_m_ = row_y_m_;
  row_to_m_ = to_m;
  nearer_from_m_ = nearer_m_;
  nearer_to_m_ = reach_.nearer_m;
  row_ = Slide{kMinimumJerkPeak * way_m / bar_.row.speed_m_s};
}

void Serving::slideRow(const BarObservation& senses, int target, bool may_move,
                       BodyPlacements& placements) noexcept {
  if (!bar_.row.slides) return;
  if (!row_.active() && target >= 0) startRow(target);
  if (!row_.active()) return;
  row_.advance(may_move, senses.elapsed_s);
  pending_ = true;
  const double way_m = row_to_m_ - row_from_m_, nearer_m = nearer_to_m_ - nearer_from_m_;
  row_y_m_ = row_from_m_ + row_.share() * way_m;
  nearer_m_ = nearer_from_m_ + row_.share() * nearer_m;
  const Eigen::Vector3d velocity_m_s(-row_.rate_per_s() * nearer_m, row_.rate_per_s() * way_m, 0.0);
  for (std::size_t i = 0; i < bar_.dispensers.size(); ++i) {
    Eigen::Vector3d at_m = bar_.dispensers[i].home_m;
    at_m.x() -= nearer_m_;
    at_m.y() = row_y_m_ + static_cast<double>(i) * bar_.row.spacing_m;
    place(placements, bar_.dispensers[i].body_index, at_m, velocity_m_s);
  }
  if (nearer_m == 0.0) return;
  // The rail moves with the dispensers.
  const Eigen::Vector3d rail_m = bar_.rail_home_m - nearer_m_ * Eigen::Vector3d::UnitX();
  place(placements, bar_.rail_index, rail_m, velocity_m_s.x() * Eigen::Vector3d::UnitX());
}

void Serving::slideGlass(const BarObservation& senses, int target, bool may_move,
                         BodyPlacements& placements) noexcept {
  if (!glass_.active()) {
    if (target < 0) return;
    const BarDispenser& d = bar_.dispensers[target];
    if (d.free) return;  // the person carries it to the glass
    Eigen::Vector3d to_m = d.home_m + d.nozzle_m;
    if (bar_.row.slides) {
      const double row_y_m = row_.active() ? row_to_m_ : row_y_m_;
      to_m.x() -= row_.active() ? nearer_to_m_ : nearer_m_;
      to_m.y() = row_y_m + target * bar_.row.spacing_m + d.nozzle_m.y();
    }
    to_m.z() = glass_m_.z();
    if ((to_m - glass_m_).norm() <= kThere_m) return;
    glass_from_m_ = glass_m_;
    glass_to_m_ = to_m;
    glass_ = Slide{bar_.glass.slide_s};
  }
  glass_.advance(may_move, senses.elapsed_s);
  pending_ = true;
  const Eigen::Vector3d way_m = glass_to_m_ - glass_from_m_;
  glass_m_ = glass_from_m_ + glass_.share() * way_m;
  place(placements, bar_.glass.body_index, glass_m_, glass_.rate_per_s() * way_m);
}

bool Serving::atHome(const BarObservation& senses, std::size_t dispenser) const noexcept {
  return (senses.at_m[dispenser] - bar_.dispensers[dispenser].home_m).norm() < kHome_m &&
         senses.tilt_rad[dispenser] < kUpright_rad;
}

bool Serving::isNear(const HandPosture& hand, const BarObservation& senses) const noexcept {
  const BarGlass& glass = bar_.glass;
  bool near = hand.clearance_m(senses.glass_m, glass.radius_m, glass.height_m) < kClear_m;
  for (std::size_t i = 0; i < bar_.dispensers.size(); ++i) {
    const BarDispenser& d = bar_.dispensers[i];
    near = near || hand.clearance_m(senses.at_m[i], d.radius_m, d.height_m) < kClear_m;
  }
  return near;
}

/// True when a dispenser occupies the place of another.
bool Serving::blocksHome(const BarObservation& senses, std::size_t other,
                         std::size_t dispenser) const noexcept {
  const BarDispenser& own = bar_.dispensers[dispenser];
  const BarDispenser& d = bar_.dispensers[other];
  const Eigen::Vector3d apart_m = senses.at_m[other] - own.home_m;
  // A lying body may extend by its length in any direction.
  const double needs_m = own.radius_m + (lying_[other] ? 0.5 * d.height_m : 0.0) + d.radius_m;
  return other != dispenser && apart_m.head<2>().norm() < needs_m &&
         std::abs(apart_m.z()) < 0.5 * (own.height_m + d.height_m);
}

/// Updates whether a free dispenser must return home, and whether it leaks.
void Serving::noteLying(const BarObservation& senses, std::size_t i, bool may_move) noexcept {
  const BarDispenser& d = bar_.dispensers[i];
  const bool dropped = senses.at_m[i].z() < d.home_m.z() - bar_.upset.dropped_m;
  const bool leans = senses.tilt_rad[i] > bar_.upset.tilt_rad;
  const bool upset = leans || dropped || !bar_.reach.contains(senses.at_m[i]);
  const unsigned bit = 1U << i;
  // A dispenser that only touches a withdrawn hand without a grip is not held.
  if (senses.touched[i] && !may_move) {
    lying_[i] = lying_[i] && upset;  // the dispenser was picked up
  } else if (!lying_[i] && upset) {
    lying_[i] = true;
    away_s_[i] = 0.0;
    knocked_over_ |= bit;
  }
  if (!lying_[i]) leaking_ &= ~bit;
  if (lying_[i] && leans) leaking_ |= bit;  // the leak continues in any orientation
  called_[i] = called_[i] && !atHome(senses, i);
}

void Serving::standUp(const BarObservation& senses, const HandPosture& hand, bool may_move,
                      BodyPlacements& placements) noexcept {
  std::array<bool, kMaxDispensers> goes{};
  const std::size_t count = bar_.dispensers.size();
  for (std::size_t i = 0; i < count; ++i) {
    const BarDispenser& d = bar_.dispensers[i];
    if (!d.free) continue;
    noteLying(senses, i, may_move);
    away_s_[i] = may_move && lying_[i] ? away_s_[i] + senses.elapsed_s : 0.0;
    goes[i] = may_move && (called_[i] || (lying_[i] && away_s_[i] >= bar_.upset.stand_up_s)) &&
              hand.clearance_m(d.home_m, d.radius_m, d.height_m) >= kClear_m;
  }
  // A dispenser can return only if the dispensers in its place return too. Each round removes
  // blocked dispensers.
  for (std::size_t round = 0; round < count; ++round) {
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < count; ++k) {
        goes[i] = goes[i] && (goes[k] || !blocksHome(senses, k, i));
      }
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!goes[i]) continue;
    place(placements, bar_.dispensers[i].body_index, bar_.dispensers[i].home_m,
          Eigen::Vector3d::Zero());
    lying_[i] = called_[i] = false;
    leaking_ &= ~(1U << i);
    stood_up_ |= 1U << i;
  }
}

}  // namespace wholehand
