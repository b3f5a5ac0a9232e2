// A run with a passport: what renders counts on what is proven, and so does its re-simulation.
#include "commissioning/passport.hpp"
#include "resimulation/recorded_files.hpp"
#include "resimulation/resimulation.hpp"
#include "support/folder.hpp"
#include "support/recorded_run.hpp"

#include <cmath>

namespace wholehand::test {
namespace {

constexpr double kProven = 0.9;  // of the damping that the device file states

Passport passportOf(const DeviceModel& device) {
  Passport out;
  out.identity = {"S-1", "1", "1"};
  out.device = device.name;
  out.device_sha256 = std::string(64, '0');
  out.operator_name = "A";
  out.measured_on = today();
  for (const DeviceAxis& axis : device.axes) {
    PassportAxis measured;
    measured.name = axis.name;
    measured.kind = axis.kind;
    measured.mass = {0.99 * axis.mass, 1.01 * axis.mass};
    measured.damping = {kProven * axis.damping, 1.2 * axis.damping};
    measured.coulomb = {axis.coulomb, axis.coulomb + 0.1};
    measured.gravity = {-0.01, 0.01};
    measured.delay_s = {0.9e-3, 1.1e-3};
    measured.resolution = axis.encoder_step;
    out.axes.push_back(measured);
  }
  return out;
}

// Presses into what lies there and comes back.
std::unique_ptr<Rig> measuredRig(const Passport& passport) {
  Models models = load(shippedFiles("lambda-pride", "four-shapes"));
  RigOptions options;
  options.uncertified = true;  // simulated
  options.measured = worstCorners(models.device, passport, options.period_s);
  options.passport = "digest";
  options.passport_text = passportText(passport);
  AxisPosition there(6);
  there[0] = 0.05;
  return orThrow(buildRig(std::move(models),
                          Intention::throughWaypoints({{0.0, AxisPosition(6)}, {0.3, there}}),
                          options));
}

TEST(MeasuredDevice, TankCountsOnTheLowerEndOfItsDamping) {
  const Models models = load(shippedFiles("lambda-pride", "four-shapes"));
  const auto rig = measuredRig(passportOf(models.device));
  const EnergyTankConfig& tank = rig->renderer->config().safety.tank;
  for (int i = 0; i < tank.axes; ++i) {
    const double stated = models.device.axes[i].damping;
    EXPECT_DOUBLE_EQ(tank.device_damping[i], kProven * stated);
    EXPECT_EQ(rig->models.device.axes[i].damping, stated) << "the file is as it was";
  }
}

TEST(MeasuredDevice, DampingAboveTheFiles_ProvesNoMoreThanTheFileStates) {
  const Models models = load(shippedFiles("lambda-pride", "four-shapes"));
  Passport passport = passportOf(models.device);
  for (PassportAxis& axis : passport.axes) axis.damping = {100.0, 120.0};
  const auto rig = measuredRig(passport);
  EXPECT_EQ(rig->renderer->config().safety.tank.device_damping[0], models.device.axes[0].damping);
}

TEST(MeasuredDevice, RecordingCarriesThePassportAndRunsAgainToTheBit) {
  const Folder folder;
  const Passport passport = passportOf(load(shippedFiles("lambda-pride", "four-shapes")).device);
  const auto rig = measuredRig(passport);
  const std::string record = recordTicks(*rig, 500, folder.file("run.h5"));
  const auto reader = orThrow(RecordingReader::open(record));
  const auto corners = orThrow(recordedCorners(reader->meta(), rig->models.device, record));
  ASSERT_EQ(corners.size(), 2U);
  EXPECT_NEAR(corners[0].axes[0].damping, kProven * rig->models.device.axes[0].damping, 1e-8);
  const auto again = resimulate(*reader, record);
  ASSERT_TRUE(again) << format(again.errors());
  EXPECT_GT(again->compared, 500U);
  EXPECT_EQ(again->difference.field, "");
}

}  // namespace
}  // namespace wholehand::test
