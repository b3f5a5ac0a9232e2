#include "apps/tools/experiment/experiment_command.hpp"
#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/result_files.hpp"
#include "experiments/touch_trial.hpp"
#include "files/scene/scene_file.hpp"
#include "files/text/text_file.hpp"
#include "loop/core/printable.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <string>

namespace wholehand {
namespace {

std::string placeOf(const TouchedJoint& joint, double value) {
  return joint.hinge ? fmt::format("{:.3f} rad", value) : fmt::format("{:.1f} mm", 1e3 * value);
}

std::string verdict(const TouchedJoint& joint) {
  std::string text = joint.moves() ? "through its range" : "NOT through its range";
  if (joint.follows) return text + ", as it follows";
  if (joint.cannotMove()) {
    return text +
           (joint.dry_friction > 0.0
                ? fmt::format(": its dry friction of {:g} {} holds against the finger's {:.3g}",
                              joint.dry_friction, joint.hinge ? "N·m" : "N", joint.most_effort)
                : ": it is round about its axis and has no friction");
  }
  if (joint.help == TouchHelp::kHeld) text += ", the other joints held";
  if (joint.help == TouchHelp::kCleared) text += ", without the other parts";
  if (!joint.in_the_way.empty() && (!joint.moves() || joint.help == TouchHelp::kCleared)) {
    text += fmt::format(": '{}' is in the finger's way", printable(joint.in_the_way));
  }
  return text;
}

}  // namespace

int touchCommand(const TouchOptions& options) {
  if (auto writable = checkFiles({options.json}, options.files); !writable) {
    return refuse(writable.errors());
  }
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  int joints = 0, moved = 0, held = 0;
  Diagnostics errors;
  for (const std::string& file : options.files) {
    const auto scene = loadSceneFile(file);
    auto touched = scene ? touchJoints(*scene, options.engine)
                         : Expected<std::vector<TouchedJoint>>(scene.errors());
    if (!touched) {
      errors.insert(errors.end(), touched.errors().begin(), touched.errors().end());
      continue;
    }
    std::printf("%s\n", printable(file).c_str());
    for (const TouchedJoint& joint : *touched) {
      ++joints;
      moved += joint.moves() ? 1 : 0;
      held += !joint.moves() && joint.cannotMove() ? 1 : 0;
      std::printf("  %-30s %11s .. %-11s of %11s .. %-11s %5.1f N  %s\n",
                  printable(joint.body).c_str(), placeOf(joint, joint.reached_least).c_str(),
                  placeOf(joint, joint.reached_most).c_str(), placeOf(joint, joint.least).c_str(),
                  placeOf(joint, joint.most).c_str(), joint.force_n, verdict(joint).c_str());
      out.push_back({{"file", file},
                     {"body", joint.body},
                     {"hinge", joint.hinge},
                     {"follows", joint.follows},
                     {"least", joint.least},
                     {"most", joint.most},
                     {"reached_least", joint.reached_least},
                     {"reached_most", joint.reached_most},
                     {"moves", joint.moves()},
                     {"help", joint.help == TouchHelp::kNone   ? "none"
                              : joint.help == TouchHelp::kHeld ? "held"
                                                               : "cleared"},
                     {"in_the_way", joint.in_the_way},
                     {"force_n", joint.force_n},
                     {"cannot_move", joint.cannotMove()}});
    }
    std::fflush(stdout);
  }
  if (!options.json.empty()) {
    if (auto done = writeText(options.json, jsonText(out)); !done) return refuse(done.errors());
  }
  std::printf("%d of %d joints move through their range", moved, joints);
  if (held > 0) std::printf("; %d cannot be moved by any touch", held);
  std::printf("\n");
  if (!errors.empty()) return refuse(errors);
  return moved == joints ? kExitDone : kExitNotMoved;
}

}  // namespace wholehand
