// Body models of golden cases.
#pragma once

#include <motionlang/kinematics/body.hpp>

#include "tensors.hpp"

namespace golden {

using ml::Index;

template <ml::Backend B>
ml::BodyModel<B> body_of(const Case& c, const std::string& prefix) {
  ml::BodyModel<B> body;
  auto flat = [&](const std::string& name, Index rows, Index columns) {
    return ml::Tensor<B, 2>::from(c.values<typename B::scalar>(prefix + name), {rows, columns});
  };
  const Index v = c.shape(prefix + "v_template")[0], j = c.shape(prefix + "J_regressor")[0];
  body.v_template = flat("v_template", v, 3);
  body.shapedirs = c.has(prefix + "shapedirs") ? flat("shapedirs", 3 * v, c.shape(prefix + "shapedirs")[2])
                                               : ml::Tensor<B, 2>::zeros({3 * v, 1});
  body.posedirs = flat("posedirs", 3 * v, 9 * (j - 1));
  body.J_regressor = flat("J_regressor", j, v);
  body.weights = flat("weights", v, j);
  const auto parents = c.values<Index>(prefix + (c.has(prefix + "kintree_table") ? "kintree_table" : "parents"));
  for (Index i = 0; i < j; ++i)
    body.parents.push_back(i == 0 ? -1 : static_cast<int>(parents[static_cast<std::size_t>(i)]));
  if (c.has(prefix + "extra_vertex_ids")) body.extra = c.values<Index>(prefix + "extra_vertex_ids");
  body.validate();
  return body;
}

/// The same with the mean poses of its hands, if the case has them.
template <ml::Backend B>
ml::Body<B> body_with_hands(const Case& c, const std::string& prefix) {
  ml::Body<B> body;
  body.model = body_of<B>(c, prefix);
  body.kind = ml::body_kind_of(body.model.joints());
  auto hand = [&](const char* name) -> std::optional<ml::HandPoses<B>> {
    if (!c.has(prefix + name)) return std::nullopt;
    return ml::HandPoses<B>{ml::Tensor<B, 2>::zeros({0, 45}), tensor<B, 1>(c, prefix + name)};
  };
  body.left_hand = hand("hands_meanl");
  body.right_hand = hand("hands_meanr");
  return body;
}

}  // namespace golden
