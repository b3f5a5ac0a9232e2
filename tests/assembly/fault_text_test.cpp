// Its tests are in safety_log_test.cpp.
