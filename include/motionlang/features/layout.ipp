// SPDX-License-Identifier: MIT
// Bodies of layout.hpp.
#pragma once

#include <motionlang/features/layout.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<Index> FeatureLayout::indices(BodyPart part) const {
  std::vector<Index> out;
  for (const IndexRange& r : ranges(part)) {
    for (Index i = r.begin; i < r.end; ++i) out.push_back(i);
  }
  return out;
}

MOTIONLANG_BODY void FeatureLayout::validate() const {
  std::vector<int> owners(static_cast<std::size_t>(size), 0);
  for (int p = 0; p < most_body_parts; ++p) {
    for (const IndexRange& r : ranges(static_cast<BodyPart>(p))) {
      if (p >= body.size())
        raise<config_error>(102, "FeatureLayout '", name, "': range ", r.begin, ":", r.end, " belongs to part ", p,
                            " of ", body.size());
      if (r.begin < 0 || r.end < r.begin || r.end > size) {
        raise<config_error>(102, "FeatureLayout '", name, "': range ", r.begin, ":", r.end, " of ",
                            body.name(static_cast<BodyPart>(p)), " is not inside 0:", size);
      }
      for (Index i = r.begin; i < r.end; ++i) ++owners[static_cast<std::size_t>(i)];
    }
  }
  for (std::size_t i = 0; i < owners.size(); ++i) {
    if (owners[i] != 1) {
      raise<config_error>(102, "FeatureLayout '", name, "': number ", i, " belongs to ", owners[i], " body parts");
    }
  }
}

MOTIONLANG_BODY FeatureLayout smplrifke_layout(std::span<const BodyPart> part_of_joint, Index rotations,
                                               const BodyPartition& body) {
  const Index joints = std::ssize(part_of_joint), first_position = 4 + 6 * rotations;
  if (joints < 1 || rotations < 0 || rotations > joints) {
    raise<config_error>(101, "smplrifke_layout: ", rotations, " rotations of ", joints, " joints");
  }
  return FeatureLayout::from_owner("smplrifke", first_position + 3 * (joints - 1), body, [&](Index i) {
    if (i < 4) return body.path();
    const Index joint = i < first_position ? (i - 4) / 6 : 1 + (i - first_position) / 3;
    return part_of_joint[static_cast<std::size_t>(joint)];
  });
}

MOTIONLANG_BODY FeatureLayout guoh3dfeats_layout(std::span<const BodyPart> part_of_joint, const BodyPartition& body) {
  const Guoh3dSlots slots{std::ssize(part_of_joint)};
  if (slots.joints < 1) raise<config_error>(101, "guoh3dfeats_layout: no joints");
  return FeatureLayout::from_owner("guoh3dfeats", slots.size(), body, [&](Index i) {
    if (i < slots.positions().begin || i >= slots.contacts().begin) return body.path();
    const Index joint = i < slots.positions().end   ? 1 + (i - slots.positions().begin) / 3
                        : i < slots.rotations().end ? 1 + (i - slots.rotations().begin) / 6
                                                    : (i - slots.velocities().begin) / 3;
    return part_of_joint[static_cast<std::size_t>(joint)];
  });
}

MOTIONLANG_BODY FeatureLayout rifke_layout(std::span<const BodyPart> part_of_joint, const BodyPartition& body) {
  const Index joints = std::ssize(part_of_joint);
  if (joints < 1) raise<config_error>(101, "rifke_layout: no joints");
  return FeatureLayout::from_owner("rifke", 3 * joints + 1, body, [&](Index i) {
    if (i < 1 || i >= 3 * joints - 2) return body.path();
    return part_of_joint[static_cast<std::size_t>(1 + (i - 1) / 3)];
  });
}

MOTIONLANG_NAMESPACE_END
