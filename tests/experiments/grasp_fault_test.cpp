// Its tests are in grasp_trial_test.cpp.
