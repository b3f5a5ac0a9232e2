/* A dishonest driver for tests: three rails of desktop-3axis on a simulated clock, whose motors do
 * not give what was sent. The setting names the lie (the table at the end of the lies); "" is
 * honest. It says whatever was sent, so that only the motion shows the lie. A lie that grows begins
 * late: 30 s after enabling, at the 40th enabling, or above an effort. */
#define _POSIX_C_SOURCE 200809L
#include "liar.h"
#include "test_driver.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <wholehand/device.h>

enum { AXES = LIAR_AXES, STEPS = 10, LATE = 32 };
static const double pi = 3.14159265358979323846;
static const double mass_kg = 0.25, damping = 3.0, friction_n = 0.1, limit_n = 8.0;
static const double travel_m[AXES] = {0.0505, 0.0808, 0.0606};
static const double range_m[AXES] = {0.05, 0.08, 0.06}, step_m = 2e-5, silence_s = 0.02;

static liar_truth truth = {1000000000, 0, 0, {0}, {0}, {0}, 0, 0, 0, {0}, 0};
static struct {
  double sent[LATE][AXES]; /* a ring, newest at `newest` */
  int newest;
  int enabled, silenced, dropped, written;
  int64_t enabled_ns, written_ns;
  double state[AXES];
} drive;

typedef struct moment {
  double on_s;  /* time since enabling */
  int enables;
  double v;     /* speed of the axis */
} moment;
/* Effort of the motor of an axis for the efforts that arrive. */
typedef double (*law)(int axis, const double* sent, const moment* at);

static double clip(double value, double most) {
  return value > most ? most : value < -most ? -most : value;
}
static int late(const moment* at) { return at->on_s > 30.0; }
static int worn(const moment* at) { return at->enables > 40; }
static double ago(int axis, int ms) { return drive.sent[(drive.newest - ms + 2 * LATE) % LATE][axis]; }

#define LAW(name) static double name(int i, const double* u, const moment* at)
#define IGNORE ((void)at)
LAW(honest) { IGNORE; return u[i]; }
/* From the beginning. */
LAW(turned) { IGNORE; return -u[i]; }
LAW(swapped) { IGNORE; return i < 2 ? u[1 - i] : u[i]; }
LAW(coupled) { IGNORE; return u[i] + 0.5 * u[(i + 1) % AXES]; }
LAW(halved) { IGNORE; return 0.5 * u[i]; }
LAW(doubled) { IGNORE; return 2.0 * u[i]; }
LAW(dead) { (void)i; (void)u; IGNORE; return 0.0; }
LAW(weak) { IGNORE; return clip(u[i], 0.8); }
LAW(one_sided) { IGNORE; return u[i] < 0.0 ? 0.0 : u[i]; }
LAW(both_one_way) { IGNORE; return fabs(u[i]); }
LAW(lame_back) { IGNORE; return u[i] < 0.0 ? 0.5 * u[i] : u[i]; }
LAW(dead_zone) { IGNORE; return u[i] - clip(u[i], 0.5); }
LAW(millinewton) { IGNORE; return 1e-3 * u[i]; }
LAW(smoothed) { IGNORE; return drive.state[i] += (u[i] - drive.state[i]) * 1e-4 / 0.05; }
LAW(slewed) { IGNORE; return drive.state[i] += clip(u[i] - drive.state[i], 25e-4); }
LAW(integrated) { IGNORE; return drive.state[i] += u[i] * 1e-4 / 0.05; }
LAW(pushes) { IGNORE; return u[i] + 1.5; }
LAW(tardy) { (void)u; IGNORE; return ago(i, 20); }
LAW(shakes) { return u[i] + 1.5 * sin(2.0 * pi * 20.0 * at->on_s); }
LAW(pumps) { return u[i] + 5.0 * at->v; }
/* Growing. */
LAW(flips_late) { return late(at) ? -u[i] : u[i]; }
LAW(exchanges_worn) { return worn(at) && i < 2 ? u[1 - i] : u[i]; }
LAW(thrice_above_quarter) { IGNORE; return fabs(u[i]) > 0.25 * limit_n ? 3.0 * u[i] : u[i]; }
LAW(clips_at_half) { IGNORE; return clip(u[i], 0.5 * limit_n); }
LAW(flips_worn) { return worn(at) ? -u[i] : u[i]; }
LAW(flips_above_half) { IGNORE; return fabs(u[i]) > 0.5 * limit_n ? -u[i] : u[i]; }
LAW(flips_z_late) { return late(at) && i == 2 ? -u[i] : u[i]; }
LAW(one_sided_late) { return late(at) && u[i] < 0.0 ? 0.0 : u[i]; }
LAW(one_way_late) { return late(at) ? fabs(u[i]) : u[i]; }
LAW(one_way_above_third) { IGNORE; return u[i] < -limit_n / 3.0 ? -u[i] : u[i]; }
LAW(dies_late) { return late(at) ? 0.0 : u[i]; }
LAW(tardy_late) { return late(at) ? ago(i, 20) : u[i]; }
LAW(coupled_worn) { return worn(at) && i < 2 ? u[i] + u[1 - i] : u[i]; }
LAW(stays_above_half) { /* keeps its effort once above half the limit, until it is below a tenth */
  IGNORE;
  if (fabs(u[i]) > 0.5 * limit_n) drive.state[i] = u[i];
  if (fabs(u[i]) < 0.1 * limit_n) drive.state[i] = 0.0;
  return drive.state[i] != 0.0 ? drive.state[i] : u[i];
}
LAW(smoothed_late) {
  drive.state[i] += (u[i] - drive.state[i]) * 1e-4 / 0.05;
  return late(at) ? drive.state[i] : u[i];
}
LAW(thrice_late) { return late(at) ? 3.0 * u[i] : u[i]; }
LAW(gains_late) { return late(at) ? u[i] * fmin(3.0, 1.0 + 0.1 * (at->on_s - 30.0)) : u[i]; }
LAW(leans_late) { return late(at) ? u[i] + fmin(3.0, 0.2 * (at->on_s - 30.0)) : u[i]; }
LAW(pumps_late) { return late(at) ? u[i] + 12.0 * at->v : u[i]; }
LAW(attracts_late) { return late(at) ? u[i] + 150.0 * truth.position[i] : u[i]; }
LAW(shakes_late) { return late(at) ? u[i] + 3.0 * sin(2.0 * pi * 8.0 * at->on_s) : u[i]; }

static const struct {
  const char* name;
  law gives;
} lies[] = {
#define LIE(name) {#name, name}
    {"", honest}, LIE(turned), LIE(swapped), LIE(coupled), LIE(halved), LIE(doubled), LIE(dead),
    LIE(weak), LIE(one_sided), LIE(both_one_way), LIE(lame_back), LIE(dead_zone), LIE(millinewton),
    LIE(smoothed), LIE(slewed), LIE(integrated), LIE(pushes), LIE(tardy), LIE(shakes), LIE(pumps),
    LIE(flips_late), LIE(exchanges_worn), LIE(thrice_above_quarter), LIE(clips_at_half),
    LIE(flips_worn), LIE(flips_above_half), LIE(flips_z_late), LIE(one_sided_late),
    LIE(one_way_late), LIE(one_way_above_third), LIE(dies_late), LIE(tardy_late), LIE(coupled_worn),
    LIE(stays_above_half), LIE(smoothed_late), LIE(thrice_late), LIE(gains_late), LIE(leans_late),
    LIE(pumps_late), LIE(attracts_late), LIE(shakes_late)};

struct wh_device {
  law gives;
  uint64_t samples;
};
static law gives = honest;

liar_truth* liar(void) { return &truth; }

static void move(int i, const double* sent, double h) {
  const moment at = {(double)(truth.now_ns - drive.enabled_ns) * 1e-9, truth.enables,
                     truth.velocity[i]};
  const int powered = drive.enabled && !drive.silenced;
  const double motor = powered ? gives(i, sent, &at) : 0.0;
  const double moved = mass_kg + truth.limb_mass;
  const double limb = truth.limb_stiffness * (truth.rest[i] - truth.position[i]) -
                      truth.limb_damping * truth.velocity[i];
  const double push = motor + limb + truth.pull[i] - damping * truth.velocity[i];
  const double v = truth.velocity[i] + h * push / moved;
  const double rubs = h * friction_n / moved;
  double next = fabs(v) <= rubs ? 0.0 : v - (v > 0.0 ? rubs : -rubs);
  if (!powered && truth.limb_mass == 0.0) next = 0.0; /* it locks */
  if (fabs(motor - sent[i]) > 1e-9) truth.work_j += motor * 0.5 * (truth.velocity[i] + next) * h;
  truth.velocity[i] = next;
  truth.position[i] += h * next;
  if (fabs(truth.position[i]) > travel_m[i]) {
    truth.position[i] = clip(truth.position[i], travel_m[i]);
    truth.velocity[i] = 0.0;
  }
}

void liar_pass(void) {
  const double h = 1e-3 / STEPS;
  double arrives[AXES];
  int i, j;
  for (i = 0; i < AXES; ++i) arrives[i] = ago(i, 1);
  if (drive.written && (double)(truth.now_ns - drive.written_ns) * 1e-9 > silence_s) drive.silenced = 1;
  if (truth.stop_pressed) drive.enabled = 0;
  for (j = 0; j < STEPS; ++j) {
    for (i = 0; i < AXES; ++i) move(i, arrives, h);
  }
  truth.now_ns += 1000000;
  i = drive.newest;
  drive.newest = (drive.newest + 1) % LATE;
  memcpy(drive.sent[drive.newest], drive.sent[i], sizeof drive.sent[i]);
}

static int open_device(const wh_host* host, const char* locator, const char* settings,
                       wh_device** out) {
  wh_device* device = calloc(1, sizeof *device);
  size_t k;
  (void)locator;
  if (device == NULL) return WH_FAILED;
  for (k = 0; k < sizeof lies / sizeof *lies; ++k) {
    if (strcmp(lies[k].name, settings) == 0) device->gives = lies[k].gives;
  }
  if (device->gives == NULL) {
    host->say(host->context, "knows no such lie");
    free(device);
    return WH_FAILED;
  }
  gives = device->gives;
  memset(&drive, 0, sizeof drive);
  memset(&truth, 0, sizeof truth);
  truth.now_ns = 1000000000;
  *out = device;
  return WH_OK;
}

static int describe(wh_device* device, wh_axis* axes, uint32_t capacity, uint32_t* count) {
  const rail each = {0.1, 8.0, 2e-5, 0.001, 0.02};
  uint32_t i;
  (void)device;
  describe_rails(&each, AXES, axes, capacity, count);
  for (i = 0; i < AXES && i < capacity; ++i) {
    axes[i].lower = -range_m[i];
    axes[i].upper = range_m[i];
    axes[i].disabled = WH_LOCKS;
  }
  return WH_OK;
}

static int control(wh_device* device, uint32_t verb, double argument) {
  (void)device;
  (void)argument;
  if (verb == WH_DROP_WATCHDOG) {
    drive.dropped = 1;
    return WH_OK;
  }
  if (verb != WH_ENABLE && verb != WH_DISABLE) return WH_UNSUPPORTED;
  if (verb == WH_ENABLE && truth.stop_pressed) return WH_FAILED;
  memset(drive.sent, 0, sizeof drive.sent);
  memset(drive.state, 0, sizeof drive.state);
  drive.enabled = verb == WH_ENABLE;
  drive.silenced = drive.dropped = drive.written = 0;
  drive.enabled_ns = truth.now_ns;
  if (drive.enabled) ++truth.enables;
  return WH_OK;
}

static int read_sample(wh_device* device, wh_sample* sample) {
  int i;
  sample->status = WH_HOMED | (drive.enabled ? WH_ENABLED : 0) | (drive.silenced ? WH_SILENCED : 0);
  sample->sequence = ++device->samples;
  sample->monotonic_ns = truth.now_ns;
  sample->valid = (1u << AXES) - 1;
  sample->vendor_code = 0;
  for (i = 0; i < AXES; ++i) {
    sample->position[i] = step_m * floor(truth.position[i] / step_m + 0.5);
    sample->effort[i] = drive.sent[drive.newest][i]; /* whatever the motor gives */
  }
  return WH_OK;
}

static int write_command(wh_device* device, const wh_command* command) {
  (void)device;
  if (!drive.enabled) return WH_FAILED;
  if (!drive.dropped) drive.written_ns = truth.now_ns;
  drive.written = 1;
  memcpy(drive.sent[drive.newest], command->effort, sizeof drive.sent[0]);
  return WH_OK;
}

static void close_device(wh_device* device) { free(device); }

static int identify(wh_device* device, wh_identity* identity) {
  (void)device;
  strcpy(identity->serial, "liar-1");
  return WH_OK;
}

PLUGIN("liar", WH_NEVER_WAITS, identify)
