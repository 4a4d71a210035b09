// SPDX-License-Identifier: MIT
// Bodies of the headers in metrics/, compiled once for motionlang::instantiated.
#include <motionlang/metrics/captions.ipp>
#include <motionlang/metrics/detail/symmetric.ipp>
#include <motionlang/metrics/diversity.ipp>
#include <motionlang/metrics/frechet.ipp>
#include <motionlang/metrics/inspect_motion.ipp>
#include <motionlang/metrics/motion_quality.ipp>
#include <motionlang/metrics/motion_trace.ipp>
#include <motionlang/metrics/mtt.ipp>
#include <motionlang/metrics/retrieval.ipp>
#include <motionlang/metrics/sampled_errors.ipp>
#include <motionlang/metrics/similarity_scale.ipp>
#include <motionlang/metrics/stgcn.ipp>
#include <motionlang/metrics/study.ipp>
#include <motionlang/metrics/study_counts.ipp>
#include <motionlang/metrics/summary.ipp>
