// SPDX-License-Identifier: MIT
/// SMPL-H with the hands of MANO in one file, as TEMOS wants it: the downloads have them apart.
///
///     merge_smplh("smplh/male/model.npz", "MANO_LEFT.pkl", "MANO_RIGHT.pkl", "smplh/SMPLH_MALE.npz");
///
/// Source   vchoutas/smplx tools/merge_smplh_mano.py: hands_components, hands_mean, hands_coeffs of MANO, with l and r
///          behind
/// Differs  from TEMOS' script: the members of the archive are stored, not deflated; what forward passes do not read is
///          left out
#pragma once

#include <motionlang/file/file_path.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Throws  io_error 401 to 407 for files that cannot be read, and for a body of other than 52 joints or another hand;
///         numeric_error 301
void merge_smplh(const FilePath& body, const FilePath& left, const FilePath& right, const FilePath& out);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/merged_body.ipp>
#endif
