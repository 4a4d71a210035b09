// SPDX-License-Identifier: MIT
// The flagship header in a unit of its own.
#include <motionlang/stmc.hpp>

motionlang::Index frames_of(const char* text);
motionlang::Index frames_of(const char* text) { return motionlang::parse_timeline(text).end(); }
