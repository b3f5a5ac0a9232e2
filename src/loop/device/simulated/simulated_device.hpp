#pragma once

#include "loop/device/haptic_device.hpp"
#include "loop/device/simulated/axis_dynamics.hpp"
#include "loop/device/simulated/linked_dynamics.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/patient_config.hpp"
#include "loop/patient/active_patient.hpp"
#include "loop/patient/motion.hpp"
#include "loop/patient/player.hpp"

#include <array>
#include <memory>
#include <vector>

namespace wholehand {

/// A simulated device as its file describes it: per axis mass, viscous and Coulomb friction,
/// encoder step, output delay in samples, saturation at the effort limit, stops at the ends of the
/// range. A virtual patient is attached, who may link its axes. Valid at any rate: the linear part
/// is advanced by its exact solution for a held effort and for efforts of the person that are
/// linear over the period; Coulomb friction sticks. When the person lets go, the bare mechanism
/// remains.
///
/// The axis's weight pulls with minus its neutral effort, so that sending neutral balances it.
/// Deterministic: the same calls give the same bits.
class SimulatedDevice final : public HapticDevice, public KnownPerson {
 public:
  /// The device starts at rest at the player's start, clamped to its range, and follows the
  /// player's target.
  /// @pre the patient and the player have the device's axes; the person's mass, damping and
  /// stiffness, links included, are positive semidefinite
  /// @param period_s the loop's period
  SimulatedDevice(const DeviceModel& device, const PatientConfig& patient,
                  std::unique_ptr<Player> player, double period_s);
  /// The same with a ScriptedPlayer.
  SimulatedDevice(const DeviceModel& device, const PatientConfig& patient, Intention intention,
                  double period_s);

  /// Resets the device to its start and its time to 0. Never fails.
  [[nodiscard]] Expected<Done> open() override;
  /// Always ready: open() puts the device at rest.
  [[nodiscard]] Expected<Done> ready() override { return Done{}; }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  /// The first read after open() returns the start position and advances no time. kDeviceRead
  /// unless the device is open.
  [[nodiscard]] Fault read(DeviceReading& reading, int elapsed_periods) noexcept override;
  /// Clamps the effort to the limit. Returns kDeviceWrite and keeps the last effort unless the
  /// device is open and the effort is finite with the device's number of axes.
  [[nodiscard]] Fault write(const AxisEffort& effort) noexcept override;
  void close() noexcept override;
  /// Reports the virtual patient, or the person at the screen.
  void report(PersonReading& reading) const noexcept override;

  /// True (unquantised) state, for tests.
  [[nodiscard]] const AxisPosition& position() const noexcept { return q_; }
  [[nodiscard]] const AxisVelocity& velocity() const noexcept { return qd_; }
  /// Effort that currently acts on the mechanism: the last one that passed the output delay.
  [[nodiscard]] const AxisEffort& acting() const noexcept { return acting_; }
  /// The person attached to the device.
  [[nodiscard]] const ActivePatient& person() const noexcept { return person_; }

 private:
  void letPersonAct() noexcept;
  void moveAxes(const AxisPosition& aim, const AxisVelocity& aim_speed) noexcept;
  [[nodiscard]] AxisEffort impedance() const noexcept;
  void letPeriodPass() noexcept;
  void shiftDelayLine() noexcept;

  static constexpr int kMostDelay = 8;  ///< longest output delay [samples]

  DeviceModel device_;
  PatientConfig patient_;
  std::unique_ptr<Player> player_;
  double period_s_;
  ActivePatient person_;
  AxisEffort neutral_;
  std::vector<AxisDynamics> axes_;  ///< with the person's mass and impedance
  std::vector<AxisDynamics> bare_;  ///< without the person; empty when the person never lets go
  LinkedPerson linked_;             ///< moves the axes that the person links

  bool open_ = false;
  bool fresh_ = false;                 // open and not yet read
  std::array<bool, kMaxAxes> held_{};  // held by the person; otherwise the bare mechanism moves
  AxisEffort commanded_;               // last write, held until the next one
  AxisEffort acting_;
  std::array<AxisEffort, kMostDelay> delayed_{};  // ring buffer: sent, not yet acting
  int oldest_ = 0;
  AxisPosition q_, q_intended_;
  AxisPosition q_pull_;  // the intention, as far as the person's strength reaches
  AxisVelocity qd_, qd_pull_;
};

}  // namespace wholehand
