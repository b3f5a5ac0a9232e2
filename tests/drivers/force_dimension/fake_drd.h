/* The fake Force Dimension device behind the fake libdrd.so.3. */
#ifndef WHOLEHAND_TESTS_FAKE_DRD_H
#define WHOLEHAND_TESTS_FAKE_DRD_H

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  /* The connected devices. */
  int devices;
  unsigned short serial[4];
  int has_gripper, left_handed;
  /* State of the device. */
  int connected, power, initialized, reset, error;
  int waits_for_button; /* force is on only once its button was pressed */
  int force_on, cause;
  /* Position in the device's own frame: x to the person, z up [m]; opening of its gripper [rad]. */
  double position_m[3], angle_rad;
  /* Forces x, y, z [N], three torques [N.m], gripper force [N]. */
  double force[7];
  /* Return values of the functions; 0 is success. */
  int open_returns, status_returns, position_returns, angle_returns, force_returns, enable_returns,
      init_returns, stop_returns;
  /* Numbers of calls. */
  int opened, closed, inits, stops, stops_that_leave_force_on, enables, enables_with_a_force, sent;
  int forbidden; /* expert mode, watchdog, velocity trip, time guard, gravity, brakes */
} fake_device;

/* The device of this library; `fresh` resets it to the maker's delivery state. */
fake_device* fake_drd(int fresh);

#ifdef __cplusplus
}
#endif

#endif
