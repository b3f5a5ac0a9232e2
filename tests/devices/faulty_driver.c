/* A driver for tests that behaves as its settings say: "drive@40" reports a drive fault from the
 * 40th sample on, "weak" states a smaller effort limit. Defects of the shared object itself are
 * chosen when it is built. */
#define _POSIX_C_SOURCE 200809L
#include <wholehand/device.h>

#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { AXES = 4 };
/* The axes are in another order than in the device file, with one axis more. */
static const char* const names[AXES] = {"z", "roll", "y", "x"};

struct wh_device {
  char settings[128];
  uint64_t at; /* sample from which the settings hold */
  uint64_t samples, commands;
  int enabled;
  double effort[AXES];
  struct timespec taken;
};

static int is(const wh_device* device, const char* word) {
  return device->samples >= device->at && strcmp(device->settings, word) == 0;
}

static int open_device(const wh_host* host, const char* locator, const char* settings,
                       wh_device** out) {
  wh_device* device;
  char* at;
  if (strcmp(locator, "nowhere") == 0) {
    host->say(host->context, "nothing answers");
    return WH_FAILED;
  }
  device = calloc(1, sizeof *device);
  if (device == NULL) return WH_FAILED;
  strncpy(device->settings, settings, sizeof device->settings - 1);
  at = strchr(device->settings, '@');
  if (at != NULL) {
    *at = 0;
    device->at = strtoull(at + 1, NULL, 10);
  }
  *out = device;
  return WH_OK;
}

static int describe(wh_device* device, wh_axis* axes, uint32_t capacity, uint32_t* count) {
  uint32_t i;
  *count = is(device, "many") ? 17 : is(device, "axisless") ? 0 : AXES;
  for (i = 0; i < AXES && i < capacity; ++i) {
    const int last = i == AXES - 1; /* x */
    strcpy(axes[i].name, last && is(device, "nameless") ? "w" : names[i]);
    axes[i].kind = i == 1 || (last && is(device, "turning")) ? WH_ROTATION : WH_TRANSLATION;
    axes[i].effort_meaning = last && is(device, "brake") ? WH_BRAKE : WH_EFFORT;
    axes[i].lower = last && is(device, "short") ? -0.01 : -0.1;
    axes[i].upper = 0.1;
    axes[i].effort_limit = last && is(device, "weak") ? 1.0 : 8.0;
    axes[i].resolution = last && is(device, "coarse") ? 1e-3 : 1e-5;
    axes[i].delay_s = last && is(device, "slow") ? 0.005 : 0.001;
    axes[i].silence_s = last && is(device, "deaf") ? 0.0 : 0.02;
  }
  return WH_OK;
}

static int control(wh_device* device, uint32_t verb, double argument) {
  (void)argument;
  if (verb != WH_ENABLE && verb != WH_DISABLE) return WH_UNSUPPORTED;
  if (verb == WH_ENABLE && is(device, "locked")) return WH_FAILED;
  device->enabled = verb == WH_ENABLE;
  memset(device->effort, 0, sizeof device->effort);
  return WH_OK;
}

/* Each axis has its own position and reports the commanded effort as measured. */
static int read_sample(wh_device* device, wh_sample* sample) {
  const struct timespec fifty_ms = {0, 50000000};
  uint64_t n = ++device->samples;
  int i;
  if (is(device, "unplug")) return WH_FAILED;
  if (is(device, "crashes")) abort();
  if (is(device, "blocks")) nanosleep(&fifty_ms, NULL);
  if (is(device, "forks") && n == device->at && fork() == 0) {
    sleep(5);
    _exit(0);
  }
  sample->status = WH_HOMED | (device->enabled ? WH_ENABLED : 0);
  if (is(device, "unhomed")) sample->status &= ~(uint32_t)WH_HOMED;
  if (is(device, "enable")) sample->status &= ~(uint32_t)WH_ENABLED;
  if (is(device, "drive")) sample->status |= WH_DRIVE_FAULT;
  if (is(device, "silenced")) sample->status |= WH_SILENCED;
  if (is(device, "hot")) sample->status |= WH_HOT;
  if (is(device, "frozen")) n = device->at;
  sample->sequence = is(device, "backwards") ? 1000000 - n : 1000000 + n;
  if (!is(device, "frozen")) clock_gettime(CLOCK_MONOTONIC, &device->taken);
  sample->monotonic_ns = (int64_t)device->taken.tv_sec * 1000000000 + device->taken.tv_nsec;
  if (is(device, "clock")) sample->monotonic_ns = 1000000;
  sample->valid = is(device, "missing") ? 7 : 15;
  sample->vendor_code = 42;
  for (i = 0; i < AXES; ++i) {
    const double nan = 0.0 * strtod("inf", NULL);
    sample->position[i] = is(device, "nan") ? nan : 0.001 * (i + 1);
    sample->effort[i] = device->effort[i];
  }
  return WH_OK;
}

#ifndef WITHOUT_WRITE
static int write_command(wh_device* device, const wh_command* command) {
  if (!device->enabled || is(device, "refuse")) return WH_FAILED;
  if (command->sequence <= device->commands && device->commands != 0) return WH_FAILED;
  device->commands = command->sequence;
  memcpy(device->effort, command->effort, sizeof device->effort);
  return WH_OK;
}
#endif

static void close_device(wh_device* device) { free(device); }

/* "anonymous" does not know its device's identity. */
static int identify(wh_device* device, wh_identity* identity) {
  if (is(device, "anonymous")) return WH_FAILED;
  strcpy(identity->serial, is(device, "other") ? "S-2" : "S-1");
  strcpy(identity->firmware, is(device, "updated") ? "2.0" : "1.0");
  strcpy(identity->sdk, is(device, "sdk") ? "8" : "7");
  return WH_OK;
}

#ifndef SYMBOL
#define SYMBOL wh_plugin_v1
#endif
#ifndef MAJOR
#define MAJOR WH_MAJOR
#endif
#ifndef FLAGS
#define FLAGS WH_NEVER_WAITS
#endif
#ifdef OLDER /* built with device.h of 1.0 */
#define SIZE offsetof(wh_plugin, identify)
#endif
#ifndef SIZE
#define SIZE sizeof(wh_plugin)
#endif
#ifdef WITHOUT_WRITE
#define write_command 0
#endif
const wh_plugin* SYMBOL(void) {
  static const wh_plugin plugin = {SIZE, MAJOR, WH_MINOR, FLAGS, "faulty", open_device, describe,
                                   control, read_sample, write_command, close_device, identify, NULL,
                                   0.0, 0.0};
  return &plugin;
}
