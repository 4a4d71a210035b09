// SPDX-License-Identifier: MIT
// Bodies of data_set_form.hpp.
#pragma once

#include <motionlang/datasets/data_set_form.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string known_data_sets() {
  return join_text(data_set_forms, " or ", [](const DataSetForm& f) {
    return concat_text(f.features, " (", counted(f.form.width(), "number"), ")");
  });
}

MOTIONLANG_BODY const DataSetForm* find_data_set_form(std::string_view features) {
  for (const DataSetForm& f : data_set_forms) {
    if (f.features == features) return &f;
  }
  return nullptr;
}

MOTIONLANG_BODY std::vector<Index> npy_shape(const std::filesystem::path& npy) {
  return detail::npy_parts(MappedFile::open(npy)->bytes(), npy.string()).header.shape;
}

MOTIONLANG_BODY const DataSetForm& data_set_form_of(const std::filesystem::path& npy) {
  const auto shape = npy_shape(npy);
  for (const DataSetForm& f : data_set_forms) {
    if (shape.size() == 2 && shape[1] == f.form.width()) return f;
  }
  raise<io_error>(407, npy.string(), ": an array ", detail::shape_text(shape), ", expected rows of ",
                  known_data_sets());
}

MOTIONLANG_NAMESPACE_END
