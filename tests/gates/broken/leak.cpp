// SPDX-License-Identifier: MIT
// Loses what it allocated.
#include <vector>

int main() {
  const auto* lost = new std::vector<int>(3);
  return lost->size() == 3 ? 0 : 1;
}
