// SPDX-License-Identifier: MIT
/// The landmarks of a face: first those that stay on their triangles, then those of its contour. The latter move over
/// the cheek when the head turns away from the camera.
///
///     const auto posed = body.model(betas, rotations, translation);
///     // SMPL-X: 144 points.
///     const auto points = concat(1, posed.joints, posed.extra, face_landmarks(body, posed.vertices, rotations));
///
/// Source  vchoutas/smplx smplx/lbs.py find_dynamic_lmk_idx_and_bcoords; dynamic_lmk_faces_idx of the model files has a
///         contour for each angle of the neck
#pragma once

#include <algorithm>  // bounds
#include <cmath>      // atan2

#include <motionlang/geometry/degree.hpp>
#include <motionlang/kinematics/body.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The contour of a head that faces the direction of R, the world rotation of the neck.
///     angle = -atan2(-R_20, sqrt(R_00^2 + R_10^2))   in degrees, rounded: negative for a turn to the left
///     row   = angle                for 0, 1, ..., h         h = (contours - 1) / 2, published 39; larger turns count
///           as h
///           = h + |angle|          for -1, -2, ..., -h
template <class S>
Index contour_row(const Matrix3<S>& r, Index contours) {
  const double turn =
      std::atan2(-static_cast<double>(r(2, 0)), std::hypot(static_cast<double>(r(0, 0)), static_cast<double>(r(1, 0))));
  const Index half = (contours - 1) / 2, angle = static_cast<Index>(std::nearbyint(-turn / degree));
  return angle >= 0 ? std::min(angle, half) : half + std::min(-angle, half);
}

/// vertices (N, V, 3) of the posed body, rotations (N, J, 9) that posed it -> (N, landmarks + points of a contour, 3).
/// Bodies without contours give only the landmarks. neck: its joint. Differentiable by the vertices.
/// Throws  shape_error 204 unless both have N poses and the rotations are those of the body, config_error 101 for a
///         neck that is not a joint
template <Backend B>
Tensor<B, 3> face_landmarks(const Body<B>& body, const Tensor<B, 3>& vertices, const Tensor<B, 3>& rotations,
                            Index neck = 12) {
  using S = typename B::scalar;
  const Index n = vertices.size(0), count = vertices.size(1), joints = body.model.joints();
  if (body.contours.empty()) return surface_points(vertices, body.landmarks);
  if (rotations.shape() != Shape{n, joints, 9})
    raise<shape_error>(204, "face_landmarks: rotations ", rotations.shape(), " for ", n, " poses of ", joints,
                       " joints");
  if (neck < 0 || neck >= joints) raise<config_error>(101, "face_landmarks: the neck is joint ", neck, " of ", joints);
  const auto local = rotations.span();
  SurfacePoints points;  // on the vertices of all poses, one after the other
  for (Index pose = 0; pose < n; ++pose) {
    Matrix3<S> world = Matrix3<S>::identity();
    for (Index j = neck; j >= 0; j = body.model.parents[static_cast<std::size_t>(j)]) {
      Matrix3<S> own;
      std::copy_n(local.begin() + 9 * (pose * joints + j), 9, own.m.begin());
      world = own * world;
    }
    const Index row = contour_row(world, std::ssize(body.contours));
    for (const SurfacePoints* some : {&body.landmarks, &body.contours[static_cast<std::size_t>(row)]}) {
      for (std::array<Index, 3> corners : some->corners) {
        for (Index& v : corners) v += pose * count;
        points.corners.push_back(corners);
      }
      points.weights.insert(points.weights.end(), some->weights.begin(), some->weights.end());
    }
  }
  return reshape<3>(surface_points(reshape<3>(vertices, {1, n * count, 3}), points),
                    {n, points.size() / std::max<Index>(n, 1), 3});
}

MOTIONLANG_NAMESPACE_END
