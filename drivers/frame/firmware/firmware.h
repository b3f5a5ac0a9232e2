/* Reference firmware of a device that uses the frame: C99, without malloc, clock or I/O of its own.
 * A board passes bytes and time to it, returns positions and receives efforts.
 *
 * It guarantees, whatever the program does:
 *   - no effort exceeds the axis's limit, and every effort is finite;
 *   - a disabled device is at neutral;
 *   - each command must be followed by another within `silence_us`. Otherwise the firmware releases:
 *     all axes go to neutral together by the same smoothstep over 80 ms, and no effort ever rises.
 *     Samples then have WH_SILENCED, and no command is obeyed until WH_ENABLE;
 *   - it releases in the same way after a command that is not finite or has another number of axes;
 *   - nothing is done twice: a copy of an answered question gets the same answer and has no effect,
 *     and a command from before WH_ENABLE is not obeyed afterwards. */
#ifndef WHOLEHAND_FIRMWARE_H
#define WHOLEHAND_FIRMWARE_H

#include "frame.h"

#include <wholehand/device.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { FW_RAMP_US = 80000, FW_TICK_US = 1000 };
/* Longest time from WH_ENABLE to the first command, while the program locks memory and starts its
 * loop. */
enum { FW_FIRST_COMMAND_US = 2000000 };

typedef struct {
  float position[WF_MAX_AXES]; /* [m or rad] */
  float effort[WF_MAX_AXES];   /* measured [N or N.m]; unchanged: not known */
  uint32_t valid;              /* bit i: position[i] was measured */
  uint32_t status;             /* WH_HOMED, WH_DRIVE_FAULT, and other bits of device.h */
  int32_t vendor_code;
} fw_state;

/* Description and functions of a board. Only `control`, which is called at neutral, may wait. */
typedef struct {
  void* context;
  char name[WF_NAME], serial[WF_NAME], firmware[WF_NAME]; /* as in WF_WELCOME */
  uint8_t axes;
  /* delay_s: delay of the line and the motors plus two periods of firmware_tick: a command waits
   * for a tick, and a sample is up to a tick old when the next one comes. */
  wf_axis axis[WF_MAX_AXES];
  float neutral[WF_MAX_AXES]; /* balances the axis's own weight [N or N.m] */
  uint32_t silence_us;        /* e.g. 20,000; equal to every axis's silence_s */
  void (*measure)(void* context, fw_state* state);
  /* Applies efforts to the motors; `on` is 0 while the device is disabled. */
  void (*drive)(void* context, const float* effort, int on);
  /* Carries out a verb of device.h other than enable and disable. Returns WH_OK, WH_FAILED or
   * WH_UNSUPPORTED. */
  int32_t (*control)(void* context, uint8_t verb, float argument);
  /* Sends bytes to the program; bytes without room are dropped. */
  void (*send)(void* context, const uint8_t* bytes, size_t count);
} fw_board;

typedef enum {
  FW_OFF = 0,   /* disabled */
  FW_WAITING,   /* enabled at neutral, no command yet */
  FW_RENDERING, /* applies the commanded efforts */
  FW_RAMPING,   /* on the way to neutral */
  FW_LATCHED    /* at neutral until WH_ENABLE */
} fw_phase;

typedef struct {
  uint32_t broken, crc_errors, foreign, stale; /* ignored frames, by reason */
} fw_counters;

typedef struct {
  const fw_board* board;
  fw_phase phase;
  uint8_t to_off;      /* ramping because of WH_DISABLE */
  uint8_t saturated;   /* the last command was clamped */
  uint32_t session, heard, samples, asked; /* sequence of the last command, sample, question */
  uint32_t passed;     /* commands up to this one are not obeyed any more */
  uint8_t answered;    /* the last question was answered */
  int32_t result;      /* of the last question */
  uint32_t heard_us, ramp_us; /* times of the last command and of the ramp's begin */
  float held[WF_MAX_AXES];    /* efforts at the ramp's begin */
  float effort[WF_MAX_AXES];  /* applied now */
  wf_receiver receiver;
  fw_counters counters;
} firmware;

/* @pre the board outlives the firmware. */
void firmware_init(firmware* fw, const fw_board* board);
/* Takes received bytes. The watchdog is checked first, so that a late command is not obeyed. */
void firmware_receive(firmware* fw, const uint8_t* bytes, size_t count, uint32_t now_us);
/* Runs the watchdog and the ramp, drives the motors and sends a sample. Call it at a fixed rate of at
 * least 1,000 per second. */
void firmware_tick(firmware* fw, uint32_t now_us);

#ifdef __cplusplus
}
#endif

#endif /* WHOLEHAND_FIRMWARE_H */
