// The passport's file: what is written is read, and whatever is wrong with it is refused by name.
#include "commissioning/passport_chart.hpp"
#include "passport_file.hpp"
#include "support/says.hpp"
#include "support/seed.hpp"

#include <vector>

namespace wholehand::test {
namespace {

using std::chrono::days;

template <class Value>
std::string refusal(const Expected<Value>& passport) {
  return passport.ok() ? "" : format(passport.errors());
}

TEST(Sha256, OfThePublishedExample_IsThePublishedDigest) {
  // FIPS 180-4, example of one block: "abc".
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Passport, WrittenAndRead_SaysTheSame) {
  PassportFolder f;
  f.passport.axes[1].mark = 0.0125;
  f.keep();
  const Passport read = orThrow(readPassport(f.path));
  EXPECT_EQ(read.identity.serial, "S-1");
  EXPECT_EQ(read.identity.firmware, "1.0");
  EXPECT_EQ(read.identity.sdk, "7");
  EXPECT_EQ(read.operator_name, f.passport.operator_name);
  EXPECT_EQ(read.measured_on, f.day);
  EXPECT_EQ(read.axes[1].mark, 0.0125);
  ASSERT_EQ(read.axes.size(), f.passport.axes.size());
  for (std::size_t i = 0; i < read.axes.size(); ++i) {
    EXPECT_EQ(read.axes[i].mass.lower, f.passport.axes[i].mass.lower);
    EXPECT_EQ(read.axes[i].delay_s.upper, f.passport.axes[i].delay_s.upper);
    EXPECT_EQ(read.axes[i].resolution, f.passport.axes[i].resolution);
  }
}

TEST(Passport, ThatLacksAnyOfItsEnd_IsRefused) {
  PassportFolder f;
  const std::string whole = passportText(f.passport);
  for (std::size_t length = 0; length < whole.size(); length += 7) {
    writeFile(f.path, whole.substr(0, length));
    const std::string said = refusal(readPassport(f.path));
    EXPECT_TRUE(says(said, "truncated")) << length << ": " << said;
    EXPECT_TRUE(says(said, "device commission")) << "no remedy: " << said;
  }
}

TEST(Passport, WithAnyByteChanged_IsRefused) {
  PassportFolder f;
  const std::string whole = passportText(f.passport);
  auto random = seededRandom(411);
  for (int i = 0; i < damagedCases(200); ++i) {
    std::string changed = whole;
    changed[random() % changed.size()] ^= static_cast<char>(1U << random() % 7);
    if (changed == whole) continue;
    writeFile(f.path, changed);
    EXPECT_FALSE(readPassport(f.path).ok()) << changed;
  }
}

TEST(Passport, SealedButImpossible_IsRefusedByKey) {
  PassportFolder f;
  f.passport.axes[0].mass = {-1.0, 1.0};
  writeFile(f.path, passportText(f.passport));
  EXPECT_TRUE(says(refusal(readPassport(f.path)), "mass_kg"));
}

// What clearToArm() says after one thing was changed.
template <class Change>
std::string armingAfter(Change change) {
  PassportFolder f;
  f.keep();
  change(f);
  return refusal(clearToArm(f.identity, orThrow(loadDeviceFile(f.device_file)), f.rate_hz, f.day));
}

TEST(Arming, WithPassportAndTodaysCheck_IsCleared) {
  EXPECT_EQ(armingAfter([](PassportFolder&) {}), "");
  EXPECT_EQ(armingAfter([](PassportFolder& f) {  // on its last day, checked again
              const std::string digest = orThrow(readPassport(f.path)).sha256;
              f.day += days(30);
              writeFile(f.check_path, dailyCheckText({digest, "A", f.day}));
            }),
            "");
}

TEST(Arming, WithAnythingMissingOrForeign_IsRefusedByName) {
  struct Case {
    const char* what;
    void (*change)(PassportFolder&);
    const char* says;
  };
  const Case all[] = {
      {"no serial", [](PassportFolder& f) { f.identity.serial = ""; }, "says no serial number"},
      {"no passport", [](PassportFolder& f) { std::filesystem::remove(f.path); }, "no passport"},
      {"another device", [](PassportFolder& f) { f.identity.serial = "S-2"; },
       "S-2 has no passport"},
      {"another's, renamed",
       [](PassportFolder& f) {
         f.identity.serial = "S-2";
         std::filesystem::rename(f.path, passportPath(f.device_file, "S-2"));
       },
       "serial = S-1: the passport is foreign: this device says S-2"},
      {"new firmware", [](PassportFolder& f) { f.identity.firmware = "2.0"; }, "firmware = 1.0"},
      {"another driver or setting", [](PassportFolder& f) { f.identity.driver_sha256 = "5ba2"; },
       "the driver, its settings or a file that they name is another one"},
      {"another rate", [](PassportFolder& f) { f.rate_hz = 4000.0; }, "rate_hz = 1000"},
      {"new SDK", [](PassportFolder& f) { f.identity.sdk = "8"; }, "sdk = 7"},
      {"device file changed",
       [](PassportFolder& f) {
         writeFile(f.device_file, orThrow(readWhole(f.device_file)) + "# mine\n");
       },
       "was changed since"},
      {"passport changed",
       [](PassportFolder& f) { writeFile(f.path, orThrow(readWhole(f.path)) + "# mine\n"); },
       "changed after it was written"},
      {"expired", [](PassportFolder& f) { f.day += days(31); }, "has expired"},
      {"from the future", [](PassportFolder& f) { f.day -= days(1); }, "in the future"},
      {"no check", [](PassportFolder& f) { std::filesystem::remove(f.check_path); },
       "not checked today"},
      {"yesterday's check", [](PassportFolder& f) { f.day += days(1); }, "not checked today"},
      {"check changed",
       [](PassportFolder& f) { writeFile(f.check_path, orThrow(readWhole(f.check_path)) + "\n"); },
       "changed after it was written"},
      {"check with another passport",
       [](PassportFolder& f) {
         f.passport.operator_name = "C";
         writeFile(f.path, passportText(f.passport));
       },
       "another passport"}};
  for (const Case& c : all) {
    const std::string said = armingAfter(c.change);
    EXPECT_TRUE(says(said, c.says)) << c.what << ": " << said;
    EXPECT_TRUE(says(said, ";")) << c.what << " has no remedy: " << said;
  }
}

TEST(WorstCorners, OfAPassport_AreTheWorseOfFileAndMeasurement) {
  PassportFolder f;
  f.passport.axes[0].damping = {2.0, 2.5};  // the file states 3
  f.passport.axes[1].damping = {3.5, 4.0};  // better than the file
  f.passport.axes[2].delay_s = {1e-3, 1.3e-3};
  f.passport.axes[2].resolution = 1e-3;
  const auto corners = worstCorners(f.model, f.passport, 1e-3);
  ASSERT_EQ(corners.size(), 2U);
  EXPECT_EQ(corners[0].axes[0].mass, f.passport.axes[0].mass.lower);
  EXPECT_EQ(corners[1].axes[0].mass, f.passport.axes[0].mass.upper);
  for (const DeviceModel& corner : corners) {
    EXPECT_EQ(corner.axes[0].damping, 2.0);
    EXPECT_EQ(corner.axes[1].damping, f.model.axes[1].damping);
    EXPECT_EQ(corner.axes[0].coulomb, f.passport.axes[0].coulomb.lower);
    EXPECT_EQ(corner.axes[2].encoder_step, 1e-3);
    EXPECT_EQ(corner.output_delay_ticks, 2) << "1.3 periods are two";
  }
  f.passport.axes[2].delay_s = {0.9e-3, 1.1e-3};
  EXPECT_EQ(worstCorners(f.model, f.passport, 1e-3)[0].output_delay_ticks, 1)
      << "a tenth of a period is within what was measured";
}

// The chart of a passport: what is drawn is what was measured.

// The bars, axis by axis: mass, damping, dry friction, delay; null where there is none.
std::vector<nlohmann::json> bars(const ChartPage& page) {
  std::vector<nlohmann::json> out;
  for (const ChartTable& table : page.tables) {
    for (const auto& row : table.rows) {
      out.push_back(row[1].is_object() ? row[1]["interval"] : nlohmann::json());
    }
  }
  return out;
}

TEST(PassportChart, OfIntervals_SpansThemAsSharesOfTheFile) {
  PassportFolder f;
  for (std::size_t i = 0; i < f.model.axes.size(); ++i) {
    const DeviceAxis& axis = f.model.axes[i];
    f.passport.axes[i].mass = {0.5 * axis.mass, 1.0 * axis.mass};
    f.passport.axes[i].damping = {1.0 * axis.damping, 1.5 * axis.damping};
    f.passport.axes[i].coulomb = {0.0, 5.0 * axis.coulomb};
  }
  const auto drawn = bars(passportChart(f.passport, f.model));
  ASSERT_EQ(drawn.size(), 4 * f.model.axes.size());
  for (std::size_t i = 0; i < f.model.axes.size(); ++i) {
    EXPECT_EQ(drawn[4 * i], nlohmann::json({0.5, 1.0}));
    EXPECT_EQ(drawn[4 * i + 1], nlohmann::json({1.0, 1.5}));
    EXPECT_EQ(drawn[4 * i + 2], nlohmann::json({0.0, 5.0}));
  }
}

TEST(PassportChart, OfAFileThatStatesZero_HasNoBarButTheWords) {
  PassportFolder f;
  f.model.axes[0].coulomb = 0.0;
  f.passport.axes[0].coulomb = {0.0125, 0.25};
  const ChartPage page = passportChart(f.passport, f.model);
  EXPECT_EQ(bars(page)[2], nullptr);
  const auto& row = page.tables[0].rows[2];
  EXPECT_EQ(row[2]["with"], nlohmann::json({{"low", "0.0125"}, {"high", "0.25"}, {"unit", "N"}}));
  EXPECT_EQ(row[3], "0");
}

}  // namespace
}  // namespace wholehand::test
