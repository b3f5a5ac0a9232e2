#include "exercises/cocktail_bar/pouring.hpp"

#include "exercises/cocktail_bar/bar_record.hpp"
#include "loop/exercise/grip.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace wholehand {
namespace {

int dispenserOf(const Bar& bar, int body) noexcept {
  for (std::size_t i = 0; i < bar.dispensers.size(); ++i) {
    if (bar.dispensers[i].body_index == body) return static_cast<int>(i);
  }
  return -1;
}

void senseContacts(const Bar& bar, const TickRecord& record, BarObservation& out) noexcept {
  for (int k = 0; k < record.contact_count; ++k) {
    const Contact& c = record.contacts[k];
    const int at = dispenserOf(bar, c.body);
    if (at < 0 && c.body != bar.glass.body_index) continue;
    const double normal_n = c.force_n.eigen().dot(c.normal.eigen());
    if (!(normal_n > 0.0)) continue;  // a close point pair without force
    out.touches_any = true;
    if (at < 0) continue;
    out.force_n[at] += normal_n;
    out.touched[at] = true;
  }
}

}  // namespace

BarObservation observeBar(const Bar& bar, const TickRecord& record, const HandPosture& hand,
                          double period_s) noexcept {
  BarObservation out;
  out.elapsed_s = std::max(record.elapsed_periods, 1U) * period_s;
  senseContacts(bar, record, out);
  for (std::size_t i = 0; i < bar.dispensers.size(); ++i) {
    const BarDispenser& d = bar.dispensers[i];
    const bool grips = out.touched[i] && gripForce_n(record, d.body_index, hand) > 0.0;
    out.grips_any = out.grips_any || grips;
    const BodyState& body = record.bodies[d.body_index];
    const Eigen::Matrix3d turn = body.orientation_xyzw.eigen().toRotationMatrix();
    out.at_m[i] = body.position_m.eigen();
    out.nozzle_m[i] = out.at_m[i] + turn * d.nozzle_m;
    out.tilt_rad[i] = std::acos(std::clamp(turn(2, 2), -1.0, 1.0));
  }
  out.glass_m = record.bodies[bar.glass.body_index].position_m.eigen();
  out.nearest = dispenserOf(bar, record.palm_body);
  const double to_nearest_m = record.palm_target_distance_m;
  out.palm_m = to_nearest_m < 0.0 ? std::numeric_limits<double>::infinity() : to_nearest_m;
  out.behind = bar.x_axis < 0 || record.q_s[bar.x_axis] < bar.drawn_back.x_m;
  out.drawn_back =
      out.behind && std::abs(to_nearest_m) >= bar.drawn_back.palm_m && !out.touches_any;
  return out;
}

bool BarObservation::overGlass(int dispenser, const BarGlass& glass) const noexcept {
  const Eigen::Vector3d from_glass = nozzle_m[dispenser] - glass_m;
  return from_glass.head<2>().norm() < glass.inner_radius_m &&
         from_glass.z() > 0.5 * glass.height_m;
}

namespace {

constexpr double kPerLitre = 1e12;
/// Limits of a stroke. A stroke that pressed out at least kLeastStroke_l is spent when its flow has
/// been below kSlow_l_s and below kSlow times its fastest flow for kSlow_s. A smaller stroke is
/// spent when its flow has been below kNothing_l_s for kNothing_s. The spent state ends when the
/// shell has returned to kBack times the pressed volume, when the flow exceeds kSlow_l_s, or when
/// the hand has rested for kRested_s. A hand that cannot open counts as released from a hanging
/// dispenser after a rest of kAtRest_s.
constexpr double kAtRest_s = 1.0;
constexpr double kLeastStroke_l = 0.002, kSlow_l_s = 0.001, kSlow = 0.15, kNothing_l_s = 5e-5,
                 kSlow_s = 0.3, kNothing_s = 1.0, kBack = 0.15, kRested_s = 1.5;

std::int64_t picolitres(double volume_l) noexcept {
  return volume_l > 0.0 ? std::llround(std::min(volume_l, 1e3) * kPerLitre) : 0;  // NaN: 0
}

double litres(std::int64_t volume_pl) noexcept {
  return static_cast<double>(volume_pl) / kPerLitre;
}

}  // namespace

void Ledger::fill(const std::vector<BarDispenser>& dispensers) noexcept {
  *this = Ledger{};
  for (std::size_t i = 0; i < dispensers.size(); ++i) {
    left_[i] = picolitres(dispensers[i].start_l);
    start_ += left_[i];
  }
}

Ledger::Picolitres Ledger::take(int dispenser, double volume_l) noexcept {
  Picolitres& left = left_[dispenser];
  const Picolitres taken = std::min(left, picolitres(volume_l));
  left -= taken;
  return taken;
}

double Ledger::pour(int dispenser, double volume_l, int step, double room_l,
                    double capacity_l) noexcept {
  const Picolitres taken = take(dispenser, volume_l);
  const Picolitres room =
      std::min(picolitres(room_l), std::max<Picolitres>(picolitres(capacity_l) - glass_, 0));
  const Picolitres into = std::min(taken, room);
  layer_[step] += into;
  glass_ += into;
  poured_ += into;
  spilt_ += taken - into;
  return litres(taken);
}

double Ledger::spill(int dispenser, double volume_l) noexcept {
  const Picolitres taken = take(dispenser, volume_l);
  spilt_ += taken;
  return litres(taken);
}

void Ledger::newGlass() noexcept {
  layer_ = {};
  glass_ = 0;
}

double Ledger::left_l(int dispenser) const noexcept {
  return litres(left_[dispenser]);
}
double Ledger::layer_l(int step) const noexcept {
  return litres(layer_[step]);
}
double Ledger::glass_l() const noexcept {
  return litres(glass_);
}
double Ledger::poured_l() const noexcept {
  return litres(poured_);
}
double Ledger::spilt_l() const noexcept {
  return litres(spilt_);
}
double Ledger::start_l() const noexcept {
  return litres(start_);
}

void Pouring::reset() noexcept {
  ledger_.fill(bar_.dispensers);
  squeeze_n_ = {};
  flowing_ = -1;
  flow_l_s_ = 0.0;
  into_glass_ = spilling_ = spent_ = false;
  fastest_l_s_ = slow_s_ = rested_s_ = spent_at_l_ = 0.0;
}

double Pouring::squeeze_n(int dispenser) const noexcept {
  return dispenser < 0 ? 0.0 : squeeze_n_[dispenser];
}

bool Pouring::letGo(int dispenser) const noexcept {
  if (dispenser < 0 || (flowing_ == dispenser && flow_l_s_ > 0.0)) return false;
  if (squeeze_n(dispenser) < bar_.squeeze.let_go_n) return true;
  return !bar_.dispensers[dispenser].free && rested_s_ > kAtRest_s;
}

void Pouring::follow(const Stroke& stroke, bool squeezes, double elapsed_s) noexcept {
  rested_s_ = squeezes ? 0.0 : rested_s_ + elapsed_s;
  if (stroke.pressed_l <= kBack * spent_at_l_ || flow_l_s_ > kSlow_l_s || rested_s_ > kRested_s) {
    spent_ = false;
  }
  const bool whole = stroke.pressed_l >= kLeastStroke_l;
  if (!whole) fastest_l_s_ = 0.0;
  fastest_l_s_ = std::max(fastest_l_s_, flow_l_s_);
  const double slow_l_s = std::max(kNothing_l_s, std::min(kSlow_l_s, kSlow * fastest_l_s_));
  slow_s_ = squeezes && flow_l_s_ < slow_l_s ? slow_s_ + elapsed_s : 0.0;
  if (spent_ || slow_s_ < (whole ? kSlow_s : kNothing_s)) return;
  spent_ = true;
  spent_at_l_ = stroke.pressed_l;
}

void Pouring::tick(const BarObservation& senses, const PourOrder& order, int engaged,
                   const Stroke& stroke, unsigned leaking, double threshold_ratio, bool running,
                   ExerciseRecord& out) noexcept {
  const double tau_s = 1.0 / (2.0 * std::numbers::pi * bar_.squeeze.filter_hz);
  for (std::size_t i = 0; i < bar_.dispensers.size(); ++i) {
    squeeze_n_[i] = (tau_s * squeeze_n_[i] + senses.elapsed_s * senses.squeeze_n[i]) /
                    (tau_s + senses.elapsed_s);
  }
  const bool was_into_glass = into_glass_;
  const double before_l = ledger_.layer_l(order.step), spilt_before_l = ledger_.spilt_l();
  flowing_ = engaged;
  flow_l_s_ = 0.0;
  into_glass_ = false;
  if (running && engaged >= 0) {
    const bool over = engaged == order.dispenser && senses.overGlass(engaged, bar_.glass);
    const double room_l = order.amount_l + order.tolerance_l - before_l;
    const bool had = !empty(engaged);
    const double went_l =
        over ? ledger_.pour(engaged, stroke.out_l, order.step, room_l, bar_.glass.capacity_l)
             : ledger_.spill(engaged, stroke.out_l);
    flow_l_s_ = went_l / senses.elapsed_s;
    into_glass_ = over && went_l > 0.0;
    if (had && empty(engaged)) addEvent(out, BarEvent::kEmpty, engaged);
  }
  follow(engaged >= 0 ? stroke : Stroke{},
         squeeze_n(engaged) >= threshold_ratio * bar_.squeeze.threshold_n, senses.elapsed_s);
  for (std::size_t i = 0; running && i < bar_.dispensers.size(); ++i) {
    if ((leaking >> i & 1U) == 0U) continue;
    const double thicker = bar_.liquids[bar_.dispensers[i].liquid].viscosity_pa_s / thinnest_pa_s_;
    (void)ledger_.spill(static_cast<int>(i), bar_.upset.leak_l_s / thicker * senses.elapsed_s);
  }
  addEvents(order, before_l, spilt_before_l, was_into_glass, out);
}

void Pouring::addEvents(const PourOrder& order, double before_l, double spilt_before_l,
                        bool was_into_glass, ExerciseRecord& out) noexcept {
  const double now_l = ledger_.layer_l(order.step);
  const bool spills = ledger_.spilt_l() > spilt_before_l;
  if (into_glass_ && !was_into_glass) addEvent(out, BarEvent::kPourBegan, order.dispenser);
  if (!into_glass_ && was_into_glass) addEvent(out, BarEvent::kPourEnded, order.dispenser, now_l);
  if (before_l < order.amount_l && now_l >= order.amount_l) {
    addEvent(out, BarEvent::kLineReached, order.step, now_l);
  }
  if (spills && !spilling_) {
    if (into_glass_) addEvent(out, BarEvent::kOverfilled, order.step, now_l);
    addEvent(out, BarEvent::kSpilt, flowing_, ledger_.spilt_l());
  }
  spilling_ = spills;
}

}  // namespace wholehand
