// SPDX-License-Identifier: MIT
/// GLB files, and .gltf files with their data in base64, as motions: skins and animations of glTF 2.0. Meshes,
/// materials and morph targets are left out. The bones of a VRM avatar (.vrm, .vrma) have the names of VRM's humanoid.
///
/// The skeleton's rest pose is that of the file, with all rotations the identity as everywhere in this library: with B
/// the world rotation of a node at rest and r its local rotation, L_j = B_parent r_j B_j^-1, and the offset of a joint
/// is its rest translation turned by B_parent. Bones keep their length: only the root moves; animated scales and
/// translations of other joints are dropped (stretched_joints names these).
///
/// Two keys of a small file can be years apart. What is sampled has at most 10 million rotations (frames x joints;
/// nearly four hours at 30 per second with 24 joints: 320 MB), or 16 for each key of a channel in the file, which is
/// enough for any recording with keys at its frames. motions() counts all animations together, and for each of them the
/// rotations that would fill the memory of its skeleton, of which every motion has its own.
#pragma once

#include <algorithm>  // max
#include <cmath>      // ceil, floor
#include <limits>     // precision of a float
#include <optional>   // frame rates

#include <motionlang/formats/detail/gltf_skeleton.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A GLB file in memory, from which several motions can be taken.
class GlbFile {
 public:
  /// skin    which of the file's skins; a file without any gives a skeleton of all animated nodes
  /// Throws  io_error 401 to 405; config_error 107 where the JSON has a value of the wrong kind
  static GlbFile open(const FilePath& path, Index skin = 0) {
    return GlbFile(MappedFile::open(path)->bytes(), path.string(), skin);
  }
  GlbFile(std::span<const std::byte> bytes, std::string name, Index skin = 0)
      : GlbFile(detail::GltfDocument(bytes, std::move(name)), skin) {}

  const Skeleton& skeleton() const { return joints_.skeleton; }
  std::vector<std::string> animation_names() const {
    std::vector<std::string> out;
    for (const auto& a : animations_) out.push_back(a.name());
    return out;
  }

  /// Seconds from time 0 to the last key of an animation. Throws config_error 103 if there is no such animation.
  double duration(Index animation) const { return at(animation).duration(); }

  /// Names of the joints below the root that an animation moves away from their place at rest, by more than a hundredth
  /// of the bone, or by the scale of the joint before: motion() leaves this out. Throws config_error 103 if there is no
  /// such animation.
  std::vector<std::string> stretched_joints(Index animation) const {
    const detail::GltfAnimation& a = at(animation);
    std::vector<std::string> names;
    for (std::size_t j = 1; j < joints_.nodes.size(); ++j) {
      const int node = joints_.nodes[j], before = joints_.nodes[static_cast<std::size_t>(skeleton().parents[j])];
      const bool stretched = before >= 0 && a.grows(before, nodes_[static_cast<std::size_t>(before)].rest.scale);
      if (stretched || a.moves_away(node, nodes_[static_cast<std::size_t>(node)].rest.translation)) {
        names.push_back(skeleton().names[j]);
      }
    }
    return names;
  }

  /// Frames per second at which motion() takes an animation: those of its keys, where all are at whole frames of one
  /// rate of 10 to 1000; 30 for others. Throws config_error 103 if there is no such animation.
  double rate(Index animation) const {
    const double own = at(animation).rate().value_or(0);
    return own >= 10 && own <= 1000 ? own : 30;
  }

  /// The animation from time 0 to its last key, at `wanted` frames per second or as rate() says.
  /// Throws  config_error 103 if there is no such animation, 101 for an impossible frame rate, io_error 405 if the
  ///         motion would be too long
  Motion motion(Index animation, std::optional<double> wanted = {}) const {
    const detail::GltfAnimation& a = at(animation);
    const double fps = wanted ? *wanted : rate(animation), frames = frames_of(a, fps);
    const double rotations = frames * skeleton().size(), most = most_rotations(a.keys());
    if (rotations > most)
      raise<io_error>(405, file_, ": animation '", a.name(), "' of ", a.duration(), " s at ", fps,
                      " per second: ", rotations, " rotations (frames x joints), at most ", most, " of ",
                      counted(a.keys(), "key"));
    Motion motion{skeleton(), fps, {}, {}, a.name()};
    motion.root.reserve(static_cast<std::size_t>(frames));
    motion.local.reserve(static_cast<std::size_t>(frames) * joints_.nodes.size());
    for (double frame = 0; frame < frames; ++frame) append_pose(motion, a, frame / fps);
    return motion;
  }
  /// All animations. Throws what motion(number) throws; io_error 405 if they would be too long together.
  std::vector<Motion> motions(std::optional<double> wanted = {}) const {
    double frames = 0;
    std::size_t keys = 0;
    for (std::size_t i = 0; i < animations_.size(); ++i) {
      frames += frames_of(animations_[i], wanted ? *wanted : rate(static_cast<Index>(i)));
      keys += animations_[i].keys();
    }
    const double rotations = frames * skeleton().size(), most = most_rotations(keys),
                 skeletons = std::ceil(static_cast<double>(animations_.size()) * skeleton_rotations());
    if (rotations + skeletons > most)
      raise<io_error>(405, file_, ": ", counted(animations_.size(), "animation"), ": ", rotations,
                      " rotations (frames x joints) and skeletons that take the memory of ", skeletons, ", at most ",
                      most, " of ", counted(keys, "key"));
    std::vector<Motion> out;
    for (std::size_t i = 0; i < animations_.size(); ++i) out.push_back(motion(static_cast<Index>(i), wanted));
    return out;
  }
  /// The animation of that name. Throws config_error 103, and what motion(number) throws.
  Motion motion(std::string_view animation, std::optional<double> fps = {}) const {
    for (std::size_t i = 0; i < animations_.size(); ++i) {
      if (animations_[i].name() == animation) return motion(static_cast<Index>(i), fps);
    }
    raise<config_error>(103, file_, ": no animation '", animation, "' among ", animations_.size());
  }

 private:
  GlbFile(const detail::GltfDocument& document, Index skin)
      : file_(document.file()),
        nodes_(document.nodes()),
        animations_(load(document)),
        joints_(document, animations_, skin) {}

  static std::vector<detail::GltfAnimation> load(const detail::GltfDocument& document) {
    detail::SharedAccessors keys(document);
    std::vector<detail::GltfAnimation> out;
    for (Index i = 0; i < document.count("animations"); ++i) out.emplace_back(keys, i);
    return out;
  }

  const detail::GltfAnimation& at(Index animation) const {
    if (animation < 0 || animation >= static_cast<Index>(animations_.size())) {
      raise<config_error>(103, file_, ": animation ", animation, " of ", animations_.size());
    }
    return animations_[static_cast<std::size_t>(animation)];
  }

  double frames_of(const detail::GltfAnimation& a, double fps) const {
    if (!(fps > 0 && fps < 1e6)) raise<config_error>(101, file_, ": ", fps, " frames per second");
    const double last = a.duration() * fps;  // the time of the last key is a float
    return std::floor(last + std::max(1e-4, std::numeric_limits<float>::epsilon() * last)) + 1;
  }
  static double most_rotations(std::size_t keys) {
    constexpr double most_of_any = 1e7, most_of_key = 16;
    return std::max(most_of_any, most_of_key * static_cast<double>(keys));
  }
  /// How many rotations take as much memory as the skeleton of a motion.
  double skeleton_rotations() const {
    std::size_t bytes = 0;
    for (const std::string& name : skeleton().names)
      bytes += sizeof name + name.size() + sizeof(int) + sizeof(Vec3<double>);
    return static_cast<double>(bytes) / sizeof(Quaternion<double>);
  }

  detail::GltfTransform transform(const detail::GltfAnimation& a, int node, double time) const {
    return a.at(node, nodes_[static_cast<std::size_t>(node)].rest, time);
  }

  /// The root with all that stands above it in the file.
  detail::GltfTransform root_in_world(const detail::GltfAnimation& a, double time) const {
    detail::GltfTransform world;
    for (int n = joints_.nodes.front(); n >= 0; n = nodes_[static_cast<std::size_t>(n)].parent) {
      const detail::GltfTransform t = transform(a, n, time);
      world.translation = t.translation + rotate(t.rotation, detail::scaled(t.scale, world.translation));
      world.rotation = normalized(t.rotation * world.rotation);
    }
    return world;
  }

  void append_pose(Motion& motion, const detail::GltfAnimation& a, double time) const {
    const detail::GltfTransform root = root_in_world(a, time);
    motion.root.push_back(root.translation);
    motion.local.push_back(normalized(root.rotation * inverse(joints_.rest_rotations.front())));
    for (std::size_t j = 1; j < joints_.nodes.size(); ++j) {
      const auto parent = static_cast<std::size_t>(skeleton().parents[j]);
      const Quaternion<double> r = transform(a, joints_.nodes[j], time).rotation;
      motion.local.push_back(normalized(joints_.rest_rotations[parent] * r * inverse(joints_.rest_rotations[j])));
    }
  }

  std::string file_;
  std::vector<detail::GltfNode> nodes_;
  std::vector<detail::GltfAnimation> animations_;
  detail::GltfSkeleton joints_;
};

struct GlbReadOptions {
  std::string animation{};      // by name; "": the first
  std::optional<double> fps{};  // none: GlbFile::rate
  Index skin = 0;
};

/// Throws what GlbFile::open and GlbFile::motion throw.
inline Motion read_glb(const FilePath& path, const GlbReadOptions& options = {}) {
  const GlbFile file = GlbFile::open(path, options.skin);
  return options.animation.empty() ? file.motion(0, options.fps) : file.motion(options.animation, options.fps);
}

MOTIONLANG_NAMESPACE_END
