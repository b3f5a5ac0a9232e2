/* Reference firmware of a device that speaks the frame: C99, no malloc, no clock and no I/O of its
 * own. A board gives it bytes and time, returns positions and gets efforts.
 *
 * What it holds to, whatever the program does:
 *   - no effort beyond the axis's limit, none that is not finite;
 *   - neutral when disabled;
 *   - from a command on, another within `silence_us`, or it lets go: every axis goes to neutral at
 *     once by the same smoothstep over 80 ms, only ever falling. Samples then say WH_SILENCED, and
 *     no command is obeyed, until WH_ENABLE;
 *   - the same where a command is not finite or of another number of axes;
 *   - what was sent before is not done again: a copy of a question that was answered is answered
 *     with the same and does nothing, and no command of before WH_ENABLE is obeyed after it. */
#ifndef WHOLEHAND_FIRMWARE_H
#define WHOLEHAND_FIRMWARE_H

#include "frame.h"

#include <wholehand/device.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { FW_RAMP_US = 80000, FW_TICK_US = 1000 };
/* From WH_ENABLE to the first command, while the program locks memory and starts its loop. */
enum { FW_FIRST_COMMAND_US = 2000000 };

typedef struct {
  float position[WF_MAX_AXES]; /* [m or rad] */
  float effort[WF_MAX_AXES];   /* measured [N or N.m]; left alone: not known */
  uint32_t valid;              /* bit i: position[i] was measured */
  uint32_t status;             /* WH_HOMED, WH_DRIVE_FAULT, and what else device.h has */
  int32_t vendor_code;
} fw_state;

/* What a board has. None of the functions may wait, but `control`, which is called at neutral. */
typedef struct {
  void* context;
  char name[WF_NAME], serial[WF_NAME], firmware[WF_NAME]; /* as in WF_WELCOME */
  uint8_t axes;
  /* delay_s: what the line and the motors take, and two periods of firmware_tick: a command waits
   * for a tick, and a sample is up to one old when the next comes. */
  wf_axis axis[WF_MAX_AXES];
  float neutral[WF_MAX_AXES]; /* carries the axis's own weight [N or N.m] */
  uint32_t silence_us;        /* 20,000, say; the same as every axis's silence_s */
  void (*measure)(void* context, fw_state* state);
  /* Efforts to the motors; `on` is 0 while the device is disabled. */
  void (*drive)(void* context, const float* effort, int on);
  /* A verb of device.h that is neither enable nor disable: WH_OK, WH_FAILED or WH_UNSUPPORTED. */
  int32_t (*control)(void* context, uint8_t verb, float argument);
  /* Bytes to the program; what has no room is dropped. */
  void (*send)(void* context, const uint8_t* bytes, size_t count);
} fw_board;

typedef enum {
  FW_OFF = 0,   /* disabled */
  FW_WAITING,   /* enabled at neutral, no command yet */
  FW_RENDERING, /* gives what is commanded */
  FW_RAMPING,   /* on the way to neutral */
  FW_LATCHED    /* at neutral until WH_ENABLE */
} fw_phase;

typedef struct {
  uint32_t broken, crc_errors, foreign, stale; /* frames that were passed over, and why */
} fw_counters;

typedef struct {
  const fw_board* board;
  fw_phase phase;
  uint8_t to_off;      /* ramping because of WH_DISABLE */
  uint8_t saturated;   /* the last command was clamped */
  uint32_t session, heard, samples, asked; /* sequence of the last command, sample, question */
  uint32_t passed;     /* commands up to this one are not obeyed any more */
  uint8_t answered;    /* the last question is done */
  int32_t result;      /* of it */
  uint32_t heard_us, ramp_us; /* when the last command came, when the ramp began */
  float held[WF_MAX_AXES];    /* where the ramp began */
  float effort[WF_MAX_AXES];  /* given now */
  wf_receiver receiver;
  fw_counters counters;
} firmware;

/* @pre the board lives as long as the firmware. */
void firmware_init(firmware* fw, const fw_board* board);
/* Bytes that came. The watchdog looks first: what comes too late is not obeyed. */
void firmware_receive(firmware* fw, const uint8_t* bytes, size_t count, uint32_t now_us);
/* Call it at a fixed rate, 1,000 times a second and more: watchdog, ramp, motors, sample. */
void firmware_tick(firmware* fw, uint32_t now_us);

#ifdef __cplusplus
}
#endif

#endif /* WHOLEHAND_FIRMWARE_H */
