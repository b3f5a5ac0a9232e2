// Its tests are in slew_and_power_test.cpp.
