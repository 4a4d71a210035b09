// SPDX-License-Identifier: MIT
/// What all usage examples take for granted.
#pragma once

#include <motionlang/backend/eigen.hpp>

using namespace motionlang;
using B = EigenBackend<float>;

/// Whatever a user does with something.
template <class... T>
void use(const T&...) {}
