// SPDX-License-Identifier: MIT
/// Names that all usage examples use without declaring them.
#pragma once

#include <motionlang/backend/eigen.hpp>

using namespace motionlang;
using B = EigenBackend<float>;

/// Whatever a user does with something.
template <class... T>
void use(const T&...) {}
