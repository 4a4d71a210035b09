// SPDX-License-Identifier: MIT
/// The figures in a glTF document: which nodes are their joints, which of them is the root, and how they stand at rest.
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
  std::vector<int> nodes{};                // of each joint; -1 for a root that is made up
  std::vector<int> above{};                // the nodes from the top of the tree to the root's parent
  std::vector<Quaternion<double>> lean{};  // of each joint, from the rest of the nodes to that of the skeleton
  std::optional<SkeletonTable> table{};    // which joint is which, if that is known

  /// The joints in the world, and what is above the root: transform(node) is that of a node relative to its parent.
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

/// How a joint has turned from one place to another: the rotation between their axes in the world. `lean` is applied to
/// the first.
Quaternion<double> turn_between(const GltfPlace& rest, const Quaternion<double>& lean, const GltfPlace& now);
/// The offsets of the joints that are at these places, as they lean at rest.
std::vector<Vec3<double>> leaning_offsets(const GltfSkeleton& figure, std::span<const GltfPlace> rest);

/// Finds the figures of a document.
class GltfFigures {
 public:
  /// Says which joint of a skeleton is which; nothing if that is not known.
  using FindTable = std::function<std::optional<SkeletonTable>(const Skeleton&)>;

  /// skin   the only one whose joints count; none: all skins, the bones of VRM's humanoid, or, in a file with neither,
  ///        all nodes
  /// A skeleton that a table knows is a figure, from the lowest joint down that has all joints which the table needs.
  /// If nothing is known: the largest skin, and others that share no joint with it; without skins what is animated.
  /// Throws io_error 403 to 405
  GltfFigures(const GltfDocument& document, std::span<const GltfAnimation> animations, std::optional<Index> skin,
              const FindTable& find_table);

  std::vector<GltfSkeleton> figures;  // one at least

 private:
  static constexpr std::size_t max_joints = 4096;
  static constexpr int nowhere = std::numeric_limits<int>::max();

  /// Nodes that are joints.
  struct Marks {
    std::vector<int> place;  // of a joint in the skins; of a node above joints that of its first; nowhere for others
    std::vector<int> below;  // joints in the subtree of every node
    int total = 0;
  };

  static std::size_t slot(int node) { return static_cast<std::size_t>(node); }

  std::vector<int> joints_of_skin(Index skin) const;
  Marks marks_of(const std::vector<int>& own_place) const;

  /// Adds the figures that are known among these joints, and takes them away from them.
  void find_known(std::vector<int> own_place, const FindTable& find_table);
  void find_unknown(std::span<const GltfAnimation> animations, std::optional<Index> skin);
  /// The rest pose of a known figure is that of the nodes or that of the inverse bind matrices: whichever stands more
  /// upright, with limbs more as in a T-pose.
  void choose_rest(GltfSkeleton& figure, std::optional<Index> skin) const;

  /// True if the joints of a skin move a vertex, node by node; all do where the data are packed.
  std::vector<bool> weighted(const std::vector<int>& joints, Index skin) const;

  /// The lowest node that has all joints below it, or -1 if there is none.
  int common_root(const Marks& marks) const;

  /// Game rigs put the hips below a root on the floor and move both. The library moves only the root of a skeleton, so
  /// that becomes the hips: the only child of `root` whose joints move vertices, if an animation moves it. -1 if not.
  int moving_hips(const Marks& marks, int root, std::vector<bool> weighted,
                  std::span<const GltfAnimation> animations) const;

  /// The skeleton from `root` down: parents before children, else in the order of the skin.
  GltfSkeleton build(const Marks& marks, int root) const;
  /// The part of a skeleton from a joint on.
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
