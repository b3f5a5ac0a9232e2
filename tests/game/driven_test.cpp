// Its tests are in felt_test.cpp.
