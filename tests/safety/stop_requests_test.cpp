// Its tests are in supervisor_test.cpp.
