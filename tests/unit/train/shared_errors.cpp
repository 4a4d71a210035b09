// Errors and motions as messages, and which motions are shown.
#include <motionlang/train/shared_errors.hpp>

#include <doctest/doctest.h>

namespace ml = motionlang;
using ml::Index;

TEST_CASE("errors of clips as a message: those that are taken add up to the same") {
  const auto frames = [](double shift) {
    ml::JointFrames out;
    for (int i = 0; i < 6 * 22; ++i) out.push_back({0.1 * i + shift * (i % 3), 0.3 * (i % 7), shift * i});
    return out;
  };
  const ml::RifkeVariant variant{.joints = 22, .z_up = true, .across = {{{2, 1}, {17, 16}}}, .floor = {7, 10, 8, 11}};
  ml::SampledErrors sent(ml::JointErrors(variant), 2), taken = sent;
  ml::MessageWriter out;
  for (const double shift : {0.01, 0.02}) {
    const auto clips = sent.clips({frames(shift), frames(2 * shift)}, frames(0.05));
    sent.add(clips);
    ml::put_clips(out, clips);
  }
  ml::put_clips(out, {});
  ml::MessageReader in(out.bytes());
  for (int i = 0; i < 2; ++i) taken.add(ml::take_clips(in));
  CHECK(ml::take_clips(in).empty());
  CHECK(in.at_end());
  CHECK(ml::errors_table(ml::named_errors(taken)) == ml::errors_table(ml::named_errors(sent)));
  CHECK(taken.best().ape.joints == sent.best().ape.joints);
  CHECK(taken.worst().ave.local == sent.worst().ave.local);
  CHECK(sent.best().ape.root != sent.worst().ape.root);
}

TEST_CASE("a motion of smplvelp as a message") {
  ml::SmplVelpMotion<float> motion;
  for (int i = 0; i < 4; ++i) motion.rotations.push_back(ml::Matrix3<float>::identity());
  motion.rotations[2](0, 1) = 0.5f;
  motion.trans = {{1, 2, 3}, {4, 5, 6}};
  ml::MessageWriter out;
  ml::put_smplvelp(out, motion);
  ml::MessageReader in(out.bytes());
  const auto taken = ml::take_smplvelp<float>(in);
  REQUIRE(taken.rotations.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) CHECK(taken.rotations[i].m == motion.rotations[i].m);
  CHECK(taken.trans == motion.trans);
  CHECK(in.at_end());
}

TEST_CASE("all items are shown, or those that a function chooses in their order") {
  const std::vector<std::string> texts{"walk", "turn", "walk", "sit"};
  const auto text_of = [&](Index i) { return texts[static_cast<std::size_t>(i)]; };
  CHECK(ml::shown_items(true, 4, {}, text_of) == std::vector<bool>(4, true));
  CHECK(ml::shown_items(false, 4, {}, text_of) == std::vector<bool>(4, false));
  Index left = 2;
  const auto first_walks = [&](const std::string& text) { return text == "walk" && left-- > 1; };
  CHECK(ml::shown_items(true, 4, first_walks, text_of) == std::vector<bool>{true, false, false, false});
}
