// Names that the usage examples of metrics/ use without declaring them.
#include "usage.hpp"

#include <motionlang/metrics/ape_ave.hpp>
#include <motionlang/metrics/bert_score.hpp>
#include <motionlang/metrics/captions.hpp>
#include <motionlang/metrics/diversity.hpp>
#include <motionlang/metrics/guo_evaluator.hpp>
#include <motionlang/metrics/inspect_motion.hpp>
#include <motionlang/metrics/matching.hpp>
#include <motionlang/metrics/motion_trace.hpp>
#include <motionlang/metrics/mtt.hpp>
#include <motionlang/metrics/retrieval.hpp>
#include <motionlang/metrics/rows.hpp>
#include <motionlang/metrics/similarity_scale.hpp>
#include <motionlang/metrics/study_counts.hpp>
#include <motionlang/text/glove.hpp>

#include <cstdio>

void ape(const std::vector<std::pair<std::span<const Vec3<double>>, std::span<const Vec3<double>>>>& pairs) {
#include "metrics/ape_ave.1.inc"
}
void bert(const BertSentence<float>& candidate, std::span<const BertSentence<float>> references,
          const std::vector<std::vector<Index>>& ids_of_references) {
#include "metrics/bert_score.1.inc"
}
void captions() {
#include "metrics/captions.1.inc"
}
void diversity(std::uint32_t seed, const Rows<float>& features, const Rows<float>& embeddings,
               const std::vector<Index>& labels) {
#include "metrics/diversity.1.inc"
}
void guo(const GuoEvaluator<B>& evaluator, const GloVe& words, const std::vector<std::string>& texts,
         const Sequences<B>& normalized, MatchingMetric& metric) {
#include "metrics/guo_evaluator.1.inc"
}
void inspect(const Motion& motion) {
#include "metrics/inspect_motion.1.inc"
}
void matching(const std::vector<std::pair<Rows<float>, Rows<float>>>& batches) {
#include "metrics/matching.1.inc"
}
void trace(const Motion& motion) {
#include "metrics/motion_trace.1.inc"
}
void mtt(std::span<const MttMotion<float>> motions, const MttReference<float>& reference,
         std::span<const Vec3<float>> joints, std::vector<float> (&encode)(const Rows<float>&)) {
#include "metrics/mtt.1.inc"
}
void retrieval(const Rows<float>& texts, const Rows<float>& motions) {
#include "metrics/retrieval.1.inc"
}
void rows(const Tensor<B, 2>& text_latents, const Tensor<B, 2>& motion_latents) {
#include "metrics/rows.1.inc"
}
void study_() {
#include "metrics/study.1.inc"
}
void study_counts_(const Study& study, const std::vector<StudyAnswers>& answers) {
#include "metrics/study_counts.1.inc"
}
void similarity_(const std::vector<float>& unlike, const std::vector<float>& own, const std::vector<float>& strangers) {
#include "metrics/similarity_scale.1.inc"
}
