/* A driver for tests: three rails that somebody pushes to and fro by 2 cm, from 3 s after they were
 * enabled, so that the loop pushes back. The person stops if nothing pushes back for 0.1 s. Stores
 * every effort with its time in the file that the settings name: int64 CLOCK_MONOTONIC [ns], three
 * doubles [N]. It may wait, so only a host accepts it. */
#define _POSIX_C_SOURCE 200809L
#include "test_driver.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <wholehand/device.h>

enum { AXES = 3, FLUSH_EVERY = 64 };

struct wh_device {
  FILE* kept;
  int enabled;
  int64_t enabled_ns, pushed_back_ns;
  int left;
  uint64_t samples, commands;
};

static int open_device(const wh_host* host, const char* locator, const char* settings,
                       wh_device** out) {
  wh_device* device = calloc(1, sizeof *device);
  (void)locator;
  if (device == NULL) return WH_FAILED;
  device->kept = fopen(settings, "wb");
  if (device->kept == NULL) {
    host->say(host->context, "cannot write the file of the settings");
    free(device);
    return WH_FAILED;
  }
  *out = device;
  return WH_OK;
}

static int describe(wh_device* device, wh_axis* axes, uint32_t capacity, uint32_t* count) {
  const rail each = {0.1, 8.0, 2e-5, 0.0005, 0.02};
  (void)device;
  return describe_rails(&each, AXES, axes, capacity, count);
}

static int control(wh_device* device, uint32_t verb, double argument) {
  (void)argument;
  if (verb != WH_ENABLE && verb != WH_DISABLE) return WH_UNSUPPORTED;
  device->enabled = verb == WH_ENABLE;
  device->enabled_ns = now_ns();
  device->left = 0;
  fflush(device->kept);
  return WH_OK;
}

/* Moves to and fro twice a second, in parabolas. */
static double place(int64_t since_ns) {
  const double p = (double)(since_ns % 500000000) * 4e-9 - 1.0; /* -1 .. 1 */
  return 4.0 * p * (1.0 - (p < 0 ? -p : p));
}

static int read_sample(wh_device* device, wh_sample* sample) {
  const int64_t now = now_ns();
  const int64_t since_ns = now - device->enabled_ns - INT64_C(3000000000);
  int i;
  if (since_ns > INT64_C(300000000) && now - device->pushed_back_ns > INT64_C(100000000)) {
    device->left = 1;
  }
  sample->status = WH_HOMED | (device->enabled ? WH_ENABLED : 0);
  sample->sequence = ++device->samples;
  sample->monotonic_ns = now;
  sample->valid = 7;
  sample->vendor_code = 0;
  for (i = 0; i < AXES; ++i) {
    const int64_t own_ns = since_ns - i * INT64_C(83000000); /* never all at rest */
    /* At rest before it is enabled, so that enabling causes no jump. */
    sample->position[i] = device->enabled && !device->left && own_ns > 0 ? 0.02 * place(own_ns) : 0.0;
  }
  return WH_OK;
}

static int write_command(wh_device* device, const wh_command* command) {
  const int64_t now = now_ns();
  int i;
  if (!device->enabled) return WH_FAILED;
  for (i = 0; i < AXES; ++i) {
    if (command->effort[i] != 0.0) device->pushed_back_ns = now;
  }
  fwrite(&now, sizeof now, 1, device->kept);
  fwrite(command->effort, sizeof(double), AXES, device->kept);
  if (++device->commands % FLUSH_EVERY == 0) fflush(device->kept);
  return WH_OK;
}

static void close_device(wh_device* device) {
  fclose(device->kept);
  free(device);
}

PLUGIN("pushed", 0, NULL)
