/* The boundary between Wholehand and the driver of a device: C99, one symbol, six functions and two that may be left out.
 *
 * A driver is a shared object that exports `wh_plugin_v1`. Wholehand loads it, asks which axes the
 * device has, holds them against the device file, and then reads a sample and writes a command in
 * every tick, 1,000 times a second and more. docs/drivers.md leads through one.
 *
 * SI units throughout: m, N, s, rad, N.m, degrees Celsius. Strings are UTF-8 and end with 0. Memory
 * stays with who made it. Nothing is thrown, nothing calls back but wh_host. Every structure begins
 * with its size, which who makes it sets: a field that lies beyond the size of the other side is not
 * touched, so that both may grow. */
#ifndef WHOLEHAND_DEVICE_H
#define WHOLEHAND_DEVICE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define WH_MAJOR 1
#define WH_MINOR 2
#define WH_MAX_AXES 16

/* What a function returns: 0 and more is success. A driver says why it fails by wh_host.say. */
enum {
  WH_OK = 0,
  WH_NOTHING_NEW = 1,   /* read: no sample since the last one; it is filled with that */
  WH_FAILED = -1,
  WH_UNSUPPORTED = -2   /* control: this device cannot do it */
};

/* Kinds of axes, and what an effort is to one. */
enum { WH_TRANSLATION = 0, WH_ROTATION = 1 };
enum { WH_EFFORT = 0, WH_POSITION_LIMIT = 1, WH_BRAKE = 2, WH_VIBRATION = 3 };

/* What an axis does while the device is not enabled. One that weighs something and is not said to
 * lock falls: only a host may hold it, which carries it from opening to closing. */
enum { WH_NOT_SAID = 0, WH_LOCKS = 1, WH_BALANCED = 2, WH_FALLS = 3 };

/* Bits of wh_sample.status. Rendering stops without WH_ENABLED and WH_HOMED, and by the faults. */
enum {
  WH_ENABLED = 1 << 0,       /* efforts reach the motors */
  WH_HOMED = 1 << 1,         /* positions are absolute */
  WH_SATURATED = 1 << 2,     /* information: the drive gave less than was asked */
  WH_DRIVE_FAULT = 1 << 3,   /* the drive has stopped itself: vendor_code says why */
  WH_HOT = 1 << 4,           /* information: near the temperature at which it derates */
  WH_DERATING = 1 << 5,      /* information: it gives less so as not to get hotter */
  WH_SILENCED = 1 << 6       /* its watchdog let go: no command came in time */
};

/* Flags of wh_plugin: read and write never wait, so that the loop itself may call them. Read when
 * the driver is loaded and again right after open: a driver that opens others clears it then. */
enum { WH_NEVER_WAITS = 1 << 0 };

/* Verbs of wh_plugin.control. Each returns when it is done. From WH_ENABLE to the first command may
 * be a second: the drive's watchdog begins with that command, or the driver feeds it until then. */
enum {
  WH_IDENTIFY = 0,       /* show which device this is: blink, click */
  WH_HOME = 1,           /* find the absolute positions; may move */
  WH_TARE = 2,           /* the present efforts measured are zero */
  WH_ENABLE = 3,         /* let efforts through, neutral first */
  WH_DISABLE = 4,        /* neutral, then let nothing through */
  WH_SELF_TEST = 5,
  WH_DROP_WATCHDOG = 6   /* for a test: stop feeding the drive's watchdog */
};

typedef struct {
  uint32_t size;
  char name[32];           /* as in the device file: x, y, z, roll, ..., finger_flexion */
  uint32_t kind;           /* WH_TRANSLATION or WH_ROTATION */
  uint32_t effort_meaning; /* WH_EFFORT or another; others are not rendered to yet */
  double lower, upper;     /* travel [m or rad] */
  double effort_limit;     /* most that the drive gives for good [N or N.m] */
  double resolution;       /* smallest change of position it resolves [m or rad] */
  double delay_s;          /* from a write to its effect */
  double silence_s;        /* without a write for so long it goes to neutral by itself; 0: never */
  uint32_t disabled;       /* since 1.2: WH_LOCKS, WH_BALANCED, WH_FALLS */
} wh_axis;

typedef struct {
  uint32_t size;
  uint32_t status;                   /* bits above */
  uint64_t sequence;                 /* rises with every new sample */
  int64_t monotonic_ns;              /* when it was taken: CLOCK_MONOTONIC */
  uint32_t valid;                    /* bit i: position[i] was measured */
  int32_t vendor_code;               /* 0: nothing to say */
  double position[WH_MAX_AXES];      /* [m or rad] */
  double effort[WH_MAX_AXES];        /* measured [N or N.m]; NaN: not known */
  double temperature_c[WH_MAX_AXES]; /* NaN: not known */
} wh_sample;

typedef struct {
  uint32_t size;
  uint32_t axes;
  uint64_t sequence;          /* rises with every command */
  double effort[WH_MAX_AXES]; /* [N or N.m], until the next command */
} wh_command;

/* What a driver may call; valid until close. */
typedef struct {
  uint32_t size;
  void* context;
  /* One line for a person. Not from read and write. */
  void (*say)(void* context, const char* line);
} wh_host;

/* Since 1.1. Which device it is, for its passport: "" where it is not known. */
typedef struct {
  uint32_t size;
  char serial[64];   /* of the device */
  char firmware[64]; /* its version */
  char sdk[64];      /* version of what the driver talks to it with */
} wh_identity;

typedef struct wh_device wh_device; /* the driver's own */

typedef struct {
  uint32_t size;
  uint16_t major, minor; /* WH_MAJOR, WH_MINOR of the header it was built with */
  uint32_t flags;        /* WH_NEVER_WAITS */
  const char* name;      /* of the driver, for a person */

  /* Finds the device. `locator` and `settings` are the user's words, "" where there are none. It
   * is not enabled yet. */
  int (*open)(const wh_host* host, const char* locator, const char* settings, wh_device** device);
  /* Fills up to `capacity` axes, whose sizes are set, and says in *count how many there are. The
   * order is that of positions and efforts. */
  int (*describe)(wh_device* device, wh_axis* axes, uint32_t capacity, uint32_t* count);
  int (*control)(wh_device* device, uint32_t verb, double argument);
  /* In the tick: no waiting, no allocation, no lock, no system call that may block. */
  int (*read)(wh_device* device, wh_sample* sample);
  int (*write)(wh_device* device, const wh_command* command);
  /* Neutral, disabled, gone. */
  void (*close)(wh_device* device);
  /* Since 1.1; NULL: not known. Of an open device; identity->size is set. */
  int (*identify)(wh_device* device, wh_identity* identity);
  /* Since 1.2; NULL: none, and no axis may have a neutral effort. As WH_ENABLE, but with these
   * efforts from the first moment: they carry the device's weight. They last like a command. */
  int (*enable)(wh_device* device, const wh_command* neutral);
} wh_plugin;

/* What a driver exports. */
#if defined(__GNUC__)
__attribute__((visibility("default")))
#endif
const wh_plugin* wh_plugin_v1(void);

#ifdef __cplusplus
}
#endif

#endif /* WHOLEHAND_DEVICE_H */
