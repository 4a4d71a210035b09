// SPDX-License-Identifier: MIT
// The first of two units with every header; declarations come first here.
#include <motionlang/fwd.hpp>
//
#include <every_header.hpp>

int frames_of_second_unit();

int main() { return frames_of_second_unit() == 120 ? 0 : 1; }
