// Its tests are in stability_test.cpp.
