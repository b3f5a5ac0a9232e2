// A hand at the bar, steered by a person on the simulated clock, for tests of the pages' aim. For
// each frame of a page it reads a line (aims of all axes, and "restart"), plays `kTicks` ticks, and
// prints the state that a page would see as a line of JSON. The first line describes the scene.
//   steered_hand EXERCISE LEVEL [HAND]
#include "loop/dynamics/articulated_body.hpp"
#include "loop/patient/steered_player.hpp"
#include "support/player_commands.hpp"
#include "support/rig_tools.hpp"

#include <nlohmann/json.hpp>

#include <iostream>
#include <sstream>

namespace wholehand::test {
namespace {

using nlohmann::json;

/// Ticks from one frame to the next: 16 ms, as at a page's 60 Hz.
constexpr int kTicks = 16;
constexpr std::size_t kNone = static_cast<std::size_t>(-1);

json vec(const Vec3& v) {
  return {v.x, v.y, v.z};
}

std::size_t palmLink(const HandModel& hand) {
  for (const auto& capsule : hand.capsules) {
    if (capsule.part == HandPart::kPalm) return static_cast<std::size_t>(capsule.link);
  }
  return kNone;
}

json describe(const Models& models, std::size_t palm_link) {
  json out = {{"right_hand", models.hand.side == Side::kRight}, {"palm_link", palm_link}};
  for (const auto& axis : models.device.axes) {
    out["axes"].push_back({{"name", axis.name}, {"lower", axis.lower}, {"upper", axis.upper}});
  }
  for (const auto& body : models.scene.bodies) out["bodies"].push_back(body.name);
  out["values"] = models.exercise->description().value_names;
  out["exercise"] = models.exercise->description().json;
  return out;
}

json seen(const TickRecord& r, const Vec3& palm_m) {
  json out = {{"q_m", std::vector<double>(r.q_m.begin(), r.q_m.end())},
              {"q_s", std::vector<double>(r.q_s.begin(), r.q_s.end())},
              {"palm", vec(palm_m)},
              {"contacts", json::array()}};
  for (int i = 0; i < r.body_count; ++i) {
    out["bodies"].push_back(vec(r.bodies[i].position_m));
    const auto& q = r.bodies[i].orientation_xyzw;
    out["turns_xyzw"].push_back({q.x, q.y, q.z, q.w});
  }
  for (int i = 0; i < r.contact_count; ++i) {
    const Contact& c = r.contacts[i];
    out["contacts"].push_back({c.body, c.capsule, vec(c.force_n)});
  }
  const auto& e = r.exercise;
  out["values"] =
      std::vector<double>(e.values.begin(), e.values.begin() + static_cast<int>(e.value_count));
  return out;
}

class SteeredHand {
 public:
  explicit SteeredHand(Models models) {
    palm_link_ = palmLink(models.hand);
    std::cout << describe(models, palm_link_).dump() << std::endl;
    auto steered = std::make_unique<SteeredPlayer>(models.exercise->makePlayer({1}), models.device);
    player_ = steered.get();
    rig_ = orThrow(buildRig(std::move(models), std::move(steered), {}));
    orThrow(rig_->renderer->arm());
    body_ = std::make_unique<ArticulatedBody>(rig_->models.hand);
    player_->command(steer(Steering::kPerson));
    play(false);
  }

  /// @return false if the line is invalid
  bool apply(const std::string& line) {
    std::istringstream words(line);
    std::string word;
    Command aim;
    aim.type = CommandType::kAim;
    aim.aim = AxisPosition(rig_->models.device.axisCount());
    bool restart = false;
    for (int i = 0; words >> word;) {
      if (word == "restart") {
        restart = true;
      } else if (i < aim.aim.size()) {
        aim.aim[i++] = std::stod(word);
      } else {
        return false;
      }
    }
    player_->command(aim);
    play(restart);
    return true;
  }

 private:
  void play(bool restart) {
    for (int k = 0; k < kTicks; ++k) {
      record_.command_count = restart && k == 0 ? 1 : 0;
      record_.commands[0].type = CommandType::kAction;
      record_.commands[0].index = static_cast<std::int32_t>(Act::kRestart);
      rig_->renderer->tick(1, record_);
      player_->onRecord(record_);
    }
    body_->updateKinematics(record_.theta);
    const auto palm = body_->linkPose(static_cast<int>(palm_link_)).translation_m;
    json out = seen(record_, Vec3::from(palm));
    out["faults"] = static_cast<std::uint32_t>(rig_->renderer->latched());
    std::cout << out.dump() << std::endl;
  }

  std::size_t palm_link_ = kNone;
  SteeredPlayer* player_ = nullptr;
  std::unique_ptr<Rig> rig_;
  std::unique_ptr<ArticulatedBody> body_;
  TickRecord record_;
};

int play(int argc, char** argv) {
  const std::string config = std::string(WHOLEHAND_SOURCE_DIR) + "/config/";
  const std::string hand = argc > 3 ? argv[3] : "adult-median-right";
  ModelFiles files = shippedFiles("lambda-pride", "empty", hand);
  files.scene.clear();
  files.exercise = config + "exercises/" + argv[1] + ".toml";
  files.level = std::stoi(argv[2]);
  SteeredHand steered(load(files));
  for (std::string line; std::getline(std::cin, line);) {
    if (!steered.apply(line)) return 2;
  }
  return 0;
}

}  // namespace
}  // namespace wholehand::test

int main(int argc, char** argv) {
  if (argc < 3) {
    std::cerr << "steered_hand EXERCISE LEVEL [HAND]\n";
    return 2;
  }
  try {
    return wholehand::test::play(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
