// SPDX-License-Identifier: MIT
// A shared library that shows one function.
#include "tasks.hpp"

__attribute__((visibility("default"))) int nested_tasks_of_library();
int nested_tasks_of_library() { return nested_tasks(); }
