// Its tests are in passport_test.cpp.
