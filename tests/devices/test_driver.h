/* Common parts of the drivers for tests. Define _POSIX_C_SOURCE first. */
#pragma once

#include <stdint.h>
#include <string.h>
#include <time.h>
#include <wholehand/device.h>

static inline int64_t now_ns(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

/* Describes up to three rails x, y, z with a watchdog; in m, N and s. */
typedef struct {
  double travel, effort_limit, resolution, delay, silence;
} rail;

static inline int describe_rails(const rail* r, uint32_t rails, wh_axis* axes, uint32_t capacity,
                                 uint32_t* count) {
  uint32_t i;
  *count = rails;
  for (i = 0; i < rails && i < capacity; ++i) {
    axes[i].name[0] = (char)('x' + (int)i);
    axes[i].name[1] = 0;
    axes[i].kind = WH_TRANSLATION;
    axes[i].effort_meaning = WH_EFFORT;
    axes[i].lower = -r->travel;
    axes[i].upper = r->travel;
    axes[i].effort_limit = r->effort_limit;
    axes[i].resolution = r->resolution;
    axes[i].delay_s = r->delay;
    axes[i].silence_s = r->silence;
  }
  return WH_OK;
}

/* The plugin that consists of the functions above. */
#define PLUGIN(name, flags, identify)                                      \
  const wh_plugin* wh_plugin_v1(void) {                                    \
    static const wh_plugin plugin = {                                      \
        sizeof(wh_plugin), WH_MAJOR, WH_MINOR, flags,       name,          \
        open_device,       describe, control,  read_sample, write_command, \
        close_device,      identify, NULL,     0.0,         0.0};          \
    return &plugin;                                                        \
  }
