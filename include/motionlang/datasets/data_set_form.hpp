// SPDX-License-Identifier: MIT
/// Data sets in the form of HumanML3D. The width of their rows tells which one it is: HumanML3D itself or KIT-ML.
///
///     if (is_data_set(folder)) data_set_form_of(rows_file(folder, "000012")).features;   // "guoh3d" or "kit"
#pragma once

#include <filesystem>   // paths
#include <string>       // ids
#include <string_view>  // features

#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/file/npy.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct DataSetForm {
  std::string_view features;  // motion_features.hpp
  HumanMl3dForm form;
};
inline constexpr DataSetForm data_set_forms[]{{"guoh3d", humanml3d_form}, {"kit", kit_ml_form}};

/// "guoh3d (263 numbers) or kit (251 numbers)"
std::string known_data_sets();

/// The form whose rows are these features; null if there is none.
const DataSetForm* find_data_set_form(std::string_view features);

/// The shape of the array in an .npy file, from its header. Throws io_error 401 to 405.
std::vector<Index> npy_shape(const std::filesystem::path& npy);

/// The form of a file of features, by the width of its rows. Throws io_error 401 to 405, 407 for another width.
const DataSetForm& data_set_form_of(const std::filesystem::path& npy);
/// True if a folder has features in the form of HumanML3D.
inline bool is_data_set(const std::filesystem::path& folder) {
  return std::filesystem::exists(folder / "new_joint_vecs");
}
/// The file with the features of a clip of a data set.
inline std::filesystem::path rows_file(const std::filesystem::path& folder, const std::string& id) {
  return folder / "new_joint_vecs" / (id + ".npy");
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/data_set_form.ipp>
#endif
