#pragma once

#include "devices/commissioning/identification/identify_axis.hpp"
#include "devices/passport/sealed_file.hpp"
#include "devices/plugin/device_driver.hpp"
#include "devices/plugin/plugin_device.hpp"
#include "devices/plugin/transport.hpp"
#include "loop/core/expected.hpp"
#include "loop/model/device_model.hpp"

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// Measurements of one device, stored next to its device file. Not real-time safe.
namespace wholehand {

struct ChartPage;

inline constexpr std::chrono::days kPassportLasts{30};

/// Measured intervals of one axis. SI; per radian for a rotation.
struct PassportAxis {
  std::string name;
  AxisKind kind = AxisKind::kTranslation;
  Interval mass;     ///< [kg or kg·m²]
  Interval damping;  ///< viscous [N·s/m or N·m·s/rad]
  Interval coulomb;  ///< dry friction [N or N·m]
  Interval gravity;  ///< effort that holds the axis in mid-range [N or N·m]
  Interval delay_s;  ///< from a command to its effect, with the transport
  /// Part of delay_s that was the transport's: the median while it was measured. Empty: unknown, as
  /// in passports that are older than this key.
  std::optional<double> transport_s;
  /// Time constant with which the drive's measured effort follows; 0 to 0: it measures none.
  Interval drive_lag_s;
  double resolution = 0.0;  ///< smallest change of position read [m or rad]
  double mark = 0.0;        ///< its position at the device's mark [m or rad]
};

struct Passport {
  std::string path;  ///< file it was read from; empty if none
  DriverIdentity identity;
  std::string driver;         ///< name that the driver gives itself
  std::string device;         ///< name in the device file
  std::string device_sha256;  ///< digest of the device file's bytes
  std::string operator_name;
  PlaceTime measured_at;
  double rate_hz = 1000.0;  ///< tick rate of the measurement
  /// Share of the effort limits up to which every axis responded as measured.
  double responds_up_to = 1.0;
  std::vector<PassportAxis> axes;
  std::string sha256;  ///< digest of the passport itself; empty if not read from a file
};

/// Path of the passport of a device: mine.toml and serial S-1 give mine.S-1.passport.toml.
/// Characters unfit for a file name become dashes.
[[nodiscard]] std::string passportPath(const std::string& device_file, const std::string& serial);

/// Text of the file, with its seal.
[[nodiscard]] std::string passportText(const Passport& passport);

/// Reads a passport. Refused: a file that cannot be read, is truncated, was changed, is of another
/// kind, or contains impossible values.
[[nodiscard]] Expected<Passport> readPassport(const std::string& path);

/// True if the passport has the axes of this device, in order and kind.
[[nodiscard]] bool sameAxes(const Passport& passport, const DeviceModel& model);

/// Checks that the passport is valid for this device and file now. Refused, each with its own
/// message: another serial, firmware, SDK, driver or setting of the driver; a device file changed
/// since; differing axes; a passport that is older than kPassportLasts or from the future.
[[nodiscard]] Expected<Done> checkPassport(const Passport& passport, const DriverIdentity& identity,
                                           const DeviceModel& model, const PlaceTime& now);

/// Device models at the worst corners of the measurement, for the certificate: least damping and
/// dry friction, longest delay and coarsest position, with every mass at its lower and at its upper
/// end. A worse value in the file is kept. Delays are whole periods, rounded up where they exceed
/// one by more than a tenth.
/// @pre sameAxes()
[[nodiscard]] std::vector<DeviceModel> worstCorners(const DeviceModel& model,
                                                    const Passport& passport, double period_s);

/// Delay of a device whose transport was measured at arming. The drive's part is the passport's
/// longest delay less the transport that it was measured with; the whole delay where the passport
/// does not say so. The periods are those of the worst corner, or more where drive and transport
/// now take longer.
/// @pre sameAxes()
[[nodiscard]] ArmingDelay delayAtArming(const DeviceModel& model, const Passport& passport,
                                        const Transport& now, double period_s);

/// Chart of the measurement against the device file. For each axis and figure it shows the interval
/// relative to the file's value, which lies at 1. Where the file states 0, the interval is given in
/// words only. Not real-time safe.
/// @pre sameAxes()
[[nodiscard]] ChartPage passportChart(const Passport& passport, const DeviceModel& device);

/// Longest validity of a daily check. It is valid only on the local day on which it was done.
inline constexpr std::chrono::hours kCheckLasts{12};

/// Daily check of a device with a passport: zero, signs, watchdog, emergency stop, response up to
/// the effort limit. Written only if all passed.
struct DailyCheck {
  std::string passport_sha256;  ///< digest of the passport that was used
  std::string operator_name;
  PlaceTime done_at;
  std::string sha256;  ///< digest of the check itself; empty if not read from a file
};

/// The check is due again after so many enablings, by whatever program.
inline constexpr int kCheckEnablings = 50;
/// A visit is taken as open until the device was not enabled for so long: the check never becomes
/// due by enablings inside it, but before the next one.
inline constexpr std::chrono::minutes kVisitPause{30};

/// Enablings of a device since a daily check.
struct Enablings {
  std::string check_sha256;  ///< digest of the check
  int count = 0;
  PlaceTime last_at;
};

/// Path of the count: mine.toml and serial S-1 give mine.S-1.enablings.toml.
[[nodiscard]] std::string enablingsPath(const std::string& device_file, const std::string& serial);

/// Text of the file, with its seal.
[[nodiscard]] std::string enablingsText(const Enablings& enablings);

/// Reads a count. Refused: a file that cannot be read, is truncated, was changed or is of another
/// kind.
[[nodiscard]] Expected<Enablings> readEnablings(const std::string& path);

/// Counts an enabling that is about to come. Refused: the check is unreadable, or the count cannot
/// be written; then the device must not be enabled. An unreadable count counts as kCheckEnablings.
[[nodiscard]] Expected<Done> countEnabling(
    const DriverIdentity& identity, const DeviceModel& model, const PlaceTime& now,
    const std::function<Expected<Done>(const std::string& path, const std::string& text)>& write);

/// Path of the daily check: mine.toml and serial S-1 give mine.S-1.check.toml.
[[nodiscard]] std::string dailyCheckPath(const std::string& device_file, const std::string& serial);

/// Text of the file, with its seal.
[[nodiscard]] std::string dailyCheckText(const DailyCheck& check);

/// Reads a check. Refused: a file that cannot be read, is truncated, was changed or is of another
/// kind.
[[nodiscard]] Expected<DailyCheck> readDailyCheck(const std::string& path);

/// The middle of each interval, for the judges of a session; the upper end of the lag.
[[nodiscard]] std::vector<MeasuredAxis> measuredAxes(const Passport& passport);

/// A passport that is valid for a device now, and the clearance based on it.
struct CheckedPermit {
  explicit CheckedPermit(Passport valid)
      : passport(std::move(valid)), permit(passport.sha256, measuredAxes(passport)) {}
  Passport passport;
  ArmingPermit permit;
};

/// Checks that a real device may be armed. It needs a passport that is valid now for this device,
/// file and rate. It also needs a check done with that passport on the present local day, within
/// kCheckLasts and, between two visits, within kCheckEnablings. Refused, each with its remedy: no
/// serial number, no passport, a passport that readPassport() or checkPassport() refuses, no check,
/// a check of another day or passport, an expired or worn check, and a check from the future,
/// because the clock was set back.
[[nodiscard]] Expected<CheckedPermit> checkArmingPermit(const DriverIdentity& identity,
                                                        const DeviceModel& model, double rate_hz,
                                                        const PlaceTime& now);

}  // namespace wholehand
