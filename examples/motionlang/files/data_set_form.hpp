// Data sets in the form of HumanML3D. The width of their rows says which one it is: HumanML3D itself or KIT-ML.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/file/npy.hpp>

namespace program {

namespace ml = motionlang;

struct DataSetForm {
  std::string_view features;  // motion_features.hpp
  ml::HumanMl3dForm form;
};
inline constexpr DataSetForm data_set_forms[]{{"guoh3d", ml::humanml3d_form}, {"kit", ml::kit_ml_form}};

/// "guoh3d (263 numbers) or kit (251 numbers)"
inline std::string known_data_sets() {
  return ml::join_text(data_set_forms, " or ", [](const DataSetForm& f) {
    return ml::concat_text(f.features, " (", ml::counted(f.form.width(), "number"), ")");
  });
}

/// The form with rows of these features; null: there is none.
inline const DataSetForm* find_data_set_form(std::string_view features) {
  for (const DataSetForm& f : data_set_forms) {
    if (f.features == features) return &f;
  }
  return nullptr;
}

/// Of a file of NumPy's, from its header. Throws io_error 401 to 405.
inline std::vector<ml::Index> npy_shape(const std::filesystem::path& npy) {
  return ml::detail::npy_parts(ml::MappedFile::open(npy)->bytes(), npy.string()).header.shape;
}

/// The form of a file of features, by the width of its rows. Throws io_error 401 to 405, 407 for another width.
inline const DataSetForm& data_set_form_of(const std::filesystem::path& npy) {
  const auto shape = npy_shape(npy);
  for (const DataSetForm& f : data_set_forms) {
    if (shape.size() == 2 && shape[1] == f.form.width()) return f;
  }
  ml::raise<ml::io_error>(407, npy.string(), ": an array ", ml::detail::shape_text(shape), ", expected rows of ",
                          known_data_sets());
}

inline bool is_data_set(const std::filesystem::path& folder) {
  return std::filesystem::exists(folder / "new_joint_vecs");
}
/// Of a clip of a data set: the file of its features.
inline std::filesystem::path rows_file(const std::filesystem::path& folder, const std::string& id) {
  return folder / "new_joint_vecs" / (id + ".npy");
}

}  // namespace program
