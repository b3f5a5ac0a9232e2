// Its tests are in contact_figures_test.cpp.
