// Names that the usage examples of evaluations, descriptions and work on whole folders use without declaring them.
#include "usage.hpp"

#include <motionlang/compose/text_sinc_parts.hpp>
#include <motionlang/datasets/action_recordings.hpp>
#include <motionlang/datasets/label_sentences.hpp>
#include <motionlang/datasets/mtt_motions.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/file/input_files.hpp>
#include <motionlang/formats/motion_file.hpp>
#include <motionlang/generate/load_motion_model.hpp>
#include <motionlang/generate/motion_describer.hpp>
#include <motionlang/generate/mtt_runs.hpp>
#include <motionlang/generate/synthesized_batch.hpp>
#include <motionlang/kinematics/join_motions.hpp>
#include <motionlang/train/made_motions.hpp>
#include <motionlang/train/moment_evaluation.hpp>
#include <motionlang/train/ranked_queries.hpp>
#include <motionlang/train/shared_errors.hpp>
#include <motionlang/train/shared_items.hpp>
#include <motionlang/train/sinc_evaluation.hpp>
#include <motionlang/train/teach_evaluation.hpp>
#include <motionlang/train/temos_evaluation.hpp>
#include <motionlang/view/convert_motions.hpp>
#include <motionlang/view/inspect_folder.hpp>
#include <motionlang/view/load_shown_body.hpp>
#include <motionlang/weights/embed_texts.hpp>
#include <motionlang/weights/text_encoder_folder.hpp>

void text_parts() {
#include "compose/text_sinc_parts.1.inc"
}
void sentences_() {
#include "datasets/label_sentences.1.inc"
}
void actions_(const std::function<void(const Motion&)>& use) {
#include "datasets/action_recordings.1.inc"
}
void mtt_motions_() {
#include "datasets/mtt_motions.1.inc"
}
void inputs_(const std::string& output) {
#include "file/input_files.1.inc"
}
void describer_() {
#include "generate/motion_describer.1.inc"
}
void mtt_runs_() {
#include "generate/mtt_runs.1.inc"
}
void synthesis(const Tmr<B>& tmr, const std::unique_ptr<MotionModel>& stmc, const TextMotionBatch<B>& batch,
               const MotionFeatures& features, const Normalizer<B>& normalizer) {
#include "generate/synthesized_batch.1.inc"
}
void join_() {
#include "kinematics/join_motions.1.inc"
}
void joints_(const Normalizer<B>& normalizer, const Tensor<B, 2>& rows) {
#include "train/compared_joints.1.inc"
}
void made_(std::vector<NamedErrors>& errors, const MotionFeatures& temos_features, const DescribedMotions& data) {
#include "train/made_motions.1.inc"
}
void galleries(const LatentTable& table, const Rows<float>& sentences, const DescribedMotions& data) {
#include "train/ranked_queries.1.inc"
}
void items_(const SincDataConfig& c) {
#include "train/measured_items.1.inc"
}
void moments(const TmrSearchEncoder<B>& tmr, const DescribedMotions& data) {
#include "train/moment_evaluation.1.inc"
}
void mtt_row_(const std::vector<MttMotion<double>>& motions) {
#include "train/mtt_evaluation.1.inc"
}
void likeness_(const std::vector<std::pair<SmplVelpMotion<float>, std::vector<float>>>& items) {
#include "train/motion_likeness.1.inc"
}
void errors_as_messages(const AnyCommunicator& all, Index count, SampledErrors& sampled,
                        std::vector<JointFrames> (*samples_of)(Index), JointFrames (*recorded)(Index)) {
#include "train/shared_errors.1.inc"
}
void sinc_(const MeasuredItems& items, const ComparedJoints<B>& joints, const LabelSentences& sentences) {
#include "train/sinc_evaluation.1.inc"
}
void teach_(const MeasuredItems& items, const ComparedJoints<B>& joints) {
#include "train/teach_evaluation.1.inc"
}
void temos_(const TemosCheckpoint<B>& temos, const DescribedMotions& data) {
#include "train/temos_evaluation.1.inc"
}
void convert_() {
#include "view/convert_motions.1.inc"
}
void folder_() {
#include "view/inspect_folder.1.inc"
}
void body_() {
#include "view/load_shown_body.1.inc"
}
void babel_(const Motion& motion) {
#include "weights/babel_checkpoint.1.inc"
}
void embed() {
#include "weights/embed_texts.1.inc"
}
