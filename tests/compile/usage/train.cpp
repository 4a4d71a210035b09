// Names that the usage examples of train/, and of the losses and metrics of trainings, use without declaring them.
#include "usage.hpp"

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/loss/foot_velocity.hpp>
#include <motionlang/metrics/sampled_errors.hpp>
#include <motionlang/train/actor_training.hpp>
#include <motionlang/train/bert_judge.hpp>
#include <motionlang/train/body_part_evaluation.hpp>
#include <motionlang/train/description_evaluation.hpp>
#include <motionlang/train/epoch_batches.hpp>
#include <motionlang/train/filtered_negatives.hpp>
#include <motionlang/train/guo_config.hpp>
#include <motionlang/train/guo_evaluation.hpp>
#include <motionlang/train/guo_matching_training.hpp>
#include <motionlang/train/guo_movement_training.hpp>
#include <motionlang/train/guo_retrieval.hpp>
#include <motionlang/train/measured_similarity.hpp>
#include <motionlang/train/part_threads.hpp>
#include <motionlang/train/presets.hpp>
#include <motionlang/train/recognition.hpp>
#include <motionlang/train/remembered_motions.hpp>
#include <motionlang/train/retrieval_evaluation.hpp>
#include <motionlang/train/sinc_training.hpp>
#include <motionlang/train/stmc_start.hpp>
#include <motionlang/train/stmc_training.hpp>
#include <motionlang/train/stmc_training_config.hpp>
#include <motionlang/train/stmc_training_notes.hpp>
#include <motionlang/train/tm2t_describer_training.hpp>
#include <motionlang/train/tm2t_tokenizer_training.hpp>
#include <motionlang/train/tmr_training.hpp>
#include <motionlang/train/trainer.hpp>
#include <motionlang/weights/motion_memory_file.hpp>

#include <atomic>

using A = Autodiff<B>;
using About = std::map<std::string, std::string>;

void actor_training() {
#include "train/actor_training.1.inc"
}
void bert_judge(const std::vector<CaptionPair>& pairs) {
#include "train/bert_judge.1.inc"
}
void epoch_batches(std::uint64_t seed) {
#include "train/epoch_batches.1.inc"
}
void guo_evaluation(const Tm2tRun<B>& run, const DescribedMotions& data) {
#include "train/guo_evaluation.1.inc"
}
void learned(const TrainingSet& data, const Stmc<B>& stmc, const StmcModelConfig& config) {
#include "train/learned_captions.1.inc"
}
void remembered(const FilePath& path, const Stmc<B>& stmc) {
#include "train/remembered_motions.1.inc"
}
void body_part_evaluation(const BodyPartTruth& truth, const BodyPartTable& table) {
#include "train/body_part_evaluation.1.inc"
}
void description_evaluation(const GuoJudge<B>& judge, const Tm2tRun<B>& run, const DescribedMotions& data) {
#include "train/description_evaluation.1.inc"
}
void filtered(const DescribedMotions& data, const EmbeddingCache& sentences, const Tensor<B, 2>& e) {
#include "train/filtered_negatives.1.inc"
}
void guo_config_() {
#include "train/guo_config.1.inc"
}
void guo_movement(const DescribedMotions& data, const About& about) {
#include "train/guo_movement_training.1.inc"
}
void guo_matching(const DescribedMotions& data, const Normalizer<B>& statistics, const GloVe& words,
                  const About& about) {
#include "train/guo_matching_training.1.inc"
}
void guo_retrieval(const GuoJudge<B>& judge, const DescribedMotions& data, const Rows<float>& sentences,
                   const std::vector<std::string>& ids) {
#include "train/guo_retrieval.1.inc"
}
void stmc_notes(Trainer<StmcTraining<A>>& trainer, const TrainingSet& data) {
#include "train/stmc_training_notes.1.inc"
}
void presets() {
#include "train/presets.1.inc"
}
void recognition(const DescribedMotions& data) {
#include "train/recognition.1.inc"
}
void retrieval_evaluation(const TmrModel<B>& model, const DescribedMotions& data, const EmbeddingCache& sentences,
                          const RetrievalOptions& options) {
#include "train/retrieval_evaluation.1.inc"
}
void sinc_training(const SincTrainingConfig& config, const About& about) {
#include "train/sinc_training.1.inc"
}
void stmc_start(Stmc<B>& model) {
#include "train/stmc_start.1.inc"
}
void stmc_training_config() {
#include "train/stmc_training_config.1.inc"
}
void stmc_training() {
#include "train/stmc_training.1.inc"
}
void describer_training(const Tm2tTrainingConfig& config, const DescribedMotions& data, const GloVe& words,
                        const About& about) {
#include "train/tm2t_describer_training.1.inc"
}
void part_threads(const std::function<void(Index)>& first_half, const std::function<void(Index)>& second_half) {
#include "train/part_threads.1.inc"
}
void tokenizer_training(const DescribedMotions& data, const About& about) {
#include "train/tm2t_tokenizer_training.1.inc"
}
void tmr_training(){
#include "train/tmr_training.1.inc"
} std::atomic<bool> asked_to_stop;
void trainer_(const TextMotionConfig& config, const DescribedMotions& data) {
#include "train/trainer.1.inc"
}
void foot_velocity(const Normalizer<A>& normaliser, const Tensor<A, 2>& out, const Tensor<B, 2>& truth,
                   const Offsets& offsets) {
#include "loss/foot_velocity.1.inc"
}
void sampled_errors(const RifkeVariant& variant,
                    const std::vector<std::pair<std::vector<JointFrames>, JointFrames>>& items) {
#include "metrics/sampled_errors.1.inc"
}
void similarity_(const TmrModel<B>& model, const DescribedMotions& data, const EmbeddingCache& sentences,
                 const StrangerTexts& strangers) {
#include "train/measured_similarity.1.inc"
}
