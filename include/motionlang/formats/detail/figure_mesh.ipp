// SPDX-License-Identifier: MIT
// Bodies of figure_mesh.hpp.
#pragma once

#include <cmath>    // angles
#include <numbers>  // pi

#include <motionlang/formats/detail/figure_mesh.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Adds the surface of a cone: rings from the pole beyond `from` to the pole beyond `to`.
///     position = centre + r n,   n = cos(latitude) (cos a u + sin a v) + sin(latitude) axis
/// The straight part touches both spheres at the latitude s with sin s = (r_from - r_to) / length.
inline void add_round_cone(FigureMesh& mesh, const RoundCone& cone, const Vec3<double>& origin) {
  constexpr int around = 16, rings = 5;  // of each half
  constexpr double half_pi = std::numbers::pi / 2;
  const Vec3<double> bone = cone.to - cone.from;
  const double length = norm(bone), difference = cone.radius_from - cone.radius_to;
  const Vec3<double> axis = length > 1e-9 ? normalized(bone) : Vec3<double>{0, 1, 0};
  const Vec3<double> u =
      normalized(cross(axis, std::abs(axis.y) < 0.9 ? Vec3<double>{0, 1, 0} : Vec3<double>{1, 0, 0}));
  const Vec3<double> v = cross(axis, u);
  const double seam =
      std::abs(difference) < length ? std::asin(difference / length) : std::copysign(half_pi, difference);

  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (int ring = 0; ring < 2 * (rings + 1); ++ring) {
    const bool start = ring <= rings;
    const double share = static_cast<double>(start ? ring : ring - rings - 1) / rings;
    const double latitude = start ? -half_pi + share * (seam + half_pi) : seam + share * (half_pi - seam);
    for (int k = 0; k < around; ++k) {
      const double a = 2 * std::numbers::pi * k / around;
      const Vec3<double> n = std::cos(latitude) * (std::cos(a) * u + std::sin(a) * v) + std::sin(latitude) * axis;
      const Vec3<double> centre = origin + (start ? cone.from : cone.to);
      mesh.positions.push_back(vec_cast<float>(centre + (start ? cone.radius_from : cone.radius_to) * n));
      mesh.normals.push_back(vec_cast<float>(n));
      mesh.joints.push_back(static_cast<std::uint16_t>(cone.joint));
    }
  }
  for (std::uint32_t ring = 0; ring + 1 < 2 * (rings + 1); ++ring) {
    for (std::uint32_t k = 0; k < around; ++k) {
      const std::uint32_t a = first + ring * around + k, b = first + ring * around + (k + 1) % around;
      if (ring > 0) mesh.triangles.insert(mesh.triangles.end(), {a, b, a + around});  // else a = b: the pole
      if (ring < 2 * rings) mesh.triangles.insert(mesh.triangles.end(), {b, b + around, a + around});
    }
  }
}

MOTIONLANG_BODY FigureMesh make_mesh(const Figure& figure, const Skeleton& skeleton) {
  const std::vector<Vec3<double>> rest = skeleton.rest_positions();
  FigureMesh mesh;
  for (const RoundCone& c : figure.cones) add_round_cone(mesh, c, rest[static_cast<std::size_t>(c.joint)]);
  return mesh;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
