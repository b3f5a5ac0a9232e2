#include "exercises/cocktail_bar/bar_record.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace wholehand {
namespace {

using Json = nlohmann::ordered_json;

Json json(const Eigen::Vector3d& v) {
  return Json::array({v.x(), v.y(), v.z()});
}

Json liquidsJson(const Bar& bar) {
  Json out = Json::array();
  for (const BarLiquid& l : bar.liquids) {
    out.push_back({{"name", l.name},
                   {"color", l.color},
                   {"pattern", l.pattern},
                   {"symbol", l.symbol},
                   {"viscosity_pa_s", l.viscosity_pa_s},
                   {"resistance_n_s_m", filledWith(bar.bottle, l.viscosity_pa_s).resistance()}});
  }
  return out;
}

Json dispensersJson(const Bar& bar) {
  Json out = Json::array();
  for (const BarDispenser& d : bar.dispensers) {
    out.push_back({{"body", d.body},
                   {"liquid", bar.liquids[d.liquid].name},
                   {"free", d.free},
                   {"radius_m", d.radius_m},
                   {"height_m", d.height_m},
                   {"start_l", d.start_l},
                   {"nozzle_m", json(d.nozzle_m)},
                   {"grip_m", json(d.grip_m)},
                   {"home_m", json(d.home_m)}});
  }
  return out;
}

Json drinksJson(const Bar& bar) {
  Json out = Json::array();
  for (const BarDrink& drink : bar.drinks) {
    Json steps = Json::array();
    for (const BarStep& s : drink.steps) {
      const BarDispenser& d = bar.dispensers[s.dispenser];
      steps.push_back({{"liquid", bar.liquids[d.liquid].name},
                       {"dispenser", s.dispenser},
                       {"amount_l", s.amount_l},
                       {"tolerance_l", s.tolerance_l}});
    }
    out.push_back({{"name", drink.name}, {"steps", std::move(steps)}});
  }
  return out;
}

// Range of the first dispenser while the row slides [m].
Json rowRangeJson(const Bar& bar) {
  const double home_m = bar.dispensers.empty() ? 0.0 : bar.dispensers[0].home_m.y();
  double lower_m = home_m, upper_m = home_m;
  if (bar.row.slides) {
    for (std::size_t i = 0; i < bar.dispensers.size(); ++i) {
      const double offset_m = static_cast<double>(i) * bar.row.spacing_m;
      lower_m = std::min(lower_m, bar.row.reach_upper_m - offset_m);
      upper_m = std::max(upper_m, bar.row.reach_lower_m - offset_m);
    }
  }
  return Json::array({lower_m, upper_m});
}

}  // namespace

static_assert(static_cast<int>(BarValue::kCount) + kMaxDispensers + kMaxSteps <=
              kMaxExerciseValues);

std::vector<std::string> barValueNames(const Bar& bar) {
  std::vector<std::string> names(kBarValueNames.begin(), kBarValueNames.end());
  for (const BarDispenser& d : bar.dispensers) {
    names.push_back("left_l/" + bar.liquids[d.liquid].name);
  }
  for (int i = 0; i < kMaxSteps; ++i) names.push_back(fmt::format("layer_l/{}", i));
  return names;
}

BarStatus readBarStatus(const ExerciseRecord& record) noexcept {
  const auto number = [&record](BarValue value) noexcept {
    const auto i = static_cast<std::int32_t>(value);
    return i < record.value_count ? record.values[i] : 0.0;
  };
  const auto whole = [&number](BarValue v) noexcept { return static_cast<int>(number(v)); };
  BarStatus out;
  if (record.value_count == 0) return out;
  out.stage = static_cast<BarStage>(whole(BarValue::kStage));
  out.drink = whole(BarValue::kDrink);
  out.step = whole(BarValue::kStep);
  out.target = whole(BarValue::kTargetDispenser);
  out.engaged = whole(BarValue::kEngagedDispenser);
  out.squeeze_n = number(BarValue::kSqueeze);
  out.low_n = number(BarValue::kSqueezeLow);
  out.high_n = number(BarValue::kSqueezeHigh);
  out.flow_l_s = number(BarValue::kFlow);
  out.poured_l = number(BarValue::kPoured);
  out.asked_l = number(BarValue::kAsked);
  return out;
}

std::string barJson(const Bar& bar) {
  Json levels = Json::array();
  for (std::size_t i = 0; i < bar.level_names.size(); ++i) {
    levels.push_back({{"level", i + 1}, {"name", bar.level_names[i]}});
  }
  Json out{{"kind", "cocktail_bar"},
           {"level", bar.level},
           {"levels", std::move(levels)},
           {"liquids", liquidsJson(bar)},
           {"dispensers", dispensersJson(bar)},
           {"glass",
            {{"body", bar.glass.body},
             {"radius_m", bar.glass.radius_m},
             {"height_m", bar.glass.height_m},
             {"inner_radius_m", bar.glass.inner_radius_m},
             {"m_per_l", bar.glass.m_per_l},
             {"capacity_l", bar.glass.capacity_l}}},
           {"counter_z_m", bar.counter_z_m},
           {"rail_z_m", bar.rail_z_m},
           {"row_y_m", rowRangeJson(bar)},
           {"engage_m", bar.transition.engage_m},
           {"release_m", bar.transition.release_m},
           {"draw_back", {{"x_m", bar.drawn_back.x_m}, {"palm_m", bar.drawn_back.palm_m}}},
           {"drinks", drinksJson(bar)}};
  return out.dump();
}

}  // namespace wholehand
