// SPDX-License-Identifier: MIT
// A model over another backend than the one that motionlang::instantiated has, where its bodies are not included.
// expect: include <motionlang/systems/stmc.ipp>
#define MOTIONLANG_INSTANTIATED
#include <motionlang/backend/reference.hpp>
#include <motionlang/stmc.hpp>
#ifndef MISTAKE
#include <motionlang/weights/stmc_file.hpp>
#endif

namespace ml = motionlang;

ml::Index parameters(const char* file) { return ml::parameter_count(ml::load_stmc<ml::ReferenceBackend<float>>(file)); }
