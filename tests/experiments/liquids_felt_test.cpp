// What the person feels of every liquid, device included: a slow and a fast squeeze of the shipped
// dispenser by a device that follows a script, through the whole renderer.
#include "experiments/felt_squeeze.hpp"
#include "support/file_bytes.hpp"
#include "support/folder.hpp"
#include "support/tolerance.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <vector>

namespace wholehand::test {
namespace {

/// Level 1 with a liquid of this viscosity in its one dispenser.
Models barWith(double viscosity_pa_s, const Folder& folder) {
  const std::string text =
      replaced(bytesOfFile(kConfig + "exercises/cocktail-bar.toml"), "viscosity_pa_s = 0.157",
               "viscosity_pa_s = " + std::to_string(viscosity_pa_s));
  folder.write("scenes/cocktail-bar.toml", bytesOfFile(kConfig + "scenes/cocktail-bar.toml"));
  ModelFiles files = shippedFiles();
  files.scene.clear();
  files.exercise = folder.write("exercises/bar.toml", text);
  return load(files);
}

/// Resistances at the tip of the shipped liquids [N·s/m].
std::vector<double> shippedResistances() {
  const Models models = load(exerciseFiles("cocktail-bar"));
  const auto json = nlohmann::json::parse(models.exercise->description().json);
  std::vector<double> out;
  for (const auto& liquid : json["liquids"]) out.push_back(liquid["resistance_n_s_m"]);
  return out;
}

/// Felt force over speed where the shell gives way steadily [N·s/m]. The speed is the one that
/// 1.5 N has through valve and liquid, so that every liquid is pressed alike.
double feltViscosity(double resistance, int axis, const Folder& folder) {
  const double per_pa_s = 8.0 * 0.02 * 16e-8 / (kPi * 16e-12);  // 8 L A²/(π r⁴)
  const double speed_m_s = (1.5 - 0.25) / resistance;
  const Squeeze s =
      squeeze(barWith(resistance / per_pa_s, folder), "dispenser_lemon", axis, speed_m_s);
  double sum_n = 0.0;
  int count = 0;
  for (const Sample& p : s.samples) {
    if (p.path_m < 0.0105 || p.path_m > 0.0125) continue;
    sum_n += p.felt_n;
    ++count;
  }
  EXPECT_GT(count, 20);
  return sum_n / count / speed_m_s;
}

/// The figure: neighbours 1.6 apart by the file are felt at least 1.55 apart, device included
/// (threshold 1.34, Jones 1997), on both axes.
TEST(Liquids, BehindTheirShell_NeighboursDifferInViscosity) {
  const Folder folder;
  for (const int axis : {kFingerAxis, kThumbAxis}) {
    double before = 0.0;
    for (const double resistance : shippedResistances()) {
      const double now = feltViscosity(resistance, axis, folder);
      const std::string of =
          ", " + std::to_string(std::lround(resistance)) + " N·s/m, axis " + std::to_string(axis);
      figure("force over speed felt in series" + of, now, "N·s/m");
      if (before > 0.0) {
        EXPECT_GE(now / before, 1.55);
        figure("ratio of it to the one before" + of, now / before, "");
      }
      before = now;
    }
  }
}

}  // namespace
}  // namespace wholehand::test
