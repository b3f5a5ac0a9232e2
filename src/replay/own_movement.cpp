#include "replay/own_movement.hpp"

#include "loop/core/printable.hpp"
#include "record/recording.hpp"
#include "replay/resimulation/resimulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string_view>

namespace wholehand {
namespace {

constexpr std::string_view kOwn = "own/";
constexpr std::string_view kLower = "_lower", kUpper = "_upper";

/// Index of the last tick with values of the exercise. The ramp to neutral has none.
bool readLastValues(RecordingReader& reader, TickRecord& record) {
  for (std::uint64_t row = reader.size(); row > 0; --row) {
    if (reader.read(row - 1, record) && record.exercise.value_count > 0) return true;
  }
  return false;
}

void putEnd(OwnMovement& own, const OwnMovementEnd& end) {
  std::erase_if(own.ends, [&](const OwnMovementEnd& known) {
    return known.axis == end.axis && known.upper == end.upper;
  });
  own.ends.push_back(end);
}

/// Adds what a recording measured. Returns whether it measured anything.
bool addEnds(const RecordingMeta& meta, const TickRecord& last, OwnMovement& own) {
  const auto value = [&](const std::string& name) {
    const auto at = std::find(meta.value_names.begin(), meta.value_names.end(), name) -
                    meta.value_names.begin();
    return at < last.exercise.value_count ? last.exercise.values[at] : std::nan("");
  };
  bool measured = false;
  for (const std::string& name : meta.value_names) {
    if (!name.starts_with(kOwn) || !std::isfinite(value(name))) continue;
    const std::string direction = name.substr(kOwn.size());
    OwnMovementEnd end;
    end.upper = direction.ends_with(kUpper);
    if (!end.upper && !direction.ends_with(kLower)) continue;
    end.axis = own.device.axisIndex(direction.substr(0, direction.size() - kUpper.size()));
    if (end.axis < 0) continue;
    end.value = value(name);
    putEnd(own, end);
    measured = true;
  }
  return measured;
}

}  // namespace

Expected<OwnMovement> ownMovementOf(const std::vector<std::string>& recordings) {
  OwnMovement own;
  for (const std::string& path : recordings) {
    auto reader = RecordingReader::open(path);
    if (!reader) return reader.errors();
    const RecordingMeta& meta = (*reader)->meta();
    const auto models = recordedModels(meta, path);
    if (!models) return models.errors();
    if (path == recordings.front()) {
      own.device = models->device;
      own.side = models->hand.side;
    } else if (models->device.name != own.device.name || models->hand.side != own.side) {
      return fileFault(path, "was made with another device or hand side than the first one",
                       "name recordings of one device and one hand");
    }
    auto record = std::make_unique<TickRecord>();
    if (!readLastValues(**reader, *record) || !addEnds(meta, *record, own)) {
      return fileFault(path, "has no own movement",
                       "record one: wholehand run --exercise own-range --record own.h5");
    }
  }
  return own;
}

LimitsFound limitsFrom(const OwnMovement& own) {
  LimitsFound out;
  for (int a = 0; a < own.device.axisCount(); ++a) {
    const DeviceAxis& axis = own.device.axes[a];
    const bool along = axis.kind == AxisKind::kTranslation;
    const auto shown = [&](double value) {
      return along ? fmt::format("{:.1f} cm", 100.0 * value) : fmt::format("{:.0f}°", value / kDeg);
    };
    const double step = along ? 1e-4 : 1e-3;  // of the written numbers
    LimitText limit{axis.name, along, axis.lower, axis.upper};
    bool known = false;
    for (const OwnMovementEnd& end : own.ends) {
      if (end.axis != a) continue;
      (end.upper ? limit.upper : limit.lower) =
          std::clamp(step * std::round(end.value / step), axis.lower, axis.upper);
      known = true;
    }
    if (!known) continue;
    const double least = 2.0 * (along ? kLimitBand_m : kLimitBand_rad);
    if (limit.upper - limit.lower < least) {
      out.notices.push_back(
          fmt::format("{}: own movement from {} to {} is narrower than {}, the walls of "
                      "a limit, so the axis gets none",
                      printable(axis.name), shown(limit.lower), shown(limit.upper), shown(least)));
      continue;
    }
    out.limits.push_back(limit);
  }
  return out;
}

}  // namespace wholehand
