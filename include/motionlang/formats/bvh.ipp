// SPDX-License-Identifier: MIT
// Bodies of bvh.hpp.
#pragma once

#include <algorithm>      // any_of, count_if, max, min
#include <cmath>          // round
#include <numbers>        // pi
#include <unordered_map>  // names
#include <unordered_set>  // names
#include <utility>        // exchange

#include <motionlang/core/text_encoding.hpp>
#include <motionlang/core/text_lines.hpp>
#include <motionlang/core/utf8.hpp>
#include <motionlang/file/detail/text_scanner.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/geometry/degree.hpp>
#include <motionlang/kinematics/body_root.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Frame times are printed with few digits: 0.0166667 s means 60 frames per second.
inline double frames_per_second(double frame_time) {
  const double fps = 1 / frame_time, whole = std::round(fps);
  return fps < 1000 && whole > 0 && std::abs(1 / whole - frame_time) < 1e-6 ? whole : fps;
}

inline double& coordinate(Vec3<double>& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

/// q times the rotation by `angle` about the coordinate axis x, y or z.
inline Quaternion<double> turned(const Quaternion<double>& q, int axis, double angle) {
  const double c = std::cos(0.5 * angle), s = std::sin(0.5 * angle);
  if (axis == 0) return {q.w * c - q.x * s, q.x * c + q.w * s, q.y * c + q.z * s, q.z * c - q.y * s};
  if (axis == 1) return {q.w * c - q.y * s, q.x * c - q.z * s, q.y * c + q.w * s, q.z * c + q.x * s};
  return {q.w * c - q.z * s, q.x * c + q.y * s, q.y * c - q.x * s, q.z * c + q.w * s};
}

/// Gives every name only once: "Hand", "Hand_2", "Hand_3".
class UniqueNames {
 public:
  std::string operator()(const std::string& name) {
    int& number = next_.try_emplace(name, 1).first->second;
    std::string unique = name;
    for (; !taken_.insert(unique).second; unique = name + "_" + std::to_string(number)) ++number;
    return unique;
  }

 private:
  std::unordered_set<std::string> taken_;
  std::unordered_map<std::string, int> next_;  // the number that was tried last
};

/// A joint of the file with the place of its channels in a frame.
struct BvhJoint {
  const BvhNode* node;
  int number;       // among the nodes
  int parent = -1;  // among the joints that are kept
  std::size_t first_channel;

  bool has_positions() const {
    return std::any_of(node->channels.begin(), node->channels.end(), [](BvhChannel c) { return !is_rotation(c); });
  }
  Vec3<double> translation(std::span<const double> frame) const {
    Vec3<double> t = node->offset;
    for (std::size_t c = 0; c < node->channels.size(); ++c) {
      const BvhChannel channel = node->channels[c];
      if (!is_rotation(channel)) coordinate(t, axis_of(channel)) = frame[first_channel + c];
    }
    return t;
  }
  Quaternion<double> rotation(std::span<const double> frame) const {
    Quaternion<double> q = Quaternion<double>::identity();
    for (std::size_t c = 0; c < node->channels.size(); ++c) {
      const BvhChannel channel = node->channels[c];
      if (is_rotation(channel)) q = turned(q, axis_of(channel), frame[first_channel + c] * degree);
    }
    return q;
  }
};

/// Joints below the chosen root, without end sites, in file order.
inline std::vector<BvhJoint> bvh_joints(const Bvh& file, int root) {
  std::vector<BvhJoint> joints;
  std::vector<int> kept(file.nodes.size(), -1);  // node -> number among `joints`
  std::size_t channel = 0;
  int roots = 0;
  for (std::size_t n = 0; n < file.nodes.size(); ++n) {
    const BvhNode& node = file.nodes[n];
    const int parent = node.parent < 0 ? -1 : kept[static_cast<std::size_t>(node.parent)];
    const bool chosen = node.parent < 0 ? roots++ == root : parent >= 0;
    if (chosen && !node.end_site) {
      kept[n] = static_cast<int>(joints.size());
      joints.push_back({&node, static_cast<int>(n), parent, channel});
    }
    channel += node.channels.size();
  }
  if (joints.empty()) raise<config_error>(101, file.name, ": root ", root, " was asked for, the file has ", roots);
  return joints;
}

/// A table row by row; `Bvh::frame` would count the channels again for every row.
struct BvhTable {
  explicit BvhTable(const Bvh& file)
      : values(file.values), columns(static_cast<std::size_t>(file.channels())), rows(file.frames) {}
  std::span<const double> operator[](Index row) const {
    return values.subspan(static_cast<std::size_t>(row) * columns, columns);
  }
  std::span<const double> values;
  std::size_t columns;
  Index rows;
};

/// True if the positions of a joint change from frame to frame by more than rounding.
inline bool moves(const BvhJoint& joint, const BvhTable& table) {
  if (!joint.has_positions() || table.rows == 0) return false;
  const Vec3<double> first = joint.translation(table[0]);
  for (Index f = 1; f < table.rows; ++f) {
    if (norm(joint.translation(table[f]) - first) > 1e-4 * (1 + norm(first))) return true;
  }
  return false;
}

/// The extent of a joint's positions, in units of the file; 0 if they change by no more than rounding.
inline double way_of(const BvhJoint& joint, const BvhTable& table) {
  if (!moves(joint, table)) return 0;
  Vec3<double> low = joint.translation(table[0]), high = low;
  for (Index f = 1; f < table.rows; ++f) {
    const Vec3<double> t = joint.translation(table[f]);
    low = {std::min(low.x, t.x), std::min(low.y, t.y), std::min(low.z, t.z)};
    high = {std::max(high.x, t.x), std::max(high.y, t.y), std::max(high.z, t.z)};
  }
  return norm(high - low);
}

inline bool turns(const BvhJoint& joint, const BvhTable& table) {
  constexpr double rounding = 1e-3;  // degrees
  for (std::size_t c = 0; c < joint.node->channels.size(); ++c) {
    if (!is_rotation(joint.node->channels[c])) continue;
    for (Index f = 1; f < table.rows; ++f) {
      if (std::abs(table[f][joint.first_channel + c] - table[0][joint.first_channel + c]) > rounding) return true;
    }
  }
  return false;
}

/// The joints of a tree of the file by their roles in the body.
struct BvhBody {
  std::vector<BvhJoint> carriers{};  // above the root of the body, from the top: their movement is the root's
  std::vector<BvhJoint> joints{};    // the root and what is below it
  std::vector<BvhJoint> beside{};    // outside the body: bones for inverse kinematics, props, cameras
};

inline BvhBody bvh_body(const Bvh& file, const BvhReadOptions& options, const BvhTable& table) {
  std::vector<BvhJoint> all = bvh_joints(file, options.root);
  Skeleton skeleton;
  for (const BvhJoint& j : all) {
    skeleton.names.push_back(j.node->name);
    skeleton.parents.push_back(j.parent);
    skeleton.offsets.push_back(j.node->offset);
  }
  std::optional<SkeletonTable> own_table;
  if (options.find_table) own_table = options.find_table(skeleton);
  const SkeletonTable* table_of_names = own_table ? &*own_table : find_skeleton_table(skeleton);
  int root = table_of_names == nullptr ? -1 : body_root(skeleton, *table_of_names);
  if (root < 0) {
    std::vector<JointMovement> movements;
    movements.reserve(all.size());
    for (const BvhJoint& j : all) movements.push_back({way_of(j, table), turns(j, table)});
    root = moving_root(skeleton, movements);
  }
  std::vector<bool> in_body(all.size(), false), carries(all.size(), false);
  for (const int j : joints_from(skeleton, root)) in_body[static_cast<std::size_t>(j)] = true;
  for (int j = skeleton.parent(root); j >= 0; j = skeleton.parent(j)) carries[static_cast<std::size_t>(j)] = true;
  BvhBody body;
  std::vector<int> number(all.size(), -1);
  for (std::size_t j = 0; j < all.size(); ++j) {
    if (in_body[j]) {
      number[j] = static_cast<int>(body.joints.size());
      all[j].parent = body.joints.empty() ? -1 : number[static_cast<std::size_t>(all[j].parent)];
    }
    (in_body[j] ? body.joints : carries[j] ? body.carriers : body.beside).push_back(all[j]);
  }
  return body;
}

/// The offset of a joint below the root; position channels replace it by their mean (a skeleton has constant bones).
inline Vec3<double> constant_offset(const BvhJoint& joint, const BvhTable& table) {
  if (!joint.has_positions() || table.rows == 0) return joint.node->offset;
  Vec3<double> sum{};
  for (Index f = 0; f < table.rows; ++f) sum = sum + joint.translation(table[f]);
  return (1.0 / static_cast<double>(table.rows)) * sum;
}

/// The end sites of the joints; the first one if a joint has several; none if the file has none.
inline std::vector<Vec3<double>> bvh_ends(const Bvh& file, std::span<const BvhJoint> joints, double scale) {
  std::vector<Vec3<double>> ends;
  std::vector<int> joint_of(file.nodes.size(), -1);  // that has no end yet
  for (std::size_t j = 0; j < joints.size(); ++j)
    joint_of[static_cast<std::size_t>(joints[j].number)] = static_cast<int>(j);
  for (const BvhNode& node : file.nodes) {
    if (!node.end_site || node.parent < 0) continue;
    const int joint = std::exchange(joint_of[static_cast<std::size_t>(node.parent)], -1);
    if (joint < 0) continue;
    ends.resize(joints.size());
    ends[static_cast<std::size_t>(joint)] = scale * node.offset;
  }
  return ends;
}

}  // namespace detail

MOTIONLANG_BODY Motion to_motion(const Bvh& file, const BvhReadOptions& options) {
  if (!(options.scale > 0)) raise<config_error>(101, file.name, ": scale ", options.scale);
  const detail::BvhTable table(file);
  const detail::BvhBody body = detail::bvh_body(file, options, table);
  const std::vector<detail::BvhJoint>& joints = body.joints;
  const auto frames = static_cast<std::size_t>(file.frames);
  if (frames > detail::max_text_rotations(2 * file.values.size()) / joints.size()) {
    raise<io_error>(405, file.name, ": ", counted(frames, "frame"), " of ", counted(joints.size(), "joint"));
  }

  Motion motion;
  motion.name = file.name;
  motion.fps = detail::frames_per_second(file.frame_time);
  Skeleton& skeleton = motion.skeleton;
  detail::UniqueNames unique;
  Vec3<double> carried{};  // the position of the body's root at rest
  for (const detail::BvhJoint& carrier : body.carriers) carried = carried + carrier.node->offset;
  for (const detail::BvhJoint& j : joints) {
    skeleton.names.push_back(unique(j.node->name));
    skeleton.parents.push_back(j.parent);
    const bool is_root = skeleton.size() == 1;
    const Vec3<double> offset = is_root ? carried + j.node->offset : detail::constant_offset(j, table);
    skeleton.offsets.push_back(options.scale * offset);
  }
  skeleton.ends = detail::bvh_ends(file, joints, options.scale);
  motion.root.reserve(frames);
  motion.local.reserve(frames * joints.size());
  for (Index f = 0; f < file.frames; ++f) {
    const auto row = table[f];
    Vec3<double> position{};
    auto rotation = Quaternion<double>::identity();
    for (const detail::BvhJoint& carrier : body.carriers) {
      position = position + rotate(rotation, carrier.translation(row));
      rotation = rotation * carrier.rotation(row);
    }
    motion.root.push_back(options.scale * (position + rotate(rotation, joints[0].translation(row))));
    for (const detail::BvhJoint& j : joints) motion.local.push_back(j.rotation(row));
    auto& root_rotation = motion.local[motion.local.size() - joints.size()];
    root_rotation = rotation * root_rotation;
  }
  motion.validate();
  return motion;
}

MOTIONLANG_BODY int bvh_roots(const Bvh& file) {
  return static_cast<int>(
      std::count_if(file.nodes.begin(), file.nodes.end(), [](const BvhNode& n) { return n.parent == -1; }));
}

MOTIONLANG_BODY std::vector<std::string> stretched_joints(const Bvh& file, const BvhReadOptions& options) {
  const detail::BvhTable table(file);
  const detail::BvhBody body = detail::bvh_body(file, options, table);
  std::vector<std::string> names;
  for (const detail::BvhJoint& j : std::span(body.joints).subspan(1)) {
    if (detail::moves(j, table)) names.push_back(j.node->name);
  }
  return names;
}

MOTIONLANG_BODY std::vector<std::string> joints_beside_body(const Bvh& file, const BvhReadOptions& options) {
  const detail::BvhTable table(file);
  std::vector<std::string> names;
  for (const detail::BvhJoint& j : detail::bvh_body(file, options, table).beside) names.push_back(j.node->name);
  return names;
}

MOTIONLANG_BODY Motion read_bvh_motion(const FilePath& path, const BvhReadOptions& options) {
  return to_motion(read_bvh(path), options);
}

namespace detail {

MOTIONLANG_BODY EulerAngles<double> continue_curve(const EulerAngles<double>& angles,
                                                   const EulerAngles<double>& before) {
  constexpr double pi = std::numbers::pi;
  auto near = [](double angle, double target) { return angle - 2 * pi * std::round((angle - target) / (2 * pi)); };
  auto moved = [&](double a, double b, double c) {
    return EulerAngles<double>{near(a, before.a), near(b, before.b), near(c, before.c), angles.order};
  };
  auto step = [&](const EulerAngles<double>& e) {
    return std::abs(e.a - before.a) + std::abs(e.b - before.b) + std::abs(e.c - before.c);
  };
  const auto same = moved(angles.a, angles.b, angles.c);
  const auto twin = moved(angles.a + pi, pi - angles.b, angles.c + pi);
  return step(twin) < step(same) ? twin : same;
}

/// A name that a BVH file can hold: words and braces end a name, and programs show only UTF-8.
inline std::string bvh_name(std::string_view name) {
  std::string out = is_utf8(name) ? std::string(name) : from_latin1(name);
  for (char& c : out) {
    if (static_cast<unsigned char>(c) <= ' ' || c == '{' || c == '}' || c == '\x7F') c = '_';
  }
  return out.empty() ? "joint" : out;
}

MOTIONLANG_BODY std::vector<int> depth_first_order(const Skeleton& skeleton) {
  std::vector<int> order, open{0};
  while (!open.empty()) {
    const int joint = open.back();
    open.pop_back();
    order.push_back(joint);
    const std::vector<int> children = skeleton.children(joint);
    open.insert(open.end(), children.rbegin(), children.rend());
  }
  return order;
}

/// The end of a leaf's bone: from the skeleton, else `length` metres along the bone before it, or upwards if there is
/// none.
inline Vec3<double> end_offset(const Skeleton& skeleton, int joint, double length) {
  if (!skeleton.ends.empty() && norm(skeleton.ends[static_cast<std::size_t>(joint)]) > 0)
    return skeleton.ends[static_cast<std::size_t>(joint)];
  const Vec3<double> bone = joint == 0 ? Vec3<double>{} : skeleton.offset(joint);
  const double before = norm(bone);
  return before > 1e-9 ? std::min(1.0, length / before) * bone : Vec3<double>{0, length, 0};
}

}  // namespace detail

MOTIONLANG_BODY std::vector<std::string> bvh_names(const Skeleton& skeleton) {
  std::vector<std::string> names(skeleton.names.size());
  detail::UniqueNames unique;
  for (const int j : detail::depth_first_order(skeleton))
    names[static_cast<std::size_t>(j)] = unique(detail::bvh_name(skeleton.name(j)));
  return names;
}

MOTIONLANG_BODY Bvh to_bvh(const Motion& motion, const BvhWriteOptions& options) {
  motion.validate();
  const EulerOrder order = EulerOrder::parse(options.order);
  if (order.axis[0] == order.axis[2]) raise<config_error>(101, "to_bvh: order '", options.order, "' has an axis twice");
  if (!(options.scale > 0)) raise<config_error>(101, "to_bvh: scale ", options.scale);
  const Skeleton& skeleton = motion.skeleton;
  const std::vector<int> joints = detail::depth_first_order(skeleton);

  Bvh file{.frame_time = 1 / motion.fps, .frames = motion.frames(), .name = motion.name};
  std::vector<BvhChannel> channels{BvhChannel::x_position, BvhChannel::y_position, BvhChannel::z_position};
  for (const int axis : order.axis) channels.push_back(static_cast<BvhChannel>(axis + 3));
  std::vector<int> node_of(joints.size());
  const std::vector<std::string> names = bvh_names(skeleton);
  for (const int j : joints) {
    const std::string& name = names[static_cast<std::size_t>(j)];
    node_of[static_cast<std::size_t>(j)] = static_cast<int>(file.nodes.size());
    const int parent = j == 0 ? -1 : node_of[static_cast<std::size_t>(skeleton.parent(j))];
    const Vec3<double> offset = j == 0 ? Vec3<double>{} : options.scale * skeleton.offset(j);
    file.nodes.push_back({.name = name, .parent = parent, .offset = offset, .channels = channels});
    if (skeleton.children(j).empty()) {
      const Vec3<double> end = options.scale * detail::end_offset(skeleton, j, options.end_length);
      file.nodes.push_back(
          {.name = "Site", .parent = static_cast<int>(file.nodes.size()) - 1, .end_site = true, .offset = end});
    }
    if (j == 0) channels.erase(channels.begin(), channels.begin() + 3);
  }

  std::vector<EulerAngles<double>> before(joints.size());
  file.values.reserve(static_cast<std::size_t>(file.frames * file.channels()));
  for (Index f = 0; f < file.frames; ++f) {
    const Vec3<double> root = options.scale * motion.root_at(f);
    file.values.insert(file.values.end(), {root.x, root.y, root.z});
    for (const int j : joints) {
      EulerAngles<double>& last = before[static_cast<std::size_t>(j)];
      const auto& rotation = motion.rotations(f)[static_cast<std::size_t>(j)];
      const auto angles = to_euler(rotation, order, last.c);
      last = f == 0 ? angles : detail::continue_curve(angles, last);
      for (const double a : {last.a, last.b, last.c}) file.values.push_back(a / degree);
    }
  }
  return file;
}

MOTIONLANG_BODY void write_bvh(const FilePath& path, const Motion& motion, const BvhWriteOptions& options) {
  write_bvh(path, to_bvh(motion, options));
}

MOTIONLANG_NAMESPACE_END
