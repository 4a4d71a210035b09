// SPDX-License-Identifier: MIT
/// Reading and writing of GLB files.
#pragma once

#include <motionlang/formats/glb_reader.hpp>
#include <motionlang/formats/glb_writer.hpp>
