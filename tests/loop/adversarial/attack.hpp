#pragma once

#include "loop/device/simulated/simulated_device.hpp"
#include "support/rig_tools.hpp"

#include <optional>

/// Runs one patient on one device, hand and exercise on the simulated clock and checks what must
/// hold in every tick for every kind of patient.
namespace wholehand::test {

/// A device whose person can be replaced while the rig around it stays.
class ChangingDevice final : public HapticDevice, public KnownPerson {
 public:
  void put(std::unique_ptr<SimulatedDevice> device) { now_ = std::move(device); }
  [[nodiscard]] const SimulatedDevice& now() const { return *now_; }

  [[nodiscard]] Expected<Done> open() override { return now_->open(); }
  [[nodiscard]] Expected<Done> ready() override { return now_->ready(); }
  [[nodiscard]] Expected<Done> enable() override { return now_->enable(); }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  [[nodiscard]] Fault read(DeviceReading& reading, int elapsed_periods) noexcept override {
    return now_->read(reading, elapsed_periods);
  }
  [[nodiscard]] Fault write(const AxisEffort& effort) noexcept override {
    return now_->write(effort);
  }
  void close() noexcept override {
    if (now_) now_->close();
  }
  void report(PersonReading& reading) const noexcept override { now_->report(reading); }

 private:
  std::unique_ptr<SimulatedDevice> now_;
};

/// Result of a run.
struct Outcome {
  std::string broken;  ///< the violation that ended the run; empty: none
  int ticks = 0;       ///< ticks before the stop
  Fault stopped_by = Fault::kNone;
  int neutral_after_ticks = -1;  ///< ticks from the stop to neutral; -1: never
  int touched_ticks = 0;
  double deepest_m = -1.0;  ///< depth of a bone of the hand in a body; negative: outside. See Bones
  double hardest = 0.0;     ///< largest effort as a share of its limit
  bool let_go = false;
};

/// Measures how deep the bones of the hand (the axes of its capsules) are in bodies that are fixed
/// or move by themselves. Skin gives way by a millimetre or two; a bone inside a body has gone
/// through its surface.
class Bones {
 public:
  explicit Bones(const Rig& rig) : rig_(rig), hand_(rig.models.hand) {}
  /// Depth of the deepest bone in any body [m]. A body that an exercise has placed is left out from
  /// then on.
  double deepest(const TickRecord& record);
  void reset() { placed_ = 0; }

 private:
  const Rig& rig_;
  ArticulatedBody hand_;
  std::uint32_t placed_ = 0;  // one bit per body
};

/// Arms, runs `ticks` or to the first fault, requests a stop and runs 150 more ticks. Ends at the
/// first violation: a number that is not finite, an effort beyond its limit or its slew limit, a
/// device not at neutral 100 ms after the stop, a bone inside a body.
/// @pre the rig's device is `device`
/// @return nullopt where arming is refused
std::optional<Outcome> attack(Rig& rig, ChangingDevice& device, Player& player, Bones& bones,
                              int ticks);

}  // namespace wholehand::test
