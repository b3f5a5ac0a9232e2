// Its tests are in complexity_test.cpp.
