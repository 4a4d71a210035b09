// Names that the usage examples of trained models, search, pages, and data sets use without declaring them.
#include "usage.hpp"

#include <iostream>

#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/core/require_value.hpp>
#include <motionlang/datasets/annotated_texts.hpp>
#include <motionlang/datasets/data_set_form.hpp>
#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/datasets/humanml3d_clip.hpp>
#include <motionlang/datasets/label_tags.hpp>
#include <motionlang/datasets/segment_motion.hpp>
#include <motionlang/features/feature_rows.hpp>
#include <motionlang/file/fields_json.hpp>
#include <motionlang/formats/body_file.hpp>
#include <motionlang/formats/features_npy.hpp>
#include <motionlang/formats/glb_reader.hpp>
#include <motionlang/formats/motion_file.hpp>
#include <motionlang/formats/motion_folder.hpp>
#include <motionlang/generate/generate_motion.ipp>
#include <motionlang/kinematics/body_partition.hpp>
#include <motionlang/kinematics/delayed.hpp>
#include <motionlang/kinematics/edit_motion.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/one_euro_filter.hpp>
#include <motionlang/kinematics/treadmill.hpp>
#include <motionlang/search/index_shards.hpp>
#include <motionlang/search/kept_index.hpp>
#include <motionlang/search/query_bench.hpp>
#include <motionlang/search/search.hpp>
#include <motionlang/search/searched_folder.hpp>
#include <motionlang/search/text_answer.hpp>
#include <motionlang/search/tmr_search_encoder.hpp>
#include <motionlang/train/messages.hpp>
#include <motionlang/train/shared_index.hpp>
#include <motionlang/train/shared_items.hpp>
#include <motionlang/train/shared_search.hpp>
#include <motionlang/view/body_view.hpp>
#include <motionlang/view/rig_viewer.hpp>
#include <motionlang/view/rig_writer.hpp>
#include <motionlang/view/view_file.hpp>
#include <motionlang/weights/actor_checkpoint.hpp>
#include <motionlang/weights/actor_model.hpp>
#include <motionlang/weights/classifier_model.hpp>
#include <motionlang/weights/safetensors_copy.hpp>
#include <motionlang/weights/sinc_checkpoint.hpp>
#include <motionlang/weights/stmc_checkpoint.hpp>
#include <motionlang/weights/teach_checkpoint.hpp>
#include <motionlang/weights/temos_checkpoint.hpp>
#include <motionlang/weights/text_motion_checkpoint.hpp>
#include <motionlang/weights/text_motion_model.hpp>
#include <motionlang/weights/text_states.hpp>
#include <motionlang/weights/tm2t_checkpoint.hpp>
#include <motionlang/weights/tmr_checkpoint.hpp>

void require_() {
  const double lr = -1;
#include "core/require_value.1.inc"
}
void label_tags() {
#include "datasets/label_tags.1.inc"
}
void annotated() {
#include "datasets/annotated_texts.1.inc"
}
void form(const std::filesystem::path& folder) {
#include "datasets/data_set_form.1.inc"
}
void described() {
#include "datasets/described_motions.1.inc"
}
void clip() {
#include "datasets/humanml3d_clip.1.inc"
}
void rows() {
#include "features/feature_rows.1.inc"
}
void fields_() {
#include "file/fields_json.1.inc"
}
void features_npy() {
#include "formats/features_npy.1.inc"
}
void motion_file() {
#include "formats/motion_file.1.inc"
}
void motion_folder(const MotionReadOptions& options) {
#include "formats/motion_folder.1.inc"
}
void partition() {
#include "kinematics/body_partition.1.inc"
}
void delay(const Motion& dance) {
#include "kinematics/delayed.1.inc"
  use(kept);
}
void edit(const Motion& motion) {
#include "kinematics/edit_motion.1.inc"
}
void one_euro_(const Motion& motion, std::span<const double> heights, std::vector<double>& shown) {
#include "kinematics/one_euro_filter.1.inc"
}
void index_folder(const TmrSearchEncoder<B>& tmr) {
#include "search/index_folder.1.inc"
}
void searched_folder(const std::shared_ptr<const SearchEncoder>& encoder) {
#include "search/searched_folder.1.inc"
}
void kept_index() {
#include "search/kept_index.1.inc"
}
void stmc_checkpoint(const Timeline& timeline) {
#include "weights/stmc_checkpoint.1.inc"
}
void search_(const TmrSearchEncoder<B>& tmr) {
#include "search/search.1.inc"
}
void search_encoder() {
#include "search/tmr_search_encoder.1.inc"
}
void body_view(const Motion& motion) {
#include "view/body_view.1.inc"
}
void view_file(char** argv, const Motion& motion) {
#include "view/view_file.1.inc"
}
void actor_checkpoint(const std::vector<Index>& classes, const std::vector<Index>& lengths) {
#include "weights/actor_checkpoint.1.inc"
}
void actor_model(const std::filesystem::path& folder) {
#include "weights/actor_model.1.inc"
}
void classifier_model(const std::filesystem::path& folder) {
#include "weights/classifier_model.1.inc"
}
void copy() {
#include "weights/safetensors_copy.1.inc"
}
void sinc_() {
#include "weights/sinc_checkpoint.1.inc"
}
void teach_() {
#include "weights/teach_checkpoint.1.inc"
}
void temos_() {
#include "weights/temos_checkpoint.1.inc"
}
void text_motion_checkpoint() {
#include "weights/text_motion_checkpoint.1.inc"
}
void text_motion_model(const std::filesystem::path& folder, const std::vector<std::string>& texts) {
#include "weights/text_motion_model.1.inc"
}
void text_states_(const std::vector<std::string>& texts, const DescribedMotions& data) {
#include "weights/text_states.1.inc"
}
void tm2t_(const std::vector<std::string>& texts) {
#include "weights/tm2t_checkpoint.1.inc"
}
void tmr_() {
#include "weights/tmr_checkpoint.1.inc"
}
void segment(const ClipLine& line, Motion (*clip_at_20_fps)(const ClipLine&)) {
#include "datasets/segment_motion.1.inc"
}
void treadmill() {
#include "kinematics/treadmill.1.inc"
}
void rig_page(const Motion& motion) {
#include "view/rig_viewer.1.inc"
}
void character(const Motion& motion) {
#include "view/rig_writer.1.inc"
}
void queries_(const MotionIndex& index, const TmrSearchEncoder<B>& tmr) {
#include "search/query_bench.1.inc"
}
void answer_(const MotionIndex& index, const TmrSearchEncoder<B>& tmr) {
#include "search/text_answer.1.inc"
}
void shards_(const TmrSearchEncoder<B>& tmr, const EncodedClip& clip) {
#include "search/index_shards.1.inc"
}
void open_shards() {
#include "search/index_shards.2.inc"
}
void messages_(const AnyCommunicator& all, std::uint64_t seed, const std::vector<float>& rows) {
#include "train/messages.1.inc"
}
void shared_items_(const AnyCommunicator& all, Index count, double (*error_of)(Index)) {
#include "train/shared_items.1.inc"
}
void shared_index(const AnyCommunicator& all, const TmrSearchEncoder<B>& tmr, ShardStore& store, IndexUpdate& update,
                  const MotionReadOptions& read, Progress progress) {
#include "train/shared_index.1.inc"
}
void shared_search(const AnyCommunicator& all, std::span<const float> query) {
#include "train/shared_search.1.inc"
}
