// SPDX-License-Identifier: MIT
/// Merges SMPL-H and the hands of MANO into one file for TEMOS. The downloads have them in separate files.
///
///     merge_smplh("smplh/male/model.npz", "MANO_LEFT.pkl", "MANO_RIGHT.pkl", "smplh/SMPLH_MALE.npz");
///
/// Source   vchoutas/smplx tools/merge_smplh_mano.py: hands_components, hands_mean, hands_coeffs of MANO, with the
///          suffixes l and r
/// Differs  from TEMOS' script: the members of the archive are stored, not deflated; arrays that forward passes do not
///          read are left out
#pragma once

#include <motionlang/file/file_path.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Throws  io_error 401 to 407 for files that cannot be read, for a body without 52 joints, and for another kind of
///         hand; numeric_error 301
void merge_smplh(const FilePath& body, const FilePath& left, const FilePath& right, const FilePath& out);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/merged_body.ipp>
#endif
