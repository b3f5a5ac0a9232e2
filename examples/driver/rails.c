/* A driver to start from: it simulates a device with three rails. Build it with only the header and
 * run it with nobody attached:
 *
 *   cc -std=c99 -O2 -shared -fPIC -I <prefix>/include rails.c -o rails.so
 *   wholehand run --driver ./rails.so --device config/devices/desktop-3axis.toml \
 *     --exercise free-grasping --without-passport
 *
 * Then replace the parts marked "Your device". docs/drivers.md explains each function. */
#define _POSIX_C_SOURCE 199309L
#include <wholehand/device.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { AXES = 3 };
static const char* const names[AXES] = {"x", "y", "z"};
static const double travel_m[AXES] = {0.06, 0.09, 0.07};
static const double limit_n = 8.0;

struct wh_device {
  wh_host host;
  int enabled, silenced, saturated;
  uint64_t sequence;
  int64_t taken_ns, written_ns;
  int watchdog_ms; /* --driver-settings watchdog_ms=20 */
  /* Your device: these numbers simulate it, a free handle of 0.25 kg. */
  double position[AXES], velocity[AXES], effort[AXES];
};

static int64_t now_ns(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

/* Finds the device; `locator` is the text that the user gave after --device-at. */
static int open_device(const wh_host* host, const char* locator, const char* settings,
                       wh_device** out) {
  wh_device* device;
  if (*locator != 0 && strcmp(locator, "here") != 0) {
    host->say(host->context, "the rails are only to be found \"here\"");
    return WH_FAILED;
  }
  device = calloc(1, sizeof *device);
  if (device == NULL) return WH_FAILED;
  device->host = *host;
  device->watchdog_ms = 20;
  if (*settings != 0 && sscanf(settings, "watchdog_ms=%d", &device->watchdog_ms) != 1) {
    host->say(host->context, "the only setting is watchdog_ms=N");
    free(device);
    return WH_FAILED;
  }
  device->taken_ns = now_ns();
  *out = device;
  return WH_OK;
}

/* Describes the axes of the device. The device file may state lower limits, never higher ones. */
static int describe(wh_device* device, wh_axis* axes, uint32_t capacity, uint32_t* count) {
  uint32_t i;
  *count = AXES;
  for (i = 0; i < AXES && i < capacity; ++i) {
    strcpy(axes[i].name, names[i]);
    axes[i].kind = WH_TRANSLATION;
    axes[i].effort_meaning = WH_EFFORT;
    axes[i].lower = -travel_m[i];
    axes[i].upper = travel_m[i];
    axes[i].effort_limit = limit_n;
    axes[i].resolution = 2e-5;
    axes[i].delay_s = 0.001;
    axes[i].silence_s = device->watchdog_ms * 1e-3;
    axes[i].disabled = WH_BALANCED; /* the rails are horizontal */
  }
  return WH_OK;
}

/* Carries out a verb; may take long, and returns when it is done. */
static int control(wh_device* device, uint32_t verb, double argument) {
  (void)argument;
  switch (verb) {
    case WH_ENABLE:
    case WH_DISABLE:
      memset(device->effort, 0, sizeof device->effort);
      device->enabled = verb == WH_ENABLE;
      device->silenced = device->saturated = 0;
      device->taken_ns = now_ns();
      device->written_ns = 0; /* the watchdog begins with the first command */
      return WH_OK;
    default: return WH_UNSUPPORTED;
  }
}

static void move(wh_device* device, double dt) {
  int i;
  for (i = 0; i < AXES; ++i) {
    device->velocity[i] += dt * (device->effort[i] - 3.0 * device->velocity[i]) / 0.25;
    device->position[i] += dt * device->velocity[i];
    if (device->position[i] > travel_m[i] || device->position[i] < -travel_m[i]) {
      device->position[i] = device->position[i] > 0 ? travel_m[i] : -travel_m[i];
      device->velocity[i] = 0.0;
    }
  }
}

/* Your device: this function simulates its motion up to now, and its watchdog, which checks that
 * commands keep coming. */
static int64_t pass(wh_device* device) {
  const int64_t now = now_ns(), step = 1000000;
  while (device->taken_ns < now) {
    const int64_t left = now - device->taken_ns;
    const int64_t silent = device->taken_ns - device->written_ns;
    if (device->written_ns != 0 && silent > device->watchdog_ms * step) {
      device->silenced = 1; /* until it is enabled again */
      memset(device->effort, 0, sizeof device->effort);
    }
    move(device, (double)(left < step ? left : step) * 1e-9);
    device->taken_ns += left < step ? left : step;
  }
  return now;
}

/* Called in the tick: returns the newest sample without waiting. */
static int read_sample(wh_device* device, wh_sample* sample) {
  const int64_t now = pass(device);
  int i;
  sample->status = WH_HOMED;
  if (device->enabled) sample->status |= WH_ENABLED;
  if (device->silenced) sample->status |= WH_SILENCED;
  if (device->saturated) sample->status |= WH_SATURATED;
  sample->sequence = ++device->sequence;
  sample->monotonic_ns = now;
  sample->valid = (1u << AXES) - 1;
  sample->vendor_code = 0;
  for (i = 0; i < AXES; ++i) sample->position[i] = device->position[i];
  return WH_OK;
}

static int write_command(wh_device* device, const wh_command* command) {
  int i;
  if (!device->enabled || command->axes != AXES) return WH_FAILED;
  for (i = 0; i < AXES; ++i) {
    if (!isfinite(command->effort[i])) return WH_FAILED;
  }
  device->written_ns = pass(device);
  device->saturated = 0;
  if (device->silenced) return WH_OK; /* no effort reaches the motors */
  for (i = 0; i < AXES; ++i) {
    const double asked = command->effort[i];
    device->effort[i] = asked > limit_n ? limit_n : asked < -limit_n ? -limit_n : asked;
    if (device->effort[i] != asked) device->saturated = 1;
  }
  return WH_OK;
}

/* Like WH_ENABLE, but these efforts act from the first moment: they carry the rails' weight. */
static int enable(wh_device* device, const wh_command* neutral) {
  int i;
  control(device, WH_ENABLE, 0.0);
  for (i = 0; i < AXES; ++i) device->effort[i] = neutral->effort[i];
  return WH_OK;
}

static void close_device(wh_device* device) { free(device); }

/* Reports the identity of the device, by which its passport is found. */
static int identify(wh_device* device, wh_identity* identity) {
  (void)device;
  strcpy(identity->serial, "rails-0001");
  strcpy(identity->firmware, "1.0");
  strcpy(identity->sdk, "none");
  return WH_OK;
}

const wh_plugin* wh_plugin_v1(void) {
  static const wh_plugin plugin = {sizeof(wh_plugin), WH_MAJOR, WH_MINOR, WH_NEVER_WAITS,
                                   "rails (an example)", open_device, describe, control,
                                   read_sample, write_command, close_device, identify, enable,
                                   0.0, 0.0};
  return &plugin;
}
