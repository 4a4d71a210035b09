// Golden functions: rotation conversions and forward kinematics, over float and double.
#include <motionlang/geometry/euler.hpp>
#include <motionlang/geometry/pytorch3d.hpp>
#include <motionlang/kinematics/forward.hpp>

#include "geometry.hpp"

namespace {

using golden::append, golden::Case, golden::Registration;
namespace ml = motionlang;

template <class S>
constexpr const char* variant = sizeof(S) == 8 ? "double" : "float";

// Values of a tensor as geometry, and back.
template <class S>
using Row = std::span<const S>;
template <class S>
ml::Vec3<S> vec(Row<S> r) {
  return {r[0], r[1], r[2]};
}
template <class S>
ml::Quaternion<S> quaternion(Row<S> r) {
  return {r[0], r[1], r[2], r[3]};
}
template <class S>
ml::Matrix3<S> matrix(Row<S> r) {
  ml::Matrix3<S> m;
  for (std::size_t i = 0; i < 9; ++i) m.m[i] = r[i];
  return m;
}
template <class S>
void append(std::vector<S>& out, const ml::EulerAngles<S>& e) {
  out.insert(out.end(), {e.a, e.b, e.c});
}

/// Computes `name` = f(row of a, row of b) for every row, if the case asks for it.
template <class S, class F>
void map_rows(Case& c, const std::string& name, const std::string& a, const std::string& b, F f) {
  if (!c.wants(name)) return;
  const auto va = c.values<S>("in/" + a), vb = c.values<S>("in/" + b);
  const auto rows = static_cast<std::size_t>(c.shape("in/" + a)[0]);
  std::vector<S> out;
  for (std::size_t i = 0; i < rows; ++i) {
    const std::size_t wa = va.size() / rows, wb = vb.size() / rows;
    append(out, f(Row<S>(va).subspan(i * wa, wa), Row<S>(vb).subspan(i * wb, wb)));
  }
  c.out(name, c.shape("out/" + name), out);
}
template <class S, class F>
void map_rows(Case& c, const std::string& name, const std::string& a, F f) {
  map_rows<S>(c, name, a, a, [&](Row<S> r, Row<S>) { return f(r); });
}

/// Two vectors behind each other, as the 6D forms are stored.
template <class S>
struct Six {
  ml::Vec3<S> a, b;
};
template <class S>
void append(std::vector<S>& out, const Six<S>& six) {
  append(out, six.a), append(out, six.b);
}

template <class S>
void rotation_conversions(Case& c) {
  using V = ml::Vec3<S>;
  using Q = ml::Quaternion<S>;
  namespace p3d = ml::pytorch3d;
  const auto axis_angle_quaternion = [](Row<S> r) { return ml::to_quaternion(ml::AxisAngle<S>{vec(r)}); };
  map_rows<S>(c, "axis_angle_to_quaternion", "axis_angle", axis_angle_quaternion);
  map_rows<S>(c, "axis_angle_to_matrix", "axis_angle", [&](auto r) { return to_matrix(axis_angle_quaternion(r)); });
  map_rows<S>(c, "axis_angle_to_matrix_rodrigues", "axis_angle", [](auto r) { return p3d::rodrigues(vec(r)); });

  map_rows<S>(c, "quaternion_to_matrix", "quaternion", [](auto r) { return to_matrix(quaternion(r)); });
  map_rows<S>(c, "quaternion_to_axis_angle", "quaternion",
              [](auto r) { return p3d::quaternion_to_axis_angle(quaternion(r)); });
  map_rows<S>(c, "quaternion_to_cont6d", "quaternion", [](auto r) {
    const auto six = ml::to_rotation6d_columns(quaternion(r));
    return Six<S>{six.a, six.b};
  });
  map_rows<S>(c, "matrix_to_quaternion", "matrix", [](auto r) { return p3d::matrix_to_quaternion(matrix(r)); });
  map_rows<S>(c, "matrix_to_axis_angle", "matrix", [](auto r) { return p3d::matrix_to_axis_angle(matrix(r)); });
  map_rows<S>(c, "matrix_to_rot6d", "matrix", [](auto r) {
    const auto six = ml::to_rotation6d_rows(matrix(r));
    return Six<S>{six.a, six.b};
  });
  map_rows<S>(c, "rot6d_to_matrix", "rot6d", [](auto r) {
    return to_matrix(ml::Rotation6dRows<S>{vec(r), vec(r.subspan(3))});
  });
  map_rows<S>(c, "cont6d_to_matrix", "cont6d", [](auto r) {
    return to_matrix(ml::Rotation6dColumns<S>{vec(r), vec(r.subspan(3))});
  });

  map_rows<S>(c, "quaternion_multiply_raw", "quaternion", "quaternion_b",
              [](auto a, auto b) { return quaternion(a) * quaternion(b); });
  map_rows<S>(c, "quaternion_multiply", "quaternion", "quaternion_b", [](auto a, auto b) {
    const Q product = quaternion(a) * quaternion(b);
    return product.w < 0 ? -product : product;
  });
  map_rows<S>(c, "quaternion_invert", "quaternion", [](auto r) { return inverse(quaternion(r)); });
  map_rows<S>(c, "quaternion_apply", "quaternion", "axis_angle", [](auto a, auto b) {  // q p q*, q of any length
    const V point = vec(b);
    return (quaternion(a) * Q{S(0), point.x, point.y, point.z} * inverse(quaternion(a))).vec();
  });

  for (const auto& letters : c.config()["euler_conventions"].as<std::vector<std::string>>()) {
    const auto order = ml::EulerOrder::parse(letters);
    map_rows<S>(c, "euler_" + letters + "_to_matrix", "euler", [&](auto r) {
      return to_matrix(ml::EulerAngles<S>{r[0], r[1], r[2], order});
    });
    map_rows<S>(c, "matrix_to_euler_" + letters, "matrix", [&](auto r) { return ml::to_euler(matrix(r), order); });
  }
}

/// The same formulas in double, under the names of the 205-vector's code.
void smplrifke_rotations(Case& c) {
  using S = double;
  namespace p3d = ml::pytorch3d;
  const auto q = [](Row<S> r) { return ml::to_quaternion(ml::AxisAngle<S>{vec(r)}); };
  map_rows<S>(c, "quaternion", "axis_angle", q);
  map_rows<S>(c, "matrix", "axis_angle", [&](auto r) { return to_matrix(q(r)); });
  map_rows<S>(c, "six_d", "axis_angle", [&](auto r) {
    const auto six = ml::to_rotation6d_rows(q(r));
    return Six<S>{six.a, six.b};
  });
  map_rows<S>(c, "quaternion_from_matrix", "axis_angle",
              [&](auto r) { return p3d::matrix_to_quaternion(to_matrix(q(r))); });
  map_rows<S>(c, "axis_angle_from_matrix", "axis_angle",
              [&](auto r) { return p3d::matrix_to_axis_angle(to_matrix(q(r))); });
  map_rows<S>(c, "euler_zyx", "axis_angle", [&](auto r) { return ml::to_euler(q(r), ml::EulerOrder::parse("ZYX")); });
  map_rows<S>(c, "matrix_from_six_d", "six_d_raw", [](auto r) {
    return to_matrix(ml::Rotation6dRows<S>{vec(r), vec(r.subspan(3))});
  });
}

template <class S>
void smplx_forward_kinematics(Case& c) {
  const auto parents = c.values<int>("in/parents");
  const auto rest = c.values<double>("in/rest_joints");
  const auto rotations = c.values<S>("in/rotations"), translation = c.values<S>("in/translation");
  const std::size_t joints = parents.size(), poses = translation.size() / 3;

  std::vector<std::string> names;
  std::vector<ml::Vec3<double>> position, offsets;
  for (std::size_t j = 0; j < joints; ++j) {
    names.push_back(std::to_string(j));
    position.push_back(vec(Row<double>(rest).subspan(3 * j)));
    offsets.push_back(parents[j] < 0 ? position[j] : position[j] - position[static_cast<std::size_t>(parents[j])]);
  }
  const auto skeleton = ml::Skeleton::from_arrays(names, parents, offsets);

  std::vector<S> out_joints, out_translated, out_rotations, out_skinning;
  for (std::size_t n = 0; n < poses; ++n) {
    std::vector<ml::Matrix3<S>> local;
    for (std::size_t j = 0; j < joints; ++j) local.push_back(matrix(Row<S>(rotations).subspan(9 * (n * joints + j))));
    const auto world =
        ml::forward_kinematics(skeleton, std::span<const ml::Matrix3<S>>(local), ml::vec_cast<S>(skeleton.offset(0)));
    for (std::size_t j = 0; j < joints; ++j) {
      const auto& p = world.position[j];
      const auto& r = world.rotation[j];
      append(out_joints, p);
      append(out_translated, p + vec(Row<S>(translation).subspan(3 * n)));
      append(out_rotations, r);
      const auto shift = p - r * ml::vec_cast<S>(position[j]);
      for (int row = 0; row < 3; ++row) {
        append(out_skinning, r.row(row));
        out_skinning.push_back(row == 0 ? shift.x : row == 1 ? shift.y : shift.z);
      }
    }
  }
  const auto N = static_cast<ml::Index>(poses), J = static_cast<ml::Index>(joints);
  c.out("joints", {N, J, 3}, out_joints);
  c.out("joints_translated", {N, J, 3}, out_translated);
  c.out("global_rotations", {N, J, 3, 3}, out_rotations);
  c.out("skinning_transforms", {N, J, 3, 4}, out_skinning);
}

const Registration registrations[] = {
    {"pytorch3d rotation conversions", variant<double>, rotation_conversions<double>},
    {"pytorch3d rotation conversions", variant<float>, rotation_conversions<float>},
    {"smplrifke rotation conversions", variant<double>, smplrifke_rotations},
    {"smplx forward kinematics", variant<double>, smplx_forward_kinematics<double>},
    {"smplx forward kinematics", variant<float>, smplx_forward_kinematics<float>},
};

}  // namespace
