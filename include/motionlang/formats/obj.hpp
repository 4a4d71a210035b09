// SPDX-License-Identifier: MIT
/// Wavefront OBJ: a surface in one pose, for every program that shows meshes. Y up, metres.
#pragma once

#include <array>   // faces
#include <vector>  // faces

#include <motionlang/core/shape.hpp>
#include <motionlang/file/file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// vertices (V, 3), one after the other; faces: three vertices each, counted from 0.
/// Throws shape_error 205 if vertices are not triples or a face names a vertex that does not exist, numeric_error 301
template <class S>
std::string obj_text(std::span<const S> vertices, std::span<const std::array<Index, 3>> faces) {
  if (vertices.size() % 3 != 0)
    raise<shape_error>(205, "OBJ: ", counted(vertices.size(), "coordinate"), " of vertices");
  const auto count = static_cast<Index>(vertices.size()) / 3;
  std::string out;
  for (std::size_t i = 0; i < vertices.size(); i += 3) {
    for (std::size_t c = 0; c < 3; ++c) {
      if (!(vertices[i + c] - vertices[i + c] == 0)) raise<numeric_error>(301, "OBJ: vertex ", i / 3, " is not finite");
    }
    out += concat_text("v ", vertices[i], " ", vertices[i + 1], " ", vertices[i + 2], "\n");
  }
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (const Index v : faces[i]) {
      if (v < 0 || v >= count) raise<shape_error>(205, "OBJ: face ", i, " has vertex ", v, " of ", count);
    }
    out += concat_text("f ", faces[i][0] + 1, " ", faces[i][1] + 1, " ", faces[i][2] + 1, "\n");
  }
  return out;
}

/// Throws io_error 401, and what obj_text throws.
template <class S>
void write_obj(const FilePath& path, std::span<const S> vertices, std::span<const std::array<Index, 3>> faces) {
  write_file(path, obj_text(vertices, faces));
}

MOTIONLANG_NAMESPACE_END
