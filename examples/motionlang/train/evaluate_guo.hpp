// The common part of the evaluations of TMR and TM2T, and of those by the networks of Guo et al.
#pragma once

#include <optional>
#include <vector>

#include <motionlang/train/guo_evaluation.hpp>
#include <motionlang/train/text_motion_batch.hpp>

#include "evaluate.hpp"

namespace program {

/// The evaluator that --evaluator names, with its words and statistics.
ml::GuoJudgeFiles judge_files(const EvaluationOptions& o);

/// Draws motions of a part, makes others for their texts, and prints the five metrics of both.
void print_judged(const EvaluationOptions& o, const ml::GuoJudge<EvaluationBackend>& judge,
                  const std::vector<ml::DescribedMotion>& part, ml::Index width,
                  const ml::GuoMaker<EvaluationBackend>& make);

/// Retrieval in both directions by all protocols. made: of the same texts, if there are any
void print_retrieval_tables(const EvaluationOptions& o, const std::vector<ml::DescribedMotion>& part,
                            const ml::LatentTable& table, const std::optional<ml::LatentTable>& made,
                            const ml::EmbeddingCache& sentences, bool euclidean);

}  // namespace program
