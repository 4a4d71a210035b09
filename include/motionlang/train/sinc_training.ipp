// SPDX-License-Identifier: MIT
// Bodies of sinc_training.hpp.
#pragma once

#include <cstdint>  // conjunctions

#include <motionlang/features/smplvelp.hpp>
#include <motionlang/kinematics/sinc_part_motion.hpp>
#include <motionlang/train/sinc_training.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline SincSource sinc_source_of(const std::string& key) {
  return key.starts_with("seg-")             ? SincSource::segment
         : key.starts_with("seq-")           ? SincSource::sequence
         : key.starts_with("spatial_pairs-") ? SincSource::simultaneous
                                             : SincSource::pair;
}

MOTIONLANG_BODY std::vector<std::string> sinc_sentences(const DescribedMotions& data) {
  std::vector<std::string> out;
  for (const DescribedMotion& m : data.training) {
    for (const DescribedText& t : m.texts) {
      for (std::uint32_t c = 0; c < 5; ++c)
        out.push_back(join_labels(std::vector{t.text, t.text}, static_cast<Conjunction>(c)));
    }
  }
  return out;
}

MOTIONLANG_BODY SincItems sinc_training_items(const DescribedMotions& data, const BodyPartTable& table) {
  const std::set<std::string> known(table.labels().begin(), table.labels().end());
  std::vector<SincItem> items;
  for (const DescribedMotion& m : data.training) {
    const auto labels = labels_of(m);
    for (const std::string& label : labels) {
      if (!known.contains(label)) raise<config_error>(103, "`body_parts`: no parts of '", label, "' (", m.id, ")");
    }
    items.push_back({sinc_source_of(m.id), labels, std::ssize(m.rows) / data.width});
  }
  return {std::move(items), table};
}

MOTIONLANG_BODY std::vector<float> composed_rows(std::span<const float> a, const SincParts& parts_a,
                                                 std::span<const float> b, const SincParts& parts_b, bool exact_yaw) {
  const auto both = compose_motions(smplvelp_inverse(a), parts_a, smplvelp_inverse(b), parts_b);
  return smplvelp_features(std::span<const Matrix3<float>>(both.rotations), std::span<const Vec3<float>>(both.trans),
                           {.exact_yaw = exact_yaw});
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
