// SPDX-License-Identifier: MIT
// The second of two units with every header; declarations come last here.
#include <every_header.hpp>
//
#include <motionlang/fwd.hpp>

int frames_of_second_unit();
int frames_of_second_unit() { return static_cast<int>(motionlang::parse_timeline("walk # 0 # 6 # legs").end()); }
