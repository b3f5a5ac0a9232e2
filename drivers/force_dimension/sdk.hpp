#pragma once

#include "loop/core/expected.hpp"

#include <memory>
#include <string>

namespace wholehand::force_dimension {

/// Results of the SDK's functions. Errors are negative.
enum Returned {
  kFine = 0,
  kTimeGuard = 1,      ///< nothing new: called too soon
  kMotorSaturated = 2  ///< a motor gives less force than requested
};

/// Indices in the status of dhdGetStatus().
enum StatusAt {
  kPower = 0,
  kConnected = 1,
  kStarted = 2,
  kReset = 3,  ///< waits for its calibration
  kForce = 5,
  kError = 9,
  kForceOffCause = 14
};
/// Size of the status array. The SDK writes 17 numbers today; a later version may write more.
inline constexpr int kStatusRoom = 64;
static_assert(kStatusRoom >= 17);

/// Reason why force is off.
enum ForceOff {
  kNotOff = 0,
  kButton = 1,
  kVelocity = 2,
  kWatchdog = 3,
  kSoftware = 4,
  kUsb = 5,
  kDeadman = 6
};
[[nodiscard]] const char* forceOffText(int cause) noexcept;

/// The functions of Force Dimension's SDK that the driver calls, found in libdrd.so.3 at run time.
/// The prototypes are written here after the SDK's reference for C: identifiers are `char`, and
/// default values of C++ are explicit arguments. Functions of expert mode are missing on purpose:
/// watchdog, velocity trip, gravity compensation and brakes stay as the maker delivers them.
struct Sdk {
  // NOLINTBEGIN(readability-identifier-naming): as the SDK names them
  void (*dhdGetSDKVersion)(int* major, int* minor, int* release, int* revision);
  const char* (*dhdErrorGetLastStr)();
  int (*dhdGetDeviceCount)();
  int (*dhdGetSerialNumber)(unsigned short* serial, char id);
  const char* (*dhdGetSystemName)(char id);
  bool (*dhdHasGripper)(char id);
  bool (*dhdIsLeftHanded)(char id);
  int (*dhdGetStatus)(int* status, char id);
  int (*dhdEnableForce)(unsigned char on, char id);
  int (*dhdGetPosition)(double* x_m, double* y_m, double* z_m, char id);
  int (*dhdGetGripperAngleRad)(double* angle_rad, char id);
  int (*dhdSetForceAndTorqueAndGripperForce)(double x_n, double y_n, double z_n, double a_nm,
                                             double b_nm, double g_nm, double gripper_n, char id);
  int (*drdOpenID)(char id);
  int (*drdClose)(char id);
  bool (*drdIsInitialized)(char id);
  int (*drdAutoInit)(char id);
  int (*drdStop)(bool leave_force_on, char id);
  // NOLINTEND(readability-identifier-naming)

  std::shared_ptr<void> library;  ///< keeps the library loaded
  std::string version;            ///< e.g. "3.17.1"
};

/// Loads libdrd.so.3 from the folder of the environment variable FORCEDIM_SDK or from
/// lib/release/lin-*-gcc in it, else from the system. Refused, each by name: no library, a missing
/// function, an SDK before 3.14 or of another major version.
[[nodiscard]] Expected<Sdk> loadSdk();

}  // namespace wholehand::force_dimension
