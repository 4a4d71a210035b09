// SPDX-License-Identifier: MIT
/// Reads the user's own SMPL, SMPL-H and SMPL-X files, .npz or .pkl, as body models. The content of a file decides its
/// form, and the number of joints the kind of body. A body with any other number of joints is read, too. None of these
/// files is or may be part of this library.
///
///     auto file = find_body_file("models", BodyKind::smplh);
///     auto body = read_body<EigenBackend<float>>(file, {.betas = 16});
///     auto posed = body.model(betas, rotations, translation);        // vertices, joints, extra points
///
/// Coefficients are those of shape and then those of expression. Source: vchoutas/smplx smplx/body_models.py.
#pragma once

#include <algorithm>    // copy_n, max, min
#include <array>        // faces
#include <cmath>        // abs
#include <memory>       // the file
#include <optional>     // hands
#include <span>         // faces
#include <string>       // names of files
#include <string_view>  // names of arrays
#include <vector>       // numbers

#include <motionlang/file/file_path.hpp>
#include <motionlang/kinematics/body.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct NpyArray;

struct BodyFileOptions {
  Index betas = 10;      // shape coefficients, which the file must have
  Index most_betas = 0;  // take this many if the file has more than `betas`
  /// SMPL-X: expression coefficients, which follow those of shape. -1: those in the file, up to 10.
  Index expressions = -1;
  /// SMPL-X: directions of shape in the file. 0: 300 of 400 directions, 10 of 20, and all in other files.
  Index shape_directions = 0;
  /// Adds nose, eyes, ears, feet and finger tips (kinematics/body.hpp), if the vertices are those of the kind.
  bool extra_points = true;
};

namespace detail {

/// The named arrays of a file of either form.
class BodyArrays {
 public:
  explicit BodyArrays(const FilePath& path);

  const std::string& file() const { return file_; }
  bool has(const char* name) const;
  NpyArray read(const char* name) const;
  /// An array of this shape; a size below 0 may be any. Throws io_error 407, and numeric_error 301 if a value is not
  /// finite. T: float, double or std::int64_t.
  template <class T>
  std::vector<T> read(const char* name, std::vector<Index> wanted, std::vector<Index>* found = nullptr) const;

 private:
  struct Source;  // one of two forms
  std::string file_;
  std::shared_ptr<const Source> source_;
};

/// Columns first ... first + count - 1 of every row.
template <class T>
void copy_columns(const std::vector<T>& from, Index width, Index first, Index count, std::vector<T>& to, Index to_width,
                  Index to_first) {
  for (Index row = 0; row < static_cast<Index>(from.size()) / width; ++row) {
    std::copy_n(from.begin() + row * width + first, count, to.begin() + row * to_width + to_first);
  }
}

/// Row 0: parents, -1 of any width for the root. Row 1: the joints' own numbers, which must be 0, 1, 2, ...
std::vector<int> body_parents(const BodyArrays& arrays);

template <class S>
void check_weights(const BodyArrays& arrays, const std::vector<S>& weights, Index joints) {
  for (std::size_t at = 0; at < weights.size(); at += static_cast<std::size_t>(joints)) {
    double sum = 0;
    for (Index j = 0; j < joints; ++j) sum += static_cast<double>(weights[at + static_cast<std::size_t>(j)]);
    if (std::abs(sum - 1) > 1e-3) {
      raise<io_error>(403, arrays.file(), ": 'weights' of vertex ", at / static_cast<std::size_t>(joints),
                      " sum up to ", sum);
    }
  }
}

std::vector<std::array<Index, 3>> body_faces(const BodyArrays& arrays, Index vertices);

template <Backend B>
std::optional<HandPoses<B>> hand_poses(const BodyArrays& arrays, const char* components, const char* mean) {
  if (!arrays.has(components)) return std::nullopt;
  using S = typename B::scalar;
  std::vector<Index> shape;
  const auto rows = arrays.read<S>(components, {-1, 45}, &shape);
  return HandPoses<B>{Tensor<B, 2>::from(rows, {shape[0], 45}), Tensor<B, 1>::from(arrays.read<S>(mean, {45}), {45})};
}

/// The index of the first direction of expression: 300 shape and 100 expression directions in new files, 10 and 10 in
/// old ones.
Index first_expression(BodyKind kind, Index directions, Index told);

/// Points on triangles: one row of triangles, or several.
std::vector<SurfacePoints> rows_of_points(const BodyArrays& arrays, const char* triangles, const char* weights,
                                          std::span<const std::array<Index, 3>> faces);

bool readable(const FilePath& path);

}  // namespace detail

/// Throws  io_error 401 to 407 for files that cannot be read or are not a body, numeric_error 301 for values that are
///         not finite, config_error 101 if the file has too few coefficients
template <Backend B>
Body<B> read_body(const FilePath& path, const BodyFileOptions& options = {}) {
  using S = typename B::scalar;
  const detail::BodyArrays arrays(path);
  Body<B> body;
  BodyModel<B>& model = body.model;
  model.parents = detail::body_parents(arrays);
  const Index joints = model.joints();
  body.kind = body_kind_of(joints);

  std::vector<Index> shape;
  auto tensor = [](const std::vector<S>& values, Index rows, Index columns) {
    return Tensor<B, 2>::from(values, {rows, columns});
  };
  const auto points = arrays.read<S>("v_template", {-1, 3}, &shape);
  const Index vertices = shape[0];
  model.v_template = tensor(points, vertices, 3);
  model.posedirs = tensor(arrays.read<S>("posedirs", {vertices, 3, 9 * (joints - 1)}), 3 * vertices, 9 * (joints - 1));
  model.J_regressor = tensor(arrays.read<S>("J_regressor", {joints, vertices}), joints, vertices);
  const auto weights = arrays.read<S>("weights", {vertices, joints});
  detail::check_weights(arrays, weights, joints);
  model.weights = tensor(weights, vertices, joints);

  const auto directions = arrays.read<S>("shapedirs", {vertices, 3, -1}, &shape);
  const Index first_expression = detail::first_expression(body.kind, shape[2], options.shape_directions);
  const Index betas = std::max(options.betas, std::min(options.most_betas, first_expression));
  const Index expressions =
      options.expressions >= 0 ? options.expressions : std::min<Index>(10, shape[2] - first_expression);
  body.expressions = body.kind == BodyKind::smplx ? expressions : 0;
  if (options.betas < 0 || options.betas > first_expression || body.expressions < 0 ||
      body.expressions > shape[2] - first_expression) {
    raise<config_error>(101, path.string(), ": ", counted(options.betas, "coefficient"), " of shape and ",
                        body.expressions, " of expression asked for, the file has ", first_expression, " and ",
                        shape[2] - first_expression);
  }
  const Index wanted = betas + body.expressions;
  std::vector<S> chosen(static_cast<std::size_t>(3 * vertices * wanted));
  if (shape[2] > 0) {
    detail::copy_columns(directions, shape[2], 0, betas, chosen, wanted, 0);
    detail::copy_columns(directions, shape[2], first_expression, body.expressions, chosen, wanted, betas);
  }
  model.shapedirs = tensor(chosen, 3 * vertices, wanted);

  body.faces = detail::body_faces(arrays, vertices);
  const bool published =
      body.kind != BodyKind::other && vertices == body_kinds[static_cast<std::size_t>(body.kind)].vertices;
  if (options.extra_points && published) model.extra = extra_vertices(body.kind);
  body.left_hand = detail::hand_poses<B>(arrays, "hands_componentsl", "hands_meanl");
  body.right_hand = detail::hand_poses<B>(arrays, "hands_componentsr", "hands_meanr");
  const std::span<const std::array<Index, 3>> faces(body.faces);
  if (auto rows = detail::rows_of_points(arrays, "lmk_faces_idx", "lmk_bary_coords", faces); !rows.empty())
    body.landmarks = std::move(rows.front());
  body.contours = detail::rows_of_points(arrays, "dynamic_lmk_faces_idx", "dynamic_lmk_bary_coords", faces);
  model.validate();
  return body;
}

/// The poses of a hand from MANO's own file, for SMPL-H bodies whose file has none:
///
///     body.left_hand = read_hand<B>("MANO_LEFT.pkl");
/// Throws  as read_body; io_error 406 for a file without the arrays
template <Backend B>
HandPoses<B> read_hand(const FilePath& path) {
  const detail::BodyArrays arrays(path);
  if (auto hand = detail::hand_poses<B>(arrays, "hands_components", "hands_mean")) return std::move(*hand);
  raise<io_error>(406, path.string(), ": no 'hands_components'; not a hand of MANO");
}

/// The file of a body below a folder, under one of its usual names: smpl/SMPL_NEUTRAL.pkl, smplh/SMPLH_MALE.npz,
/// smplh/female/model.npz, smplx/SMPLX_NEUTRAL.npz, and the names of the downloads.
/// Throws  io_error 401 if there is none, with the place where it can be downloaded; config_error 101 for a body of
///         kind `other`
FilePath find_body_file(const FilePath& root, BodyKind kind, BodyGender gender = BodyGender::neutral);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/body_file.ipp>
#endif
