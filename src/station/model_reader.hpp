#pragma once

#include "rig/models.hpp"
#include "rig/rig.hpp"
#include "station/profiles.hpp"
#include "vocabulary/backend.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// Names of the *.toml files of a folder, without ending, sorted.
[[nodiscard]] std::vector<std::string> stemsIn(const std::string& folder);

/// Finds, reads and checks the models that orders name. Waits for the disk.
class ModelReader {
 public:
  /// @param visit_hands_folder hand files that visits may name
  ModelReader(std::string config_folder, std::string visit_hands_folder, RigOptions rig)
      : config_(std::move(config_folder)),
        visit_hands_(std::move(visit_hands_folder)),
        rig_(std::move(rig)) {}

  /// Names of models; empty or 0: as in the files that are in use.
  struct Names {
    std::string exercise, hand;
    std::string hand_file;  ///< file among the visits' hands; used when not empty
    int level = 0;
    /// File among the visits' hands; empty: no prescription; nullopt: as in use.
    std::optional<std::string> prescription_file = {};
  };
  /// Resolves names to files, which are not read yet.
  [[nodiscard]] OrderReply find(const Names& names, ModelFiles& files) const;
  /// Reads the files. Models that cannot be rendered stably are refused.
  [[nodiscard]] OrderReply read(const ModelFiles& files, Models& models) const;

 private:
  std::string config_, visit_hands_;
  RigOptions rig_;
};

/// The models as a profile, without name and values.
[[nodiscard]] Profile profileOf(const Models& models);

}  // namespace wholehand
