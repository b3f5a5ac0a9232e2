// Its tests are in players_test.cpp.
