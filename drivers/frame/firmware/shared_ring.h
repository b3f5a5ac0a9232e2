/* Frames between two processes of one machine: the carrier shm:NAME, /dev/shm/wholehand-frame-NAME.
 * The device's side creates it with mode 0600. Each direction is a ring of slots for one writer and
 * one reader. Neither waits: a frame for which the ring has no room is dropped, as on a line. Whatever
 * the other side writes into it, this code stays within the structure; the CRC rejects a frame mixed
 * from two writers. For GCC and clang. */
#ifndef WHOLEHAND_SHARED_RING_H
#define WHOLEHAND_SHARED_RING_H

#include "frame.h"

#include <string.h>

enum { SR_SLOTS = 32, SR_MAGIC = 0x57484652, SR_LAYOUT = 1 };

typedef struct {
  uint32_t written, read; /* number of slots written and read; each has one writer */
  struct {
    uint32_t count;
    uint8_t bytes[WF_MAX_WIRE];
  } slots[SR_SLOTS];
} sr_ring;

typedef struct {
  uint32_t magic, layout;
  sr_ring to_device, from_device;
} sr_memory;

/* Writes a frame. False: too long, or no room. */
static inline int sr_put(sr_ring* ring, const uint8_t* bytes, size_t count) {
  const uint32_t n = __atomic_load_n(&ring->written, __ATOMIC_RELAXED);
  if (count > WF_MAX_WIRE) return 0;
  if (n - __atomic_load_n(&ring->read, __ATOMIC_ACQUIRE) >= SR_SLOTS) return 0;
  memcpy(ring->slots[n % SR_SLOTS].bytes, bytes, count);
  ring->slots[n % SR_SLOTS].count = (uint32_t)count;
  __atomic_store_n(&ring->written, n + 1, __ATOMIC_RELEASE);
  return 1;
}

/* Takes the oldest frame. Returns its length; 0: none. @pre `bytes` has room for WF_MAX_WIRE. */
static inline size_t sr_get(sr_ring* ring, uint8_t* bytes) {
  const uint32_t n = __atomic_load_n(&ring->read, __ATOMIC_RELAXED);
  uint32_t count;
  if (n == __atomic_load_n(&ring->written, __ATOMIC_ACQUIRE)) return 0;
  count = ring->slots[n % SR_SLOTS].count;
  if (count > WF_MAX_WIRE) count = 0;
  memcpy(bytes, ring->slots[n % SR_SLOTS].bytes, count);
  __atomic_store_n(&ring->read, n + 1, __ATOMIC_RELEASE);
  return count;
}

#endif /* WHOLEHAND_SHARED_RING_H */
