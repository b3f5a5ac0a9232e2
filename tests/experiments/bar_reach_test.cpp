// Its tests are in bar_patients_test.cpp.
