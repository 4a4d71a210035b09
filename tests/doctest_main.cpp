#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

#include "support/tests_folder.hpp"

const char* tests_folder() { return MOTIONLANG_TESTS_FOLDER; }
