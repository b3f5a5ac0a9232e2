// Its tests are in habits_test.cpp.
