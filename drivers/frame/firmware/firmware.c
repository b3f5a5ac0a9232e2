#include "firmware.h"

#include <math.h>
#include <string.h>

static void send_frame(firmware* fw, const wf_frame* frame) {
  uint8_t wire[WF_MAX_WIRE];
  const size_t count = wf_encode(frame, wire);
  if (count > 0) fw->board->send(fw->board->context, wire, count);
}

/* Makes an answer to a question, or a sample; the caller fills in the content. */
static wf_frame frame_of(const firmware* fw, uint8_t kind, const wf_frame* question) {
  wf_frame frame;
  memset(&frame, 0, sizeof frame);
  frame.kind = kind;
  frame.axes = fw->board->axes;
  frame.session = fw->session;
  if (question != NULL) {
    frame.index = question->index;
    frame.sequence = question->sequence;
  }
  return frame;
}

static int at_neutral(const firmware* fw) {
  uint8_t i;
  for (i = 0; i < fw->board->axes; ++i) {
    if (fw->effort[i] != fw->board->neutral[i]) return 0;
  }
  return 1;
}

static void to_neutral(firmware* fw, fw_phase phase) {
  memcpy(fw->effort, fw->board->neutral, sizeof fw->effort);
  fw->phase = phase;
  fw->saturated = 0;
}

/* Starts the ramp at the effort that is applied now. */
static void let_go(firmware* fw, uint32_t begin_us, int to_off) {
  const fw_phase end = to_off ? FW_OFF : FW_LATCHED;
  if (at_neutral(fw)) {
    to_neutral(fw, end);
    return;
  }
  memcpy(fw->held, fw->effort, sizeof fw->held);
  fw->ramp_us = begin_us;
  fw->to_off = (uint8_t)to_off;
  fw->saturated = 0;
  fw->phase = FW_RAMPING;
}

/* effort = neutral + s (held - neutral), s = 1 - (3 u^2 - 2 u^3), u = time / 80 ms, the same
 * s for every axis. A rounding error cannot raise an effort again. */
static void ramp(firmware* fw, uint32_t now_us) {
  const uint32_t elapsed_us = now_us - fw->ramp_us;
  const float u = (float)elapsed_us / (float)FW_RAMP_US;
  const float share = 1.0f - u * u * (3.0f - 2.0f * u);
  uint8_t i;
  /* The last tick is within 80 ms; half a thousandth of the initial effort is left then. */
  if (elapsed_us + (uint32_t)FW_TICK_US >= (uint32_t)FW_RAMP_US) {
    to_neutral(fw, fw->to_off ? FW_OFF : FW_LATCHED);
    return;
  }
  for (i = 0; i < fw->board->axes; ++i) {
    const float from_neutral = share * (fw->held[i] - fw->board->neutral[i]);
    if (fabsf(from_neutral) < fabsf(fw->effort[i] - fw->board->neutral[i])) {
      fw->effort[i] = fw->board->neutral[i] + from_neutral;
    }
  }
}

static void watch(firmware* fw, uint32_t now_us) {
  const uint32_t silent_us = now_us - fw->heard_us;
  if (fw->phase == FW_WAITING && silent_us > (uint32_t)FW_FIRST_COMMAND_US) let_go(fw, now_us, 0);
  if (fw->phase == FW_RENDERING && silent_us > fw->board->silence_us) {
    /* The ramp counts from the end of the allowed silence, but at most one tick back, to avoid a step. */
    const uint32_t late_us = silent_us - fw->board->silence_us;
    let_go(fw, now_us - (late_us < (uint32_t)FW_TICK_US ? late_us : (uint32_t)FW_TICK_US), 0);
  }
}

static void take_command(firmware* fw, const wf_frame* command, uint32_t now_us) {
  uint8_t i;
  if (fw->phase != FW_WAITING && fw->phase != FW_RENDERING) return;
  if (!wf_newer(command->sequence, fw->passed)) {
    ++fw->counters.stale;
    return;
  }
  for (i = 0; i < command->axes; ++i) {
    if (!isfinite(command->effort[i])) break;
  }
  if (command->axes != fw->board->axes || i < command->axes) {
    let_go(fw, now_us, 0);
    return;
  }
  fw->saturated = 0;
  for (i = 0; i < command->axes; ++i) {
    const float limit = fw->board->axis[i].effort_limit;
    const float asked = command->effort[i];
    fw->effort[i] = asked > limit ? limit : asked < -limit ? -limit : asked;
    if (fw->effort[i] != asked) fw->saturated = 1;
  }
  fw->heard = fw->passed = command->sequence;
  fw->heard_us = now_us;
  fw->phase = FW_RENDERING;
}

static void answer_with(firmware* fw, wf_frame* answer, int32_t result) {
  fw->answered = 1;
  fw->result = answer->result = result;
  send_frame(fw, answer);
}

/* Carries out a verb and answers when it is done; the program repeats its question until then. A late
 * copy of the question is answered without repeating the action. */
static void take_control(firmware* fw, const wf_frame* question, uint32_t now_us) {
  wf_frame answer = frame_of(fw, WF_ANSWER, question);
  const int again = question->sequence == fw->asked;
  if (!again && !wf_newer(question->sequence, fw->asked)) {
    ++fw->counters.stale;
    return;
  }
  if (again && fw->answered) {
    answer_with(fw, &answer, fw->result);
    return;
  }
  fw->asked = question->sequence;
  fw->answered = 0;
  if (question->index == WH_ENABLE) {
    if (fw->phase == FW_RENDERING && !again) let_go(fw, now_us, 0);
    if (fw->phase == FW_RENDERING || fw->phase == FW_RAMPING) return;
    to_neutral(fw, FW_WAITING);
    /* Commands still on their way are ignored, too. */
    if (fw->passed != 0) fw->passed = fw->heard + WF_ENABLE_SKIP / 2;
    fw->heard_us = now_us;
    answer_with(fw, &answer, WH_OK);
  } else if (question->index == WH_DISABLE) {
    if (fw->phase == FW_RAMPING) fw->to_off = 1;
    if (fw->phase != FW_OFF && fw->phase != FW_RAMPING) let_go(fw, now_us, 1);
    if (fw->phase == FW_OFF) answer_with(fw, &answer, WH_OK);
  } else {
    const int free = fw->phase != FW_RENDERING && fw->phase != FW_RAMPING;
    answer_with(fw, &answer,
                free ? fw->board->control(fw->board->context, question->index, question->argument)
                     : WH_FAILED);
  }
}

/* Begins a session, unless another program renders. The answer then names that program's session. */
static void take_hello(firmware* fw, const wf_frame* hello) {
  wf_frame welcome;
  const int free = fw->phase == FW_OFF || fw->phase == FW_LATCHED;
  /* A late copy from the same session has no effect. */
  if (hello->version == WF_VERSION && free && hello->session != fw->session) {
    fw->session = hello->session;
    fw->heard = fw->passed = fw->samples = fw->asked = 0;
    fw->answered = 0;
  }
  welcome = frame_of(fw, WF_WELCOME, hello);
  memcpy(welcome.name, fw->board->name, WF_NAME);
  memcpy(welcome.serial, fw->board->serial, WF_NAME);
  memcpy(welcome.firmware, fw->board->firmware, WF_NAME);
  send_frame(fw, &welcome);
}

static void tell_axis(firmware* fw, const wf_frame* question) {
  wf_frame answer = frame_of(fw, WF_AXIS, question);
  if (question->index >= fw->board->axes) return;
  answer.axis = fw->board->axis[question->index];
  send_frame(fw, &answer);
}

static void take(firmware* fw, const wf_frame* frame, uint32_t now_us) {
  if (frame->kind == WF_HELLO) {
    take_hello(fw, frame);
    return;
  }
  if (frame->version != WF_VERSION || frame->session != fw->session || fw->session == 0) {
    ++fw->counters.foreign;
    return;
  }
  switch (frame->kind) {
    case WF_ASK_AXIS: tell_axis(fw, frame); break;
    case WF_CONTROL: take_control(fw, frame, now_us); break;
    case WF_COMMAND: take_command(fw, frame, now_us); break;
    default: ++fw->counters.foreign; break;
  }
}

void firmware_init(firmware* fw, const fw_board* board) {
  memset(fw, 0, sizeof *fw);
  fw->board = board;
  to_neutral(fw, FW_OFF);
}

void firmware_receive(firmware* fw, const uint8_t* bytes, size_t count, uint32_t now_us) {
  wf_frame frame;
  size_t i;
  watch(fw, now_us);
  for (i = 0; i < count; ++i) {
    switch (wf_receive(&fw->receiver, bytes[i], &frame)) {
      case WF_GOOD:
      case WF_OTHER_VERSION: take(fw, &frame, now_us); break;
      case WF_BROKEN: ++fw->counters.broken; break;
      case WF_CRC_ERROR: ++fw->counters.crc_errors; break;
      case WF_NONE: break;
    }
  }
}

void firmware_tick(firmware* fw, uint32_t now_us) {
  wf_frame sample = frame_of(fw, WF_SAMPLE, NULL);
  fw_state state;
  uint8_t i;
  watch(fw, now_us);
  if (fw->phase == FW_RAMPING) ramp(fw, now_us);
  fw->board->drive(fw->board->context, fw->effort, fw->phase != FW_OFF);
  memset(&state, 0, sizeof state);
  for (i = 0; i < WF_MAX_AXES; ++i) state.effort[i] = NAN; /* unless the board measures it */
  fw->board->measure(fw->board->context, &state);
  if (fw->session == 0) return;
  sample.sequence = ++fw->samples;
  sample.time_us = now_us;
  sample.status = state.status;
  if (fw->phase != FW_OFF && (state.status & WH_DRIVE_FAULT) == 0) sample.status |= WH_ENABLED;
  if (fw->phase == FW_LATCHED || (fw->phase == FW_RAMPING && !fw->to_off)) {
    sample.status |= WH_SILENCED;
  }
  if (fw->saturated) sample.status |= WH_SATURATED;
  sample.valid = state.valid;
  sample.vendor_code = state.vendor_code;
  sample.heard = fw->heard;
  for (i = 0; i < fw->board->axes; ++i) {
    sample.position[i] = state.position[i];
    sample.effort[i] = state.effort[i];
  }
  send_frame(fw, &sample);
}
