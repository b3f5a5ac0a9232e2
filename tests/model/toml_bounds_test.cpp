// Its tests are in bad_input_test.cpp.
