/* A fake of Force Dimension's libdrd.so.3: the functions of its C reference, around one device. It
 * is also built as an old SDK and as one that lacks a function. */
#include "fake_drd.h"

#include <stdbool.h>
#include <string.h>

#ifndef MAJOR
#define MAJOR 3
#endif
#ifndef MINOR
#define MINOR 17
#endif

static fake_device device;

/* A program that loads it finds a device in the maker's delivery state. */
__attribute__((constructor)) static void deliver(void) { (void)fake_drd(1); }

fake_device* fake_drd(int fresh) {
  if (fresh) {
    memset(&device, 0, sizeof device);
    device.devices = 2;
    device.serial[0] = 11111;
    device.serial[1] = 22222;
    device.has_gripper = device.connected = device.power = device.initialized = 1;
  }
  return &device;
}

void dhdGetSDKVersion(int* major, int* minor, int* release, int* revision) {
  *major = MAJOR;
  *minor = MINOR;
  *release = 1;
  *revision = 0;
}

const char* dhdErrorGetLastStr(void) { return "the fake says why"; }
int dhdGetDeviceCount(void) { return device.devices; }
const char* dhdGetSystemName(char id) { return id >= 0 ? "fake.7" : 0; }

int dhdGetSerialNumber(unsigned short* serial, char id) {
  if (id < 0 || id >= device.devices) return -1;
  *serial = device.serial[(int)id];
  return 0;
}

bool dhdHasGripper(char id) { return id >= 0 && device.has_gripper; }
bool dhdIsLeftHanded(char id) { return id >= 0 && device.left_handed; }

int drdOpenID(char id) {
  if (id < 0 || id >= device.devices || device.open_returns < 0) return -1;
  ++device.opened;
  return 0;
}

int drdClose(char id) {
  (void)id;
  ++device.closed;
  return 0;
}

bool drdIsInitialized(char id) { return id >= 0 && device.initialized; }

/* Leaves the force on, as the SDK's regulation does. */
int drdAutoInit(char id) {
  (void)id;
  ++device.inits;
  if (device.init_returns < 0) return device.init_returns;
  device.initialized = 1;
  device.reset = 0;
  device.force_on = 1;
  return 0;
}

int drdStop(bool leave_force_on, char id) {
  (void)id;
  ++device.stops;
  device.stops_that_leave_force_on += leave_force_on;
  if (device.stop_returns < 0) return device.stop_returns;
  if (!leave_force_on) device.force_on = 0;
  return 0;
}

int dhdEnableForce(unsigned char on, char id) {
  int i;
  (void)id;
  ++device.enables;
  for (i = 0; on && i < 7; ++i) device.enables_with_a_force += device.force[i] != 0.0;
  if (device.enable_returns < 0) return device.enable_returns;
  device.force_on = on && !device.waits_for_button;
  device.cause = on ? 0 : 4;
  return 0;
}

/* Writes 17 numbers: the driver must have room for them. */
int dhdGetStatus(int* status, char id) {
  (void)id;
  memset(status, 0, 17 * sizeof *status);
  status[0] = device.power;
  status[1] = device.connected;
  status[2] = 1;
  status[3] = device.reset;
  status[5] = device.force_on;
  status[6] = !device.force_on;
  status[9] = device.error;
  status[14] = device.cause;
  status[16] = -1;
  return device.status_returns;
}

int dhdGetPosition(double* x, double* y, double* z, char id) {
  (void)id;
  if (device.position_returns < 0) return device.position_returns;
  *x = device.position_m[0];
  *y = device.position_m[1];
  *z = device.position_m[2];
  return device.position_returns;
}

#ifndef WITHOUT_GRIPPER_ANGLE
int dhdGetGripperAngleRad(double* angle, char id) {
  (void)id;
  if (device.angle_returns < 0) return device.angle_returns;
  *angle = device.left_handed ? -device.angle_rad : device.angle_rad;
  return device.angle_returns;
}
#endif

int dhdSetForceAndTorqueAndGripperForce(double fx, double fy, double fz, double ta, double tb,
                                        double tg, double f, char id) {
  const double force[7] = {fx, fy, fz, ta, tb, tg, f};
  (void)id;
  ++device.sent;
  if (device.force_returns < 0) return device.force_returns;
  memcpy(device.force, force, sizeof force);
  return device.force_returns;
}

static int forbidden(void) {
  ++device.forbidden;
  return 0;
}
int dhdEnableExpertMode(void) { return forbidden(); }
int dhdSetWatchdog(unsigned char duration, char id) { return (void)duration, (void)id, forbidden(); }
int dhdSetVelocityThreshold(unsigned value, char id) { return (void)value, (void)id, forbidden(); }
int dhdSetTimeGuard(int us, char id) { return (void)us, (void)id, forbidden(); }
int dhdSetGravityCompensation(int on, char id) { return (void)on, (void)id, forbidden(); }
int dhdSetBrakes(int on, char id) { return (void)on, (void)id, forbidden(); }
int dhdSetEffectorMass(double mass, char id) { return (void)mass, (void)id, forbidden(); }
