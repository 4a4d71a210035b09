// SPDX-License-Identifier: MIT
/// The figures in a glTF document: the nodes that are their joints, the root among these, and the rest pose.
#pragma once

#include <functional>     // tables
#include <limits>         // no place
#include <optional>       // tables
#include <span>           // animations
#include <string>         // names
#include <unordered_map>  // names that occur twice
#include <unordered_set>  // names
#include <vector>         // joints

#include <motionlang/formats/detail/gltf_animation.hpp>
#include <motionlang/kinematics/skeleton_table.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The joints of a figure, parents first.
struct GltfSkeleton {
  Skeleton skeleton{};                     // at rest
  std::vector<int> nodes{};                // of each joint; -1 for an artificial root
  std::vector<int> above{};                // the nodes from the top of the tree to the root's parent
  std::vector<Quaternion<double>> lean{};  // of each joint, from the rest of the nodes to that of the skeleton
  std::optional<SkeletonTable> table{};    // the names of the joints, if they are known

  /// The joints in the world, and the place above the root. transform(node) is the transform of a node relative to its
  /// parent.
  template <class F>
  GltfPlace place(F transform, std::vector<GltfPlace>& joints) const {
    GltfPlace top;
    for (const int n : above) top = top * transform(n);
    joints.resize(nodes.size());
    for (std::size_t j = 0; j < nodes.size(); ++j) {
      const GltfPlace& parent = j == 0 ? top : joints[static_cast<std::size_t>(skeleton.parents[j])];
      joints[j] = nodes[j] < 0 ? parent : parent * transform(nodes[j]);
    }
    return top;
  }
  /// The nodes of the joints and those above them, ascending.
  std::vector<int> moving_nodes() const;
};

/// The turn of a joint from one place to another: the rotation between their axes in the world. `lean` is applied to
/// the first.
Quaternion<double> turn_between(const GltfPlace& rest, const Quaternion<double>& lean, const GltfPlace& now);
/// The offsets of the joints at these places, with their lean at rest.
std::vector<Vec3<double>> leaning_offsets(const GltfSkeleton& figure, std::span<const GltfPlace> rest);

/// Finds the figures of a document.
class GltfFigures {
 public:
  /// Finds the table of a skeleton; nothing if none is known.
  using FindTable = std::function<std::optional<SkeletonTable>(const Skeleton&)>;

  /// skin   the only one whose joints count; none: all skins, the bones of VRM's humanoid, or, in a file with neither,
  ///        all nodes
  /// A skeleton that a table knows is a figure, starting at the lowest joint above all joints that the table needs. If
  /// nothing is known, the figures are the largest skin and others that share no joint with it. Without skins they are
  /// the animated nodes.
  /// Throws io_error 403 to 405
  GltfFigures(const GltfDocument& document, std::span<const GltfAnimation> animations, std::optional<Index> skin,
              const FindTable& find_table);

  std::vector<GltfSkeleton> figures;  // at least one

 private:
  static constexpr std::size_t max_joints = 4096;
  static constexpr int nowhere = std::numeric_limits<int>::max();

  /// Nodes that are joints.
  struct Marks {
    std::vector<int> place;  // of a joint in the skins; of a node above joints that of its first; else `nowhere`
    std::vector<int> below;  // joints in the subtree of every node
    int total = 0;
  };

  static std::size_t slot(int node) { return static_cast<std::size_t>(node); }

  std::vector<int> joints_of_skin(Index skin) const;
  Marks marks_of(const std::vector<int>& own_place) const;

  /// Adds the known figures among these joints, and removes their joints.
  void find_known(std::vector<int> own_place, const FindTable& find_table);
  void find_unknown(std::span<const GltfAnimation> animations, std::optional<Index> skin);
  /// The rest pose of a known figure is that of the nodes or that of the inverse bind matrices. It chooses the one that
  /// is more upright and whose limbs are closer to a T-pose.
  void choose_rest(GltfSkeleton& figure, std::optional<Index> skin) const;

  /// For each node, true if it moves a vertex as a joint of the skin. All are true if the data are packed.
  std::vector<bool> weighted(const std::vector<int>& joints, Index skin) const;

  /// The lowest node that has all joints below it, or -1 if there is none.
  int common_root(const Marks& marks) const;

  /// Game rigs put the hips below a root on the floor and move both. The library moves only the root of a skeleton, so
  /// the hips become the root. They are the only child of `root` whose joints move vertices, if an animation moves it.
  /// Otherwise -1.
  int moving_hips(const Marks& marks, int root, std::vector<bool> weighted,
                  std::span<const GltfAnimation> animations) const;

  /// The skeleton from `root` down: parents before children, otherwise in the order of the skin.
  GltfSkeleton build(const Marks& marks, int root) const;
  /// The part of a skeleton from a joint down.
  GltfSkeleton part(const GltfSkeleton& all, int joint) const;
  void finish(GltfSkeleton& figure) const;

  const GltfDocument& document_;
  std::vector<GltfPlace> world_;  // at rest
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/detail/gltf_skeleton.ipp>
#endif
