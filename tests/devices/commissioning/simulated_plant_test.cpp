// Commissioning as training: a person without knowledge follows the instructions at a simulated
// plant.
#include "devices/commissioning/simulated/simulated_plant.hpp"

#include "devices/commissioning/commissioning.hpp"
#include "files/device/device_file.hpp"
#include "passport_file.hpp"
#include "support/contains.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <regex>

namespace wholehand::test {
namespace {

/// An operator who types the numbers of the last message and holds the key.
class Newcomer final : public Operator {
 public:
  void reportLine(const std::string& line, const std::vector<FoundFigure>&) override {
    said += line + "\n";
    std::smatch number;
    if (std::regex_search(line, number, std::regex(R"((?:reads|with) ([0-9.e+-]+) )"))) {
      last_number_ = number[1];
    }
  }
  void reportStep(const StepNews& news) override {
    if (!news.why.empty()) said += format(news.why);
  }
  void reportMotion(const Motion&, MotionState) override {}
  [[nodiscard]] std::optional<std::string> ask(const Question& question,
                                               const std::function<void()>& meanwhile) override {
    meanwhile();
    switch (question.about) {
      case QuestionKind::kThisDevice:
      case QuestionKind::kNobodyAttached:
        return "yes";
      case QuestionKind::kTravel:
      case QuestionKind::kKnownForce:
        return last_number_;
      default:
        return "";
    }
  }
  [[nodiscard]] bool holdsKey() override { return true; }
  [[nodiscard]] bool gaveUp() override { return false; }

  std::string said;

 private:
  std::string last_number_;
};

/// A device file, its simulated plant, and the newcomer.
struct Lesson {
  explicit Lesson(const std::string& file)
      : path(folder.file("mine.toml")), model(load(file, path)), plant(model, 1e-3) {
    CommissioningPlan plan;
    plan.operator_name = "Test";
    plan.now = [] {
      return PlaceTime{std::chrono::sys_days(std::chrono::year(2026) / 11 / 28), {}};
    };
    plan.write = [](const std::string& to, const std::string& text) -> Expected<Done> {
      writeFile(to, text);
      return Done{};
    };
    plan.draw = [](const ChartPage&, const std::string&) -> Expected<Done> { return Done{}; };
    bench.emplace(orThrow(Bench::make(plant, model, hands, plant, 1e-3)));
    commissioning.emplace(*bench, plan);
  }
  static DeviceModel load(const std::string& file, const std::string& to) {
    std::filesystem::copy_file(WHOLEHAND_SOURCE_DIR "/config/devices/" + file + ".toml", to);
    return orThrow(loadDeviceFile(to));
  }

  Folder folder;
  std::string path;
  DeviceModel model;
  SimulatedPlant plant;
  Newcomer person;
  SimulatedHands hands{person, plant, model};
  std::optional<Bench> bench;
  std::optional<Commissioning> commissioning;
};

TEST(SimulatedPlant, EachShippedDevice_CanBeCommissionedByTheInstructionsAlone) {
  for (const std::string& file :
       sampleTenth<std::string>({"desktop-3axis", "lambda-pride", "wrist-9axis"})) {
    Lesson lesson(file);
    ASSERT_TRUE(leadCommissioning(*lesson.commissioning, lesson.hands)) << lesson.person.said;
    EXPECT_TRUE(contains(lesson.person.said, "no device is armed with it")) << file;
    EXPECT_LE(lesson.bench->largestShare(), 1.0 + 1e-12) << file;
    const Passport passport = orThrow(readPassport(lesson.commissioning->path()));
    for (std::size_t i = 0; i < lesson.model.axes.size(); ++i) {
      const DeviceAxis& truth = lesson.model.axes[i];  // the plant has the figures of its file
      EXPECT_TRUE(passport.axes[i].mass.contains(truth.mass)) << file << truth.name;
      EXPECT_TRUE(passport.axes[i].damping.contains(truth.damping)) << file << truth.name;
      EXPECT_TRUE(passport.axes[i].coulomb.contains(truth.coulomb)) << file << truth.name;
    }
  }
}

// A passport from training, with a check of the day, beside a device that claims the same identity.
TEST(SimulatedPlant, PassportOfASimulatedPlant_NeverArmsADevice) {
  Lesson lesson("desktop-3axis");
  ASSERT_TRUE(leadCommissioning(*lesson.commissioning, lesson.hands)) << lesson.person.said;
  ASSERT_TRUE(lesson.commissioning->checkToday().ok()) << "the daily check can be learned, too";
  const Passport passport = orThrow(readPassport(lesson.commissioning->path()));
  EXPECT_TRUE(passport.identity.simulated);
  EXPECT_TRUE(
      checkPassport(passport, lesson.plant.identity(), lesson.model, passport.measured_at).ok());

  DriverIdentity device = lesson.plant.identity();
  device.simulated = false;  // a real device of the same serial number, firmware and SDK
  const auto armed =
      checkArmingPermit(device, lesson.model, passport.rate_hz, passport.measured_at);
  EXPECT_TRUE(refusedWith(armed, "learned on a simulated plant"));
  const auto plant = checkArmingPermit(lesson.plant.identity(), lesson.model, passport.rate_hz,
                                       passport.measured_at);
  EXPECT_TRUE(refusedWith(plant, "simulated plant: it arms nothing"));

  // Removing the mark changes the text, which the seal detects.
  std::string text = passportText(passport);
  const std::string mark = "simulated = true";
  writeFile(passport.path, text.replace(text.find(mark), mark.size(), ""));
  const auto edited =
      checkArmingPermit(device, lesson.model, passport.rate_hz, passport.measured_at);
  EXPECT_TRUE(refusedWith(edited, "changed after it was written"));
}

}  // namespace
}  // namespace wholehand::test
