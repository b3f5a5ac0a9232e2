/* A driver for tests: one rail that a person holds while it is disabled. Its settings name a file
 * of seven doubles shared with the test. Written by the test: 0: where the person holds it [m], 1:
 * emergency stop pressed, 2: how long WH_ENABLE takes [s]. Written by the driver: 3: enabled, 4:
 * effort [N], 5: position [m], 6: largest effort so far [N]. */
#define _POSIX_C_SOURCE 200809L
#include "test_driver.h"

#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>
#include <wholehand/device.h>

enum { HAND, STOP, ENABLE_TAKES, ENABLED, EFFORT, POSITION, LARGEST, SHARED };

struct wh_device {
  volatile double* shared;
  double position, velocity;
  int silenced;
  uint64_t sequence;
  int64_t taken_ns, written_ns;
};

static const double silence_s = 1.0; /* the machine of a test may stall */

static int open_device(const wh_host* host, const char* locator, const char* settings,
                       wh_device** out) {
  wh_device* device = calloc(1, sizeof *device);
  const int file = open(settings, O_RDWR);
  (void)locator;
  if (device == NULL || file < 0) {
    host->say(host->context, "the settings name no file");
    free(device);
    return WH_FAILED;
  }
  device->shared = mmap(NULL, SHARED * sizeof(double), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  close(file);
  device->taken_ns = now_ns();
  *out = device;
  return WH_OK;
}

static int describe(wh_device* device, wh_axis* axes, uint32_t capacity, uint32_t* count) {
  const rail each = {0.06, 8.0, 2e-5, 0.001, silence_s};
  (void)device;
  return describe_rails(&each, 1, axes, capacity, count);
}

static int control(wh_device* device, uint32_t verb, double argument) {
  struct timespec takes = {0, 0};
  (void)argument;
  if (verb != WH_ENABLE && verb != WH_DISABLE) return WH_UNSUPPORTED;
  if (verb == WH_ENABLE) {
    const double takes_s = device->shared[ENABLE_TAKES];
    if (device->shared[STOP] != 0.0) return WH_FAILED;
    takes.tv_sec = (time_t)takes_s;
    takes.tv_nsec = (long)((takes_s - (double)takes.tv_sec) * 1e9);
    nanosleep(&takes, NULL);
  }
  device->silenced = 0;
  device->written_ns = 0;
  device->velocity = 0.0;
  device->taken_ns = now_ns();
  device->shared[EFFORT] = 0.0;
  device->shared[ENABLED] = verb == WH_ENABLE;
  return WH_OK;
}

static void move(wh_device* device) {
  const int64_t now = now_ns();
  double left = (double)(now - device->taken_ns) * 1e-9;
  device->taken_ns = now;
  if (device->shared[ENABLED] == 0.0) {
    device->position = device->shared[HAND];
    return;
  }
  for (; left > 0.0; left -= 1e-3) {
    const double dt = left < 1e-3 ? left : 1e-3;
    device->velocity += dt * (device->shared[EFFORT] - 3.0 * device->velocity) / 0.25;
    device->position += dt * device->velocity;
    if (fabs(device->position) > 0.061) {
      device->position = copysign(0.061, device->position);
      device->velocity = 0.0;
    }
  }
}

static int read_sample(wh_device* device, wh_sample* sample) {
  move(device);
  if (device->shared[STOP] != 0.0) device->shared[ENABLED] = device->shared[EFFORT] = 0.0;
  if (device->written_ns != 0 && (double)(now_ns() - device->written_ns) > 1e9 * silence_s) {
    device->silenced = 1;
    device->shared[EFFORT] = 0.0;
  }
  sample->status = WH_HOMED;
  if (device->shared[ENABLED] != 0.0) sample->status |= WH_ENABLED;
  if (device->silenced) sample->status |= WH_SILENCED;
  device->shared[POSITION] = device->position;
  sample->sequence = ++device->sequence;
  sample->monotonic_ns = device->taken_ns;
  sample->valid = 1;
  sample->vendor_code = 0;
  sample->position[0] = 2e-5 * round(device->shared[POSITION] / 2e-5);
  return WH_OK;
}

static int write_command(wh_device* device, const wh_command* command) {
  if (device->shared[ENABLED] == 0.0 || device->silenced || !isfinite(command->effort[0])) {
    return WH_FAILED;
  }
  device->shared[EFFORT] = command->effort[0];
  if (fabs(command->effort[0]) > device->shared[LARGEST]) {
    device->shared[LARGEST] = fabs(command->effort[0]);
  }
  device->written_ns = now_ns();
  return WH_OK;
}

static void close_device(wh_device* device) {
  device->shared[ENABLED] = device->shared[EFFORT] = 0.0;
  munmap((void*)device->shared, SHARED * sizeof(double));
  free(device);
}

static int identify(wh_device* device, wh_identity* identity) {
  (void)device;
  strcpy(identity->serial, "H-1");
  strcpy(identity->firmware, "1.0");
  strcpy(identity->sdk, "none");
  return WH_OK;
}

PLUGIN("handled", WH_NEVER_WAITS, identify)
