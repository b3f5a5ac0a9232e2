#include "station/profiles.hpp"

#include "station/session_files.hpp"
#include "station_bench.hpp"

#include <fstream>
#include <iterator>
#include <sys/stat.h>

namespace wholehand::test {
namespace {

Profile somebody() {
  return {"p-014",        "lambda-pride",
          "right",        "woman-p50-right",
          "cocktail-bar", 2,
          Help::kSome,    {{"effort_limit_hand_tip_n", 0.1 + 0.2}, {"lead_in_m", 0.004}}};
}

TEST(ProfileFile, SavedAndLoaded_IsBitIdentical) {
  const Folder folder;
  const Profiles profiles(folder.path() + "/profiles");
  EXPECT_TRUE(profiles.list().empty());
  ASSERT_TRUE(profiles.save(somebody()).ok());
  EXPECT_EQ(profiles.list(), std::vector<std::string>{"p-014"});
  const auto loaded = profiles.load("p-014");
  ASSERT_TRUE(loaded.ok()) << format(loaded.errors());
  EXPECT_EQ(loaded->hand, "woman-p50-right");
  EXPECT_EQ(loaded->level, 2);
  EXPECT_EQ(loaded->help, Help::kSome);
  EXPECT_EQ(loaded->parameters, somebody().parameters);
}

TEST(ProfileFile, EveryHelpLevel_IsReadBackAndTheKeyIsOmittedIfUnset) {
  const Folder folder;
  const Profiles profiles(folder.path());
  for (const Help help : {Help::kUnspecified, Help::kFull, Help::kSome, Help::kNone}) {
    Profile profile = somebody();
    profile.help = help;
    ASSERT_TRUE(profiles.save(profile).ok());
    EXPECT_EQ(profiles.load("p-014")->help, help);
    std::ifstream in(folder.path() + "/p-014.toml");
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    EXPECT_EQ(text.find("help") != std::string::npos, help != Help::kUnspecified) << text;
  }
}

/// Profile file in the format of version 0.3.
TEST(ProfileFile, FileOfVersion03_StillLoads) {
  const Folder folder;
  std::ofstream(folder.path() + "/old.toml")
      << "kind = \"profile\"\nversion = 1\nname = \"old\"\ndevice = \"lambda-pride\"\n"
         "side = \"right\"\nhand = \"man-p50-right\"\nexercise = \"cocktail-bar\"\nlevel = 3\n\n"
         "[parameters]\nlead_in_m = 0.004\n";
  const auto loaded = Profiles(folder.path()).load("old");
  ASSERT_TRUE(loaded.ok()) << format(loaded.errors());
  EXPECT_EQ(loaded->help, Help::kUnspecified);
  EXPECT_EQ(loaded->parameters.size(), 1U);
}

TEST(ProfileFile, CodeOfSixtyLetters_IsSavedLoadedAndNamesARecording) {
  const Folder folder;
  const Profiles profiles(folder.path() + "/profiles");
  Profile profile = somebody();
  profile.name = std::string(60, 'w');
  ASSERT_TRUE(profiles.save(profile).ok());
  EXPECT_EQ(profiles.list(), std::vector<std::string>{profile.name});
  EXPECT_EQ(profiles.load(profile.name)->hand, profile.hand);
  const SessionFiles files(folder.path() + "/recordings");
  const auto path = files.nameNew(profile.name, "cocktail-bar", 1000);
  ASSERT_TRUE(path.ok()) << format(path.errors());
  EXPECT_NE(path->find(profile.name), std::string::npos) << "the whole code";
  profile.name += 'w';
  EXPECT_FALSE(profiles.save(profile).ok());
  EXPECT_EQ(profiles.list().size(), 1U);
}

// A pipe is not read, because reading would block every order; a link is not written through.
TEST(ProfileFile, LinkOrPipeInPlaceOfTheFile_IsReportedAndUntouched) {
  const Folder folder;
  const Profiles profiles(folder.path());
  const std::string path = folder.path() + "/p-014.toml";
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  EXPECT_TRUE(profiles.list().empty());
  const auto piped = profiles.load("p-014");
  ASSERT_FALSE(piped.ok());
  EXPECT_NE(format(piped.errors()).find(path + ": is no regular file"), std::string::npos)
      << format(piped.errors());
  EXPECT_FALSE(profiles.save(somebody()).ok());
  std::filesystem::remove(path);
  std::ofstream(folder.path() + "/precious") << "mine";
  std::filesystem::create_symlink(folder.path() + "/precious", path);
  const auto saved = profiles.save(somebody());
  ASSERT_FALSE(saved.ok());
  EXPECT_NE(format(saved.errors()).find(path), std::string::npos) << format(saved.errors());
  std::ifstream in(folder.path() + "/precious");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "mine");
}

TEST(ProfileFile, InvalidName_IsRefusedAndWritesNothing) {
  const Folder folder;
  const Profiles profiles(folder.path() + "/profiles");
  for (const char* name : {"", "../p", "a b", "a/b", ".", "ä"}) {
    Profile profile = somebody();
    profile.name = name;
    EXPECT_FALSE(profiles.save(profile).ok()) << name;
    EXPECT_FALSE(profiles.load(name).ok()) << name;
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path() + "/profiles"));
}

TEST(ProfileFile, EveryFault_IsReportedByKey) {
  const Folder folder;
  const Profiles profiles(folder.path());
  std::ofstream(folder.path() + "/p.toml")
      << "kind = \"profile\"\nversion = 1\nname = \"q\"\ndevice = \"d\"\nside = \"middle\"\n"
         "hand = \"h\"\nhelp = \"much\"\nlevel = 0\n[parameters]\na = \"x\"\n";
  const auto loaded = profiles.load("p");
  ASSERT_FALSE(loaded.ok());
  const std::string reported = format(loaded.errors());
  for (const char* key : {"name", "side", "exercise", "help", "level", "parameters.a"}) {
    EXPECT_NE(reported.find(key), std::string::npos) << key << " in " << reported;
  }
}

class StationProfiles : public Bar {
 protected:
  void begin() {
    StationConfig config = barConfig();
    config.profiles_folder = folder_ + "/profiles";
    load(config);
    run(false);
  }
  OrderReply set(const std::string& name, double value) {
    return ask(orders::SetParameter{name, value});
  }
  double parameter(const std::string& name) {
    const auto scene = station_->scene();
    for (std::size_t i = 0; i < scene->parameters.size(); ++i) {
      if (scene->parameters[i].name == name) return station_->status().parameters[i];
    }
    return std::nan("");
  }
};

TEST_F(StationProfiles, ProfileSavedBeforeARestart_AppliesFromTheFirstTickAfterIt) {
  begin();
  ASSERT_TRUE(set("lead_in_m", 0.004).accepted);
  ASSERT_TRUE(ask(orders::SaveProfile{"p-014"}).accepted);
  EXPECT_EQ(station_->scene()->profile, "p-014");
  quit();
  station_.reset();

  begin();
  EXPECT_EQ(station_->scene()->profile, "");
  EXPECT_EQ(parameter("lead_in_m"), 0.0);
  const OrderReply loaded = ask(orders::LoadProfile{"p-014"});
  ASSERT_TRUE(loaded.accepted) << loaded.reason;
  EXPECT_EQ(station_->scene()->profile, "p-014");
  EXPECT_EQ(parameter("lead_in_m"), 0.004);
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  TickRecord record;
  ASSERT_TRUE(becomes([&] { return station_->latest(record); }));
  EXPECT_EQ(parameter("lead_in_m"), 0.004);  // it does not ramp from another value
  EXPECT_EQ(ask(orders::LoadProfile{"p-014"}).refusal, Refusal::kArmedAlready);
}

/// Every key of a patient's profile, each with a value that differs from the initial one.
const std::vector<std::pair<const char*, double>> kOfOnePatient = {
    {"line_tolerance_l", 0.008},      {"wall_fade_s", 2.5},
    {"reach_left_m", 0.05},           {"reach_right_m", 0.07},
    {"reach_forward_m", 0.065},       {"fingers_open_rad", 0.3},
    {"fingers_close_rad", 2.6},       {"squeeze_threshold_ratio", 0.5},
    {"effort_limit_hand_tip_n", 5.0}, {"effort_limit_arm_n", 8.0}};

TEST_F(StationProfiles, EveryKeyOfAPatient_AppliesAfterARestart) {
  begin();
  for (const auto& [name, value] : kOfOnePatient) {
    EXPECT_NE(parameter(name), value) << name;
    const OrderReply reply = set(name, value);
    EXPECT_TRUE(reply.accepted) << reply.reason;
  }
  ASSERT_TRUE(ask(orders::SetHelp{Help::kNone}).accepted);
  EXPECT_EQ(station_->status().help, Help::kNone);
  ASSERT_TRUE(ask(orders::SaveProfile{"p-020"}).accepted);
  quit();
  station_.reset();

  begin();
  EXPECT_EQ(station_->status().help, Help::kUnspecified);
  const OrderReply loaded = ask(orders::LoadProfile{"p-020"});
  ASSERT_TRUE(loaded.accepted) << loaded.reason;
  EXPECT_EQ(station_->status().help, Help::kNone);
  for (const auto& [name, value] : kOfOnePatient) EXPECT_EQ(parameter(name), value) << name;
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  TickRecord record;
  ASSERT_TRUE(becomes([&] { return station_->latest(record); }));
  for (const auto& [name, value] : kOfOnePatient) EXPECT_EQ(parameter(name), value) << name;
}

TEST_F(StationProfiles, EveryKeyOutOfItsRange_IsRefusedByProfileKeyAndRange) {
  begin();
  ASSERT_TRUE(ask(orders::SaveProfile{"mine"}).accepted);
  std::ifstream in(folder_ + "/profiles/mine.toml");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  for (const auto& [name, value] : kOfOnePatient) {
    EXPECT_EQ(set(name, 1e3).refusal, Refusal::kOutOfRange) << name;
    const std::string key = "\n" + std::string(name) + " = ";
    const std::size_t at = text.find(key);
    ASSERT_NE(at, std::string::npos) << name;
    std::string other = text;
    other.replace(at + key.size(), text.find('\n', at + 1) - at - key.size(), "1000.0");
    other.replace(other.find("\"mine\""), 6, "\"bad\"");
    std::ofstream(folder_ + "/profiles/bad.toml") << other;
    const OrderReply reply = ask(orders::LoadProfile{"bad"});
    EXPECT_EQ(reply.refusal, Refusal::kOutOfRange) << reply.reason;
    for (const std::string& part : {std::string("bad"), std::string(name), std::string("1000")}) {
      EXPECT_NE(reply.reason.find(part), std::string::npos) << reply.reason;
    }
  }
  EXPECT_EQ(station_->scene()->profile, "mine");
}

/// The console groups parameters by these names: reach belongs to the person's limits, fingers to
/// the hand.
TEST_F(StationProfiles, ParametersOfThePerson_AreGroupedUnderPersonAndHand) {
  begin();
  int patient = 0, hand = 0;
  for (const PublishedParameter& p : station_->scene()->parameters) {
    if (p.name.starts_with("reach_")) patient += p.group == ParameterGroup::kPatient ? 1 : 0;
    if (p.name.starts_with("fingers_")) hand += p.group == ParameterGroup::kHand ? 1 : 0;
  }
  EXPECT_EQ(patient, 3);
  EXPECT_EQ(hand, 2);
}

TEST_F(StationProfiles, ProfileOfAnotherDeviceOrHand_IsRefusedByNameAndChangesNothing) {
  begin();
  ASSERT_TRUE(ask(orders::SaveProfile{"mine"}).accepted);
  const std::string path = folder_ + "/profiles/mine.toml";
  std::ifstream in(path);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const auto altered = [&](const std::string& from, const std::string& to,
                           const std::string& name) {
    std::string other = text;
    other.replace(other.find(from), from.size(), to);
    other.replace(other.find("\"mine\""), 6, "\"" + name + "\"");
    std::ofstream(folder_ + "/profiles/" + name + ".toml") << other;
    return ask(orders::LoadProfile{name});
  };
  const std::string device = station_->scene()->device.name;
  OrderReply reply = altered("device = \"" + device + "\"", "device = \"desktop\"", "elsewhere");
  EXPECT_EQ(reply.refusal, Refusal::kOtherProfile);
  EXPECT_NE(reply.reason.find("elsewhere"), std::string::npos) << reply.reason;
  EXPECT_NE(reply.reason.find("desktop"), std::string::npos) << reply.reason;
  reply = altered("side = \"right\"", "side = \"left\"", "lefty");
  EXPECT_EQ(reply.refusal, Refusal::kOtherProfile);
  EXPECT_NE(reply.reason.find("left"), std::string::npos) << reply.reason;
  reply = altered("lead_in_m = 0", "lead_in_m = 9", "far");
  EXPECT_EQ(reply.refusal, Refusal::kOutOfRange);
  EXPECT_EQ(ask(orders::LoadProfile{"nobody"}).refusal, Refusal::kUnknownProfile);
  EXPECT_EQ(station_->scene()->profile, "mine");
}

}  // namespace
}  // namespace wholehand::test
