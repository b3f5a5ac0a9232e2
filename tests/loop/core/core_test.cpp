#include "loop/core/axis_array.hpp"
#include "loop/core/expected.hpp"
#include "loop/core/fault.hpp"
#include "loop/core/geometry.hpp"
#include "loop/core/printable.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/realtime/allocation_counter.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <numeric>
#include <set>
#include <string>
#include <type_traits>
#include <variant>

namespace wholehand::test {
namespace {

// ---- axis arrays

// Mixing positions, velocities and efforts, or axes and joints, must not compile.
static_assert(!std::is_convertible_v<AxisVelocity, AxisPosition>);
static_assert(!std::is_assignable_v<AxisPosition&, AxisVelocity>);
static_assert(!std::is_assignable_v<AxisEffort&, AxisPosition>);
static_assert(!std::is_assignable_v<JointPosition&, AxisPosition>);
static_assert(!std::is_constructible_v<AxisPosition, AxisVelocity>);
static_assert(!std::is_convertible_v<int, AxisPosition>, "a size is not a position");
static_assert(std::is_trivially_copyable_v<TickRecord>);

TEST(AxisArray, SizeAndValue_FillTheArray) {
  EXPECT_EQ(AxisPosition().size(), 0);
  const AxisEffort none, f(3, 1.5);
  EXPECT_EQ(none.begin(), none.end());
  EXPECT_EQ(f.size(), 3);
  EXPECT_EQ(std::accumulate(f.begin(), f.end(), 0.0), 4.5);
}

TEST(AxisArray, View_WritesThroughToTheArray) {
  AxisPosition q(kMaxAxes, 1.0);
  q.vec() *= 2.0;
  q.vec()[3] = 7.0;
  EXPECT_EQ(q[0], 2.0);
  EXPECT_EQ(q[3], 7.0);
  EXPECT_EQ(q.vec().size(), kMaxAxes);
}

TEST(AxisArray, BytewiseCopy_IsEqual) {
  AxisVelocity a(2, 3.25);
  a[1] = -1.0;
  AxisVelocity b;
  std::memcpy(static_cast<void*>(&b), &a, sizeof a);
  EXPECT_EQ(b.size(), 2);
  EXPECT_EQ(b[1], -1.0);
}

TEST(AxisArray, AllFinite_ChecksEveryElementAndNoneBeyondTheEnd) {
  AxisPosition q(4, 1.0);
  EXPECT_TRUE(allFinite(q));
  EXPECT_TRUE(allFinite(AxisPosition{}));
  for (int i = 0; i < 4; ++i) {
    for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
      AxisPosition broken = q;
      broken[i] = bad;
      EXPECT_FALSE(allFinite(broken));
    }
  }
  q.data()[4] = std::nan("");  // beyond its size
  EXPECT_TRUE(allFinite(q));
}

TEST(AxisArray, FullSizedMatrices_DoNotAllocate) {
  const AllocationScope scope;
  AxisMatrix m = AxisMatrix::Identity(kMaxAxes, kMaxAxes);
  m *= 2.0;
  const AxisPosition q(kMaxAxes, 1.0);
  AxisPosition out(kMaxAxes);
  out.vec() = m.lazyProduct(q.vec());
  EXPECT_EQ(scope.allocations(), 0U);
  EXPECT_EQ(out[kMaxAxes - 1], 2.0);
}

// ---- diagnostics

TEST(Diagnostic, Complete_NamesFileLineKeyValueProblemAndRemedy) {
  EXPECT_EQ(format(Diagnostic{"config/devices/a.toml", 12, "axes[2].effort_limit_n", "nan",
                              "is not finite", "must be in (0, 1000] N"}),
            "config/devices/a.toml:12: axes[2].effort_limit_n = nan: is not finite; "
            "must be in (0, 1000] N");
}

TEST(Diagnostic, MissingParts_LeaveNoStrayPunctuation) {
  EXPECT_EQ(format(fileFault("a.toml", "cannot be read", "")), "a.toml: cannot be read");
  EXPECT_EQ(format(Diagnostic{"a.toml", 3, "name", "", "is missing", "add it"}),
            "a.toml:3: name: is missing; add it");
  EXPECT_EQ(format(Diagnostic{"", 0, "--engine", "mujoco", "is not a known engine", "use bullet"}),
            "--engine = mujoco: is not a known engine; use bullet");
  EXPECT_EQ(format(fileFault("", "something is wrong", "")), "something is wrong");
}

TEST(Diagnostics, SeveralFaults_AreOneLineEachInOrder) {
  const Diagnostics all = {{"a.toml", 1, "x", "", "is bad", ""}, {"a.toml", 2, "y", "", "too", ""}};
  EXPECT_EQ(format(all), "a.toml:1: x: is bad\na.toml:2: y: too");
  EXPECT_EQ(format(Diagnostics{}), "");
}

// ---- expected

TEST(Expected, Value_IsReachedByEveryAccessor) {
  Expected<std::string> e(std::string("hand"));
  ASSERT_TRUE(e.ok());
  EXPECT_TRUE(static_cast<bool>(e));
  EXPECT_EQ(*e, "hand");
  EXPECT_EQ(e->size(), 4U);
  e.value() += "s";
  EXPECT_EQ(std::as_const(e).value(), "hands");
}

TEST(Expected, SeveralErrors_AreAllKept) {
  const Expected<int> one(Diagnostic{"a.toml", 1, "", "", "broken", ""});
  ASSERT_FALSE(one.ok());
  ASSERT_EQ(one.errors().size(), 1U);
  EXPECT_EQ(one.errors()[0].problem, "broken");
  EXPECT_EQ(Expected<int>(Diagnostics(3)).errors().size(), 3U);
}

TEST(Expected, MoveOnlyValue_CanBeTaken) {
  Expected<std::unique_ptr<int>> e(std::make_unique<int>(7));
  const std::unique_ptr<int> taken = *std::move(e);
  ASSERT_TRUE(taken);
  EXPECT_EQ(*taken, 7);
}

TEST(Expected, AccessToTheWrongSide_Throws) {
  Expected<int> bad(Diagnostic{});
  EXPECT_THROW((void)bad.value(), std::bad_variant_access);
  const Expected<int> good(1);
  EXPECT_THROW((void)good.errors(), std::bad_variant_access);
}

// ---- faults and stages

TEST(Fault, Bits_CombineAndAreReported) {
  Fault f = Fault::kNone;
  EXPECT_FALSE(any(f));
  f |= Fault::kEffortLimit | Fault::kLateTick;
  EXPECT_TRUE(any(f & Fault::kLateTick));
  EXPECT_FALSE(any(f & Fault::kDeviceRead));
  EXPECT_FALSE(any(f & kStoppingFaults)) << "information must not stop rendering";
  f |= Fault::kNonFinitePosition;
  EXPECT_TRUE(any(f & kStoppingFaults));
}

/// Checks that each of `count` items has a name of its own.
void expectNamesOfTheirOwn(int count, const std::function<std::string(int)>& nameOf) {
  std::set<std::string> names = {"unknown"};
  for (int i = 0; i < count; ++i) EXPECT_TRUE(names.insert(nameOf(i)).second) << i;
  EXPECT_EQ(nameOf(count), "unknown");
}

TEST(Fault, EveryBitAndStage_HasItsOwnName) {
  expectNamesOfTheirOwn(kFaultBits, [](int bit) { return faultName(bit); });
  expectNamesOfTheirOwn(kStages, [](int i) { return stageName(static_cast<Stage>(i)); });
  EXPECT_STREQ(faultName(-1), "unknown");
  EXPECT_STREQ(faultName(0), "device read failed");
  EXPECT_STREQ(faultName(9), "singular reduced inertia");  // 1 << 9 of Fault::kSingularInertia
}

// ---- geometry

TEST(Pose, InverseAndProduct_AreThoseOfHomogeneousMatrices) {
  const Pose a{Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix(),
               {0.1, -0.2, 0.3}};
  const Pose b{Eigen::AngleAxisd(-1.1, Eigen::Vector3d(0, 1, 1).normalized()).toRotationMatrix(),
               {1.0, 2.0, -3.0}};
  const auto matrix = [](const Pose& p) {
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    m.topLeftCorner<3, 3>() = p.rotation;
    m.topRightCorner<3, 1>() = p.translation_m;
    return m;
  };
  EXPECT_LE((matrix(a * b) - matrix(a) * matrix(b)).norm(), tolerance(1e-15));
  EXPECT_LE((matrix(a.inverse()) - matrix(a).inverse()).norm(), tolerance(1e-14));
  const Eigen::Vector3d p(0.4, 0.5, 0.6);
  EXPECT_LE(((a * p) - (matrix(a) * p.homogeneous()).head<3>()).norm(), tolerance(1e-15));
}

TEST(QuatXyzw, Conversion_KeepsTheComponentOrderBothWays) {
  const Eigen::Quaterniond q(0.1, 0.2, 0.3, 0.4);  // Eigen: w first
  const QuatXyzw stored = QuatXyzw::from(q);
  EXPECT_EQ(stored.x, 0.2);
  EXPECT_EQ(stored.w, 0.1);
  EXPECT_EQ(stored.eigen().coeffs(), q.coeffs());
  EXPECT_EQ(Vec3::from({1.0, 2.0, 3.0}).eigen(), Eigen::Vector3d(1.0, 2.0, 3.0));
}

// ---- untrusted text

TEST(Printable, ControlCharactersAndInvalidUtf8_AreEscaped) {
  EXPECT_EQ(printable("Glas für 2 Gäste \u2192 \U0001F378"), "Glas für 2 Gäste \u2192 \U0001F378");
  EXPECT_EQ(printable("a\x1b[2J\n"), "a\\x1b[2J\\x0a");
  EXPECT_EQ(printable("\u009b"), "\\u{009b}");  // CSI in one character
  EXPECT_EQ(printable("\u202e\u2066"), "\\u{202e}\\u{2066}");
  EXPECT_EQ(printable("\xff"), "\\xff");
  EXPECT_EQ(printable("\xc0\xaf"), "\\xc0\\xaf");                    // overlong encoding of a slash
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");           // a surrogate
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");  // beyond U+10FFFF
  EXPECT_EQ(printable("\xe2\x82"), "\\xe2\\x82");                    // truncated
}

TEST(Printable, LongText_IsCutAtACharacter) {
  EXPECT_EQ(printable("äöü", 2), "äö...");
  EXPECT_EQ(printable("äöü", 3), "äöü");
  EXPECT_FALSE(isPrintable("äöü", 2));
}

TEST(Diagnostics, UntrustedText_StaysOnItsLine) {
  const Diagnostic d{"a\n.toml", 3, "k\x1b", "v\n", "is wrong\nand more", "correct it"};
  EXPECT_EQ(format(d), "a\\x0a.toml:3: k\\x1b = v\\x0a: is wrong\\x0aand more; correct it");
}

}  // namespace
}  // namespace wholehand::test
