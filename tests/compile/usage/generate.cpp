// Names that the usage examples of generate/, Stmc, its baseline and the words of models use without declaring them.
#include "usage.hpp"

#include <cstdio>
#include <iostream>

#include <motionlang/backend/precision.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/file/project_folder.hpp>
#include <motionlang/generate/arm_overlay.hpp>
#include <motionlang/generate/describe_files.hpp>
#include <motionlang/generate/finish_motion.hpp>
#include <motionlang/generate/gallery_prompts.hpp>
#include <motionlang/generate/guo_motions.hpp>
#include <motionlang/generate/joined_timeline.hpp>
#include <motionlang/generate/judged_clips.hpp>
#include <motionlang/generate/judged_prompts.hpp>
#include <motionlang/generate/kept_clip_text.hpp>
#include <motionlang/generate/latent_motion_model.hpp>
#include <motionlang/generate/load_trained_motion_model.hpp>
#include <motionlang/generate/missing_parts.hpp>
#include <motionlang/generate/reuse_notes.hpp>
#include <motionlang/generate/samples.hpp>
#include <motionlang/generate/shared_motions.hpp>
#include <motionlang/generate/studio_request.hpp>
#include <motionlang/generate/studio_server.hpp>
#include <motionlang/generate/text_warnings.hpp>
#include <motionlang/generate/timeline_tracks.hpp>
#include <motionlang/generate/timelines_of_text.hpp>
#include <motionlang/generate/token_clips.hpp>
#include <motionlang/search/text_similarity.hpp>
#include <motionlang/stmc.hpp>
#include <motionlang/systems/sinc_baseline.hpp>
#include <motionlang/train/shared_progress.hpp>
#include <motionlang/view/film_strip.hpp>
#include <motionlang/view/gallery_page.hpp>
#include <motionlang/view/loss_curves.hpp>
#include <motionlang/view/similarity_picture.hpp>
#include <motionlang/view/studio_page.hpp>
#include <motionlang/view/study_chart.hpp>
#include <motionlang/view/study_page.hpp>
#include <motionlang/view/viewer.hpp>

void precision_(Stmc<B> stmc) {
#include "backend/precision.1.inc"
}
void joined_(const Timeline& timeline, const std::unique_ptr<MotionModel>& sinc) {
#include "generate/joined_timeline.1.inc"
}
void describe_files_(const MotionDescriber<B>& describer, const std::vector<std::string>& inputs) {
#include "generate/describe_files.1.inc"
}
void kept_text(const Motion& clip) {
#include "generate/kept_clip_text.1.inc"
}
void reuse_(GenerateOptions options, const GenerateNotes& notes) {
#include "generate/reuse_notes.1.inc"
}
void overlay(Motion motion, const Motion& alone, const Timeline& timeline) {
#include "generate/arm_overlay.1.inc"
}
void finish(const Stmc<B>& stmc, const std::vector<double>& rows) {
#include "generate/finish_motion.1.inc"
}
void guo_motions(const GuoJudge<B>& judge, const GuoItems<B>& items) {
#include "generate/guo_motions.1.inc"
}
void missing_parts(const std::string& file, const BodyPartAnswers& answers) {
#include "generate/missing_parts.1.inc"
}
void token_clips_(const std::vector<Index>& codes) {
#include "generate/token_clips.1.inc"
}
void generate() {
#include "generate/generate_motion.1.inc"
}
void options_(const Stmc<B>& stmc, const Timeline& timeline) {
#include "generate/generate_options.1.inc"
}
void clips() {
#include "generate/judged_clips.1.inc"
}
void verbs(const Motion& motion) {
#include "generate/judged_verbs.1.inc"
}
void gallery_(const std::unique_ptr<MotionModel>& model) {
#include "generate/gallery_prompts.1.inc"
}
void gallery_page_(std::span<const GalleryCard> cards) {
#include "view/gallery_page.1.inc"
}
void study_page_(const std::string& table) {
#include "view/study_page.1.inc"
}
void studio_page_() {
#include "view/studio_page.1.inc"
}
void study_chart_(const Study& study, const std::vector<StudyAnswers>& answers) {
#include "view/study_chart.1.inc"
}
void curves_() {
#include "view/loss_curves.1.inc"
}
void text_similarity_(const SearchEncoder& tmr, const Motion& motion) {
#include "search/text_similarity.1.inc"
}
void similarity_picture_(const SearchEncoder& tmr, const std::vector<TextToLocate>& texts, const Motion& motion) {
#include "view/similarity_picture.1.inc"
}
void judge_(const std::unique_ptr<MotionModel>& model) {
#include "generate/judged_prompts.1.inc"
}
void latent_model(const std::unique_ptr<MotionModel>& model, const Timeline& walk, const Timeline& run) {
#include "generate/latent_motion_model.1.inc"
}
void load() {
#include "generate/load_motion_model.1.inc"
}
void load_trained() {
#include "generate/load_trained_motion_model.1.inc"
}
void shared_motions_(const std::unique_ptr<MotionModel>& model, const std::vector<Timeline>& timelines,
                     const AnyCommunicator& all) {
#include "generate/shared_motions.1.inc"
}
void shared_progress_(const AnyCommunicator& all, const std::unique_ptr<MotionModel>& model,
                      std::span<const Timeline> own_part, const Progress& caller) {
#include "train/shared_progress.1.inc"
}
void any_model() {
#include "generate/motion_model.1.inc"
}
void place_() {
#include "generate/motion_model_place.1.inc"
}
void samples(const Stmc<B>& stmc, const std::vector<Timeline>& timelines) {
#include "generate/samples.1.inc"
}
void warnings(const std::unique_ptr<MotionModel>& model, const std::vector<Timeline>& timelines,
              const GenerateOptions& options) {
#include "generate/text_warnings.1.inc"
}
void tracks(const Motion& motion, const Timeline& timeline) {
#include "generate/timeline_tracks.1.inc"
}
void timelines_() {
#include "generate/timelines_of_text.1.inc"
}
void baseline(const Stmc<B>& stmc, const Timeline& timeline) {
#include "systems/sinc_baseline.1.inc"
}
void stmc_() {
#include "systems/stmc.1.inc"
}
void words() {
#include "text/known_words.1.inc"
}
void project_(std::span<const std::byte> bytes) {
  const auto offer = [](const std::string&) {};
#include "file/project_folder.1.inc"
}
void studio_request_(const StudioHead& head, const std::string& token, std::string_view body) {
  const auto answer = [](int, const auto&) {};
#include "generate/studio_request.1.inc"
}
void studio_server_(std::unique_ptr<MotionModel> model, std::string_view body) {
  const auto send = [](std::string_view) { return true; };
#include "generate/studio_server.1.inc"
}
