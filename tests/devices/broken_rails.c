/* A driver for tests of the conformance suite: two moving rails, x and y, each a handle of 0.25 kg
 * that nobody holds. The settings "WORD" or "WORD AXIS" name the defect of one axis (y if none is
 * named); "" has no defect, and neither have "weighs" and "rubs". It reports as efforts what was
 * commanded, unless stated otherwise, so that only the motion shows a defect. The rails exist
 * before open and after close. */
#define _POSIX_C_SOURCE 200809L
#include "test_driver.h"

#include <wholehand/device.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { AXES = 2, ENTRIES = 256, STEPS = 512 };
static const int64_t step_ns = 250000;
static const double limit_n = 8.0, travel_m = 0.1, silence_s = 0.05, resolution_m = 1e-5;
static const double mass_kg = 0.25, damping = 3.0;

/* The last commands of the drive: the efforts that it reports (said) and that its motors get
 * (given). */
typedef struct {
  int64_t at_ns;
  double said[AXES], given[AXES];
} entry;

/* State of the rails. */
static struct {
  int64_t at_ns;
  double position[AXES], velocity[AXES], state[AXES];
  double before[STEPS][AXES]; /* positions, one a step */
  uint64_t steps;
  entry commanded[ENTRIES];
  uint64_t entries;
} rails;

struct wh_device {
  char broken[32];
  int axis;
  int enabled, silenced, saturated, deaf;
  uint64_t enables, silences, sequence, commands;
  int64_t opened_ns, written_ns; /* 0: no command since WH_ENABLE */
  double zero[AXES], kept[AXES];
  int64_t kept_ns;
};

static int is(const wh_device* device, const char* word) { return strcmp(device->broken, word) == 0; }
static int on(const wh_device* device, int axis, const char* word) {
  return axis == device->axis && is(device, word);
}

static const entry* last(void) { return &rails.commanded[rails.entries % ENTRIES]; }

static void tell(const entry* next) {
  ++rails.entries;
  rails.commanded[rails.entries % ENTRIES] = *next;
}

/* The command in force at a time. */
static const entry* commanded_at(int64_t at_ns) {
  uint64_t back;
  for (back = 0; back < ENTRIES - 1 && back < rails.entries; ++back) {
    const entry* commanded = &rails.commanded[(rails.entries - back) % ENTRIES];
    if (commanded->at_ns <= at_ns) return commanded;
  }
  return last();
}

/* Goes to neutral. The axis with the defect `word` keeps its effort and does not report it. */
static void let_go(const wh_device* device, int64_t at_ns, const char* word) {
  entry next = *last();
  int i;
  next.at_ns = at_ns;
  for (i = 0; i < AXES; ++i) {
    if (on(device, i, "holds")) continue; /* and reports it */
    next.said[i] = on(device, i, "keeps_saying") ? next.said[i] : 0.0;
    if (!on(device, i, word)) next.given[i] = 0.0;
  }
  tell(&next);
}

static double clamp(double value, double most) {
  return value > most ? most : value < -most ? -most : value;
}

/* Effort of an axis's motor in the step that begins at a time. */
static double motor(const wh_device* device, int i, int64_t at_ns) {
  const double dt = (double)step_ns * 1e-9;
  double effort = commanded_at(on(device, i, "late") ? at_ns - 20000000 : at_ns)->given[i];
  double* const state = &rails.state[i];
  const int powered = device->enabled && !device->silenced;
  if (is(device, "swapped")) effort = commanded_at(at_ns)->given[1 - i];
  if (on(device, i, "coupled")) effort += 0.5 * commanded_at(at_ns)->given[1 - i];
  if (on(device, i, "halved") || on(device, i, "halved_unsaid")) effort *= 0.5;
  if (on(device, i, "turned")) effort = -effort;
  if (on(device, i, "dead")) effort = 0.0;
  if (on(device, i, "weak")) effort = clamp(effort, 0.1 * limit_n);
  if (on(device, i, "one_sided") && effort < 0.0) effort = 0.0;
  if (on(device, i, "both_one_way")) effort = fabs(effort);
  if (on(device, i, "lame_back") && effort < 0.0) effort *= 0.5;
  if (on(device, i, "dead_zone")) effort -= clamp(effort, 0.06 * limit_n);
  if (on(device, i, "millinewton")) effort *= 1e-3;
  if (on(device, i, "smoothed")) effort = *state += (effort - *state) * dt / 0.05;
  if (on(device, i, "slewed")) effort = *state += clamp(effort - *state, 25.0 * dt);
  if (on(device, i, "integrated")) effort = *state = powered ? *state + effort * dt / 0.05 : 0.0;
  if (on(device, i, "pushes") && powered) effort += 1.5;
  if (on(device, i, "forgets") && powered && device->enables > 3) effort -= 3.0;
  return effort;
}

/* Advances in its own steps, however late it is read. */
static void advance(wh_device* device, int64_t now) {
  const double dt = (double)step_ns * 1e-9;
  const int slow = is(device, "patient") && last()->given[device->axis] != 0.0;
  const int locks = is(device, "weighs") || is(device, "forgets"); /* a brake holds while no motor drives */
  const double patience_s = slow ? 5.0 * silence_s : silence_s;
  int i;
  for (; rails.at_ns + step_ns <= now; rails.at_ns += step_ns) {
    const int due = device->enabled && device->written_ns != 0 && !device->silenced &&
                    (double)(rails.at_ns - device->written_ns) * 1e-9 > patience_s;
    if (due && !(is(device, "once") && device->silences > 0)) {
      device->silenced = 1;
      ++device->silences;
      let_go(device, rails.at_ns, "watchdog_bit");
    }
    for (i = 0; i < AXES; ++i) {
      double push = motor(device, i, rails.at_ns) - damping * rails.velocity[i];
      if (is(device, "rubs")) push -= 0.15 * rails.velocity[i] / (fabs(rails.velocity[i]) + 0.002);
      rails.velocity[i] += dt * push / mass_kg;
      if (locks && (!device->enabled || device->silenced)) rails.velocity[i] = 0.0;
      rails.position[i] += dt * rails.velocity[i];
      if (fabs(rails.position[i]) > travel_m) {
        rails.position[i] = clamp(rails.position[i], travel_m);
        rails.velocity[i] = 0.0;
      }
      rails.before[rails.steps % STEPS][i] = rails.position[i];
    }
    ++rails.steps;
  }
}

static int open_device(const wh_host* host, const char* locator, const char* settings,
                       wh_device** out) {
  wh_device* device;
  const char* axis = strchr(settings, ' ');
  if (*locator != 0) {
    host->say(host->context, "there is nothing but \"\"");
    return WH_FAILED;
  }
  device = calloc(1, sizeof *device);
  if (device == NULL) return WH_FAILED;
  strncpy(device->broken, settings, sizeof device->broken - 1);
  device->broken[strcspn(device->broken, " ")] = 0;
  device->axis = axis != NULL && strcmp(axis, " x") == 0 ? 0 : 1;
  device->opened_ns = now_ns();
  if (rails.at_ns == 0) rails.at_ns = device->opened_ns;
  *out = device;
  return WH_OK;
}

static int describe(wh_device* device, wh_axis* axes, uint32_t capacity, uint32_t* count) {
  const rail each = {travel_m, limit_n, resolution_m, 0.001, silence_s};
  (void)device;
  return describe_rails(&each, AXES, axes, capacity, count);
}

static int control(wh_device* device, uint32_t verb, double argument) {
  const int64_t now = now_ns();
  int i;
  (void)argument;
  advance(device, now);
  if (verb != WH_ENABLE && verb != WH_DISABLE) return WH_UNSUPPORTED;
  if (verb == WH_ENABLE) ++device->enables;
  for (i = 0; i < AXES && verb == WH_ENABLE; ++i) {
    if (on(device, i, "rezeroes")) device->zero[i] = rails.position[i] - 0.01;
  }
  device->enabled = verb == WH_ENABLE;
  if (is(device, "remembers") && verb == WH_ENABLE && device->commands > 0) {
    entry next = *last();
    next.at_ns = now;
    next.given[device->axis] = device->kept[device->axis];
    tell(&next);
  } else {
    if (verb == WH_DISABLE && last()->given[device->axis] != 0.0) {
      device->kept[device->axis] = last()->given[device->axis];
    }
    let_go(device, now, verb == WH_DISABLE ? "disable_bit" : "-");
    if (is(device, "tardy_off") && verb == WH_DISABLE) {
      /* The motor follows 0.1 s later. */
      entry next = *last();
      next.given[device->axis] = device->kept[device->axis];
      tell(&next);
      next.at_ns = now + 100000000;
      next.given[device->axis] = 0.0;
      tell(&next);
    }
  }
  device->written_ns = 0;
  device->saturated = 0;
  if (!is(device, "sticky_bit")) device->silenced = 0;
  return WH_OK;
}

static double position(wh_device* device, int i, int64_t now) {
  double q = rails.position[i] - device->zero[i];
  const double stale = rails.before[(rails.steps + STEPS - 76) % STEPS][i]; /* 19 ms */
  if ((is(device, "old") || on(device, i, "old_unsaid")) && rails.steps > 76) q = stale;
  if (is(device, "positions_swapped")) q = rails.position[1 - i];
  if (on(device, i, "millimetre")) q *= 1e3;
  if (on(device, i, "encoder_turned")) q = -q;
  if (on(device, i, "drifts")) q += 0.005 * (double)(now - device->opened_ns) * 1e-9;
  if (on(device, i, "repeats") && fabs(rails.velocity[i]) < 0.02) q = device->kept[i];
  if (on(device, i, "tenth")) {
    if (now - device->kept_ns < 10000000) q = device->kept[i];
    else device->kept_ns = now;
  }
  if (on(device, i, "repeats") || on(device, i, "tenth")) device->kept[i] = q;
  return resolution_m * (double)(int64_t)(q / resolution_m + (q < 0.0 ? -0.5 : 0.5));
}

static int read_sample(wh_device* device, wh_sample* sample) {
  const int64_t now = now_ns();
  const int knows_all = sample->size >= sizeof *sample;
  const int64_t age_ns = is(device, "old") ? 19000000 : 0;
  int i;
  advance(device, now);
  sample->status = WH_HOMED;
  if (device->enabled) sample->status |= WH_ENABLED;
  if (device->silenced) sample->status |= WH_SILENCED;
  if (device->saturated) sample->status |= WH_SATURATED;
  sample->sequence = ++device->sequence;
  sample->monotonic_ns = now - age_ns;
  if (is(device, "fast_clock")) sample->monotonic_ns -= (now - device->opened_ns) / 20;
  sample->valid = (1u << AXES) - 1;
  sample->vendor_code = 0;
  for (i = 0; i < AXES; ++i) {
    const double said = last()->said[i];
    sample->position[i] = position(device, i, now);
    sample->effort[i] = on(device, i, "halved")        ? 0.5 * said
                        : on(device, i, "says_turned") ? -said
                        : on(device, i, "says_other")  ? last()->said[1 - i]
                        : on(device, i, "says_gram")   ? said / 9.81
                        : is(device, "silent")         ? NAN
                                                       : said;
    if (knows_all) sample->temperature_c[i] = 25.0;
  }
  return WH_OK;
}

/* Returns whether a command may be carried out. */
static int sound(const wh_device* device, const wh_command* command) {
  int i;
  if (!device->enabled || command->axes != AXES || device->deaf) return 0;
  for (i = 0; i < AXES; ++i) {
    if (!isfinite(command->effort[i]) && !on(device, i, "nan_taken")) return 0;
  }
  return 1;
}

static int write_command(wh_device* device, const wh_command* command) {
  const int64_t now = now_ns();
  entry next;
  int i;
  advance(device, now);
  if (!sound(device, command)) {
    device->deaf = device->deaf || (is(device, "sulks") && device->enabled);
    return WH_FAILED;
  }
  if (device->silenced) return WH_OK; /* latched */
  device->commands = command->sequence;
  device->saturated = 0;
  next = *last();
  next.at_ns = now;
  for (i = 0; i < AXES; ++i) {
    const double asked = command->effort[i];
    /* The limit holds for the sum of both axes: one axis may use what the other leaves. */
    const double most = is(device, "limits_sum") ? AXES * limit_n : limit_n;
    const int free = on(device, i, "unlimited") || on(device, i, "unlimited_unsaid") ||
                     (on(device, i, "unlimited_back") && asked < 0.0);
    const double clipped = clamp(asked, most);
    const int keeps = asked == 0.0 && on(device, i, "ignores_neutral");
    if (clipped != asked && !on(device, i, "clips_unsaid")) device->saturated = 1;
    if (asked == 0.0 && on(device, i, "holds")) continue;
    next.said[i] = free && !on(device, i, "unlimited_unsaid") ? asked : clipped;
    if (!keeps) next.given[i] = free ? asked : clipped;
    if (!isfinite(asked)) next.said[i] = next.given[i] = 0.5 * limit_n;
  }
  tell(&next);
  device->written_ns = now;
  return WH_OK;
}

static void close_device(wh_device* device) {
  advance(device, now_ns());
  device->enabled = 0;
  let_go(device, rails.at_ns, "outlives");
  free(device);
}

PLUGIN("broken rails", WH_NEVER_WAITS, NULL)
