/* What a test sees of the dishonest driver (liar_driver.c), beside its plugin: the truth. */
#pragma once

#include <stdint.h>

enum { LIAR_AXES = 3 };

typedef struct liar_truth {
  int64_t now_ns;
  int enables;               /* since it was opened; a test may set it */
  int stop_pressed;
  double position[LIAR_AXES], velocity[LIAR_AXES];
  double pull[LIAR_AXES];    /* a weight, or a hand [N] */
  /* A person who does nothing: a limb that moves with each axis, held softly at `rest`. */
  double limb_mass, limb_damping, limb_stiffness, rest[LIAR_AXES];
  double work_j;             /* of the motors, while the driver lies */
} liar_truth;

#ifdef __cplusplus
extern "C" {
#endif
liar_truth* liar(void);
void liar_pass(void); /* a millisecond */
typedef liar_truth* (*liar_function)(void);
typedef void (*liar_pass_function)(void);
#ifdef __cplusplus
}
#endif
