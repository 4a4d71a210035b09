// SPDX-License-Identifier: MIT
// clang-tidy finds a pointer that is 0.
const char* name = 0;
