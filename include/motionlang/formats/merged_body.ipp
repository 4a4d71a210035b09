// SPDX-License-Identifier: MIT
// Bodies of merged_body.hpp.
#pragma once

#include <utility>  // pair

#include <motionlang/file/npz.hpp>
#include <motionlang/formats/body_file.hpp>
#include <motionlang/formats/merged_body.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void merge_smplh(const FilePath& body, const FilePath& left, const FilePath& right,
                                 const FilePath& out) {
  const detail::BodyArrays arrays(body);
  if (const auto joints = std::ssize(detail::body_parents(arrays)); body_kind_of(joints) != BodyKind::smplh)
    raise<io_error>(407, arrays.file(), ": a body of ", counted(joints, "joint"),
                    "; hands belong to SMPL-H, which has 52");
  std::vector<NamedArray> merged;
  for (const char* name : {"v_template", "f", "shapedirs", "posedirs", "J_regressor", "weights", "kintree_table"})
    merged.push_back({name, arrays.read(name)});
  if (arrays.has("J")) merged.push_back({"J", arrays.read("J")});
  for (const auto& [file, side] : {std::pair{&left, "l"}, {&right, "r"}}) {
    const detail::BodyArrays hand(*file);
    for (const auto& [name, shape] :
         {std::pair{"hands_components", std::vector<Index>{-1, 45}}, {"hands_mean", {45}}}) {
      if (!hand.has(name)) raise<io_error>(406, hand.file(), ": no '", name, "'; not a hand of MANO");
      hand.read<double>(name, shape);  // checks that it has that shape, and is finite
      merged.push_back({concat_text(name, side), hand.read(name)});
    }
    if (hand.has("hands_coeffs")) merged.push_back({concat_text("hands_coeffs", side), hand.read("hands_coeffs")});
  }
  write_npz(out, merged);
}

MOTIONLANG_NAMESPACE_END
