#include "exercise/cocktail_bar/bar_record.hpp"

#include <fmt/format.h>

namespace wholehand {

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

}  // namespace wholehand
