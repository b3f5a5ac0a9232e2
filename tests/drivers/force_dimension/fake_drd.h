/* A Force Dimension device that is not there: what stands behind the fake libdrd.so.3. */
#ifndef WHOLEHAND_TESTS_FAKE_DRD_H
#define WHOLEHAND_TESTS_FAKE_DRD_H

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  /* What there is. */
  int devices;
  unsigned short serial[4];
  int has_gripper, left_handed;
  /* How it is. */
  int connected, power, initialized, reset, error;
  int waits_for_button; /* force is on only once its button was pressed */
  int force_on, cause;
  /* In its own frame: x to the person, z up [m], and the opening of its gripper [rad]. */
  double position_m[3], angle_rad;
  /* x, y, z [N], three torques [N.m], gripper [N]. */
  double force[7];
  /* What functions return instead of 0. */
  int open_returns, status_returns, position_returns, angle_returns, force_returns, enable_returns,
      init_returns, stop_returns;
  /* What was called. */
  int opened, closed, inits, stops, stops_that_leave_force_on, enables, enables_with_a_force,
      sent;
  int forbidden; /* expert mode, watchdog, velocity trip, time guard, gravity, brakes */
} fake_device;

/* Of this library; `fresh`: as the maker delivers it. */
fake_device* fake_drd(int fresh);

#ifdef __cplusplus
}
#endif

#endif
