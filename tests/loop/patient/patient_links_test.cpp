// Patients whose axes are linked: the meaning of their files, and the messages for wrong ones.
#include "files/patient/patient_file.hpp"
#include "files/shipped_models.hpp"
#include "loop/model/patient_config.hpp"
#include "loop/patient/active_patient.hpp"
#include "support/contains.hpp"
#include "support/file_bytes.hpp"
#include "support/folder.hpp"
#include "support/tolerance.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include <iterator>

namespace wholehand::test {
namespace {

std::string textOf(const std::string& patient) {
  return bytesOfFile(patientPath(patient));
}

Expected<PatientConfig> load(const std::string& text, const DeviceModel& model) {
  const Folder folder;
  return loadPatientFile(folder.write("p.toml", text), model);
}

/// A relaxed adult with one table of links.
PatientConfig linkedBy(const std::string& table, const std::string& on = "lambda-pride") {
  return orThrow(load(textOf("relaxed-adult") + "\n[[links]]\n" + table, deviceNamed(on)));
}

/// Links plus the values of the single axes.
AxisMatrix total(const PatientConfig& p, AxisMatrix PatientLinks::*link, double PatientAxis::*own) {
  const auto n = static_cast<Eigen::Index>(p.axes.size());
  AxisMatrix out = AxisMatrix::Zero(n, n);
  if ((p.links.*link).size() > 0) out = p.links.*link;
  for (Eigen::Index i = 0; i < n; ++i) out(i, i) += p.axes[i].*own;
  return out;
}
AxisMatrix stiffnessOf(const PatientConfig& p) {
  return total(p, &PatientLinks::stiffness, &PatientAxis::stiffness);
}

TEST(PatientLinks, FilesWithoutLinks_LinkNothing) {
  for (const char* name : {"relaxed-adult", "spastic", "tremor", "fights", "no-arm"}) {
    const PatientConfig patient = patientNamed(name);
    EXPECT_EQ(patient.links.stiffness.size(), 0) << name;
    EXPECT_EQ(patient.tremor.along.size(), 0) << name;
    EXPECT_FALSE(patient.reflex.largest_triggers_all) << name;
  }
}

// Units: a force at the tip times a lever arm is a torque; a distance divided by it is an angle.
TEST(PatientLinks, ValuesAtTheTip_AreConvertedByBothLeverArms) {
  const std::string on = "wrist-9axis";
  const DeviceModel model = deviceNamed(on);
  const int y = model.axisIndex("y"), roll = model.axisIndex("roll"),
            fingers = model.axisIndex("finger_flexion");
  const PatientConfig p = linkedBy(R"(axes = ["finger_flexion", "y", "roll"]
lever_m = { roll = -0.05 }
stiffness_tip_n_m = [[3.0, 1.0, 2.0], [1.0, 4.0, 0.5], [2.0, 0.5, 5.0]]
)",
                                   on);
  EXPECT_NEAR(p.links.stiffness(fingers, y), 1.0 * 0.08, tolerance(1e-15));
  EXPECT_NEAR(p.links.stiffness(y, fingers), 1.0 * 0.08, tolerance(1e-15));
  EXPECT_NEAR(p.links.stiffness(fingers, roll), -2.0 * 0.08 * 0.05, tolerance(1e-15));
  EXPECT_NEAR(p.links.stiffness(y, roll), -0.5 * 0.05, tolerance(1e-15));
  EXPECT_EQ(p.links.stiffness(y, y), 0.0);  // the diagonal belongs to the axes
  EXPECT_EQ(p.axes[y].stiffness, 300.0 + 4.0);
  EXPECT_NEAR(p.axes[roll].stiffness, 2.0 + 5.0 * 0.0025, tolerance(1e-15));
  EXPECT_TRUE(p.links.mass.isZero(0.0));
}

TEST(PatientLinks, DiagonalMatrix_EqualsTheAxisKeys) {
  const PatientConfig linked = linkedBy(R"(axes = ["x", "z"]
mass_kg = [[0.5, 0.0], [0.0, 0.25]]
damping_n_s_m = [[2, 0], [0, 3]]
stiffness_n_m = [[100.0, 0.0], [0.0, 50.0]]
)");
  std::string text = textOf("relaxed-adult");
  text = replaced(text, "mass_kg = 1.0\ndamping_n_s_m = 15.0\nstiffness_n_m = 300.0",
                  "mass_kg = 1.5\ndamping_n_s_m = 17.0\nstiffness_n_m = 400.0");
  const std::size_t z = text.find("name = \"z\"");
  text = text.substr(0, z) +
         replaced(text.substr(z), "mass_kg = 1.0\ndamping_n_s_m = 15.0\nstiffness_n_m = 300.0",
                  "mass_kg = 1.25\ndamping_n_s_m = 18.0\nstiffness_n_m = 350.0");
  const PatientConfig own = load(text, deviceNamed()).value();
  EXPECT_EQ(linked.links.stiffness.size(), 0);  // nothing is linked: single axes are simulated
  for (std::size_t i = 0; i < own.axes.size(); ++i) {
    EXPECT_EQ(linked.axes[i].mass, own.axes[i].mass);
    EXPECT_EQ(linked.axes[i].damping, own.axes[i].damping);
    EXPECT_EQ(linked.axes[i].stiffness, own.axes[i].stiffness);
  }
}

TEST(PatientLinks, AxesInAnotherOrder_GiveTheSamePatient) {
  const AxisMatrix one = stiffnessOf(linkedBy(R"(axes = ["x", "y", "z"]
stiffness_n_m = [[10, 2, 3], [2, 20, 5], [3, 5, 30]]
)"));
  const AxisMatrix other = stiffnessOf(linkedBy(R"(axes = ["z", "x", "y"]
stiffness_n_m = [[30, 3, 5], [3, 10, 2], [5, 2, 20]]
)"));
  EXPECT_EQ(one, other);
}

TEST(PatientLinks, SeveralTables_AddUp) {
  const auto two = load(textOf("relaxed-adult") + R"(
[[links]]
axes = ["x", "y"]
stiffness_n_m = [[10, 4], [4, 10]]
[[links]]
axes = ["y", "x", "z"]
stiffness_n_m = [[1, 2, 0], [2, 1, 3], [0, 3, 9]]
)",
                        deviceNamed())
                       .value();
  EXPECT_EQ(two.links.stiffness(0, 1), 6.0);
  EXPECT_EQ(two.links.stiffness(2, 0), 3.0);
  EXPECT_EQ(two.axes[0].stiffness, 300.0 + 10.0 + 1.0);
}

TEST(PatientLinks, AxesThatTheDeviceLacks_AreLeftOut) {
  for (const char* name : {"enslaved-fingers", "spastic-fist", "holds-a-ball"}) {
    EXPECT_EQ(patientNamed(name, "desktop-3axis").links.stiffness.size(), 0) << name;
    EXPECT_GT(patientNamed(name, "lambda-pride").links.stiffness.size(), 0) << name;
  }
  const PatientConfig pills = patientNamed("pill-rolling", "desktop-3axis");
  ASSERT_EQ(pills.tremor.along.size(), 3);
  EXPECT_EQ(pills.tremor.along[1], 1.0);
}

// Work done on the person along any closed path is not negative: vᵀ K v >= 0.
TEST(PatientLinks, ShippedMatrices_ArePositiveSemidefinite) {
  for (const char* name : {"enslaved-fingers", "spastic-fist", "holds-a-ball", "pill-rolling"}) {
    for (const char* on : {"lambda-pride", "wrist-9axis", "desktop-3axis"}) {
      const PatientConfig p = patientNamed(name, on);
      for (const AxisMatrix& m : {stiffnessOf(p), total(p, &PatientLinks::mass, &PatientAxis::mass),
                                  total(p, &PatientLinks::damping, &PatientAxis::damping)}) {
        EXPECT_EQ(m, AxisMatrix(m.transpose())) << name;
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(m, Eigen::EigenvaluesOnly);
        EXPECT_GT(solver.eigenvalues()[0], 0.0) << name << " on " << on;
      }
    }
  }
}

/// If one digit is moved by 1 and the others are free, they follow by -K_oo⁻¹ K_od.
TEST(ShippedPatients, EnslavedFingers_FollowAsPublished) {
  const PatientConfig p = patientNamed("enslaved-fingers");
  const DeviceModel model = deviceNamed();
  const int fingers = model.axisIndex("finger_flexion"),
            swing = model.axisIndex("thumb_circumduction"),
            thumb = model.axisIndex("thumb_flexion");
  const AxisMatrix k = stiffnessOf(p);
  const auto follows = [&](int moved, int a, int b) {
    Eigen::Matrix2d own;
    own << k(a, a), k(a, b), k(b, a), k(b, b);
    return Eigen::Vector2d(-own.inverse() * Eigen::Vector2d(k(a, moved), k(b, moved)));
  };
  // The levers are equal, so shares of angles are shares of distances. The file cites the numbers.
  EXPECT_NEAR(follows(fingers, swing, thumb)[0], 0.06, 0.005);
  EXPECT_NEAR(follows(fingers, swing, thumb)[1], 0.19, 0.005);
  EXPECT_NEAR(follows(thumb, fingers, swing)[0], 0.17, 0.005);
  for (const double share : {follows(fingers, swing, thumb)[0], follows(fingers, swing, thumb)[1],
                             follows(thumb, fingers, swing)[0]}) {
    EXPECT_GE(share, 0.05);
    EXPECT_LE(share, 0.30);
  }
}

/// The ball's stiffness: closing both digits by 1 cm at the tips compresses it by 2 cm; rolling it
/// needs no force.
TEST(ShippedPatients, HeldBall_IsCompressedByBothDigitsAndRollsFreely) {
  const DeviceModel model = deviceNamed();
  const int fingers = model.axisIndex("finger_flexion"), thumb = model.axisIndex("thumb_flexion");
  const AxisMatrix ball =
      stiffnessOf(patientNamed("holds-a-ball")) - stiffnessOf(patientNamed("relaxed-adult"));
  const double angle = 0.01 / 0.08;
  Eigen::VectorXd press = Eigen::VectorXd::Zero(6), roll = press;
  press[fingers] = press[thumb] = roll[fingers] = angle;
  roll[thumb] = -angle;
  EXPECT_NEAR(0.5 * press.dot(ball * press), 0.5 * 500.0 * 0.02 * 0.02, tolerance(1e-12));
  EXPECT_NEAR(0.5 * roll.dot(ball * roll), 0.0, tolerance(1e-12));
  // The ball's weight at the wrist, as a point mass at 0.08 m: ½ m (v + ω r)².
  const PatientConfig wrist = patientNamed("holds-a-ball", "wrist-9axis");
  EXPECT_NEAR(wrist.links.mass(1, 4), 0.05 * 0.08, tolerance(1e-15));
  EXPECT_NEAR(wrist.axes[4].mass, 3e-3 + 0.05 * 0.08 * 0.08, tolerance(1e-15));
}

TEST(PatientEffort, LinkedAxes_PullEachOther) {
  PatientConfig p = linkedBy(R"(axes = ["x", "y"]
damping_n_s_m = [[1, -1], [-1, 1]]
stiffness_n_m = [[50, -50], [-50, 50]]
)");
  AxisPosition q(6), meant(6);
  AxisVelocity qd(6), meant_speed(6);
  q[0] = 0.01;
  qd[1] = 0.2;
  const AxisEffort f = patientEffort(p, q, qd, meant, meant_speed);
  EXPECT_NEAR(f[0], -(300.0 + 50.0) * 0.01 + 1.0 * 0.2, tolerance(1e-12));
  EXPECT_NEAR(f[1], 50.0 * 0.01 - (15.0 + 1.0) * 0.2, tolerance(1e-12));
  EXPECT_EQ(f[2], 0.0);
}

/// Checks that the suggested remedy works: the off-diagonal value times the named share is
/// accepted.
TEST(WrongLinks, OffDiagonalTimesTheNamedShare_IsAccepted) {
  const std::string find = "[[500.0, 500.0],\n                     [500.0, 500.0]]";
  // 620 and 600 N/m on the diagonal with 900 off it: sqrt(620 600) / 900 = 0.677.
  const auto wrong =
      load(replaced(textOf("holds-a-ball"), find, "[[500, 900], [900, 500]]"), deviceNamed());
  ASSERT_FALSE(wrong.ok());
  EXPECT_TRUE(contains(wrong.errors().front().remedy, "by 0.677 or less"))
      << format(wrong.errors());
  EXPECT_TRUE(
      load(replaced(textOf("holds-a-ball"), find, "[[500, 609.3], [609.3, 500]]"), deviceNamed())
          .ok());
}

}  // namespace
}  // namespace wholehand::test
