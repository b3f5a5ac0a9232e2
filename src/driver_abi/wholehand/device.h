/* The interface between Wholehand and the driver of a device: C99, one exported symbol, six
 * functions and two optional ones.
 *
 * A driver is a shared object that exports `wh_plugin_v1`. Wholehand loads it, asks which axes the
 * device has, compares them with the device file, and then reads a sample and writes a command in
 * every tick, 1,000 times a second or more. docs/drivers.md explains a driver step by step.
 *
 * SI units throughout: m, N, s, rad, N.m, degrees Celsius. Strings are UTF-8 and end with 0. The
 * side that allocates memory owns and frees it. No function throws; a driver calls back only through
 * wh_host. Every structure begins with its size, which the side that creates it sets. A field beyond
 * the size of the other side is neither read nor written, so that both sides may add fields. */
#ifndef WHOLEHAND_DEVICE_H
#define WHOLEHAND_DEVICE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define WH_MAJOR 1
#define WH_MINOR 3
#define WH_MAX_AXES 16

/* Return values of the functions: 0 or more is success. A driver reports the reason of a failure by
 * wh_host.say. */
enum {
  WH_OK = 0,
  WH_NOTHING_NEW = 1,   /* read: no new sample; filled with the last one */
  WH_FAILED = -1,
  WH_UNSUPPORTED = -2   /* control: this device cannot do it */
};

/* Kinds of axes, and what an effort means on an axis. */
enum { WH_TRANSLATION = 0, WH_ROTATION = 1 };
enum { WH_EFFORT = 0, WH_POSITION_LIMIT = 1, WH_BRAKE = 2, WH_VIBRATION = 3 };

/* What an axis does while the device is not enabled. An axis that carries weight and is not declared
 * to lock falls. Only a host may use such an axis: it carries the weight from opening to closing. */
enum { WH_NOT_SAID = 0, WH_LOCKS = 1, WH_BALANCED = 2, WH_FALLS = 3 };

/* Bits of wh_sample.status. Rendering stops without WH_ENABLED or WH_HOMED, and at a fault. */
enum {
  WH_ENABLED = 1 << 0,       /* efforts reach the motors */
  WH_HOMED = 1 << 1,         /* positions are absolute */
  WH_SATURATED = 1 << 2,     /* information: the drive gave less effort than commanded */
  WH_DRIVE_FAULT = 1 << 3,   /* the drive has stopped itself: vendor_code says why */
  WH_HOT = 1 << 4,           /* information: near the temperature at which it derates */
  WH_DERATING = 1 << 5,      /* information: the drive gives less effort to limit its heat */
  WH_SILENCED = 1 << 6       /* no command came in time: the watchdog released the effort */
};

/* Flags of wh_plugin. WH_NEVER_WAITS: read and write never wait, so that the loop itself may call
 * them. Wholehand reads the flags when the driver is loaded and again right after open: a driver
 * that opens other drivers, which may wait, clears the flag then. */
enum { WH_NEVER_WAITS = 1 << 0 };

/* Verbs of wh_plugin.control. Each returns when it is done. Up to a second may pass from WH_ENABLE to
 * the first command: the drive's watchdog starts with that command, or the driver feeds it until
 * then. */
enum {
  WH_IDENTIFY = 0,       /* show which device this is: blink, click */
  WH_HOME = 1,           /* find the absolute positions; may move */
  WH_TARE = 2,           /* take the efforts measured now as zero */
  WH_ENABLE = 3,         /* let efforts reach the motors, beginning with neutral */
  WH_DISABLE = 4,        /* go to neutral, then let no effort reach the motors */
  WH_SELF_TEST = 5,
  WH_DROP_WATCHDOG = 6   /* for a test: stop feeding the drive's watchdog */
};

typedef struct {
  uint32_t size;
  char name[32];           /* as in the device file: x, y, z, roll, ..., finger_flexion */
  uint32_t kind;           /* WH_TRANSLATION or WH_ROTATION */
  uint32_t effort_meaning; /* WH_EFFORT or another; others are not rendered yet */
  double lower, upper;     /* travel [m or rad] */
  double effort_limit;     /* largest continuous effort of the drive [N or N.m] */
  double resolution;       /* smallest measurable change of position [m or rad] */
  double delay_s;          /* delay from a write to its effect */
  double silence_s;        /* after so long without a write the drive goes to neutral; 0: never */
  uint32_t disabled;       /* since 1.2: WH_LOCKS, WH_BALANCED, WH_FALLS */
} wh_axis;

typedef struct {
  uint32_t size;
  uint32_t status;                   /* bits above */
  uint64_t sequence;                 /* increases with every new sample */
  int64_t monotonic_ns;              /* time of the sample, CLOCK_MONOTONIC */
  uint32_t valid;                    /* bit i: position[i] was measured */
  int32_t vendor_code;               /* the drive's own fault code; 0: none */
  double position[WH_MAX_AXES];      /* [m or rad] */
  double effort[WH_MAX_AXES];        /* measured [N or N.m]; NaN: not known */
  double temperature_c[WH_MAX_AXES]; /* NaN: not known */
  /* Since 1.3. With WH_DERATING: bit i: the drive of axis i gives less effort; 0: any may. The
   * efforts of all other axes are judged in full. */
  uint32_t derating;
  uint32_t reserved; /* 0 */
} wh_sample;

typedef struct {
  uint32_t size;
  uint32_t axes;
  uint64_t sequence;          /* increases with every command */
  double effort[WH_MAX_AXES]; /* [N or N.m], holds until the next command */
} wh_command;

/* Functions that a driver may call; valid until close. */
typedef struct {
  uint32_t size;
  void* context;
  /* Reports one line of text for a person. Must not be called from read or write. */
  void (*say)(void* context, const char* line);
} wh_host;

/* Since 1.1. Identity of the device, for its passport; "" when not known. */
typedef struct {
  uint32_t size;
  char serial[64];   /* serial number of the device */
  char firmware[64]; /* firmware version of the device */
  char sdk[64];      /* version of the vendor library that the driver uses */
} wh_identity;

typedef struct wh_device wh_device; /* defined by the driver */

typedef struct {
  uint32_t size;
  uint16_t major, minor; /* WH_MAJOR, WH_MINOR of the header that the driver was built with */
  uint32_t flags;        /* WH_NEVER_WAITS or 0 */
  const char* name;      /* name of the driver, for a person */

  /* Finds and opens the device, which is not enabled yet. `locator` and `settings` are the texts
   * that the user gave, "" without any. */
  int (*open)(const wh_host* host, const char* locator, const char* settings, wh_device** device);
  /* Fills up to `capacity` axes, whose sizes are set, and writes their number to *count. Positions
   * and efforts have the same order. */
  int (*describe)(wh_device* device, wh_axis* axes, uint32_t capacity, uint32_t* count);
  int (*control)(wh_device* device, uint32_t verb, double argument);
  /* Called in the tick: no waiting, no allocation, no lock, no system call that may block. */
  int (*read)(wh_device* device, wh_sample* sample);
  int (*write)(wh_device* device, const wh_command* command);
  /* Takes the device to neutral, disables it and releases it. */
  void (*close)(wh_device* device);
  /* Since 1.1; NULL: the identity is not known. Called for an open device; identity->size is set. */
  int (*identify)(wh_device* device, wh_identity* identity);
  /* Since 1.2; NULL: not available, and no axis may have a neutral effort. Like WH_ENABLE, but these
   * efforts act from the first moment: they carry the device's weight. They hold like a command. */
  int (*enable)(wh_device* device, const wh_command* neutral);
  /* Since 1.3; 0: 50 ms. Longest time [s] of open, and of enabling, disabling or closing while the
   * device answers. People are told that the robot does not answer when these, or any other call but
   * a verb that moves or tests, take longer. A driver that opens others sets them in open. */
  double opens_within_s, switches_within_s;
} wh_plugin;

/* The function that a driver exports. */
#if defined(__GNUC__)
__attribute__((visibility("default")))
#endif
const wh_plugin* wh_plugin_v1(void);

#ifdef __cplusplus
}
#endif

#endif /* WHOLEHAND_DEVICE_H */
