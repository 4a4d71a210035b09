// SPDX-License-Identifier: MIT
/// Reads the original files of the CMU motion capture database: ASF (Acclaim skeleton) and AMC (Acclaim motion).
///
///    L = C M C^-1,   C, M: products of axis rotations, the axis named first is turned about first (R = Rz Ry Rx)
/// C is the bone's "axis", and M has the angles of its degrees of freedom. A joint of the motion is the start of a
/// bone: it is where the parent bone ends, and its rotation turns the bone. In the rest pose all rotations are the
/// identity.
#pragma once

#include <string>       // notes
#include <string_view>  // texts
#include <vector>       // notes

#include <motionlang/file/file_path.hpp>
#include <motionlang/formats/detail/asf_skeleton.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct AmcReadOptions {
  double fps = 120;  // the format does not state it
};

/// Reads the text of an ASF file. Throws io_error 402 (too short), 403 (malformed), 405 (too many bones).
AsfSkeleton parse_asf(std::string_view text, std::string_view name = "ASF text");
/// Throws io_error 401 and as parse_asf.
AsfSkeleton read_asf(const FilePath& path);

/// One joint for each bone, at its start; metres.
Skeleton to_skeleton(const AsfSkeleton& asf);

/// Reads the text of an AMC file that belongs to the skeleton. Bones that no frame names stay at rest. Bones keep their
/// length. A translated bone (tx, ty, tz) begins at its mean place, and changing lengths (l) are left out.
/// notes  gets a sentence for each bone of which something is left out
/// Throws io_error 402 (too short), 403 (malformed; unknown bone; frames that are not numbered consecutively; bones
/// that a frame names twice or omits although others name them), 405 (far more bones than values), config_error 101
/// (fps), numeric_error 301 (values so large that they overflow).
Motion parse_amc(std::string_view text, const AsfSkeleton& asf, const AmcReadOptions& options = {},
                 std::string_view name = "AMC text", std::vector<std::string>* notes = nullptr);
/// Throws io_error 401 and as parse_amc.
Motion read_amc(const FilePath& path, const AsfSkeleton& asf, const AmcReadOptions& options = {},
                std::vector<std::string>* notes = nullptr);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/amc.ipp>
#endif
