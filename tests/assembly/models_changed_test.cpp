// Its tests are in run_test.cpp.
