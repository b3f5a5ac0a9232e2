#include "exercise/cocktail_bar/ledger.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

constexpr double kPerLitre = 1e12;

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

}  // namespace wholehand
