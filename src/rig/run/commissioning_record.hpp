#pragma once

#include "loop/core/expected.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/model/device_model.hpp"
#include "loop/realtime/spsc_queue.hpp"
#include "record/black_box.hpp"
#include "record/hub.hpp"
#include "record/recording.hpp"

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

/// Records a commissioning with the same recorder and black box as every run (docs/adr/0026). The
/// recording has no hand and no scene; its values are the step, the device's status word, and the
/// reason why the guard let go. The black box file is written if the process crashes.
class CommissioningRecord {
 public:
  struct Plan {
    std::string path;         ///< HDF5 file; the black box file is written to the same folder
    std::string title;        ///< "Commissioning of ..."
    std::string device_text;  ///< text of the device file
    double period_s = 1e-3;
    double effort_share = 0.2;  ///< used share of the effort limits of the device file
  };
  /// Names of the values of a tick.
  static std::vector<std::string> valueNames() { return {"step", "device_status", "let_go"}; }

  /// Begins a recording. Returns an error if the file cannot be written or there is no memory for
  /// the black box.
  [[nodiscard]] static Expected<std::unique_ptr<CommissioningRecord>> begin(
      const DeviceModel& model, const Plan& plan);
  /// Writes the remaining data and closes the files. A recording without ticks is removed.
  ~CommissioningRecord();
  CommissioningRecord(const CommissioningRecord&) = delete;
  CommissioningRecord& operator=(const CommissioningRecord&) = delete;

  /// Data of one tick.
  struct Tick {
    std::int64_t monotonic_ns = 0;
    AxisPosition position;     ///< position of the newest sample
    AxisEffort sent;           ///< [N or N·m]
    std::uint32_t status = 0;  ///< status bits of device.h
    bool rendering = false;  ///< true during a move; false during the ramp to neutral and after it
    int let_go = 0;          ///< reason why the guard let go (device/host); 0: it did not
  };
  /// Adds a tick, from the thread that moves the device. Never blocks.
  void keep(const Tick& tick) noexcept;
  /// Sets the step number of all later ticks. Any thread.
  void setStep(int step) noexcept { step_ = step; }
  [[nodiscard]] const std::string& path() const noexcept { return plan_.path; }
  [[nodiscard]] std::uint64_t kept() const noexcept { return kept_; }

 private:
  CommissioningRecord(const DeviceModel& model, Plan plan);

  Plan plan_;
  std::vector<std::filesystem::path> made_folders_;  ///< created folders, innermost first
  AxisEffort limit_;                                 ///< limit used in commissioning
  std::unique_ptr<RecordingWriter> writer_;
  std::unique_ptr<BlackBox> black_box_;
  RecordQueue queue_;
  std::unique_ptr<TelemetryHub> hub_;
  TickRecord record_;
  std::atomic<int> step_{-1};
  std::int64_t began_ns_ = 0;
  std::uint64_t kept_ = 0;
};

}  // namespace wholehand
