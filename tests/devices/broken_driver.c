/* A driver for tests of the conformance suite: two rails that follow all rules of device.h but the
 * one that the settings name. "moving" breaks no rule: the rails move by themselves. */
#define _POSIX_C_SOURCE 200809L
#include "test_driver.h"

#include <wholehand/device.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { AXES = 2 };
static const double limit_n = 8.0;
static const double silence_s = 0.02;
static const double resolution_m = 1e-5;

struct wh_device {
  wh_host host;
  char broken[32];
  int enabled, silenced, starved;
  uint64_t sequence, commands;
  int64_t opened_ns, written_ns; /* 0: no command since WH_ENABLE */
  double effort[AXES];
  int saturated;
};
static wh_device* only; /* "shared" */

static int is(const wh_device* device, const char* word) {
  return strcmp(device->broken, word) == 0;
}

static void wait_ms(long ms) {
  struct timespec t;
  t.tv_sec = ms / 1000;
  t.tv_nsec = ms % 1000 * 1000000;
  nanosleep(&t, NULL);
}

static int open_device(const wh_host* host, const char* locator, const char* settings,
                       wh_device** out) {
  wh_device* device;
  if (strcmp(settings, "exits") == 0) _exit(7);
  if (*locator != 0) {
    if (strcmp(settings, "mute") != 0) host->say(host->context, "there is nothing but \"\"");
    return WH_FAILED;
  }
  if (strcmp(settings, "shared") == 0 && only != NULL) {
    *out = only;
    return WH_OK;
  }
  device = calloc(1, sizeof *device);
  if (device == NULL) return WH_FAILED;
  device->host = *host;
  strncpy(device->broken, settings, sizeof device->broken - 1);
  device->opened_ns = now_ns();
  device->enabled = is(device, "eager");
  if (is(device, "chatty")) host->say(host->context, "two\nlines");
  if (is(device, "leaks")) (void)!dup(0);
  only = device;
  *out = device;
  return WH_OK;
}

static int describe(wh_device* device, wh_axis* axes, uint32_t capacity, uint32_t* count) {
  const rail sound = {0.1, limit_n, resolution_m, 0.001, silence_s};
  uint32_t i;
  if (is(device, "overfills")) capacity = AXES;
  describe_rails(&sound, AXES, axes, capacity, count);
  for (i = 0; i < AXES && i < capacity; ++i) {
    if (is(device, "twins")) strcpy(axes[i].name, "x");
    if (is(device, "millimetres")) axes[i].lower = -(axes[i].upper = 100.0);
    if (is(device, "inverted")) axes[i].lower = -(axes[i].upper = -0.1);
    if (is(device, "limitless")) axes[i].effort_limit = HUGE_VAL;
    if (is(device, "milliseconds")) axes[i].delay_s = 1.0;
    if (is(device, "unwatched")) axes[i].silence_s = 0.0;
  }
  return WH_OK;
}

static int control(wh_device* device, uint32_t verb, double argument) {
  (void)argument;
  if (verb == WH_DROP_WATCHDOG) {
    device->starved = 1;
    return WH_OK;
  }
  if (verb == WH_DISABLE && !device->enabled && is(device, "strict")) return WH_FAILED;
  if (verb != WH_ENABLE && verb != WH_DISABLE) {
    return is(device, "obliging") ? WH_OK : WH_UNSUPPORTED;
  }
  if (verb == WH_ENABLE || !is(device, "stuck")) device->enabled = verb == WH_ENABLE;
  if (!is(device, "remembers")) memset(device->effort, 0, sizeof device->effort);
  device->written_ns = is(device, "impatient") && verb == WH_ENABLE ? now_ns() : 0;
  device->silenced = device->starved = device->saturated = 0;
  if (!is(device, "rigid")) device->commands = 0;
  return WH_OK;
}

static void watch(wh_device* device, int64_t now) {
  const double silent_s = (double)(now - device->written_ns) * 1e-9;
  const double patience_s = is(device, "tardy") ? 5.0 * silence_s : silence_s;
  const int waits = device->written_ns != 0 && silent_s > patience_s;
  if (is(device, "sleepless")) return;
  if (is(device, "forgiving")) device->silenced = 0;
  if (waits) device->silenced = 1;
  if (device->silenced) memset(device->effort, 0, sizeof device->effort);
}

/* Position of axis i: at rest, or on a slow parabola in steps of the encoder. */
static double place(const wh_device* device, int i, int64_t now) {
  const double t = (double)((now - device->opened_ns) % 1000000000) * 1e-9;
  const double step_m = is(device, "coarse") ? 50.0 * resolution_m : resolution_m;
  if (is(device, "beyond")) return 0.2;
  if (!is(device, "moving") && !is(device, "coarse")) return 0.01 * i;
  return step_m * (double)(int64_t)(0.08 * t * (1.0 - t) / step_m);
}

static void corrupt(const wh_device* device, wh_sample* sample) {
  const uint64_t n = device->sequence;
  if (is(device, "backwards") && n % 50 == 0) sample->sequence -= 2;
  if (is(device, "frozen")) sample->sequence = 1;
  if (is(device, "clock") && n % 50 == 0) sample->monotonic_ns -= 10000000;
  if (is(device, "walltime")) sample->monotonic_ns = (int64_t)time(NULL) * 1000000000;
  if (is(device, "nan") && n > 30) sample->position[1] = NAN;
  if (is(device, "missing") && n > 30) sample->valid = 1;
  if (is(device, "ghosts")) sample->valid |= 1u << AXES;
  if (is(device, "hot")) sample->temperature_c[0] = 4000.0;
  if (is(device, "codeless")) sample->status |= WH_DRIVE_FAULT;
}

static void misbehave(wh_device* device) {
  const int late = device->sequence > 5;
  volatile double work = 0.0;
  int i;
  if (is(device, "blocks")) wait_ms(50);
  if (is(device, "sleeps")) wait_ms(1);
  if (is(device, "hangs") && late) wait_ms(3600000);
  if (is(device, "crashes") && late) *(volatile int*)0 = 1;
  if (is(device, "allocates")) free(malloc(64 + (size_t)device->sequence % 7));
  if (is(device, "talks")) device->host.say(device->host.context, "a sample");
  for (i = 0; is(device, "computes") && i < 1000000; ++i) work += i;
  if (is(device, "forks") && late && fork() == 0) {
    sleep(5);
    _exit(0);
  }
}

static int read_sample(wh_device* device, wh_sample* sample) {
  const int64_t now = now_ns();
  const int knows_all = sample->size >= sizeof *sample || is(device, "oversized");
  int i;
  misbehave(device);
  watch(device, now);
  if (is(device, "hollow") && device->sequence % 2 == 1) {
    sample->sequence = device->sequence++;
    memset(sample->position, 0, sizeof sample->position);
    sample->valid = 0;
    return WH_NOTHING_NEW;
  }
  sample->status = WH_HOMED;
  if (device->enabled) sample->status |= WH_ENABLED;
  if (device->silenced) sample->status |= WH_SILENCED;
  if (device->saturated) sample->status |= WH_SATURATED;
  sample->sequence = ++device->sequence;
  sample->monotonic_ns = is(device, "stale") ? now - 100000000 : now;
  sample->valid = (1u << AXES) - 1;
  sample->vendor_code = 0;
  for (i = 0; i < AXES; ++i) {
    sample->position[i] = place(device, i, now);
    sample->effort[i] = is(device, "reversed") ? -device->effort[i] : device->effort[i];
    if (knows_all) sample->temperature_c[i] = 25.0;
  }
  corrupt(device, sample);
  return WH_OK;
}

/* Returns whether a command may be carried out. */
static int sound(const wh_device* device, const wh_command* command) {
  uint32_t i;
  if (!device->enabled && !is(device, "willing")) return 0;
  if (command->axes != AXES && !is(device, "countless")) return 0;
  if (command->sequence <= device->commands) return 0;
  for (i = 0; i < AXES; ++i) {
    if (!isfinite(command->effort[i]) && !is(device, "gullible")) return 0;
  }
  return 1;
}

static int write_command(wh_device* device, const wh_command* command) {
  int i;
  if (is(device, "ponders")) wait_ms(1);
  if (!sound(device, command)) return WH_FAILED;
  device->commands = command->sequence;
  device->saturated = 0;
  for (i = 0; i < AXES; ++i) {
    double effort = command->effort[i];
    if (fabs(effort) > limit_n && !is(device, "unclipped")) {
      effort = effort > 0.0 ? limit_n : -limit_n;
      device->saturated = 1;
    }
    device->effort[i] = effort;
  }
  if (!device->starved || is(device, "undroppable")) device->written_ns = now_ns();
  return WH_OK;
}

static void close_device(wh_device* device) {
  if (is(device, "shared")) return;
  if (only == device) only = NULL;
  free(device);
}

PLUGIN("broken", WH_NEVER_WAITS, NULL)
