// SPDX-License-Identifier: MIT
// An older standard than C++20: the first error says so.
// flags: -std=c++17
// first: motionlang needs C\+\+20
#include <motionlang/backend/reference.hpp>
