#include "frame.h"

#include <string.h>

enum { HEADER = 12, CRC = 2, AXIS_BYTES = 36 + 6 * 4, SAMPLE_BYTES = 20 };

uint16_t wf_crc16(const uint8_t* bytes, size_t count) {
  uint16_t crc = 0xFFFF;
  size_t i;
  int bit;
  for (i = 0; i < count; ++i) {
    crc = (uint16_t)(crc ^ (uint16_t)(bytes[i] << 8));
    for (bit = 0; bit < 8; ++bit) {
      crc = (uint16_t)((crc & 0x8000) != 0 ? (crc << 1) ^ 0x1021 : crc << 1);
    }
  }
  return crc;
}

size_t wf_cobs_encode(const uint8_t* bytes, size_t count, uint8_t* out) {
  size_t at = 1, code_at = 0, i;
  uint8_t code = 1;
  for (i = 0; i < count; ++i) {
    if (bytes[i] != 0) {
      out[at++] = bytes[i];
      ++code;
    }
    /* A full block is closed only if more bytes follow. */
    if (bytes[i] == 0 || (code == 0xFF && i + 1 < count)) {
      out[code_at] = code;
      code_at = at++;
      code = 1;
    }
  }
  out[code_at] = code;
  return at;
}

int wf_cobs_decode(const uint8_t* bytes, size_t count, uint8_t* out, size_t* length) {
  size_t at = 0, i = 0;
  while (i < count) {
    const uint8_t code = bytes[i++];
    uint8_t k;
    if (code == 0 || (size_t)(code - 1) > count - i) return 0;
    for (k = 1; k < code; ++k) {
      if (bytes[i] == 0) return 0;
      out[at++] = bytes[i++];
    }
    if (code != 0xFF && i < count) out[at++] = 0;
  }
  *length = at;
  return count > 0;
}

static uint8_t* put32(uint8_t* to, uint32_t value) {
  int i;
  for (i = 0; i < 4; ++i) to[i] = (uint8_t)(value >> (8 * i));
  return to + 4;
}

static const uint8_t* get32(const uint8_t* from, uint32_t* value) {
  *value = (uint32_t)from[0] | (uint32_t)from[1] << 8 | (uint32_t)from[2] << 16 |
           (uint32_t)from[3] << 24;
  return from + 4;
}

static uint8_t* put_floats(uint8_t* to, const float* values, size_t count) {
  size_t i;
  for (i = 0; i < count; ++i) {
    uint32_t bits;
    memcpy(&bits, &values[i], 4);
    to = put32(to, bits);
  }
  return to;
}

static const uint8_t* get_floats(const uint8_t* from, float* values, size_t count) {
  size_t i;
  for (i = 0; i < count; ++i) {
    uint32_t bits;
    from = get32(from, &bits);
    memcpy(&values[i], &bits, 4);
  }
  return from;
}

/* Length of the frame before its CRC; 0: unknown kind, or impossible number of axes. */
static size_t length_of(uint8_t kind, uint8_t axes) {
  if (axes > WF_MAX_AXES) return 0;
  if (kind != WF_HELLO && axes == 0) return 0;
  switch (kind) {
    case WF_HELLO:
    case WF_ASK_AXIS: return HEADER;
    case WF_WELCOME: return HEADER + 3 * WF_NAME;
    case WF_AXIS: return HEADER + AXIS_BYTES;
    case WF_CONTROL:
    case WF_ANSWER: return HEADER + 4;
    case WF_COMMAND: return HEADER + 4 * (size_t)axes;
    case WF_SAMPLE: return HEADER + SAMPLE_BYTES + 8 * (size_t)axes;
    default: return 0;
  }
}

static void put_payload(const wf_frame* f, uint8_t* to) {
  const wf_axis* a = &f->axis;
  switch (f->kind) {
    case WF_WELCOME:
      memcpy(to, f->name, WF_NAME);
      memcpy(to + WF_NAME, f->serial, WF_NAME);
      memcpy(to + 2 * WF_NAME, f->firmware, WF_NAME);
      break;
    case WF_AXIS:
      memcpy(to, a->name, WF_NAME);
      to[WF_NAME] = a->kind;
      to[WF_NAME + 1] = a->effort_meaning;
      to[WF_NAME + 2] = to[WF_NAME + 3] = 0;
      put_floats(to + WF_NAME + 4, &a->lower, 1);
      put_floats(to + WF_NAME + 8, &a->upper, 1);
      put_floats(to + WF_NAME + 12, &a->effort_limit, 1);
      put_floats(to + WF_NAME + 16, &a->resolution, 1);
      put_floats(to + WF_NAME + 20, &a->delay_s, 1);
      put_floats(to + WF_NAME + 24, &a->silence_s, 1);
      break;
    case WF_CONTROL: put_floats(to, &f->argument, 1); break;
    case WF_ANSWER: put32(to, (uint32_t)f->result); break;
    case WF_COMMAND: put_floats(to, f->effort, f->axes); break;
    case WF_SAMPLE:
      to = put32(to, f->time_us);
      to = put32(to, f->status);
      to = put32(to, f->valid);
      to = put32(to, (uint32_t)f->vendor_code);
      to = put32(to, f->heard);
      to = put_floats(to, f->position, f->axes);
      put_floats(to, f->effort, f->axes);
      break;
    default: break;
  }
}

static void get_payload(wf_frame* f, const uint8_t* from) {
  wf_axis* a = &f->axis;
  uint32_t word;
  switch (f->kind) {
    case WF_WELCOME:
      memcpy(f->name, from, WF_NAME);
      memcpy(f->serial, from + WF_NAME, WF_NAME);
      memcpy(f->firmware, from + 2 * WF_NAME, WF_NAME);
      f->name[WF_NAME - 1] = f->serial[WF_NAME - 1] = f->firmware[WF_NAME - 1] = 0;
      break;
    case WF_AXIS:
      memcpy(a->name, from, WF_NAME);
      a->name[WF_NAME - 1] = 0;
      a->kind = from[WF_NAME];
      a->effort_meaning = from[WF_NAME + 1];
      from = get_floats(from + WF_NAME + 4, &a->lower, 1);
      from = get_floats(from, &a->upper, 1);
      from = get_floats(from, &a->effort_limit, 1);
      from = get_floats(from, &a->resolution, 1);
      from = get_floats(from, &a->delay_s, 1);
      get_floats(from, &a->silence_s, 1);
      break;
    case WF_CONTROL: get_floats(from, &f->argument, 1); break;
    case WF_ANSWER:
      get32(from, &word);
      f->result = (int32_t)word;
      break;
    case WF_COMMAND: get_floats(from, f->effort, f->axes); break;
    case WF_SAMPLE:
      from = get32(from, &f->time_us);
      from = get32(from, &f->status);
      from = get32(from, &f->valid);
      from = get32(from, &word);
      f->vendor_code = (int32_t)word;
      from = get32(from, &f->heard);
      from = get_floats(from, f->position, f->axes);
      get_floats(from, f->effort, f->axes);
      break;
    default: break;
  }
}

size_t wf_encode(const wf_frame* frame, uint8_t* out) {
  uint8_t bytes[WF_MAX_FRAME];
  const size_t length = length_of(frame->kind, frame->axes);
  uint16_t crc;
  size_t coded;
  if (length == 0) return 0;
  bytes[0] = WF_VERSION;
  bytes[1] = frame->kind;
  bytes[2] = frame->axes;
  bytes[3] = frame->index;
  put32(put32(bytes + 4, frame->session), frame->sequence);
  put_payload(frame, bytes + HEADER);
  crc = wf_crc16(bytes, length);
  bytes[length] = (uint8_t)crc;
  bytes[length + 1] = (uint8_t)(crc >> 8);
  out[0] = 0;
  coded = wf_cobs_encode(bytes, length + CRC, out + 1);
  out[coded + 1] = 0;
  return coded + 2;
}

static wf_outcome parse(const uint8_t* bytes, size_t count, wf_frame* f) {
  if (count < HEADER + CRC) return WF_BROKEN;
  count -= CRC;
  if (wf_crc16(bytes, count) != (uint16_t)(bytes[count] | bytes[count + 1] << 8)) {
    return WF_CRC_ERROR;
  }
  memset(f, 0, sizeof *f);
  f->version = bytes[0];
  f->kind = bytes[1];
  f->axes = bytes[2];
  f->index = bytes[3];
  get32(get32(bytes + 4, &f->session), &f->sequence);
  if (f->version != WF_VERSION) return WF_OTHER_VERSION;
  if (length_of(f->kind, f->axes) != count) return WF_BROKEN;
  get_payload(f, bytes + HEADER);
  return WF_GOOD;
}

wf_outcome wf_receive(wf_receiver* r, uint8_t byte, wf_frame* frame) {
  uint8_t bytes[WF_MAX_WIRE];
  size_t length = 0;
  wf_outcome outcome;
  if (byte != 0) {
    if (r->count == WF_MAX_WIRE) {
      r->too_long = 1;
    } else {
      r->bytes[r->count++] = byte;
    }
    return WF_NONE;
  }
  if (r->count == 0) return WF_NONE;
  if (r->too_long || !wf_cobs_decode(r->bytes, r->count, bytes, &length)) {
    outcome = WF_BROKEN;
  } else {
    outcome = parse(bytes, length, frame);
  }
  r->count = 0;
  r->too_long = 0;
  return outcome;
}

int wf_newer(uint32_t sequence, uint32_t last) {
  const uint32_t ahead = sequence - last;
  return ahead != 0 && ahead < UINT32_C(0x80000000);
}
