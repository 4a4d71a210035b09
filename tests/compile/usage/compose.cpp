// Names that the usage examples of compose/ and datasets/ use without declaring them.
#include "usage.hpp"

#include <motionlang/compose/cut_texts.hpp>
#include <motionlang/compose/handovers.hpp>
#include <motionlang/compose/in_turn.hpp>
#include <motionlang/compose/long_texts.hpp>
#include <motionlang/compose/mtt_timelines.hpp>
#include <motionlang/compose/natural_lengths.hpp>
#include <motionlang/compose/sinc_composition.hpp>
#include <motionlang/compose/text_timeline.hpp>
#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/datasets/amass_releases.hpp>
#include <motionlang/datasets/annotations.hpp>
#include <motionlang/datasets/babel.hpp>
#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/datasets/humanml3d_source.hpp>
#include <motionlang/datasets/make_humanml3d.hpp>
#include <motionlang/datasets/sinc_items.hpp>
#include <motionlang/datasets/teach_pairs.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/stmc.hpp>
#include <motionlang/weights/known_caption_file.hpp>

void cut(const Stmc<B>& stmc, const Timeline& timeline, const Philox& rng) {
#include "compose/cut_texts.1.inc"
}
void hand_over(const Stmc<B>& stmc, const Timeline& timeline, const Philox& rng) {
#include "compose/handovers.1.inc"
}
void turn(const Stmc<B>& stmc, const Timeline& timeline, const Philox& rng) {
#include "compose/in_turn.1.inc"
}
void long_texts(const Stmc<B>& stmc, const Timeline& timeline, const Philox& rng) {
#include "compose/long_texts.1.inc"
}
void mtt() {
#include "compose/mtt_timelines.1.inc"
}
void lengths() {
#include "compose/natural_lengths.1.inc"
}
void times_of_text(const std::string& path, const Stmc<B>& stmc) {
#include "compose/text_timeline.1.inc"
}
void text() {
#include "compose/timeline_text.1.inc"
}
void amass(const BabelSequence& babel, const std::string& path) {
  struct {
    double fps;
  } sequence{20};
#include "datasets/amass_releases.1.inc"
}
void annotations() {
#include "datasets/annotations.1.inc"
}
void babel(const SpellingTable& spelling, Index frames) {
#include "datasets/babel.1.inc"
}
void make_humanml3d_() {
#include "datasets/make_humanml3d.1.inc"
}
void folder_of_clips(){
#include "datasets/humanml3d_folder.1.inc"
} std::vector<Vec3<double>> posed_joints(int model, int sequence, std::span<const Index> numbers);
void source(const HumanMl3dSource& row, Index frames, double fps, int model, int sequence) {
#include "datasets/humanml3d_source.1.inc"
}
void sinc(const std::vector<SincItem>& list_of_items, const BodyPartTable& table, std::size_t k, Philox& rng,
          const std::vector<Motion>& motions) {
#include "datasets/sinc_items.1.inc"
}
void teach(const std::vector<BabelLabel>& labels, Index frames) {
#include "datasets/teach_pairs.1.inc"
}
