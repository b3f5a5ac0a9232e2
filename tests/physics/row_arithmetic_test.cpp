// Its tests are in body_rows_test.cpp.
