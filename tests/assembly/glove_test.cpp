// Its tests are in every_file_test.cpp.
