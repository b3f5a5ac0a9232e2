/* A driver for tests, one of whose calls does not return while a file exists, like a call into a
 * library whose cable was pulled. Settings: "CALL FILE", with CALL one of open, describe, identify,
 * read, write, enable, disable, close. */
#define _POSIX_C_SOURCE 200809L
#include "test_driver.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum { RAILS = 3 };

struct wh_device {
  char call[16], file[1024];
  uint64_t samples;
  int enabled;
  double effort[RAILS];
};

/* Writes into FILE.at when the call was entered [ns, CLOCK_MONOTONIC]. */
static void hang_in(const wh_device* device, const char* call) {
  const struct timespec ms = {0, 1000000};
  char path[sizeof device->file + 4];
  FILE* at;
  if (strcmp(device->call, call) != 0 || access(device->file, F_OK) != 0) return;
  snprintf(path, sizeof path, "%s.at", device->file);
  at = fopen(path, "w");
  if (at != NULL) {
    fprintf(at, "%lld", (long long)now_ns());
    fclose(at);
  }
  while (access(device->file, F_OK) == 0) nanosleep(&ms, NULL);
}

static int open_device(const wh_host* host, const char* locator, const char* settings,
                       wh_device** out) {
  const char* space = strchr(settings, ' ');
  wh_device* device = calloc(1, sizeof *device);
  (void)host, (void)locator;
  if (device == NULL || space == NULL || space - settings >= (long)sizeof device->call) {
    free(device);
    return WH_FAILED;
  }
  memcpy(device->call, settings, (size_t)(space - settings));
  strncpy(device->file, space + 1, sizeof device->file - 1);
  hang_in(device, "open");
  *out = device;
  return WH_OK;
}

static int describe(wh_device* device, wh_axis* axes, uint32_t capacity, uint32_t* count) {
  const rail r = {0.1, 8.0, 1e-5, 0.0005, 2.0};
  hang_in(device, "describe");
  return describe_rails(&r, RAILS, axes, capacity, count);
}

static int control(wh_device* device, uint32_t verb, double argument) {
  (void)argument;
  if (verb != WH_ENABLE && verb != WH_DISABLE) return WH_UNSUPPORTED;
  hang_in(device, verb == WH_ENABLE ? "enable" : "disable");
  device->enabled = verb == WH_ENABLE;
  memset(device->effort, 0, sizeof device->effort);
  return WH_OK;
}

static int read_sample(wh_device* device, wh_sample* sample) {
  int i;
  hang_in(device, "read");
  sample->status = WH_HOMED | (device->enabled ? WH_ENABLED : 0);
  sample->sequence = ++device->samples;
  sample->monotonic_ns = now_ns();
  sample->valid = (1U << RAILS) - 1;
  for (i = 0; i < RAILS; ++i) {
    sample->position[i] = 0.001 * (i + 1);
    sample->effort[i] = device->effort[i];
  }
  return WH_OK;
}

static int write_command(wh_device* device, const wh_command* command) {
  if (!device->enabled) return WH_FAILED;
  hang_in(device, "write");
  memcpy(device->effort, command->effort, sizeof device->effort);
  return WH_OK;
}

static void close_device(wh_device* device) {
  hang_in(device, "close");
  free(device);
}

static int identify(wh_device* device, wh_identity* identity) {
  hang_in(device, "identify");
  strcpy(identity->serial, "hangs-1");
  return WH_OK;
}

PLUGIN("rails that hang", WH_NEVER_WAITS, identify)
