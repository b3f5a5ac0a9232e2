/* The frame between a program and a device's controller, over any carrier of bytes: C99 without
 * malloc, for both sides. It uses no clock and never waits.
 *
 * On the wire: 0, the frame encoded by COBS, 0. A zero byte occurs nowhere else, so a receiver that
 * starts in the middle, or that loses bytes, is synchronised again at the next zero.
 * COBS: Cheshire and Baker, "Consistent Overhead Byte Stuffing", IEEE/ACM Trans. Networking 7(2).
 *
 * Little endian. float32: IEEE 754 single precision. SI units: m, rad, N, N.m, s.
 *
 *   byte            type     meaning
 *   0               u8       version of the frame: WF_VERSION
 *   1               u8       kind: WF_HELLO ...
 *   2               u8       axes of the device, 1 to 16; 0 while unknown (WF_HELLO)
 *   3               u8       index: WF_ASK_AXIS, WF_AXIS: number of an axis from 0;
 *                            WF_CONTROL, WF_ANSWER: a verb of device.h; else 0
 *   4               u32      session: a random number of the program for WF_HELLO; in every frame
 *   8               u32      sequence. An answer repeats the number of its question; commands
 *                            and samples are each numbered upwards by one
 *   12              ...      content by kind
 *   last 2          u16      CRC-16 of all bytes before it
 *
 *   WF_HELLO    1   program  no content. Begins a session
 *   WF_WELCOME  2   device   12: name, 44: serial number, 76: version of the firmware; 32 bytes each,
 *                            each ends with 0. A device without serial number gets no passport
 *   WF_ASK_AXIS 3   program  no content
 *   WF_AXIS     4   device   12: name, 32 bytes, ends with 0; 44: u8 kind, 45: u8 effort_meaning,
 *                            46: u16 0; 48: 6 x float32: lower, upper, effort_limit, resolution,
 *                            delay_s, silence_s, as in wh_axis
 *   WF_CONTROL  5   program  12: float32 argument
 *   WF_ANSWER   6   device   12: i32 result, WH_OK or another result of device.h
 *   WF_COMMAND  7   program  12: axes x float32 effort
 *   WF_SAMPLE   8   device   12: u32 time_us, the device's clock; 16: u32 status; 20: u32 valid;
 *                            24: i32 vendor_code; 28: u32 heard, sequence of the last command
 *                            taken; 32: axes x float32 position; then axes x float32 effort
 *
 * Bytes 0 to 1, 4 to 11, the CRC and COBS never change: every version of a device can answer
 * that it uses another one.
 *
 * Reason for float32: six axes at 1,000 samples per second need 84 kB/s and fit a line of 1 Mbaud; in
 * float64 they would need 132 kB/s. A position of 0.1 m is rounded by at most 3.7 nm, an effort of
 * 8 N by 0.24 uN, far below an encoder's step. Common controllers have single precision only. */
#ifndef WHOLEHAND_FRAME_H
#define WHOLEHAND_FRAME_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { WF_VERSION = 1, WF_MAX_AXES = 16, WF_NAME = 32 };
enum {
  WF_HELLO = 1,
  WF_WELCOME = 2,
  WF_ASK_AXIS = 3,
  WF_AXIS = 4,
  WF_CONTROL = 5,
  WF_ANSWER = 6,
  WF_COMMAND = 7,
  WF_SAMPLE = 8
};
/* Length of the longest frame, a sample of 16 axes with its CRC; and its length on the wire with the
 * zeros. */
enum { WF_MAX_FRAME = 32 + 8 * WF_MAX_AXES + 2, WF_MAX_WIRE = WF_MAX_FRAME + 4 };

typedef struct {
  char name[WF_NAME];
  uint8_t kind, effort_meaning;
  float lower, upper, effort_limit, resolution, delay_s, silence_s;
} wf_axis;

/* A frame of any kind; only the fields of its kind are used. */
typedef struct {
  uint8_t version, kind, axes, index;
  uint32_t session, sequence;
  char name[WF_NAME], serial[WF_NAME], firmware[WF_NAME]; /* WF_WELCOME */
  wf_axis axis;                  /* WF_AXIS */
  float argument;                /* WF_CONTROL */
  int32_t result;                /* WF_ANSWER */
  uint32_t time_us, status, valid, heard; /* WF_SAMPLE */
  int32_t vendor_code;           /* WF_SAMPLE */
  float position[WF_MAX_AXES];   /* WF_SAMPLE [m or rad] */
  float effort[WF_MAX_AXES];     /* WF_COMMAND, WF_SAMPLE [N or N.m] */
} wf_frame;

/* Result of the bytes up to a zero. */
typedef enum {
  WF_NONE = 0,      /* no frame is complete yet */
  WF_GOOD,          /* a valid frame */
  WF_BROKEN,        /* invalid COBS, too long or too short, or invalid for its kind */
  WF_CRC_ERROR,
  WF_OTHER_VERSION  /* version, kind, session and sequence are known, nothing else */
} wf_outcome;

/* Collects received bytes. Initialise with zeros. */
typedef struct {
  uint8_t bytes[WF_MAX_WIRE];
  uint32_t count;
  uint8_t too_long;
} wf_receiver;

/* CRC-16/CCITT-FALSE: polynomial 0x1021, initial value 0xFFFF, not reflected. 0x29B1 for "123456789".
 * Detects every error of 1 to 3 bits in a frame, and every burst of up to 16. */
uint16_t wf_crc16(const uint8_t* bytes, size_t count);

/* Encodes by COBS without a closing zero. @pre out has room for count + count / 254 + 1.
 * Returns the length. */
size_t wf_cobs_encode(const uint8_t* bytes, size_t count, uint8_t* out);
/* Decodes COBS. @pre out has room for count. False: a zero in the bytes, or a code beyond their end. */
int wf_cobs_decode(const uint8_t* bytes, size_t count, uint8_t* out, size_t* length);

/* Encodes a frame for the wire. @pre out has room for WF_MAX_WIRE. Returns the length; 0: impossible
 * kind or number of axes. */
size_t wf_encode(const wf_frame* frame, uint8_t* out);
/* Takes one byte; WF_GOOD: `frame` is filled. */
wf_outcome wf_receive(wf_receiver* receiver, uint8_t byte, wf_frame* frame);

/* Step of the sequence numbers of commands at WH_ENABLE. Earlier commands, received or still on their
 * way, are older by more than half of it. The first WH_ENABLE of a session needs no step. */
enum { WF_ENABLE_SKIP = 65536 };

/* True when a sequence number is later than another, also after an overflow of the 32 bits. */
int wf_newer(uint32_t sequence, uint32_t last);

#ifdef __cplusplus
}
#endif

#endif /* WHOLEHAND_FRAME_H */
