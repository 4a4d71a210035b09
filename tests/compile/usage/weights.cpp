// Names that the usage examples of weights/ use without declaring them.
#include "usage.hpp"

#include <motionlang/file/json.hpp>
#include <motionlang/weights/actor_file.hpp>
#include <motionlang/weights/caption_encoder_file.hpp>
#include <motionlang/weights/diffusion_folder.hpp>
#include <motionlang/weights/diffusion_run.hpp>
#include <motionlang/weights/guo_evaluator_file.hpp>
#include <motionlang/weights/known_systems.hpp>
#include <motionlang/weights/mdm_action_run.hpp>
#include <motionlang/weights/module_file.hpp>
#include <motionlang/weights/pack_run.hpp>
#include <motionlang/weights/run_folder.hpp>
#include <motionlang/weights/teach_sinc_file.hpp>
#include <motionlang/weights/text_encoder_folder.hpp>
#include <motionlang/weights/text_motion_file.hpp>
#include <motionlang/weights/text_network_file.hpp>
#include <motionlang/weights/tm2t_run.hpp>
#include <motionlang/weights/tokenizer_json.hpp>
#include <motionlang/weights/vae_run.hpp>
#include <motionlang/weights/weight_file.hpp>
#include <motionlang/weights/word_vector_file.hpp>
#include <motionlang/weights/word_vector_source.hpp>

void actor_file() {
#include "weights/actor_file.1.inc"
}
void folder() {
#include "weights/diffusion_folder.1.inc"
}
void run_(const Timeline& timeline) {
#include "weights/diffusion_run.1.inc"
}
void systems() {
#include "weights/known_systems.1.inc"
}
void guo() {
#include "weights/guo_evaluator_file.1.inc"
}
void mdm(const std::vector<Index>& actions) {
#include "weights/mdm_action_run.1.inc"
}
void pack() {
#include "weights/pack_run.1.inc"
}
void run_folder() {
#include "weights/run_folder.1.inc"
}
void teach_sinc(const std::string& folder) {
#include "weights/teach_sinc_file.1.inc"
}
void text_folder() {
#include "weights/text_encoder_folder.1.inc"
}
void text_motion(const std::string& folder) {
#include "weights/text_motion_file.1.inc"
}
void networks() {
#include "weights/text_network_file.1.inc"
}
void tm2t_(const std::vector<std::string>& texts, const Sequences<B>& features) {
#include "weights/tm2t_run.1.inc"
}
void tokenizer_() {
#include "weights/tokenizer_json.1.inc"
}
void vae() {
#include "weights/vae_run.1.inc"
}
void weight_file(Linear<B>& model) {
#include "weights/weight_file.1.inc"
}
void caption_encoder_file() {
#include "weights/caption_encoder_file.1.inc"
}
void known_caption_file(const std::string& path) {
#include "weights/known_caption_file.1.inc"
}
void word_vector_source(const std::vector<std::string>& captions) {
#include "weights/word_vector_source.1.inc"
}
void word_vector_file(const WordVectors& table) {
#include "weights/word_vector_file.1.inc"
}
