// SPDX-License-Identifier: MIT
// Reads behind the end.
#include <vector>

int main(int count, char**) {
  const std::vector<int> values(static_cast<std::size_t>(count));
  return values.data()[count] == 0 ? 0 : 1;
}
