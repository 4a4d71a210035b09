// SPDX-License-Identifier: MIT
/// GLB files, both ways.
#pragma once

#include <motionlang/io/glb_reader.hpp>
#include <motionlang/io/glb_writer.hpp>
