// Its tests are in touched_test.cpp.
