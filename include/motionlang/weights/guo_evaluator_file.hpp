// SPDX-License-Identifier: MIT
/// The published checkpoint of Guo's evaluator.
///
///     const auto evaluator = load_guo_evaluator<B>(open_weights("text_mot_match/model/finest.tar", {.path = ""}));
///
/// Source  Guo et al. (CVPR 2022), text-to-motion networks/evaluator_wrapper.py
#pragma once

#include <motionlang/metrics/guo_evaluator.hpp>
#include <motionlang/weights/detail/run_reader.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Sizes of the networks in a file, from the shapes of its tensors. Throws io_error 406, 407.
GuoEvaluatorConfig guo_evaluator_config(const TensorSet& file);

/// The networks, ready to run. The states of optimisers are skipped. Throws io_error 406, 407, numeric_error 301.
template <Backend B>
GuoEvaluator<B> load_guo_evaluator(const TensorSet& file) {
  const auto room = detail::room_of(file);
  NoInit zeros;
  GuoEvaluator<B> networks(guo_evaluator_config(file), zeros);
  detail::load_run_module(networks, file, "", [](const std::string& name) { return name.starts_with("opt_"); });
  prepare(networks);
  return networks;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/guo_evaluator_file.ipp>
#endif
