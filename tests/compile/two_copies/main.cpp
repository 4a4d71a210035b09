// SPDX-License-Identifier: MIT
// The program; a deadlock if the two copies mix up whose thread is inside a task.
#include "tasks.hpp"

int nested_tasks_of_library();

int main() { return nested_tasks() == 3200 && nested_tasks_of_library() == 3200 ? 0 : 1; }
