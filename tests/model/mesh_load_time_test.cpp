// Its tests are in mesh_child_test.cpp.
