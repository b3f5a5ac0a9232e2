#include "resimulation.hpp"

#include "assembly/rig.hpp"
#include "device/replay/replay_device.hpp"
#include "realtime/thread_setup.hpp"
#include "recorded_files.hpp"

#include <algorithm>

namespace wholehand {
namespace {

std::vector<RecordedReading> readInputs(RecordingReader& recording) {
  const RecordingMeta& meta = recording.meta();
  std::vector<RecordedReading> inputs;
  RecordedReading armed;
  armed.reading.q_m = AxisPosition(static_cast<int>(meta.armed_position.size()));
  std::copy(meta.armed_position.begin(), meta.armed_position.end(), armed.reading.q_m.data());
  inputs.push_back(armed);
  TickRecord record;
  for (std::uint64_t i = 0; recording.read(i, record); ++i) {
    inputs.push_back({{record.q_m, record.intention, record.patient_effort},
                      record.elapsed_periods,
                      record.faults});
  }
  return inputs;
}

}  // namespace

Expected<Resimulation> resimulate(RecordingReader& recording, const std::string& path) {
  auto models = recordedModels(recording.meta(), path);
  if (!models) return models.errors();
  RigOptions options;
  options.period_s = recording.meta().period_s;
  options.engine = recording.meta().engine;
  options.uncertified = recording.meta().uncertified;
  auto rig = buildRigThatMovesNobody(
      std::move(*models),
      std::make_unique<ReplayDevice>(readInputs(recording), recording.meta().simulated_device),
      options);
  if (!rig) return rig.errors();
  (*rig)->renderer->startParametersAt(recording.meta().parameter_values);
  flushDenormals();  // as the recorded thread did
  if (auto armed = (*rig)->renderer->arm(); !armed) return armed.errors();

  Resimulation result;
  TickRecord recorded, again;
  for (std::uint64_t i = 0; recording.read(i, recorded); ++i) {
    if (any(recorded.faults & Fault::kStopRequested)) (*rig)->renderer->requestStop();
    if (any(recorded.faults & Fault::kEmergencyStop)) (*rig)->renderer->requestEmergencyStop();
    again.command_count = recorded.command_count;
    again.commands = recorded.commands;
    (*rig)->renderer->tick(recorded.elapsed_periods, again);
    ++result.ticks;
    if (recording.meta().schema < 3) {  // it does not say
      recorded.safety_state = again.safety_state;
      recorded.fault_axis = again.fault_axis;
    }
    result.difference = firstDifference(recorded, again);
    if (!result.difference.field.empty()) {
      result.different_tick = recorded.tick;
      return result;
    }
  }
  return result;
}

}  // namespace wholehand
