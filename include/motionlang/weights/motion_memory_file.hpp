// SPDX-License-Identifier: MIT
/// The motions that a model remembers, in the file of its weights (datasets/motion_memory.hpp).
///
/// load_stmc reads them with the weights, and write_motion_memory writes others.
///
/// Tensors  memory.poses (66, frames) I16: the rotation vectors of SMPL's first 22 joints, in 1e-4 rad (features have
///          no rotations of the hands; times follow each other, so that the file packs well); memory.root (frames, 3)
///          F32: metres, Y up; memory.ends (motions) I32: the frame behind each motion; memory.captions (pairs, 2) I16:
///          the line of a caption and the place of its motion. A frame takes 144 bytes
#pragma once

#include <memory>  // shared memories

#include <motionlang/datasets/motion_memory.hpp>
#include <motionlang/file/safetensors.hpp>
#include <motionlang/weights/known_caption_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// True if the file has motions, or a part of them.
bool remembers_motions(const SafetensorsFile& file);
/// Null if the file has no motions.
/// captions  those of the file (stored_known_captions); fps: of the model
/// Throws    io_error 406, 407 for tensors that are missing, unknown or do not fit each other; config_error 107 for
///           roots farther than 10 km away; what MotionMemory throws
std::shared_ptr<const MotionMemory> stored_motion_memory(const SafetensorsFile& file, KnownCaptions captions,
                                                         double fps);

/// Writes the weights of a file to another file, or to the same, with this memory and its captions instead of its own.
/// Lengths of bones become those of SMPL's mean body. Throws io_error 401, config_error 101 for a memory with more than
/// 32,767 texts or motions, and 102 for motions with another frame rate than the model's.
void write_motion_memory(const FilePath& from, const FilePath& to, const MotionMemory& memory);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/motion_memory_file.ipp>
#endif
