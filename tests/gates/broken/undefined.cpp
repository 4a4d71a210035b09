// SPDX-License-Identifier: MIT
// A sum that no int holds.
#include <limits>

int main(int count, char**) { return std::numeric_limits<int>::max() + count == 0 ? 0 : 1; }
