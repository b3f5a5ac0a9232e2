// The passport's file: it is read back as written, and every defect is refused by name.
#include "devices/passport/passport.hpp"

#include "files/device/device_file.hpp"
#include "files/page/chart_page.hpp"
#include "files/toml/toml_file.hpp"
#include "passport_file.hpp"
#include "support/contains.hpp"
#include "support/seed.hpp"

#include <cstdlib>
#include <ctime>
#include <vector>

namespace wholehand::test {
namespace {

using std::chrono::days;

template <class Value>
std::string refusal(const Expected<Value>& passport) {
  return passport.ok() ? "" : format(passport.errors());
}

TEST(Sha256, PublishedExample_GivesThePublishedDigest) {
  // The one-block example of FIPS 180-4: "abc".
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Passport, WrittenPassport_IsReadBackUnchanged) {
  PassportFolder f;
  f.passport.axes[1].mark = 0.0125;
  f.passport.axes[2].transport_s = 0.00025;
  f.passport.axes[2].drive_lag_s = {0.5e-3, 2e-3};
  f.keep();
  const Passport read = orThrow(readPassport(f.path));
  EXPECT_EQ(read.identity.serial, "S-1");
  EXPECT_EQ(read.identity.firmware, "1.0");
  EXPECT_EQ(read.identity.sdk, "7");
  EXPECT_EQ(read.operator_name, f.passport.operator_name);
  EXPECT_EQ(read.measured_at.at, f.now.at);
  EXPECT_EQ(read.measured_at.ahead, f.now.ahead);
  EXPECT_EQ(read.axes[1].mark, 0.0125);
  EXPECT_EQ(read.axes[2].transport_s, 0.00025);
  EXPECT_FALSE(read.axes[1].transport_s) << "a passport that does not say it";
  ASSERT_EQ(read.axes.size(), f.passport.axes.size());
  for (std::size_t i = 0; i < read.axes.size(); ++i) {
    EXPECT_EQ(read.axes[i].mass.lower, f.passport.axes[i].mass.lower);
    EXPECT_EQ(read.axes[i].delay_s.upper, f.passport.axes[i].delay_s.upper);
    EXPECT_EQ(read.axes[i].resolution, f.passport.axes[i].resolution);
    EXPECT_EQ(read.axes[i].drive_lag_s.upper, f.passport.axes[i].drive_lag_s.upper);
  }
}

TEST(Passport, TruncatedPassport_IsRefused) {
  PassportFolder f;
  const std::string whole = passportText(f.passport);
  for (std::size_t length = 0; length < whole.size(); length += 7) {
    writeFile(f.path, whole.substr(0, length));
    const std::string said = refusal(readPassport(f.path));
    EXPECT_TRUE(contains(said, "truncated")) << length << ": " << said;
    EXPECT_TRUE(contains(said, "device commission")) << "no remedy: " << said;
  }
}

TEST(Passport, PassportWithAnyByteChanged_IsRefused) {
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

TEST(Passport, SealedPassportWithImpossibleValues_IsRefusedByKey) {
  PassportFolder f;
  f.passport.axes[0].mass = {-1.0, 1.0};
  writeFile(f.path, passportText(f.passport));
  EXPECT_TRUE(contains(refusal(readPassport(f.path)), "mass_kg"));
  PassportFolder g;
  g.passport.axes[0].transport_s = -1e-3;
  writeFile(g.path, passportText(g.passport));
  EXPECT_TRUE(contains(refusal(readPassport(g.path)), "transport_s"));
}

// Answer of checkArmingPermit() after one change.
template <class Change>
std::string armingAfter(Change change) {
  PassportFolder f;
  f.keep();
  change(f);
  return refusal(
      checkArmingPermit(f.identity, orThrow(loadDeviceFile(f.device_file)), f.rate_hz, f.now));
}

TEST(Arming, PassportAndTodaysCheck_PermitArming) {
  EXPECT_EQ(armingAfter([](PassportFolder&) {}), "");
  EXPECT_EQ(armingAfter([](PassportFolder& f) {  // on its last day, with a new check
              const std::string digest = orThrow(readPassport(f.path)).sha256;
              f.now.at += days(30);
              writeFile(f.check_path, dailyCheckText({digest, "A", f.now, ""}));
            }),
            "");
}

TEST(Arming, MissingOrForeignPassportOrCheck_IsRefusedByName) {
  struct Case {
    const char* what;
    void (*change)(PassportFolder&);
    const char* expected;
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
      {"expired", [](PassportFolder& f) { f.now.at += days(31); }, "has expired"},
      {"from the future", [](PassportFolder& f) { f.now.at -= days(1); }, "in the future"},
      {"no check", [](PassportFolder& f) { std::filesystem::remove(f.check_path); },
       "not checked today"},
      {"yesterday's check", [](PassportFolder& f) { f.now.at += days(1); }, "not checked today"},
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
    EXPECT_TRUE(contains(said, c.expected)) << c.what << ": " << said;
    EXPECT_TRUE(contains(said, ";")) << c.what << " has no remedy: " << said;
  }
}

// Refusal at `now` with a check made at `done` and a passport of the day before.
std::string refusalAt(const PlaceTime& done, const PlaceTime& now) {
  PassportFolder f;
  f.passport.measured_at = {done.at - days(1), done.ahead};
  f.now = done;
  f.keep();
  return refusal(checkArmingPermit(f.identity, f.model, f.rate_hz, now));
}

// Draws places from UTC-12 to UTC+14, with changes of daylight saving time; the rule is stated in
// local time.
TEST(DailyCheck, CheckAtRandomPlaces_IsValidOnItsLocalDayForTwelveHours) {
  using std::chrono::minutes;
  auto random = seededRandom(435);
  const auto draw = [&](long low, long high) {
    return std::uniform_int_distribution<long>(low, high)(random);
  };
  int open = 0;
  for (int i = 0; i < cases(400); ++i) {
    const minutes ahead(15 * draw(-48, 56));
    const PlaceTime done{
        std::chrono::sys_days(std::chrono::year(2026) / 11 / 21) + minutes(draw(0, 24 * 60)),
        ahead};
    // In one of four cases the local clock changed by an hour meanwhile.
    const minutes now_ahead = draw(0, 3) == 0 ? ahead + minutes(60) : ahead;
    const PlaceTime now{done.at + minutes(draw(-120, 30 * 60)), now_ahead};
    const long passed_min = std::chrono::duration_cast<minutes>(now.at - done.at).count();
    // The local dates, as a person sees them.
    const auto wall = [](const PlaceTime& t) {
      return std::chrono::floor<days>((t.at + t.ahead).time_since_epoch()).count();
    };
    const char* says_so = "";
    if (passed_min < 0) {
      says_so = "set back";
    } else if (wall(done) != wall(now)) {
      says_so = "not checked today";
    } else if (passed_min > 12 * 60) {
      says_so = "lasts 12 hours";
    }
    const std::string said = refusalAt(done, now);
    const std::string what = format(done) + " at " + format(now) + ": " + said;
    EXPECT_EQ(said.empty(), *says_so == 0) << what;
    EXPECT_TRUE(contains(said, says_so)) << what;
    open += said.empty() ? 1 : 0;
  }
  EXPECT_GT(open, 0);
}

// The rule of docs/commissioning.md: after 50 enablings, before the next visit, never inside one.
TEST(DailyCheck, FiftyEnablings_MakeItDueBeforeTheNextVisitAndNeverInsideOne) {
  using std::chrono::minutes;
  PassportFolder f;
  f.keep();
  const auto write = [](const std::string& to, const std::string& text) -> Expected<Done> {
    writeFile(to, text);
    return Done{};
  };
  const auto refused = [&](long after_min) {
    return refusal(checkArmingPermit(f.identity, f.model, f.rate_hz,
                                     {f.now.at + minutes(after_min), f.now.ahead}));
  };
  // A visit of 60 enablings, one a minute.
  for (long k = 0; k < 60; ++k) {
    EXPECT_EQ(refused(k), "") << k;
    orThrow(countEnabling(f.identity, f.model, {f.now.at + minutes(k), f.now.ahead}, write));
  }
  EXPECT_EQ(refused(59 + 29), "") << "the visit is still open";
  EXPECT_TRUE(contains(refused(59 + 30), "enabled 60 times")) << refused(59 + 30);
  EXPECT_TRUE(contains(refused(59 + 30), "device commission --daily"));
  // Another check begins anew.
  writeFile(f.check_path,
            dailyCheckText({orThrow(readPassport(f.path)).sha256, "Other", f.now, ""}));
  EXPECT_EQ(refused(59 + 30), "");
}

TEST(DailyCheck, DamagedCountOrOneThatCannotBeWritten_IsDue) {
  PassportFolder f;
  f.keep();
  writeFile(enablingsPath(f.device_file, f.identity.serial), "count = 3\n");
  EXPECT_TRUE(contains(refusal(checkArmingPermit(f.identity, f.model, f.rate_hz, f.now)), "due"));
  const auto full = [](const std::string& to, const std::string&) -> Expected<Done> {
    return fileFault(to, "the disk is full", "make room");
  };
  EXPECT_FALSE(countEnabling(f.identity, f.model, f.now, full).ok());
}

TEST(DailyCheck, CheckInLosAngelesAndAuckland_IsValidOnTheLocalDate) {
  using std::chrono::hours;
  using std::chrono::minutes;
  const auto tuesday = std::chrono::sys_days(std::chrono::year(2026) / 11 / 24);
  const minutes west(-8 * 60), east(13 * 60);
  const PlaceTime three_pm{tuesday + hours(15) - west, west};
  EXPECT_EQ(refusalAt(three_pm, {three_pm.at + minutes(65), west}), "") << "UTC's day has changed";
  EXPECT_TRUE(contains(refusalAt(three_pm, {three_pm.at + hours(17), west}), "not checked today"))
      << "eight on Wednesday";
  const PlaceTime four_pm{tuesday + hours(16) - east, east};
  EXPECT_TRUE(contains(refusalAt(four_pm, {four_pm.at + hours(10), east}), "not checked today"))
      << "two on Wednesday, the same day in UTC";
}

TEST(DailyCheck, ClockSetBackOrForward_IsRefusedWithTheClockAsReason) {
  using std::chrono::hours;
  PassportFolder f;
  const PlaceTime now = f.now;
  EXPECT_TRUE(contains(refusalAt(now, {now.at - hours(1), now.ahead}), "clock was set back"));
  EXPECT_TRUE(contains(refusalAt(now, {now.at + days(1), now.ahead}), "not checked today"));
  const PlaceTime tomorrow{now.at + days(1), now.ahead};
  f.passport.measured_at = tomorrow;
  f.keep();
  const std::string said = refusal(checkArmingPermit(f.identity, f.model, f.rate_hz, now));
  EXPECT_TRUE(contains(said, "measured_at"));
  EXPECT_TRUE(contains(said, "clock was set back"));
}

TEST(PlaceTime, TimeOfThisMachine_FollowsItsTimeZone) {
  const Folder folder;
  const std::string path = folder.file("place_time.toml");
  const char* const before = std::getenv("TZ");
  const std::string kept = before != nullptr ? before : "";
  // POSIX gives the offset with the opposite sign: the time to add to local time to get UTC.
  for (const auto& [zone, ahead_min] :
       std::vector<std::pair<const char*, long>>{{"<-12>12", -720},
                                                 {"<-08>8", -480},
                                                 {"UTC0", 0},
                                                 {"<+0545>-5:45", 345},
                                                 {"<+14>-14", 840}}) {
    ::setenv("TZ", zone, 1);
    ::tzset();
    const PlaceTime now = placeTimeNow();
    EXPECT_EQ(now.ahead.count(), ahead_min) << zone;
    writeFile(path, "kind = \"t\"\nversion = 1\nat = \"" + format(now) + "\"\n");
    TomlFile file(path, "t");
    const PlaceTime read = readTime(file.root(), "at");
    EXPECT_EQ(read.at, now.at);
    EXPECT_EQ(read.ahead, now.ahead);
    (void)file.finish();
  }
  if (before != nullptr) {
    ::setenv("TZ", kept.c_str(), 1);
  } else {
    ::unsetenv("TZ");
  }
  ::tzset();
}

TEST(WorstCorners, CornersOfAPassport_AreTheWorseOfFileAndMeasurement) {
  PassportFolder f;
  f.passport.axes[0].damping = {2.0, 2.5};  // the file states 3
  f.passport.axes[1].damping = {3.5, 4.0};  // better than the file states
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

// docs/commissioning.md: the drive's part of the passport and the transport of now.
TEST(DelayAtArming, TransportOfNow_ReplacesThatOfTheMeasurement) {
  struct Case {
    const char* what;
    double passport_s;
    std::optional<double> transport_s;  ///< of the measurement
    Transport now;
    int periods;
    const char* says;
  };
  const Case all[] = {
      {"as measured", 3.45e-3, 0.05e-3, {0.05e-3, 0.0}, 4, "the delay is 3.45 ms now"},
      {"behind a host of 1 kHz",
       3.45e-3,
       0.05e-3,
       {1.05e-3, 1.0e-3},
       6,
       "the delay is 5.45 ms now (drive 3.40 ms, transport 2.05 ms), the passport's 3.45 ms"},
      {"measured behind that host, now without it",
       5.45e-3,
       2.05e-3,
       {0.05e-3, 0.0},
       6,
       "the delay is 3.45 ms now"},
      {"transport of the measurement unknown",
       3.45e-3,
       std::nullopt,
       {0.05e-3, 0.0},
       4,
       "drive, with the unknown transport of its measurement, 3.45 ms"},
      {"unknown, and behind that host",
       3.45e-3,
       std::nullopt,
       {1.05e-3, 1.0e-3},
       6,
       "the delay is 5.50 ms now"},
      {"shorter than the file states", 0.2e-3, 0.1e-3, {0.1e-3, 0.0}, 3, "0.20 ms now"}};
  for (const Case& c : all) {
    PassportFolder f;
    f.model.output_delay_ticks = 3;
    for (PassportAxis& axis : f.passport.axes) {
      axis.delay_s = {0.1e-3, 0.2e-3};
      axis.transport_s = 0.1e-3;
    }
    f.passport.axes[1].delay_s = {c.passport_s - 1e-4, c.passport_s};
    f.passport.axes[1].transport_s = c.transport_s;
    const ArmingDelay delay = delayAtArming(f.model, f.passport, c.now, 1e-3);
    EXPECT_EQ(delay.periods, c.periods) << c.what;
    EXPECT_TRUE(contains(delay.sentence, c.says)) << c.what << ": " << delay.sentence;
  }
}

// The chart of a passport shows the measured values.

// The bars of each axis: mass, damping, dry friction, delay; null if there is none.
std::vector<nlohmann::json> bars(const ChartPage& page) {
  std::vector<nlohmann::json> out;
  for (const ChartTable& table : page.tables) {
    for (const auto& row : table.rows) {
      out.push_back(row[1].is_object() ? row[1]["interval"] : nlohmann::json());
    }
  }
  return out;
}

TEST(PassportChart, Intervals_AreDrawnAsSharesOfTheFilesValues) {
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

TEST(PassportChart, ValueStatedAsZero_HasTextInsteadOfABar) {
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
