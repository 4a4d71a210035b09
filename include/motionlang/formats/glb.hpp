// SPDX-License-Identifier: MIT
/// GLB files, both ways.
#pragma once

#include <motionlang/formats/glb_reader.hpp>
#include <motionlang/formats/glb_writer.hpp>
