#include "exercise/cocktail_bar/serving.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

/// Nearer than this to where it belongs, a body is there.
constexpr double kThere_m = 1e-6;

void place(BodyPlacements& placements, int body, const Eigen::Vector3d& at_m,
           const Eigen::Vector3d& velocity_m_s) noexcept {
  if (placements.count >= kMaxPlacements) return;
  BodyPlacement& out = placements.items[static_cast<std::size_t>(placements.count++)];
  out = BodyPlacement{body, 0, Vec3::from(at_m), QuatXyzw{}, Vec3::from(velocity_m_s)};
}

}  // namespace

void Serving::reset() noexcept {
  placed_ = false;
  pending_ = false;
  row_ = glass_ = Slide{};
  lying_ = {};
  away_s_ = {};
  leaking_ = knocked_over_ = stood_up_ = 0;
}

void Serving::tick(const BarSenses& senses, int target, bool running,
                   BodyPlacements& placements) noexcept {
  placements.count = 0;
  knocked_over_ = stood_up_ = 0;
  if (!placed_) {  // the world says where they are: it may have been left mid-slide
    row_y_m_ = row_to_m_ = senses.at_m[0].y();
    glass_m_ = glass_to_m_ = senses.glass_m;
    placed_ = true;
  }
  const bool may_move = running && senses.drawn_back;
  standUp(senses, may_move, placements);
  pending_ = target >= 0 && lying_[static_cast<std::size_t>(target)];
  slideRow(senses, target, may_move, placements);
  slideGlass(senses, target, may_move, placements);
}

double Serving::wantedRowY_m(int target) const noexcept {
  const double offset_m = target * bar_.row.spacing_m;
  return std::clamp(row_y_m_ + offset_m, bar_.row.reach_lower_m, bar_.row.reach_upper_m) - offset_m;
}

void Serving::slideRow(const BarSenses& senses, int target, bool may_move,
                       BodyPlacements& placements) noexcept {
  if (!bar_.row.slides) return;
  if (!row_.active()) {
    if (target >= 0 && std::abs(wantedRowY_m(target) - row_y_m_) > kThere_m) {
      row_from_m_ = row_y_m_;
      row_to_m_ = wantedRowY_m(target);
      row_ = Slide{kMinimumJerkPeak * std::abs(row_to_m_ - row_from_m_) / bar_.row.speed_m_s};
    } else {
      return;
    }
  }
  row_.advance(may_move, senses.elapsed_s);
  pending_ = true;
  const double way_m = row_to_m_ - row_from_m_;
  row_y_m_ = row_from_m_ + row_.share() * way_m;
  const Eigen::Vector3d velocity_m_s(0.0, row_.rate_per_s() * way_m, 0.0);
  for (std::size_t i = 0; i < bar_.dispensers.size(); ++i) {
    Eigen::Vector3d at_m = bar_.dispensers[i].home_m;
    at_m.y() = row_y_m_ + static_cast<double>(i) * bar_.row.spacing_m;
    place(placements, bar_.dispensers[i].body_index, at_m, velocity_m_s);
  }
}

void Serving::slideGlass(const BarSenses& senses, int target, bool may_move,
                         BodyPlacements& placements) noexcept {
  if (!glass_.active()) {
    if (target < 0) return;
    const BarDispenser& d = bar_.dispensers[static_cast<std::size_t>(target)];
    if (d.free) return;  // it is carried to the glass
    Eigen::Vector3d to_m = d.home_m + d.nozzle_m;
    if (bar_.row.slides) {
      const double row_y_m = row_.active() ? row_to_m_ : row_y_m_;
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

bool Serving::homeIsFree(const BarSenses& senses, std::size_t dispenser) const noexcept {
  const BarDispenser& own = bar_.dispensers[dispenser];
  for (std::size_t i = 0; i < bar_.dispensers.size(); ++i) {
    const BarDispenser& other = bar_.dispensers[i];
    const Eigen::Vector3d apart_m = senses.at_m[i] - own.home_m;
    // A body that lies needs its length in every direction.
    const double needs_m = own.radius_m + (lying_[i] ? 0.5 * other.height_m : 0.0) + other.radius_m;
    if (i != dispenser && apart_m.head<2>().norm() < needs_m &&
        std::abs(apart_m.z()) < 0.5 * (own.height_m + other.height_m)) {
      return false;
    }
  }
  return true;
}

void Serving::standUp(const BarSenses& senses, bool may_move, BodyPlacements& placements) noexcept {
  for (std::size_t i = 0; i < bar_.dispensers.size(); ++i) {
    const BarDispenser& d = bar_.dispensers[i];
    if (!d.free) continue;
    const bool dropped = senses.at_m[i].z() < d.home_m.z() - bar_.upset.dropped_m;
    const bool leans = senses.tilt_rad[i] > bar_.upset.tilt_rad;
    const bool upset = leans || dropped;
    const unsigned bit = 1U << i;
    if (senses.touched[i]) {
      lying_[i] = lying_[i] && upset;  // picked up
    } else if (!lying_[i] && upset) {
      lying_[i] = true;
      away_s_[i] = 0.0;
      knocked_over_ |= bit;
    }
    if (!lying_[i]) leaking_ &= ~bit;
    if (!lying_[i]) continue;
    if (leans) leaking_ |= bit;  // and goes on, however it tumbles
    away_s_[i] = may_move ? away_s_[i] + senses.elapsed_s : 0.0;
    if (away_s_[i] < bar_.upset.stand_up_s || !homeIsFree(senses, i)) continue;
    place(placements, d.body_index, d.home_m, Eigen::Vector3d::Zero());
    lying_[i] = false;
    leaking_ &= ~bit;
    stood_up_ |= bit;
  }
}

}  // namespace wholehand
