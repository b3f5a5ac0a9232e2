// Its tests are in certificate_test.cpp.
