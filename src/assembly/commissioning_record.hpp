#pragma once

#include "core/expected.hpp"
#include "core/tick_record.hpp"
#include "model/device_model.hpp"
#include "realtime/spsc_queue.hpp"
#include "telemetry/black_box.hpp"
#include "telemetry/hub.hpp"
#include "telemetry/recording.hpp"

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

/// Keeps every effort of a commissioning, and what the device did, with the recorder and the black
/// box of every run (docs/adr/0030): a recording without a hand or a scene, whose values are the
/// step, the device's status word, and whether the guard lets the move go on. The black box is
/// written where the process crashes.
class CommissioningRecord {
 public:
  struct Plan {
    std::string path;         ///< HDF5; the black box goes beside it
    std::string title;        ///< "Commissioning of ..."
    std::string device_text;  ///< of the device file
    double period_s = 1e-3;
    double effort_share = 0.2;  ///< of the file's limits that may be used
  };
  /// Names of the values of each tick.
  static std::vector<std::string> valueNames() { return {"step", "device_status", "let_go"}; }

  /// Refused: a file that cannot be written, no memory for the box.
  [[nodiscard]] static Expected<std::unique_ptr<CommissioningRecord>> begin(
      const DeviceModel& model, const Plan& plan);
  /// Writes the rest and closes; a recording of no tick is removed.
  ~CommissioningRecord();
  CommissioningRecord(const CommissioningRecord&) = delete;
  CommissioningRecord& operator=(const CommissioningRecord&) = delete;

  /// What one tick sent and read.
  struct Tick {
    std::int64_t monotonic_ns = 0;
    AxisPosition position;     ///< of the newest sample
    AxisEffort sent;           ///< [N or N·m]
    std::uint32_t status = 0;  ///< of device.h
    bool rendering = false;    ///< a move goes on; false: on the way to neutral, or there
    int let_go = 0;            ///< why the guard let go (device/host); 0: it did not
  };
  /// From the thread that moves the device: waits for nothing.
  void keep(const Tick& tick) noexcept;
  /// Number of the step under way, for every later tick. Any thread.
  void setStep(int step) noexcept { step_ = step; }
  [[nodiscard]] const std::string& path() const noexcept { return plan_.path; }
  [[nodiscard]] std::uint64_t kept() const noexcept { return kept_; }

 private:
  CommissioningRecord(const DeviceModel& model, Plan plan);

  Plan plan_;
  std::vector<std::filesystem::path> made_folders_;  ///< for its file, the innermost first
  AxisEffort limit_;                                 ///< what commissioning may use
  std::unique_ptr<RecordingWriter> writer_;
  std::unique_ptr<BlackBox> black_box_;
  SpscQueue<TickRecord> queue_;
  std::unique_ptr<TelemetryHub> hub_;
  TickRecord record_;
  std::atomic<int> step_{-1};
  std::int64_t began_ns_ = 0;
  std::uint64_t kept_ = 0;
};

}  // namespace wholehand
